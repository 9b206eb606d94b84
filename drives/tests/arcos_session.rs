//! The ARCOS adapter alone, against a server that is scripted from the sheet.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use haltline::decision::{Action, Decision, Reason, StopStatus};
use haltline::input::{Motion, Twist};
use haltline::time::{Duration, Instant};
use haltline::units::{AngularSpeed, Speed};
use haltline_drives::arcos::command::number;
use haltline_drives::arcos::config::{Config, text};
use haltline_drives::arcos::sip::{Bumpers, Flags, Tail};
use haltline_drives::arcos::{Argument, Command, Deframer, Packet, Sip};
use haltline_drives::drive::{Drive, Fault, State};
use haltline_drives::robots::seekur_config;
use haltline_drives::seekur::Adapter;

fn at(ms: u64) -> Instant {
    Instant::from_us(1_000_000 + ms * 1000)
}

/// A server whose every packet is written by the test.
struct Script {
    adapter: Adapter,
    now_ms: u64,
    said: Vec<(u8, Option<i32>)>,
    deframer: Deframer,
}

fn adapter() -> Adapter {
    let file = haltline_robots::Robot::embedded("seekur_jr").unwrap();
    Adapter::new(seekur_config(&file), at(0))
}

impl Script {
    fn new() -> Self {
        Self {
            adapter: adapter(),
            now_ms: 0,
            said: Vec::new(),
            deframer: Deframer::default(),
        }
    }

    fn hear(&mut self, packet: Packet) {
        self.adapter
            .receive(packet.to_bytes().as_slice(), at(self.now_ms));
    }

    /// What the adapter says within `ms`; all of it is kept in `said`, too.
    fn wait(&mut self, ms: u64) -> Vec<(u8, Option<i32>)> {
        let mut new = Vec::new();
        for _ in 0..ms {
            self.now_ms += 1;
            let now = at(self.now_ms);
            self.adapter.tick(now);
            let mut room = [0; 300];
            let count = self.adapter.outgoing(&mut room, now);
            for byte in &room[..count] {
                let Some(packet) = self.deframer.push(*byte, now) else {
                    continue;
                };
                let packet = packet.unwrap();
                let command = Command::decode(&packet).unwrap();
                let value = match command.argument {
                    Argument::Int(value) => Some(value),
                    _ => None,
                };
                new.push((command.number, value));
            }
        }
        self.said.extend(&new);
        new
    }

    fn sip(&mut self, change: impl FnOnce(&mut Sip)) {
        let mut sip = Sip {
            flags: Flags(Flags::MOTORS),
            tail: Tail {
                battery_decivolts: Some(260),
                ..Tail::default()
            },
            ..Sip::default()
        };
        change(&mut sip);
        self.hear(sip.encode().unwrap());
    }

    fn config(&mut self, watchdog_ms: u16) {
        let words = Some(0);
        let config = Config {
            class: text(b"Pioneer"),
            subclass: text(b"seekurjr"),
            rotation_top_degps: words,
            speed_top_mmps: words,
            rotation_acceleration_top_degps2: words,
            acceleration_top_mmps2: words,
            sip_cycle_ms: Some(100),
            low_battery_decivolts: words,
            watchdog_ms: Some(watchdog_ms),
            ..Config::default()
        };
        self.hear(config.encode().unwrap());
    }

    fn handshake(&mut self) {
        assert_eq!(self.wait(299), [], "it listens first");
        for step in 0..3 {
            assert_eq!(self.wait(10), [(step, None)]);
            self.hear(Packet::new(step, if step == 2 { b"a\0b\0c\0" } else { &[] }).unwrap());
        }
        let said = self.wait(20);
        assert_eq!(said, [(number::OPEN, Some(1)), (number::CONFIG, Some(1))]);
        self.sip(|sip| sip.flags = Flags(0));
        self.config(2000);
    }

    fn decide(&mut self, linear_mps: f64, angular_radps: f64) -> Result<(), Fault> {
        let now = at(self.now_ms);
        let decision = Decision {
            action: Action::Pass,
            setpoint: Motion::Twist(Twist {
                linear: Speed::from_um_per_s((linear_mps * 1e6) as i32),
                angular: AngularSpeed::from_urad_per_s((angular_radps * 1e6) as i32),
            }),
            reason: Reason::None,
            status: StopStatus::Running,
            expires: now.plus(Duration::from_ms(42)),
            verdict: None,
            factor_permille: 1000,
        };
        self.adapter
            .send(&decision, now)
            .map_err(|error| error.fault)
    }

    /// Handshake, motors on, zero confirmed: decisions are sent.
    fn driving() -> Self {
        let mut script = Self::new();
        script.handshake();
        script.wait(100);
        script.adapter.enable(at(script.now_ms));
        script.wait(50);
        for _ in 0..3 {
            script.sip(|_| {});
            let _ = script.decide(0.0, 0.0);
            script.wait(40);
        }
        assert_eq!(script.adapter.state(), State::Driving);
        script.said.clear();
        script
    }
}

#[test]
fn the_adapter_opens_a_scripted_server_and_tells_it_zero_before_enable() {
    let mut script = Script::new();
    script.handshake();
    assert_eq!(script.adapter.state(), State::Disabled);
    let said = script.wait(100);
    let place = |wanted: (u8, Option<i32>)| said.iter().position(|got| *got == wanted);
    assert!(place((number::STOP, None)).is_some());
    assert!(place((number::VEL, Some(0))).is_some() && place((number::RVEL, Some(0))).is_some());
    assert!(place((number::JOYDRIVE, Some(0))).is_some());
    assert!(
        place((number::SETA, Some(500))).is_some() && place((number::SETA, Some(-500))).is_some()
    );
    assert!(place((number::ENABLE, Some(1))).is_none());
    script.adapter.enable(at(script.now_ms));
    let said = script.wait(60);
    assert_eq!(said[0], (number::STOP, None));
    assert_eq!(said.last(), Some(&(number::ENABLE, Some(1))));
}

#[test]
fn a_server_still_open_is_stopped_closed_and_asked_again() {
    let mut script = Script::new();
    assert_eq!(script.wait(100), []);
    script.sip(|sip| sip.moving = true);
    let said = script.wait(200);
    assert_eq!(
        said,
        [
            (number::STOP, None),
            (number::CLOSE, Some(1)),
            (number::SYNC0, None)
        ]
    );
    // One whose SIPs nobody can read is open, too.
    script.hear(Packet::new(0x33, &[1, 2, 3]).unwrap());
    assert_eq!(script.wait(20)[..2], said[..2]);
}

#[test]
fn a_server_that_wants_the_count_restarted_gets_it_once_it_is_quiet() {
    let mut script = Script::new();
    assert_eq!(script.wait(310), [(number::SYNC0, None)]);
    script.hear(Packet::new(0, &[]).unwrap());
    assert_eq!(script.wait(10), [(number::SYNC1, None)]);
    for _ in 0..3 {
        script.hear(Packet::new(255, &[]).unwrap());
    }
    assert_eq!(script.wait(140), []);
    assert_eq!(script.wait(20), [(number::SYNC0, None)]);
}

/// Echoes that come twice, or late, do not restart the count for ever.
#[test]
fn a_server_that_answers_everything_twice_is_opened() {
    let mut script = Script::new();
    assert_eq!(script.wait(310), [(number::SYNC0, None)]);
    for step in 0..3 {
        for _ in 0..2 {
            script.hear(Packet::new(step, if step == 2 { b"a\0b\0c\0" } else { &[] }).unwrap());
        }
        let said = script.wait(20);
        if step < 2 {
            assert_eq!(said, [(step + 1, None)]);
        } else {
            assert_eq!(said, [(number::OPEN, Some(1)), (number::CONFIG, Some(1))]);
        }
    }
    for _ in 0..2 {
        script.sip(|sip| sip.flags = Flags(0));
        script.config(2000);
    }
    assert_eq!(script.adapter.state(), State::Disabled);
}

/// A server that speaks of synchronisation is not open any more: the robot has restarted.
#[test]
fn a_driven_server_that_asks_for_a_new_count_has_restarted() {
    let mut script = Script::driving();
    script.decide(0.4, 0.0).unwrap();
    script.wait(20);
    script.hear(Packet::new(255, &[]).unwrap());
    assert_eq!(script.adapter.state(), State::Connecting);
    assert_eq!(script.adapter.fault().unwrap().fault, Fault::Reboot);
    assert_eq!(script.wait(310), [(number::SYNC0, None)]);
}

/// A configuration that comes later counts as well.
#[test]
fn a_watchdog_that_turns_out_to_be_off_takes_the_motors_back() {
    let mut script = Script::driving();
    script.decide(0.4, 0.0).unwrap();
    script.wait(20);
    script.config(0);
    assert_eq!(script.wait(2), [(number::STOP, None)]);
    assert_eq!(script.adapter.state(), State::Disabled);
    assert!(matches!(
        script.adapter.fault().unwrap().fault,
        Fault::DeadMan { .. }
    ));
}

/// The robot's own time counts, not the longer one of the file.
#[test]
fn a_shorter_watchdog_than_the_file_s_is_kept() {
    let mut script = Script::new();
    script.handshake();
    script.config(400);
    script.wait(100);
    script.adapter.enable(at(script.now_ms));
    for _ in 0..50 {
        script.wait(20);
        script.sip(|_| {});
        let _ = script.decide(0.0, 0.0);
    }
    assert_eq!(script.adapter.state(), State::Driving);
    // Nobody decides any more; something is said well within the watchdog's time.
    let mut quiet_ms = 0;
    for _ in 0..2000 {
        script.sip(|_| {});
        quiet_ms = if script.wait(1).is_empty() {
            quiet_ms + 1
        } else {
            0
        };
        assert!(quiet_ms < 200, "silent for {quiet_ms} ms");
    }
    // And half of it without a word is a gap already.
    for _ in 0..3 {
        let _ = script.decide(0.0, 0.0);
        script.wait(40);
    }
    script.sip(|_| {});
    script.decide(0.4, 0.0).unwrap();
    script.wait(20);
    script.now_ms += 250;
    script.sip(|_| {});
    assert_eq!(script.wait(2), [(number::STOP, None)]);
}

/// Odometry that this robot cannot have driven is none, and nobody drives on it.
#[test]
fn absurd_odometry_is_reported_and_stops() {
    let absurd: [fn(&mut Sip); 5] = [
        |sip| sip.x = 3000,
        |sip| sip.y = 0x7FFF - 2000,
        |sip| sip.heading = 2000,
        |sip| (sip.left, sip.right) = (i16::MAX, i16::MAX),
        |sip| (sip.left, sip.right) = (i16::MIN, i16::MAX),
    ];
    for change in absurd {
        let mut script = Script::driving();
        script.decide(0.4, 0.0).unwrap();
        script.wait(40);
        let _ = script.adapter.feedback();
        script.sip(change);
        assert_eq!(script.adapter.feedback(), None);
        assert_eq!(script.adapter.fault().unwrap().fault, Fault::Impossible);
        assert_eq!(script.wait(2), [(number::STOP, None)]);
        assert_eq!(script.decide(0.4, 0.0), Err(Fault::NotReady));
        script.wait(40);
        // Straight on from wherever it is now: the next step is measured again.
        script.sip(|sip| {
            change(sip);
            (sip.left, sip.right) = (0, 0);
        });
        assert!(script.adapter.feedback().is_some());
    }
}

/// A clock that jumps back would keep a decision in force; one that jumps ahead has passed it.
#[test]
fn a_clock_that_jumps_ends_the_motion() {
    for jump_ms in [-20_000_i64, -50, 1_500, 3_600_000] {
        let mut script = Script::driving();
        script.now_ms += 40_000;
        script.sip(|_| {});
        for _ in 0..4 {
            script.sip(|_| {});
            let _ = script.decide(0.0, 0.0);
            script.wait(40);
        }
        script.decide(0.4, 0.0).unwrap();
        script.wait(20);
        script.now_ms = (script.now_ms as i64 + jump_ms) as u64;
        let said = script.wait(1500);
        let last = said.iter().rev().find(|(number, _)| *number == number::VEL);
        let stopped = said.contains(&(number::STOP, None)) || last == Some(&(number::VEL, Some(0)));
        assert!(stopped, "{jump_ms} ms: {said:?}");
    }
}

#[test]
fn a_silent_server_is_dislodged_and_reported() {
    let mut script = Script::new();
    let said = script.wait(4000);
    assert!(said.contains(&(number::OPEN, Some(1))), "{said:?}");
    let fault = script.adapter.fault().unwrap();
    assert_eq!(fault.fault, Fault::NoAnswer);
    assert!(fault.to_string().contains("nobody answers"), "{fault}");
    assert_eq!(script.adapter.state(), State::Connecting);
    // And once more while it goes on.
    script.wait(15_000);
    assert_eq!(script.adapter.fault().unwrap().fault, Fault::NoAnswer);
}

#[test]
fn a_watchdog_that_is_off_or_too_long_or_not_told_keeps_the_motors_off() {
    for watchdog_ms in [0, 2001, u16::MAX] {
        let mut script = Script::new();
        script.handshake();
        script.config(watchdog_ms);
        script.wait(100);
        script.adapter.enable(at(script.now_ms));
        assert!(
            !script.wait(200).contains(&(number::ENABLE, Some(1))),
            "{watchdog_ms} ms"
        );
        let fault = script.adapter.fault().unwrap();
        assert!(matches!(fault.fault, Fault::DeadMan { .. }), "{fault}");
    }
    // No configuration at all: refused by default.
    let mut script = Script::new();
    script.wait(300);
    for step in 0..3 {
        script.wait(10);
        script.hear(Packet::new(step, if step == 2 { b"a\0b\0c\0" } else { &[] }).unwrap());
    }
    for _ in 0..15 {
        script.wait(100);
        script.sip(|sip| sip.flags = Flags(0));
    }
    assert_eq!(script.adapter.state(), State::Disabled);
    script.adapter.enable(at(script.now_ms));
    assert!(matches!(
        script.adapter.fault().unwrap().fault,
        Fault::DeadMan {
            found_ms: u16::MAX,
            ..
        }
    ));
}

//= spec/drive.md#drive-15
//= type=test
//# An adapter MUST stop and wait for the operator when the drive reports a pressed stop button or that its motors went off.
#[test]
fn a_stop_button_holds_until_the_operator_enables_again() {
    for (flags, fault) in [
        (Flags::MOTORS | Flags::STOP_BUTTON, Fault::StopButton),
        (0, Fault::MotorsOff),
    ] {
        let mut script = Script::driving();
        script.decide(0.4, 0.2).unwrap();
        script.wait(40);
        assert!(script.said.contains(&(number::VEL, Some(400))));
        script.sip(|sip| sip.flags = Flags(flags));
        assert_eq!(script.adapter.fault().unwrap().fault, fault);
        assert_eq!(script.wait(5)[0], (number::STOP, None));
        for _ in 0..20 {
            script.sip(|sip| sip.flags = Flags(0));
            let _ = script.decide(0.4, 0.2);
            let said = script.wait(40);
            assert!(!said.contains(&(number::ENABLE, Some(1))));
            assert!(
                said.iter()
                    .all(|(number, value)| *number != number::VEL || *value == Some(0))
            );
        }
        assert_eq!(script.adapter.state(), State::Disabled);
    }
}

#[test]
fn a_bumper_is_an_emergency_stop() {
    let mut script = Script::driving();
    script.decide(0.4, 0.0).unwrap();
    script.wait(40);
    script.sip(|sip| sip.bumpers = Bumpers(1 << 9));
    assert_eq!(script.wait(5), [(number::E_STOP, None)]);
    assert_eq!(script.adapter.fault().unwrap().fault, Fault::Bumper);
}

#[test]
fn a_keep_alive_carries_the_set_point() {
    let mut script = Script::driving();
    for _ in 0..40 {
        script.wait(50);
        script.sip(|_| {});
    }
    assert!(
        !script.said.contains(&(number::PULSE, None)),
        "{:?}",
        script.said
    );
    assert!(
        script
            .said
            .iter()
            .filter(|said| **said == (number::VEL, Some(0)))
            .count()
            >= 2
    );
}

#[test]
fn commands_keep_their_distance() {
    let mut script = Script::driving();
    let mut last: Option<u64> = None;
    for _ in 0..500 {
        if script.now_ms.is_multiple_of(40) {
            let _ = script.decide(0.3, 0.1);
            script.sip(|_| {});
        }
        if !script.wait(1).is_empty() {
            assert!(last.is_none_or(|last| script.now_ms - last >= 5));
            last = Some(script.now_ms);
        }
    }
}

/// Half a packet must not be completed on the next link.
#[test]
fn a_new_link_does_not_begin_with_the_rest_of_an_old_packet() {
    let mut script = Script::driving();
    script.decide(0.4, 0.0).unwrap();
    script.now_ms += 5;
    let now = at(script.now_ms);
    let mut half = [0; 4];
    assert_eq!(script.adapter.outgoing(&mut half, now), 4);
    script.adapter.reconnected(now);
    script.deframer = Deframer::default();
    // It listens, and an open server is stopped before anything else is said.
    assert_eq!(script.wait(100), []);
    script.sip(|_| {});
    assert_eq!(script.wait(5), [(number::STOP, None)]);
}
