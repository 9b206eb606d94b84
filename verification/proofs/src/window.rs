//! The admissible commands of a tick.

use crate::robot::{any_kinematics, any_limits, config};
use haltline::config::Kinematics;
use haltline::guard::hull::Vertex;
use haltline::input::{Motion, Twist};
use haltline::time::Duration;
use haltline::units::{AngularSpeed, Curvature, Speed};
use haltline::window::{admissible, desired, no_faster, setpoint};

fn any_twist() -> Twist {
    Twist {
        linear: Speed::from_um_per_s(kani::any()),
        angular: AngularSpeed::from_urad_per_s(kani::any()),
    }
}

fn any_vertex() -> Vertex {
    Vertex {
        twist: any_twist(),
        curvature: Curvature::from_urad_per_m(kani::any()),
    }
}

fn in_limits(fault: i64) {
    let (limits, kinematics) = (any_limits(), any_kinematics());
    let config = config(kinematics, limits);
    let (reference, candidate) = (any_vertex(), any_vertex());
    let step: u32 = kani::any();
    kani::assume(step <= 10_000_000);
    let step = Duration::from_us(u64::from(step));
    let accepted = admissible(&config, reference, candidate, step);
    kani::cover!(accepted && matches!(kinematics, Kinematics::Differential));
    kani::cover!(accepted && !matches!(kinematics, Kinematics::Differential));
    kani::assume(accepted);
    let v = i64::from(candidate.twist.linear.as_um_per_s());
    assert!(v + fault <= i64::from(limits.speed_forward.as_um_per_s()));
    assert!(-v <= i64::from(limits.speed_reverse.as_um_per_s()));
    match kinematics {
        Kinematics::Differential => {
            let w = i64::from(candidate.twist.angular.as_urad_per_s());
            assert!(w.abs() <= i64::from(limits.angular_speed.as_urad_per_s()));
        }
        Kinematics::Ackermann { curvature_max, .. } => {
            let bend = i64::from(candidate.curvature.as_urad_per_m());
            assert!(bend.abs() <= i64::from(curvature_max.as_urad_per_m()));
        }
    }
}

/// What is admissible lies within the limits of speed, reverse speed, turn rate and curvature; every
/// set point, limit and step up to 10 s.
//= spec/limit.md#limit-01
//= type=proof
//# The speed of every set point MUST lie between minus the reverse limit and the forward limit.
//= spec/limit.md#limit-02
//= type=proof
//# The turn rate of every set point MUST NOT exceed the turn rate limit in magnitude.
//= spec/limit.md#limit-03
//= type=proof
//# A set point MUST NOT be negative in speed where the reverse limit is zero.
//= spec/limit.md#limit-05
//= type=proof
//# The curvature of every Ackermann set point MUST NOT exceed the curvature limit in magnitude.
#[kani::proof]
#[kani::solver(cadical)]
fn admissible_lies_within_the_limits() {
    in_limits(0);
}

#[kani::proof]
#[kani::should_panic]
fn admissible_lies_within_the_limits_twin() {
    in_limits(1);
}

fn change_is_bounded(fault: i64) {
    let (limits, kinematics) = (any_limits(), any_kinematics());
    let config = config(kinematics, limits);
    let (reference, candidate) = (any_vertex(), any_vertex());
    // One second, so that the step of the rate is the rate itself.
    let step = Duration::from_us(1_000_000);
    kani::assume(admissible(&config, reference, candidate, step));
    let wide = |twist: Twist| i64::from(twist.linear.as_um_per_s());
    let change = (wide(candidate.twist) - wide(reference.twist)).abs();
    let most = limits
        .acceleration
        .as_um_per_s2()
        .max(limits.braking.as_um_per_s2());
    kani::cover!(change > 1000);
    // The difference saturates where it does not fit 32 bits; so does the step.
    let most = i64::from(most).min(i64::from(i32::MAX));
    assert!(change + fault <= most || most == i64::from(i32::MAX));
}

/// An admissible speed differs from the one before by no more than a step of acceleration or
/// braking; every set point and limit, a step of one second.
//= spec/limit.md#limit-04
//= type=proof
//# An accepted set point MUST differ from the one before by no more than the acceleration limits
//# allow in the time between them.
#[kani::proof]
#[kani::solver(cadical)]
fn admissible_is_reachable() {
    change_is_bounded(0);
}

#[kani::proof]
#[kani::should_panic]
fn admissible_is_reachable_twin() {
    change_is_bounded(1);
}

fn wrong_kind(fault: bool) {
    let kinematics = any_kinematics();
    let config = config(kinematics, any_limits());
    let motion = if kani::any() {
        Motion::Twist(any_twist())
    } else {
        Motion::Arc {
            linear: Speed::from_um_per_s(kani::any()),
            curvature: Curvature::from_urad_per_m(kani::any()),
        }
    };
    let twist = matches!(motion, Motion::Twist(_));
    let differential = matches!(kinematics, Kinematics::Differential);
    kani::assume(twist != differential || fault);
    kani::cover!(twist);
    kani::cover!(!twist);
    assert!(desired(&config, &motion).is_err());
}

/// A command of the wrong kind for the drive is refused; every command.
//= spec/limit.md#limit-09
//= type=proof
//# A desired motion of the wrong kind for the drive MUST be treated as malformed.
#[kani::proof]
fn the_wrong_kind_is_refused() {
    wrong_kind(false);
}

#[kani::proof]
#[kani::should_panic]
fn the_wrong_kind_is_refused_twin() {
    wrong_kind(true);
}

fn reverse_is_refused(fault: i32) {
    let kinematics = any_kinematics();
    let mut limits = any_limits();
    limits.speed_reverse = Speed::from_um_per_s(fault);
    let config = config(kinematics, limits);
    let linear = kani::any();
    kani::assume(linear < 0);
    let linear = Speed::from_um_per_s(linear);
    let motion = match kinematics {
        Kinematics::Differential => Motion::Twist(Twist {
            linear,
            angular: AngularSpeed::from_urad_per_s(kani::any()),
        }),
        Kinematics::Ackermann { .. } => Motion::Arc {
            linear,
            curvature: Curvature::from_urad_per_m(kani::any()),
        },
    };
    kani::cover!(matches!(kinematics, Kinematics::Differential));
    assert!(desired(&config, &motion).is_err());
}

/// Every command with a speed below zero is refused where the reverse limit is zero.
//= spec/limit.md#limit-03
//= type=proof
//# A set point MUST NOT be negative in speed where the reverse limit is zero.
#[kani::proof]
fn reverse_is_refused_where_nobody_looks() {
    reverse_is_refused(0);
}

#[kani::proof]
#[kani::should_panic]
fn reverse_is_refused_where_nobody_looks_twin() {
    reverse_is_refused(1);
}

fn never_faster(fault: bool) {
    let config = config(Kinematics::Differential, any_limits());
    let (vertex, measured) = (any_vertex(), any_twist());
    let slow = (vertex.twist.linear.as_um_per_s()).unsigned_abs()
        <= measured.linear.as_um_per_s().unsigned_abs();
    kani::assume(slow && vertex.twist.linear != Speed::ZERO);
    kani::cover!(vertex.twist.linear.as_um_per_s() > 1000);
    let start = no_faster(&config, vertex, measured);
    assert!(start == vertex && !(fault && start.twist.linear.as_um_per_s() == 77));
    let sent = setpoint(&config, start);
    assert!(matches!(sent, Motion::Twist(twist) if twist == start.twist));
}

/// A ramp to rest begins at the set point where the robot is measured no slower; every twist.
//= spec/brake.md#brake-06
//= type=proof
//# A braking set point MUST NOT exceed in magnitude the measured twist plus its tolerance, nor
//# the set point before it.
#[kani::proof]
fn a_ramp_begins_no_faster_than_measured() {
    never_faster(false);
}

#[kani::proof]
#[kani::should_panic]
fn a_ramp_begins_no_faster_than_measured_twin() {
    never_faster(true);
}
