//! The car's adapter alone, against a board that is scripted from the sheet; its emulator alone: `uc_board.rs`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use haltline::decision::{Action, Decision, Reason, StopStatus};
use haltline::input::Motion;
use haltline::time::{Duration, Instant};
use haltline::units::{Curvature, Speed};
use haltline_drives::car::Adapter;
use haltline_drives::drive::{Drive, Fault, State};
use haltline_drives::emulator::{Car, CarModel, Robot};
use haltline_drives::robots::car_config;
use haltline_drives::uc::daq::crc16;

fn at(ms: u64) -> Instant {
    Instant::from_us(1_000_000 + ms * 1000)
}

fn decision(linear_mps: f64, curvature_per_m: f64, now: Instant) -> Decision {
    Decision {
        action: Action::Pass,
        setpoint: Motion::Arc {
            linear: Speed::from_um_per_s((linear_mps * 1e6) as i32),
            curvature: Curvature::from_urad_per_m((curvature_per_m * 1e6) as i32),
        },
        reason: Reason::None,
        status: StopStatus::Running,
        expires: now.plus(Duration::from_ms(22)),
        verdict: None,
        factor_permille: 1000,
    }
}

/// A board whose every answer is written by the test; it streams a still gyro.
struct Script {
    adapter: Adapter,
    now_ms: u64,
    dead_man_ms: u32,
    session: u32,
    mute: bool,
    lines: Vec<String>,
    line: Vec<u8>,
}

impl Script {
    fn new(dead_man_ms: u32) -> Self {
        let file = haltline_robots::Robot::embedded("pses_car").unwrap();
        Self {
            adapter: Adapter::new(car_config(&file, 99), at(0)),
            now_ms: 0,
            dead_man_ms,
            session: 0,
            mute: false,
            lines: Vec::new(),
            line: Vec::new(),
        }
    }

    fn answer(&mut self, line: &str) -> String {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["?DRV", "~DMS"] => format!("F 0 ~DMS={}", self.dead_man_ms),
            [spoilt] if spoilt.len() > 1000 => "ERR(259)".to_owned(),
            ["!DRV", option] => option.to_string(),
            ["!DRV", mode, value, _] => format!("{mode} {value}"),
            ["!STEER", value, _] => value.to_string(),
            ["?SID"] => self.session.to_string(),
            ["!SID", session] => {
                self.session = session.parse().unwrap();
                "ok".to_owned()
            }
            ["!DAQ", "START"] => "started".to_owned(),
            ["!DAQ", "STOP"] => "ERR(1031)".to_owned(),
            _ => "ok".to_owned(),
        }
    }

    fn wait(&mut self, ms: u64) {
        for _ in 0..ms {
            self.now_ms += 1;
            let now = at(self.now_ms);
            if self.now_ms.is_multiple_of(10) {
                let sum = crc16(&[0, 0]).to_le_bytes();
                let data = format!("#2:0000{:02X}{:02X}\x03", sum[0], sum[1]);
                self.adapter.receive(data.as_bytes(), now);
            }
            self.adapter.tick(now);
            let mut room = [0; 600];
            let count = self.adapter.outgoing(&mut room, now);
            for byte in &room[..count] {
                if *byte != b'\n' {
                    self.line.push(*byte);
                    continue;
                }
                let line = String::from_utf8(std::mem::take(&mut self.line)).unwrap();
                let answer = self.answer(&line);
                self.lines.push(line);
                if !self.mute {
                    self.adapter
                        .receive(format!("\x02:{answer}\x03\n").as_bytes(), now);
                }
            }
        }
    }

    fn decide(&mut self, linear_mps: f64, curvature_per_m: f64, ms: u64) -> Result<(), Fault> {
        let mut result = Ok(());
        for _ in 0..ms / 20 {
            let now = at(self.now_ms);
            let decision = decision(linear_mps, curvature_per_m, now);
            result = self
                .adapter
                .send(&decision, now)
                .map_err(|error| error.fault);
            self.wait(20);
        }
        result
    }

    fn driving() -> Self {
        let mut script = Self::new(200);
        script.wait(2500);
        script.adapter.enable(at(script.now_ms));
        script.decide(0.0, 0.0, 100).unwrap();
        assert_eq!(
            script.adapter.state(),
            State::Driving,
            "{:?}",
            script.adapter.fault()
        );
        script.lines.clear();
        script
    }

    /// Lines that make the motor turn.
    fn thrusts(&self) -> Vec<&String> {
        let motor = |line: &&String| line.starts_with("!DRV F") || line.starts_with("!DRV B");
        let lines = self.lines.iter().filter(motor);
        lines
            .filter(|line| !line.contains(" 0") && !line.contains(" -"))
            .collect()
    }
}

#[test]
fn the_dead_man_time_is_set_and_read_back_before_anything_else_may_happen() {
    let mut script = Script::new(200);
    script.wait(400);
    let first: Vec<&str> = script
        .lines
        .iter()
        .map(String::as_str)
        .skip(1)
        .take(6)
        .collect();
    assert_eq!(
        first,
        [
            "!DRV F 0  0",
            "!DRV F 0  0",
            "!DRV ~DMS=200",
            "?DRV ~DMS",
            "!SID 99",
            "?SID"
        ]
    );
    assert_eq!(script.adapter.state(), State::Disabled);
}

#[test]
fn a_board_that_keeps_another_dead_man_time_is_never_driven() {
    for found in [0, 1000, 199] {
        let mut script = Script::new(found);
        script.wait(1000);
        assert_eq!(script.adapter.state(), State::Connecting);
        let fault = script.adapter.fault().unwrap().fault;
        assert_eq!(
            fault,
            Fault::DeadMan {
                wanted_ms: 200,
                found_ms: found as u16
            }
        );
        let _ = script.decide(0.4, 0.0, 1000);
        assert!(script.thrusts().is_empty());
    }
}

#[test]
fn every_thrust_follows_a_session_number_that_is_ours() {
    let mut script = Script::driving();
    script.decide(0.4, 0.0, 200).unwrap();
    assert!(script.thrusts().len() >= 9, "{:?}", script.lines);
    for pair in script.lines.windows(2) {
        if pair[1].starts_with("!DRV F") && !pair[1].contains(" 0") {
            assert_eq!(pair[0], "?SID");
        }
    }
}

#[test]
fn a_restarted_board_gets_no_thrust_at_all() {
    let mut script = Script::driving();
    script.decide(0.4, 0.0, 200).unwrap();
    script.lines.clear();
    script.session = 0;
    let _ = script.decide(0.4, 0.0, 2000);
    assert!(script.thrusts().is_empty(), "{:?}", script.thrusts());
    assert!(
        script.lines.contains(&"!DRV ~DMS=200".to_owned()),
        "the dead-man time is set again"
    );
}

#[test]
fn an_answer_that_does_not_come_is_noticed_within_the_dead_man_time() {
    let mut script = Script::driving();
    script.decide(0.4, 0.0, 200).unwrap();
    script.mute = true;
    let _ = script.decide(0.4, 0.0, 140);
    let fault = script.adapter.fault().unwrap();
    assert_eq!(fault.fault, Fault::NoAnswer, "{fault}");
    assert_eq!(script.adapter.state(), State::Connecting);
}

/// An answer that does not fit may mean that the board does something else: it is stopped before
/// anything is asked. A flipped bit makes `F -500`, the brake, a `D -500`, which drives.
#[test]
fn an_answer_that_does_not_fit_is_followed_by_a_stop_at_once() {
    let mut script = Script::driving();
    script.decide(0.4, 0.0, 200).unwrap();
    script.lines.clear();
    let now = at(script.now_ms);
    script.adapter.receive(b"\x02:D -500\x03", now);
    assert_eq!(script.adapter.state(), State::Connecting);
    script.wait(1);
    assert_eq!(script.lines.first().unwrap(), "!DRV F -500  -500");
}

/// The wheel sensor tells no direction, so a car that rolls is not told the other one.
#[test]
fn a_rolling_car_comes_to_rest_before_it_reverses() {
    let mut car = Car::new(CarModel::default(), at(0));
    let file = haltline_robots::Robot::embedded("pses_car").unwrap();
    let mut adapter = Adapter::new(car_config(&file, 99), at(0));
    let mut now_ms = 0;
    let mut run = |car: &mut Car, adapter: &mut Adapter, v: f64, ms: u64| {
        let mut worst: f64 = 0.0;
        for _ in 0..ms {
            now_ms += 1;
            let now = at(now_ms);
            if now_ms.is_multiple_of(20) {
                let decision = decision(v, 0.0, now);
                let _ = adapter.send(&decision, now);
            }
            adapter.tick(now);
            if adapter.state() == State::Disabled {
                adapter.enable(now);
            }
            let mut room = [0; 300];
            let count = adapter.outgoing(&mut room, now);
            car.receive(&room[..count], now);
            car.step(now);
            adapter.receive(&car.outgoing(), now);
            if let Some(told) = adapter.feedback() {
                let truth = car.truth().twist[0];
                // One that does not move may be told to move for as long as a pulse takes.
                if truth.abs() > 0.1 && told.twist[0] * truth < 0.0 {
                    worst = worst.max(truth.abs());
                }
            }
        }
        worst
    };
    run(&mut car, &mut adapter, 0.0, 3000);
    run(&mut car, &mut adapter, 0.5, 3000);
    assert!(car.truth().twist[0] > 0.4);
    // At once the other way, and back again: the feedback never has the wrong sign.
    assert!(run(&mut car, &mut adapter, -0.4, 4000) < 1e-9);
    assert!(car.truth().twist[0] < -0.3);
    assert!(run(&mut car, &mut adapter, 0.5, 4000) < 1e-9);
    assert!(car.truth().twist[0] > 0.4);
}

#[test]
fn a_curvature_beyond_the_wheels_is_a_stop_and_named() {
    let mut script = Script::driving();
    script.decide(0.4, 0.0, 200).unwrap();
    script.lines.clear();
    assert_eq!(script.decide(0.4, 2.5, 1200), Err(Fault::OutOfReach));
    let last = script
        .lines
        .iter()
        .rev()
        .find(|line| line.starts_with("!DRV"))
        .unwrap();
    assert!(last.contains(" 0  0") || last.contains(" -500"), "{last}");
}

#[test]
fn zero_after_forward_motion_is_the_brake_and_then_neutral() {
    let mut script = Script::driving();
    script.decide(0.4, 0.0, 200).unwrap();
    script.lines.clear();
    script.decide(0.0, 0.0, 200).unwrap();
    assert!(script.lines.contains(&"!DRV F -500  -500".to_owned()));
    script.decide(0.0, 0.0, 1000).unwrap();
    assert_eq!(
        script
            .lines
            .iter()
            .rfind(|l| l.starts_with("!DRV"))
            .unwrap(),
        "!DRV F 0  0"
    );
}

/// A host that died in the middle of a line has left its beginning in the board.
#[test]
fn a_line_somebody_else_began_is_spoiled_and_not_finished() {
    for begun in [
        "!DRV F 1000",
        "!DRV F 10",
        "!DRV F 1000 10",
        "!DRV F 1000 1000",
        "!DRV F 300 300 0",
        "!DRV B 500 500",
        "!DRV D -500 -500",
        "!STEER 90",
        "!DR",
        "",
    ] {
        let mut car = Car::new(CarModel::default(), at(0));
        car.receive(begun.as_bytes(), at(0));
        let file = haltline_robots::Robot::embedded("pses_car").unwrap();
        let mut adapter = Adapter::new(car_config(&file, 99), at(0));
        for ms in 1..3000 {
            adapter.tick(at(ms));
            let mut room = [0; 300];
            let count = adapter.outgoing(&mut room, at(ms));
            car.receive(&room[..count], at(ms));
            car.step(at(ms));
            adapter.receive(&car.outgoing(), at(ms));
            assert!(
                car.truth().twist[0].abs() < 1e-12,
                "{begun} drives at {ms} ms"
            );
        }
        assert_eq!(adapter.state(), State::Disabled, "after {begun}");
    }
}

/// Small writes and restarts never cut a line: every line the board gets is one of ours, whole.
#[test]
fn a_restart_in_the_middle_of_a_line_finishes_it() {
    for cut in 1..15 {
        let mut script = Script::driving();
        script.wait(5);
        let now = at(script.now_ms);
        script.adapter.tick(now.plus(Duration::from_ms(41)));
        let mut room = [0; 15];
        let count = script.adapter.outgoing(&mut room[..cut], now);
        assert_eq!(count, cut);
        // An answer to nothing: everything starts again.
        for _ in 0..20 {
            script.adapter.receive(b":nonsense\x03", now);
        }
        let mut rest = [0; 600];
        let more = script.adapter.outgoing(&mut rest, now);
        let said = [&room[..cut], &rest[..more]].concat();
        let said = String::from_utf8(said).unwrap();
        // The line that was begun, and then a stop for every restart.
        let stops = said.strip_prefix("!STEER 144  144\n").unwrap();
        assert_eq!(stops.replace("!DRV F 0  0\n", ""), "", "{said}");
        assert!(!stops.is_empty());
    }
}
