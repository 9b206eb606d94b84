//! A steered robot: braking holds the wheels (BRAKE-04).
#![allow(clippy::unwrap_used, clippy::panic, missing_docs)]
#![allow(clippy::arithmetic_side_effects, clippy::cast_possible_truncation)]
mod common;

use common::{Room, config};
use haltline::config::{Config, Kinematics};
use haltline::convert;
use haltline::decision::Decision;
use haltline::input::{Inputs, Motion, Reading, Scan, Twist};
use haltline::time::{Duration, Instant};
use haltline::units::{AngularSpeed, Curvature};

fn steered() -> Config<1> {
    let mut config = config();
    config.kinematics = Kinematics::Ackermann {
        curvature_max: Curvature::from_urad_per_m(1_000_000),
        curvature_tolerance: Curvature::from_urad_per_m(10_000),
        steering_sweep: Duration::from_ms(400),
    };
    config
}

/// One tick with the desired arc; the robot executes the answer.
fn tick(room: &mut Room, speed: f64, curvature: f64, reset: bool) -> Decision {
    let beams = room.beams();
    let scans = [Reading::Value(Scan {
        scanner: 0,
        stamp: Instant::from_us(room.now_us - 20_000),
        beams: &beams,
    })];
    let now = room.now();
    let inputs = Inputs {
        scans: &scans,
        odometry: Reading::Value(room.odometry()),
        command: convert::arc_command(now, speed, curvature),
        emergency_stop: false,
        reset: reset.then_some(now),
    };
    let decision = room.kernel.step(&inputs, now);
    room.execute(twist_of(&decision));
    decision
}

fn arc_of(decision: &Decision) -> (f64, f64) {
    match decision.setpoint {
        Motion::Arc { linear, curvature } => (
            f64::from(linear.as_um_per_s()) * 1e-6,
            f64::from(curvature.as_urad_per_m()) * 1e-6,
        ),
        Motion::Twist(_) => panic!("a steered drive gets arcs"),
    }
}

fn twist_of(decision: &Decision) -> Twist {
    let Motion::Arc { linear, .. } = decision.setpoint else {
        panic!("a steered drive gets arcs");
    };
    let (speed, curvature) = arc_of(decision);
    Twist {
        linear,
        angular: AngularSpeed::from_urad_per_s((speed * curvature * 1e6) as i32),
    }
}

/// A stop command with the wheels turned over once swung a moving car aside, uncertified.
//= spec/brake.md#brake-04
//= type=test
//# Braking set points of an Ackermann drive MUST keep the commanded curvature.
#[test]
fn a_stop_command_turns_no_wheel_while_the_car_moves() {
    let mut room = Room::new((-6.0, 9.0), (-4.0, 4.0), steered());
    for _ in 0..20 {
        let _ = tick(&mut room, 0.0, 0.0, false);
    }
    let _ = tick(&mut room, 0.0, 0.0, true);
    for _ in 0..40 {
        let _ = tick(&mut room, 0.6, 0.0, false);
    }
    assert!(room.twist[0] > 0.4, "it drives: {:?}", room.twist);
    let mut last = (1.0, 0.0);
    for _ in 0..20 {
        last = arc_of(&tick(&mut room, 0.0, 0.9, false));
        if last.0 > 0.0 {
            assert!(last.1.abs() < 1e-6, "the wheels hold: {last:?}");
        }
    }
    for _ in 0..60 {
        last = arc_of(&tick(&mut room, 0.0, 0.9, false));
    }
    assert!(
        last.0 == 0.0 && last.1 > 0.89,
        "at rest they turn: {last:?}"
    );
}
