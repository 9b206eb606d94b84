//! The car's emulator alone, against lines of somebody else's client; the adapter alone: `uc_session.rs`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use haltline::time::Instant;
use haltline_drives::emulator::{Car, CarModel, Robot};

fn at(ms: u64) -> Instant {
    Instant::from_us(1_000_000 + ms * 1000)
}

/// A car and a client that only knows lines.
struct Wire {
    car: Car,
    now_ms: u64,
}

impl Wire {
    fn new(model: CarModel) -> Self {
        Self {
            car: Car::new(model, at(0)),
            now_ms: 0,
        }
    }

    /// Says a line; the answer without its frame.
    fn say(&mut self, line: &str) -> String {
        self.car.outgoing();
        self.car
            .receive(format!("{line}\n").as_bytes(), at(self.now_ms));
        let said = String::from_utf8(self.car.outgoing()).unwrap();
        said.trim_matches(['\x02', '\x03', '\n']).to_owned()
    }

    fn wait(&mut self, ms: u64) -> String {
        for _ in 0..ms {
            self.now_ms += 1;
            self.car.step(at(self.now_ms));
        }
        String::from_utf8(self.car.outgoing()).unwrap()
    }

    fn speed(&self) -> f64 {
        self.car.truth().twist[0]
    }
}

#[test]
fn the_board_answers_as_the_sheet_says() {
    let mut wire = Wire::new(CarModel::default());
    let cases = [
        ("?DRV ~DMS", ":OFF ~DMS=0"),
        ("!drv f 300", ":F 300"),
        ("!DRV F 300 300", ":F 300"),
        ("!DRV F 300 301", ":ERR(269)"),
        ("!DRV F 1001", ":ERR(266)"),
        ("!DRV B -1", ":ERR(266)"),
        ("!DRV F 1000 10", ":ERR(269)"),
        ("?DRV", ":F 300"),
        // Faults of the firmware: a wrong number for what is none, an old one for what is missing.
        ("!DRV F +3", ":F -47"),
        ("!DRV F", ":F -47"),
        ("!DRV F 300", ":F 300"),
        ("!DRV", ":ok"),
        ("!DRV ~DMS=200", ":~DMS=200"),
        ("?DRV ~DMS", ":F 300 ~DMS=200"),
        ("!STEER -200 -200", ":-200"),
        ("?STEER", ":-200"),
        ("!STEER 1001", ":ERR(266)"),
        ("?SID", ":0"),
        ("!SID 77", ":77"),
        ("?SID", ":77"),
        ("!NONSENSE", ":ERR(264)"),
        ("NONSENSE", ":ERR(258)"),
        ("!DAQ START", ":started"),
        ("!DAQ STOP", ":stopped"),
        ("!DAQ GRP 3 HALL_CNT NOSUCH", ":ERR(1027)"),
        ("!DRV OFF", ":OFF"),
    ];
    for (line, answer) in cases {
        assert_eq!(wire.say(line), answer, "{line}");
    }
    // Firmware before 0.12.0 sends no STX.
    let mut old = Car::new(
        CarModel {
            sends_stx: false,
            ..CarModel::default()
        },
        at(0),
    );
    old.receive(b"?SID\n", at(0));
    assert_eq!(old.outgoing(), b":0\x03\n");
}

#[test]
fn without_dead_man_it_drives_on_for_ever_and_with_it_coasts() {
    let mut wire = Wire::new(CarModel::default());
    wire.say("!DRV F 400");
    wire.wait(10_000);
    assert!(wire.speed() > 0.5, "nothing stops it");
    wire.say("!DRV ~DMS=200");
    wire.say("?DRV");
    wire.wait(190);
    assert!(wire.speed() > 0.5);
    wire.wait(100);
    let v = wire.speed();
    // Neither a question nor the steering reloads it; and it rolls instead of braking.
    wire.say("!STEER 100");
    wire.wait(1000);
    assert!(
        (v - wire.speed() - 0.3).abs() < 0.01,
        "from {v} to {}",
        wire.speed()
    );
}

#[test]
fn negative_forward_brakes_and_reverse_comes_after_its_sequence() {
    let mut wire = Wire::new(CarModel::default());
    wire.say("!DRV F 400");
    wire.wait(2000);
    let v = wire.speed();
    wire.say("!DRV F -500");
    wire.wait(200);
    assert!(v - wire.speed() > 0.2, "the brake brakes");
    wire.wait(2000);
    assert!(wire.speed().abs() < 1e-9, "and never reverses");
    wire.say("!DRV B 300");
    wire.wait(190);
    assert!(
        wire.speed().abs() < 1e-9,
        "brake and neutral pulses come first"
    );
    wire.wait(1500);
    let back = wire.speed();
    assert!(back < -0.3);
    wire.say("!DRV F -500");
    wire.wait(500);
    // Not a brake any more: it only rolls out.
    assert!((wire.speed() - back - 0.15).abs() < 0.01);
}

#[test]
fn positive_levels_steer_right() {
    let mut wire = Wire::new(CarModel::default());
    wire.say("!STEER 700");
    wire.say("!DRV F 300");
    wire.wait(2000);
    assert!(wire.car.truth().twist[1] < -0.1);
    wire.say("!STEER -700");
    wire.wait(1000);
    assert!(wire.car.truth().twist[1] > 0.1);
}
