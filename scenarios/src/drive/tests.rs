//! Latency, lag, ramps, slip and watchdog against closed forms.

use super::*;

const DT: f64 = 0.01;

fn model() -> DriveModel {
    DriveModel {
        latency_us: 0,
        lag_s: 0.0,
        slip: 1.0,
        acceleration: 0.5,
        braking: 0.5,
        angular_acceleration: 1.0,
        angular_braking: 1.0,
        separate: false,
        silence: Silence::Brake,
        watchdog_us: 2_000_000,
        silent_braking: 0.3,
        silent_angular_braking: 0.5,
        curvature_rate: 2.0,
    }
}

/// Runs `drive` for `steps`, telling it `set_point` at each; returns the distance.
fn run(drive: &mut Drive, from_us: u64, steps: u64, set_point: Option<SetPoint>) -> f64 {
    let mut distance = 0.0;
    for step in 0..steps {
        let now = from_us + step * 10_000;
        if let Some(set_point) = set_point {
            drive.command(now, set_point);
        }
        distance += drive.step(now, DT).ground[0] * DT;
    }
    distance
}

fn twist(v: f64, omega: f64) -> Option<SetPoint> {
    Some(SetPoint::Twist { v, omega })
}

#[test]
fn braking_distance_is_v_squared_over_two_b() {
    let mut drive = Drive::new(model(), false, [1.0, 0.0]);
    let distance = run(&mut drive, 0, 300, twist(0.0, 0.0));
    assert!((distance - 1.0).abs() < 1e-9, "{distance}");
    assert!(drive.ground()[0].abs() < 1e-12);
}

#[test]
fn latency_adds_its_way() {
    let late = DriveModel {
        latency_us: 60_000,
        ..model()
    };
    let mut drive = Drive::new(late, false, [1.0, 0.0]);
    let distance = run(&mut drive, 0, 300, twist(0.0, 0.0));
    assert!((distance - 1.06).abs() < 1e-9, "{distance}");
}

#[test]
fn lag_is_first_order() {
    let lagging = DriveModel {
        lag_s: 0.2,
        acceleration: 1e3,
        ..model()
    };
    let mut drive = Drive::new(lagging, false, [0.0, 0.0]);
    run(&mut drive, 0, 20, twist(1.0, 0.0));
    let expected = 1.0 - libm::exp(-1.0);
    assert!((drive.ground()[0] - expected).abs() < 1e-9);
}

#[test]
fn joint_ramps_keep_the_curvature_and_separate_ones_do_not() {
    let mut joint = Drive::new(model(), false, [1.0, 0.5]);
    run(&mut joint, 0, 50, twist(0.0, 0.0));
    let [v, omega] = joint.ground();
    assert!((omega / v - 0.5).abs() < 1e-9 && (v - 0.75).abs() < 1e-9);
    let apart = DriveModel {
        separate: true,
        ..model()
    };
    let mut apart = Drive::new(apart, false, [1.0, 0.5]);
    run(&mut apart, 0, 50, twist(0.0, 0.0));
    let [v, omega] = apart.ground();
    assert!(omega.abs() < 1e-9 && (v - 0.75).abs() < 1e-9);
}

#[test]
fn slip_shows_on_the_ground_and_not_at_the_wheels() {
    let slipping = DriveModel {
        slip: 0.8,
        ..model()
    };
    let drive = Drive::new(slipping, false, [0.0, 0.5]);
    assert!((drive.ground()[1] - 0.4).abs() < 1e-12);
    assert!((drive.wheels()[1] - 0.5).abs() < 1e-12);
}

#[test]
fn silent_drive_stops_by_its_watchdog_and_does_not_revive_old_commands() {
    let mut drive = Drive::new(model(), false, [0.6, 0.0]);
    drive.command(0, SetPoint::Twist { v: 0.6, omega: 0.0 });
    let distance = run(&mut drive, 10_000, 600, None);
    // 2.0 s to notice (until the first step beyond it) at 0.6 m/s, then v^2 / (2 * 0.3).
    assert!((distance - (0.6 * 2.0 + 0.6)).abs() < 1e-9, "{distance}");
    run(&mut drive, 7_000_000, 1, twist(0.0, 0.0));
    assert!(drive.ground()[0].abs() < 1e-12);
}

#[test]
fn drive_without_watchdog_runs_for_ever() {
    let deaf = DriveModel {
        silence: Silence::None,
        ..model()
    };
    let mut drive = Drive::new(deaf, false, [0.6, 0.0]);
    let distance = run(&mut drive, 0, 1000, None);
    assert!((distance - 6.0).abs() < 1e-9);
}

#[test]
fn steering_takes_its_time() {
    let mut car = Drive::new(model(), true, [0.5, 0.0]);
    let left = SetPoint::Arc {
        v: 0.5,
        curvature: 1.0,
    };
    run(&mut car, 0, 25, Some(left));
    assert!((car.curvature() - 0.5).abs() < 1e-9);
    assert!((car.ground()[1] - 0.25).abs() < 1e-9);
}
