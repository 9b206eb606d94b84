//! The ARCOS emulator alone, against bytes a client of somebody else's sends.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use haltline::time::Instant;
use haltline_drives::arcos::config::Config;
use haltline_drives::arcos::sip::Flags;
use haltline_drives::arcos::{Deframer, Packet, Sip};
use haltline_drives::drive::{Drive, State};
use haltline_drives::emulator::{OutOfOrder, Robot, Seekur, SeekurModel};
use haltline_drives::robots::seekur_config;
use haltline_drives::seekur::{Adapter, skid_factor};

fn at(ms: u64) -> Instant {
    Instant::from_us(1_000_000 + ms * 1000)
}

fn hex(text: &str) -> Vec<u8> {
    let digits = text.as_bytes().chunks(2);
    digits
        .map(|pair| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap())
        .collect()
}

fn packets(bytes: &[u8]) -> Vec<Packet> {
    let mut deframer = Deframer::default();
    bytes
        .iter()
        .filter_map(|byte| deframer.push(*byte, at(0)))
        .map(Result::unwrap)
        .collect()
}

/// A robot and a client that only knows bytes.
struct Wire {
    robot: Seekur,
    now_ms: u64,
}

impl Wire {
    fn new(model: SeekurModel) -> Self {
        Self {
            robot: Seekur::new(model, at(0)),
            now_ms: 0,
        }
    }

    fn say(&mut self, bytes: &str) -> Vec<Packet> {
        self.robot.receive(&hex(bytes), at(self.now_ms));
        packets(&self.robot.outgoing())
    }

    fn wait(&mut self, ms: u64) -> Vec<Packet> {
        for _ in 0..ms {
            self.now_ms += 1;
            self.robot.step(at(self.now_ms));
        }
        packets(&self.robot.outgoing())
    }

    /// The bytes that an independent client library was seen to send.
    fn open(&mut self) {
        assert_eq!(self.say("fafb03000000"), [Packet::new(0, &[]).unwrap()]);
        assert_eq!(self.say("fafb03010001"), [Packet::new(1, &[]).unwrap()]);
        let names = self.say("fafb03020002");
        assert_eq!(names[0].id(), 2);
        assert_eq!(names[0].data().iter().filter(|byte| **byte == 0).count(), 3);
        self.say("fafb06013b0100023b"); // OPEN 1
        assert!(self.wait(101).iter().any(|packet| packet.id() == 0x32));
        self.say("fafb06043b0100053b"); // ENABLE 1
    }

    fn speed(&self) -> f64 {
        self.robot.truth().twist[0]
    }
}

#[test]
fn any_client_can_drive_the_emulator() {
    let mut wire = Wire::new(SeekurModel::default());
    wire.open();
    let config = wire.say("fafb06123b0100133b");
    let config = Config::decode(&config[0]).unwrap();
    assert_eq!(
        (config.watchdog_ms, config.sip_cycle_ms),
        (Some(2000), Some(100))
    );
    assert_eq!(config.subclass.as_slice(), b"seekurjr");
    wire.say("fafb060b3bf401ff3c"); // VEL 500
    let sips = wire.wait(1500);
    assert!((wire.speed() - 0.5).abs() < 1e-6);
    let sip = Sip::decode(sips.last().unwrap()).unwrap();
    assert!(sip.moving && sip.flags.has(Flags::MOTORS));
    assert_eq!((sip.left, sip.right), (500, 500));
    wire.say("fafb060b1bf401ff1c"); // VEL -500
    wire.wait(1900);
    wire.say("fafb03000000"); // PULSE
    wire.wait(1500);
    assert!((wire.speed() + 0.5).abs() < 1e-6, "{}", wire.speed());
    wire.say("fafb031d001d"); // STOP
    wire.wait(1500);
    assert!(wire.speed().abs() < 1e-9);
    wire.say("fafb06153b0f00243b"); // RVEL 15: counter-clockwise
    wire.wait(900);
    assert!((wire.robot.truth().twist[1].to_degrees() - 15.0).abs() < 1e-6);
    wire.say("fafb06203be7190754"); // VEL2: left +25, right -25 turns clockwise
    wire.wait(1900);
    assert!(wire.robot.truth().twist[1] < -0.5);
    wire.say("fafb06023b0100033b"); // CLOSE
    assert!(wire.wait(3000).is_empty(), "a closed server is silent");
    assert!(wire.speed().abs() < 1e-9);
}

#[test]
fn without_argument_open_and_close_work_too() {
    let mut wire = Wire::new(SeekurModel::default());
    for bytes in [
        "fafb03000000",
        "fafb03010001",
        "fafb03020002",
        "fafb03010001",
    ] {
        wire.say(bytes);
    }
    assert!(
        !wire.wait(200).is_empty(),
        "SIPs after OPEN without argument"
    );
    wire.say("fafb03020002");
    assert!(wire.wait(500).is_empty());
}

/// The other end of its line: the robot says that the button is pressed, and stays off until it is
/// enabled again.
#[test]
fn the_stop_button_of_the_emulator_switches_the_motors_off() {
    let mut wire = Wire::new(SeekurModel::default());
    wire.open();
    wire.say("fafb060b3bf401ff3c"); // VEL 500
    wire.wait(1500);
    wire.robot.press_stop(true);
    wire.say("fafb06043b0100053b"); // ENABLE 1 does not help while it is pressed
    let sip = Sip::decode(wire.wait(101).last().unwrap()).unwrap();
    assert!(sip.flags.has(Flags::STOP_BUTTON | Flags::E_STALL) && !sip.flags.has(Flags::MOTORS));
    wire.robot.press_stop(false);
    wire.wait(2000);
    assert!(wire.speed().abs() < 1e-9);
    wire.say("fafb03000000");
    let sip = Sip::decode(wire.wait(101).last().unwrap()).unwrap();
    assert!(!sip.flags.has(Flags::STOP_BUTTON) && !sip.flags.has(Flags::MOTORS));
    wire.say("fafb06043b0100053b");
    let sip = Sip::decode(wire.wait(101).last().unwrap()).unwrap();
    assert!(sip.flags.has(Flags::MOTORS) && !sip.flags.has(Flags::E_STALL));
}

/// Servers differ in what they make of a packet out of order; none of them may be upset by this client.
#[test]
fn the_adapter_opens_servers_of_every_habit() {
    for out_of_order in [OutOfOrder::Restart, OutOfOrder::Ignore, OutOfOrder::Adopt] {
        for tells_time in [true, false] {
            let mut robot = Seekur::new(
                SeekurModel {
                    out_of_order,
                    tells_time,
                    ..SeekurModel::default()
                },
                at(0),
            );
            let file = haltline_robots::Robot::embedded("seekur_jr").unwrap();
            let mut adapter = Adapter::new(seekur_config(&file), at(0));
            serve(&mut adapter, &mut robot, 0..2000);
            assert_eq!(adapter.state(), State::Disabled, "{out_of_order:?}");
        }
    }
}

fn serve(adapter: &mut Adapter, robot: &mut Seekur, span_ms: std::ops::Range<u64>) {
    for ms in span_ms {
        adapter.tick(at(ms));
        let mut room = [0; 300];
        let count = adapter.outgoing(&mut room, at(ms));
        robot.receive(&room[..count], at(ms));
        robot.step(at(ms));
        adapter.receive(&robot.outgoing(), at(ms));
    }
}

/// An earlier client has left a set point behind; the watchdog has stopped the robot. Whatever the
/// next client hears, the robot does not drive off again.
#[test]
fn a_set_point_left_behind_is_not_revived_by_a_handshake() {
    for (hears, half) in [
        (true, ""),
        (false, ""),
        (true, "fafb060b3bf4"),
        (true, "fafbff"),
    ] {
        let mut wire = Wire::new(SeekurModel::default());
        wire.open();
        wire.say("fafb060b3bf401ff3c"); // VEL 500
        wire.say(half);
        wire.wait(5000);
        let before = wire.robot.truth();
        assert!(before.twist[0].abs() < 1e-9);
        let file = haltline_robots::Robot::embedded("seekur_jr").unwrap();
        let mut adapter = Adapter::new(seekur_config(&file), at(5000));
        let mut fastest: f64 = 0.0;
        for ms in 5000..15_000 {
            adapter.tick(at(ms));
            let mut room = [0; 300];
            let count = adapter.outgoing(&mut room, at(ms));
            wire.robot.receive(&room[..count], at(ms));
            wire.robot.step(at(ms));
            let said = wire.robot.outgoing();
            if hears {
                adapter.receive(&said, at(ms));
            }
            fastest = fastest.max(wire.robot.truth().twist[0]);
        }
        let moved = wire.robot.truth().pose[0] - before.pose[0];
        // A robot that cannot be heard is not known to be open: a quarter of a second, once.
        let most = if hears { 0.003 } else { 0.14 };
        assert!(
            fastest <= most && moved < 0.04,
            "{half:?}: {fastest} m/s, {moved} m"
        );
        assert!(wire.robot.truth().twist[0].abs() < 1e-9);
        assert_eq!(hears, adapter.state() == State::Disabled);
    }
}

#[test]
fn a_sync_out_of_order_is_answered_with_255() {
    let mut wire = Wire::new(SeekurModel::default());
    assert_eq!(wire.say("fafb03020002")[0].id(), 255);
    wire.say("fafb03000000");
    assert_eq!(wire.say("fafb03000000")[0].id(), 255);
}

/// The trap of the manuals: after the watchdog's stop the next packet revives the set point.
#[test]
fn the_emulator_s_watchdog_stops_and_any_packet_revives() {
    let mut wire = Wire::new(SeekurModel::default());
    wire.open();
    wire.say("fafb060b3bf401ff3c"); // VEL 500
    wire.wait(1900);
    assert!(
        (wire.speed() - 0.5).abs() < 1e-6,
        "within the watchdog time it drives"
    );
    wire.wait(1500);
    assert!(
        wire.speed().abs() < 1e-6,
        "2 s and 1 s of braking later it rests"
    );
    wire.say("fafb03000000"); // PULSE
    wire.wait(1100);
    assert!(
        (wire.speed() - 0.5).abs() < 1e-6,
        "a PULSE has revived the old set point"
    );
}

/// Drives turns on a robot that skids, takes the true turn from outside, and gets its factor back.
#[test]
fn the_skid_factor_is_found_by_turning() {
    for skid in [0.5, 0.73, 1.0] {
        let mut turns = Vec::new();
        for bytes in ["fafb06153b0f00243b", "fafb06151b0f00241b"] {
            let mut wire = Wire::new(SeekurModel {
                skid,
                ..SeekurModel::default()
            });
            wire.open();
            wire.say(bytes); // RVEL 15 and -15
            let (mut counts, mut before) = (0_i64, None);
            for _ in 0..250 {
                for packet in wire.wait(100) {
                    let heading = i64::from(Sip::decode(&packet).unwrap().heading);
                    let step = before.map_or(0, |before: i64| heading - before);
                    counts += (step + 2048).rem_euclid(4096) - 2048;
                    before = Some(heading);
                }
                wire.say("fafb03000000");
            }
            let told = counts as f64 * std::f64::consts::TAU / 4096.0;
            turns.push((told, wire.robot.truth().pose[2]));
        }
        let fit = skid_factor(&turns).unwrap();
        assert!((fit.factor - skid).abs() < 0.002, "{skid}: {fit:?}");
        assert_eq!(fit.turns, 2);
    }
    assert!(skid_factor(&[]).is_none());
    assert!(skid_factor(&[(6.0, -4.0)]).is_none());
    assert!(skid_factor(&[(6.0, 7.0)]).is_none());
    assert!(skid_factor(&[(0.1, 0.1)]).is_none());
    assert!(skid_factor(&[(6.0, f64::NAN)]).is_none());
}
