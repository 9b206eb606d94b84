//! GUARD, BRAKE and LIMIT in closed loop: no admissible motion of an accepted tube touches.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

mod common;

use common::check;
use common::episode::{Episode, Lie, Style, episodes};
use common::report::Report;
use common::run::run;
use proptest::prelude::*;
use std::cell::RefCell;

const ALL: [Style; 5] = [
    Style::Reckless,
    Style::Wander,
    Style::Weave,
    Style::Spot,
    Style::Creep,
];

fn truthful(name: &str, cases: u32, styles: &[Style], moving: bool, change: fn(&mut Episode)) {
    let cases = common::cases(cases);
    let total = RefCell::new(Report::default());
    let strategy = episodes(styles.to_vec(), moving).prop_map(move |mut episode| {
        change(&mut episode);
        episode
    });
    check(cases, &strategy, |episode| {
        let report = run(&episode, 6.0);
        let bad: Vec<_> = report
            .contacts
            .iter()
            .chain(&report.crashes)
            .chain(&report.faults)
            .cloned()
            .collect();
        total.borrow_mut().add(report);
        prop_assert!(bad.is_empty(), "{} broken, first: {}", bad.len(), bad[0]);
        Ok(())
    });
    let total = total.into_inner();
    println!(
        "{name}: {} ticks, {} accepted steps ({} slowed), {} refused, {} motions, {:.0} m driven, \
         {} times a body was excused ({} steps could touch it), {} contacts with bodies never returned",
        total.ticks,
        total.accepted,
        total.slowed,
        total.refused,
        total.courses,
        total.path_m,
        total.excused,
        total.excused_contacts,
        total.unseen
    );
    assert!(
        total.accepted > 10 * cases as usize,
        "hardly anything was accepted"
    );
    assert!(
        total.refused > cases as usize,
        "hardly anything was refused"
    );
}

//= spec/guard.md#guard-01
//= type=test
//# The guard MUST refuse a motion when a known point lies in one of the inflated samples of its tube.
//= spec/brake.md#brake-02
//= type=test
//# At every tick the robot MUST be at rest or inside a tube that was accepted at an earlier tick and not yet left by time.
//= spec/limit.md#limit-01
//= type=test
//# The speed of every set point MUST lie between minus the reverse limit and the forward limit.
//= spec/limit.md#limit-02
//= type=test
//# The turn rate of every set point MUST NOT exceed the turn rate limit in magnitude.
//= spec/limit.md#limit-04
//= type=test
//# An accepted set point MUST differ from the one before by no more than the acceleration limits allow in the time
//# between them.
//= spec/silent.md#silent-01
//= type=test
//# Every decision MUST expire no later than one control period plus jitter after its tick.
//= spec/brake.md#brake-03
//= type=test
//# Braking set points of a differential drive MUST keep the ratio of speed to turn rate.
//= spec/latch.md#latch-07
//= type=test
//# The set point MUST NOT grow in magnitude while a stop is active.
#[test]
fn differential_in_a_static_world() {
    truthful("static", 60, &ALL, false, |episode| episode.steered = false);
}

//= spec/guard.md#guard-07
//= type=test
//# The obstacle term of a point at a sample MUST be no less than the obstacle speed bound times the sum of the point's age
//# at the odometry stamp and the latest time at which the robot can be at that sample and still move.
#[test]
fn differential_among_moving_bodies() {
    truthful("moving", 60, &ALL, true, |episode| episode.steered = false);
}

//= spec/guard.md#guard-13
//= type=test
//# The curvature interval of an Ackermann tube MUST contain every wheel angle the steering can have at any moment of the
//# tube, widened by the curvature tolerance.
//= spec/limit.md#limit-05
//= type=test
//# The curvature of every Ackermann set point MUST NOT exceed the curvature limit in magnitude.
#[test]
fn steered_in_a_static_world() {
    truthful("steered", 60, &ALL, false, |episode| episode.steered = true);
}

#[test]
fn steered_among_moving_bodies() {
    truthful("steered, moving", 40, &ALL, true, |episode| {
        episode.steered = true
    });
}

//= spec/guard.md#guard-11
//= type=test
//# Where the drive may ramp speed and turn rate separately, the tube MUST contain every trajectory in which either of
//# them reaches zero first.
#[test]
fn separate_ramps() {
    truthful("separate", 60, &ALL, false, |episode| {
        episode.steered = false;
        episode.separate = true;
    });
}

//= spec/guard.md#guard-12
//= type=test
//# With host death covered, the tube MUST contain every trajectory in which the drive goes on until its watchdog time
//# has passed since it received the last decision and then brakes by itself.
#[test]
fn host_death_covered() {
    truthful("host death", 60, &ALL, false, |episode| {
        episode.steered = false;
        episode.watchdog_ms = Some(300);
    });
}

/// A lie of the given kind must lead to contacts, or the tests above show nothing.
fn twin(lie: Lie, cases: u32, moving: bool, change: fn(&mut Episode)) {
    let total = RefCell::new(Report::default());
    let strategy = episodes(ALL.to_vec(), moving).prop_map(move |mut episode| {
        // Nothing but the margin in question, so that no other covers for it.
        episode.steered = false;
        episode.tol_v_mps = 0.0;
        episode.tol_omega_radps = 0.0;
        episode.tracking_m = 0.0;
        episode.sensor_m = 0.0;
        episode.beams = 700;
        change(&mut episode);
        episode.lie = lie;
        episode
    });
    check(cases, &strategy, |episode| {
        // One contact shows what is to be shown.
        if total.borrow().contacts.is_empty() {
            total.borrow_mut().add(run(&episode, 6.0));
        }
        Ok(())
    });
    let total = total.into_inner();
    println!(
        "false twin {lie:?}: {} accepted steps, {} with a contact, {} crashes",
        total.accepted,
        total.contacts.len(),
        total.crashes.len()
    );
    assert!(
        !total.contacts.is_empty(),
        "{lie:?}: the oracle found nothing"
    );
}

//= spec/guard.md#guard-06
//= type=test
//# Every sample MUST be inflated by no less than the sum of sensor error, beam gap, odometry error, obstacle motion,
//# tracking error, sampling, spread and rounding as derived in the model.
#[test]
fn false_twins() {
    twin(Lie::Latency, 20, false, |e| e.latency_ms = 250);
    twin(Lie::ObstacleSpeed, 20, true, |_| {});
    twin(Lie::Tracking, 20, false, |e| e.tracking_m = 0.06);
    twin(Lie::Sensor, 60, false, |e| {
        e.sensor_m = 0.08;
        e.style = Style::Reckless;
    });
    twin(Lie::SpeedTolerance, 20, false, |e| e.tol_v_mps = 0.1);
    twin(Lie::TurnTolerance, 40, false, |e| e.tol_omega_radps = 0.3);
    twin(Lie::Braking, 20, false, |_| {});
    twin(Lie::AngularBraking, 20, false, |e| {
        e.angular_braking_radps2 = 0.5
    });
    twin(Lie::SteeringSweep, 60, false, |e| {
        e.steered = true;
        e.latency_ms = 0;
        e.style = Style::Weave;
    });
    twin(Lie::ScanTime, 60, false, |e| {
        e.scan_ms = 90;
        e.turn_radps = 2.0;
        e.angular_braking_radps2 = 3.0;
    });
    twin(Lie::JointRamps, 60, false, |e| {
        e.separate = true;
        e.speed_mps = 0.8;
        e.turn_radps = 1.0;
        e.braking_mps2 = 0.5;
        e.angular_braking_radps2 = 3.0;
        e.harder = 1.0;
    });
    twin(Lie::Footprint, 20, false, |_| {});
    twin(Lie::HostDeath, 20, false, |e| e.watchdog_ms = Some(300));
}
