//! Rules of a single tick, seen at the kernel's door: hold time, ramp, speed list, odometry that cannot be.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

#[path = "../../kernel/tests/common/mod.rs"]
mod room;

use haltline::decision::{Action, Decision, Reason, StopStatus};
use haltline::geometry::frame::PointMm;
use haltline::input::{Beam, Inputs, Motion, Odometry, Reading, Scan};
use haltline::time::Instant;
use haltline::window::FACTORS_PERMILLE;
use room::{Room, config, m};

fn twist(decision: &Decision) -> (i32, i32) {
    match decision.setpoint {
        Motion::Twist(twist) => (twist.linear.as_um_per_s(), twist.angular.as_urad_per_s()),
        other => panic!("a differential drive gets twists: {other:?}"),
    }
}

/// A robot that was released and has been driving for some ticks.
fn driving(ahead_m: f64, command: (f64, f64), ticks: usize) -> Room {
    let mut room = Room::new((-6.0, ahead_m), (-6.0, 6.0), config());
    let _ = room.start();
    for _ in 0..ticks {
        let _ = room.tick(Some(command), false);
    }
    room
}

/// The kernel's answer in this tick, with odometry of that age; the room stays as it is.
fn asked(room: &Room, odometry: Odometry, command: (f64, f64)) -> Decision {
    let beams = room.beams();
    let scans = [Reading::Value(Scan {
        scanner: 0,
        stamp: Instant::from_us(room.now_us - 30_000),
        beams: &beams,
    })];
    let inputs = Inputs {
        scans: &scans,
        odometry: Reading::Value(odometry),
        command: room.command(command.0, command.1),
        ..Inputs::default()
    };
    room.kernel.clone().step(&inputs, room.now())
}

//= spec/guard.md#guard-04
//= type=test
//# The hold time of a tube MUST be at least the age of the odometry sample plus control period, jitter and actuation
//# latency, counted from the odometry stamp, at whose pose the tube starts.
#[test]
fn old_odometry_is_paid_for_by_the_hold_time() {
    let room = driving(20.0, (0.5, 0.0), 60);
    for age_us in [0_u64, 5_000, 9_000] {
        let mut odometry = room.odometry();
        odometry.stamp = Instant::from_us(room.now_us - age_us);
        odometry.pose.x_um -= (age_us / 2).cast_signed();
        let decision = asked(&room, odometry, (0.5, 0.0));
        let verdict = decision.verdict.expect("a verdict");
        assert_eq!(verdict.refusal, None, "{decision:?}");
        // Period, jitter, latency; then at least 0.5 / 0.5 s of braking.
        let hold = age_us + 40_000 + 2_000 + 100_000;
        assert!(
            verdict.stopping_time.as_us() >= hold + 1_000_000,
            "{verdict:?} at {age_us} us"
        );
        let path_um = u64::try_from(verdict.stopping_path.as_um()).unwrap();
        assert!(path_um >= hold / 2 + 250_000, "{verdict:?} at {age_us} us");
    }
}

//= spec/brake.md#brake-05
//= type=test
//# A braking set point MUST ask for no more speed and no more turn rate than a ramp at the sure decelerations, begun at
//# the first braking tick, has left at the expiry of the decision.
#[test]
fn braking_keeps_to_the_ramp_also_when_ticks_are_late() {
    for late_us in [0_u64, 2_000] {
        let mut room = driving(20.0, (0.8, 0.4), 80);
        let mut began: Option<(Instant, [f64; 2])> = None;
        let mut braking = 0;
        for _ in 0..60 {
            room.now_us += late_us;
            let (now, before) = (room.now(), room.twist);
            // Without a command the robot brakes as soon as the last one is too old.
            let decision = room.tick(None, false);
            if decision.action == Action::Pass {
                continue;
            }
            let (since, from) = *began.get_or_insert((now, before));
            let stop_s = (from[0] / 0.5).max(from[1]);
            let span_s = decision.expires.since(since).unwrap().as_us() as f64 * 1e-6;
            let left = (1.0 - span_s / stop_s).max(0.0);
            let (v, w) = twist(&decision);
            assert!(f64::from(v) <= from[0] * left * 1e6 + 5.0, "{v} um/s");
            assert!(f64::from(w) <= from[1] * left * 1e6 + 5.0, "{w} urad/s");
            braking += usize::from(v > 0);
        }
        assert!(
            braking > 30 && room.twist.iter().all(|rate| rate.abs() < 1e-9),
            "{braking}"
        );
    }
}

//= spec/limit.md#limit-06
//= type=test
//# When limits and dynamic window leave no admissible set point, the kernel MUST brake.
#[test]
fn an_empty_window_brakes() {
    let mut room = driving(20.0, (0.0, 0.0), 3);
    // A microsecond later acceleration allows nothing yet.
    room.now_us -= 40_000 - 1;
    let decision = room.tick(Some((0.5, 0.0)), false);
    assert_eq!(decision.action, Action::Brake, "{decision:?}");
    assert_eq!(decision.reason, Reason::EmptyWindow);
    assert_eq!(twist(&decision), (0, 0));
    let next = room.tick(Some((0.5, 0.0)), false);
    assert_eq!(next.action, Action::Pass, "{next:?}");
}

//= spec/limit.md#limit-07
//= type=test
//# `limit` MUST return the fastest motion of its fixed, descending list of speed factors that the guard accepts.
#[test]
fn every_faster_factor_of_the_list_was_refused() {
    assert!(FACTORS_PERMILLE.is_sorted_by(|a, b| a > b));
    let mut room = driving(4.0, (1.0, 0.0), 1);
    let (mut slowed, mut refused) = (0, 0);
    for _ in 0..250 {
        let before = room.kernel.clone();
        let odometry = room.odometry();
        let now = room.now();
        let decision = room.tick(Some((1.0, 0.0)), false);
        if decision.action != Action::Slow {
            continue;
        }
        slowed += 1;
        let mut earlier = Room::new((-6.0, 4.0), (-6.0, 6.0), config());
        (earlier.kernel, earlier.now_us) = (before, now.as_us());
        earlier.pose = [
            odometry.pose.x_um as f64 * 1e-6,
            odometry.pose.y_um as f64 * 1e-6,
            0.0,
        ];
        earlier.twist = [f64::from(odometry.twist.linear.as_um_per_s()) * 1e-6, 0.0];
        for &factor in &FACTORS_PERMILLE {
            let mut same = Room {
                kernel: earlier.kernel.clone(),
                ..Room::new((-6.0, 4.0), (-6.0, 6.0), config())
            };
            (same.now_us, same.pose, same.twist) = (earlier.now_us, earlier.pose, earlier.twist);
            let alone = same.tick(Some((f64::from(factor) * 1e-3, 0.0)), false);
            let accepted = alone.action == Action::Pass;
            if factor > decision.factor_permille {
                refused += 1;
                // The window may keep two factors from differing at all.
                assert!(
                    !accepted || alone.setpoint == decision.setpoint,
                    "{factor} was accepted alone: {alone:?} and not by {decision:?}"
                );
            } else if factor == decision.factor_permille {
                assert!(accepted, "{alone:?} by {decision:?}");
                assert_eq!(alone.setpoint, decision.setpoint);
            }
        }
    }
    assert!(slowed >= 8 && refused > 40, "{slowed} slowed, {refused}");
}

//= spec/limit.md#limit-08
//= type=test
//# A motion that `limit` slowed MUST keep the curvature of the motion it was derived from.
#[test]
fn what_is_slowed_keeps_its_arc() {
    // Nothing returns, so known space ends 0.9 m ahead of the scanner wherever the robot is.
    let mut config = config();
    config.scanners[0].as_mut().unwrap().no_return_clear = m(0.9);
    let mut room = Room::new((-6.0, 6.0), (-6.0, 6.0), config);
    let (mut slowed, mut fastest) = (0, 0);
    for tick in 0..200 {
        let decision = room.told(
            &[Beam::NoReturn; 541],
            20_000,
            Some((1.2, 0.24)),
            tick == 10,
        );
        let (v, w) = twist(&decision);
        fastest = fastest.max(v);
        // From rest, through every change of factor, and down again.
        assert!((w * 5 - v).abs() <= 100, "{decision:?}");
        slowed += usize::from(decision.action == Action::Slow);
    }
    assert!(slowed > 20 && fastest > 400_000, "{slowed}, {fastest} um/s");
}

//= spec/input.md#input-12
//= type=test
//# The kernel MUST stop when odometry pose and odometry twist contradict each other.
#[test]
fn a_pose_that_moves_otherwise_than_the_twist_says_stops() {
    for (shift_um, contradicts) in [(0, false), (10_000, false), (30_000, true)] {
        let room = driving(20.0, (0.3, 0.0), 30);
        let mut odometry = room.odometry();
        // A jump would be more than 1.35 m/s for 40 ms and 10 mm; half of that is only odd.
        odometry.pose.x_um += shift_um;
        let decision = asked(&room, odometry, (0.3, 0.0));
        let stops = decision.reason == Reason::OdometryInconsistent;
        assert_eq!(stops, contradicts, "{shift_um} um: {decision:?}");
        assert_eq!(decision.action == Action::ProtectiveStop, contradicts);
    }
}

//= spec/memory.md#memory-11
//= type=test
//# A reset MUST forget what was known when the odometry is no longer continuous.
#[test]
fn a_jump_of_the_odometry_forgets_what_was_known() {
    let mut room = driving(3.0, (0.0, 0.0), 3);
    let behind = PointMm { x: -500, y: 0 };
    assert!(room.kernel.memory().seen.is_known(behind));
    assert!(room.kernel.memory().clouds().flatten().count() > 0);
    let mut odometry = room.odometry();
    odometry.pose.y_um += 5_000_000;
    let inputs = Inputs {
        odometry: Reading::Value(odometry),
        ..Inputs::default()
    };
    let now = room.now();
    let decision = room.kernel.step(&inputs, now);
    assert_eq!(decision.reason, Reason::OdometryJump, "{decision:?}");
    assert_eq!(decision.status, StopStatus::Protective);
    assert_eq!(room.kernel.memory().clouds().flatten().count(), 0);
    assert!(!room.kernel.memory().seen.is_known(PointMm {
        x: behind.x,
        y: behind.y + 3_000,
    }));
}

//= spec/fresh.md#fresh-04
//= type=test
//# Data stamped later than `now` MUST be treated as stale.
#[test]
fn a_scan_that_is_not_over_yet_is_from_the_future() {
    // The last beam is 20 ms younger than the stamp, that of the first.
    for (age_us, future) in [(20_000, false), (19_000, true), (1_000, true)] {
        let mut room = driving(20.0, (0.3, 0.0), 30);
        let beams = room.beams();
        let decision = room.told(&beams, age_us, Some((0.3, 0.0)), false);
        assert_eq!(
            decision.reason == Reason::ScanFuture,
            future,
            "{decision:?}"
        );
        assert_eq!(decision.action == Action::ProtectiveStop, future);
    }
}
