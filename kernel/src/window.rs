//! The admissible commands of one tick: speed limits and what acceleration allows (LIMIT).
//!
//! Everything here works on the commanded motion, not the measured one; the guard's
//! hull contains both.

use crate::arith::{magnitude, narrow};
use crate::config::{Config, Kinematics};
use crate::decision::Reason;
use crate::guard::hull::Vertex;
use crate::input::{Motion, Twist};
use crate::time::Duration;
use crate::units::{AngularSpeed, Curvature, Speed};

/// Speed factors in thousandths, fastest first: what the shield tries.
///
/// The verdict is not monotone in speed, so each is certified by itself; the
/// promise is "the fastest of this list".
pub const FACTORS_PERMILLE: [u16; 10] = [1000, 850, 700, 550, 400, 300, 200, 120, 60, 30];

/// The desired motion as a vertex within the speed limits, and whether it had to be scaled.
///
/// # Errors
/// [`Reason::CommandMalformed`] if the command is of the wrong kind for the drive,
/// [`Reason::ReverseNotAllowed`] if it reverses where nobody looks.
pub fn desired<const S: usize>(
    config: &Config<S>,
    motion: &Motion,
) -> Result<(Vertex, bool), Reason> {
    let vertex = match (config.kinematics, motion) {
        (Kinematics::Differential, Motion::Twist(twist)) => Vertex {
            twist: *twist,
            curvature: Curvature::ZERO,
        },
        (Kinematics::Ackermann { curvature_max, .. }, Motion::Arc { linear, curvature }) => {
            if magnitude(curvature.as_urad_per_m()) > magnitude(curvature_max.as_urad_per_m()) {
                return Err(Reason::CommandMalformed);
            }
            arc(*linear, *curvature)
        }
        //= spec/limit.md#limit-09
        //# A desired motion of the wrong kind for the drive MUST be treated as malformed.
        _ => return Err(Reason::CommandMalformed),
    };
    let limits = &config.limits;
    let v = vertex.twist.linear.as_um_per_s();
    //= spec/limit.md#limit-03
    //# A set point MUST NOT be negative in speed where the reverse limit is zero.
    if v < 0 && limits.speed_reverse == Speed::ZERO {
        return Err(Reason::ReverseNotAllowed);
    }
    let top = if v < 0 {
        limits.speed_reverse
    } else {
        limits.speed_forward
    };
    let over = |value: i32, limit: i32| {
        magnitude(limit)
            .saturating_mul(1_000_000)
            .checked_div(magnitude(value))
            .unwrap_or(1_000_000)
            .min(1_000_000)
    };
    let scale = over(v, top.as_um_per_s()).min(over(
        vertex.twist.angular.as_urad_per_s(),
        limits.angular_speed.as_urad_per_s(),
    ));
    if scale >= 1_000_000 {
        return Ok((vertex, false));
    }
    let part = i64::try_from(scale).unwrap_or(0);
    Ok((scaled(vertex, part, 1_000_000), true))
}

/// A motion along the wheels' arc.
fn arc(linear: Speed, curvature: Curvature) -> Vertex {
    let turn = i64::from(linear.as_um_per_s())
        .saturating_mul(i64::from(curvature.as_urad_per_m()))
        .div_euclid(1_000_000);
    Vertex {
        twist: Twist {
            linear,
            angular: AngularSpeed::from_urad_per_s(narrow(turn)),
        },
        curvature,
    }
}

/// `vertex` times `part / whole`, towards zero, on the same curvature.
//= spec/limit.md#limit-08
//# A motion that `limit` slowed MUST keep the curvature of the motion it was derived from.
fn scaled(vertex: Vertex, part: i64, whole: i64) -> Vertex {
    let times = |value: i32| {
        narrow(
            i64::from(value)
                .saturating_mul(part)
                .checked_div(whole)
                .unwrap_or(0),
        )
    };
    Vertex {
        twist: Twist {
            linear: Speed::from_um_per_s(times(vertex.twist.linear.as_um_per_s())),
            angular: AngularSpeed::from_urad_per_s(times(vertex.twist.angular.as_urad_per_s())),
        },
        curvature: vertex.curvature,
    }
}

/// The command nearest to `desired · factor` that acceleration allows `step` after `reference`.
///
/// Speed and turn rate take the same share of their ways: between two motions of one curvature the
/// curvature stays, also while the robot speeds up or slows down.
#[must_use]
pub fn towards<const S: usize>(
    config: &Config<S>,
    reference: Vertex,
    desired: Vertex,
    factor_permille: u16,
    step: Duration,
) -> Vertex {
    let limits = &config.limits;
    let target = scaled(desired, i64::from(factor_permille), 1000);
    let rate = |per_s2: u32| rate_step(per_s2, step);
    let linear = slewed(
        reference.twist.linear.as_um_per_s(),
        target.twist.linear.as_um_per_s(),
        rate(limits.acceleration.as_um_per_s2()),
        rate(limits.braking.as_um_per_s2()),
    );
    if matches!(config.kinematics, Kinematics::Ackermann { .. }) {
        return arc(Speed::from_um_per_s(linear), desired.curvature);
    }
    let angular = slewed(
        reference.twist.angular.as_urad_per_s(),
        target.twist.angular.as_urad_per_s(),
        rate(limits.angular_acceleration.as_urad_per_s2()),
        rate(limits.angular_braking.as_urad_per_s2()),
    );
    let ways = [
        (
            reference.twist.linear.as_um_per_s(),
            target.twist.linear.as_um_per_s(),
        ),
        (
            reference.twist.angular.as_urad_per_s(),
            target.twist.angular.as_urad_per_s(),
        ),
    ];
    let [v, w] = ways;
    let part = share(v, linear).min(share(w, angular));
    let [linear, angular] = ways.map(|way| along(way, part));
    Vertex {
        twist: Twist {
            linear: Speed::from_um_per_s(linear),
            angular: AngularSpeed::from_urad_per_s(angular),
        },
        curvature: Curvature::ZERO,
    }
}

/// Shares of a way are counted in 2⁻³⁰.
const WHOLE: u64 = 1 << 30;

/// Which share of the way `from`, `to` leads to `next`, rounded down.
fn share((from, to): (i32, i32), next: i32) -> u64 {
    let way = |to: i32| u64::from(from.abs_diff(to));
    way(next)
        .saturating_mul(WHOLE)
        .checked_div(way(to))
        .unwrap_or(WHOLE)
}

/// The place after a share of a way, to the nearest count: never beyond the place it was taken from.
fn along((from, to): (i32, i32), part: u64) -> i32 {
    let way = u64::from(from.abs_diff(to));
    let gone = way.saturating_mul(part).saturating_add(WHOLE / 2) / WHOLE;
    let gone = i32::try_from(gone).unwrap_or(i32::MAX);
    if to < from {
        from.saturating_sub(gone)
    } else {
        from.saturating_add(gone)
    }
}

/// How much a rate changes during `step`, rounded down.
fn rate_step(per_s2: u32, step: Duration) -> i32 {
    let change = u64::from(per_s2).saturating_mul(step.as_us()) / 1_000_000;
    i32::try_from(change).unwrap_or(i32::MAX)
}

/// From `from` towards `to`: `faster` away from zero, `slower` towards zero, never through it.
fn slewed(from: i32, to: i32, faster: i32, slower: i32) -> i32 {
    if from < 0 || (from == 0 && to < 0) {
        return slewed(from.saturating_neg(), to.saturating_neg(), faster, slower).saturating_neg();
    }
    let low = from.saturating_sub(slower).max(0);
    let high = from.saturating_add(faster);
    // Not `clamp`, which panics on an empty interval.
    to.max(low).min(high)
}

/// `vertex` scaled down on its curvature until it is no faster than `measured` plus tolerance.
///
/// Turning on the spot is judged by its turn rate.
#[must_use]
pub fn no_faster<const S: usize>(config: &Config<S>, vertex: Vertex, measured: Twist) -> Vertex {
    let bounds = &config.tolerances;
    let (set, is) = if vertex.twist.linear == Speed::ZERO {
        (
            vertex.twist.angular.as_urad_per_s(),
            magnitude(measured.angular.as_urad_per_s())
                .saturating_add(magnitude(bounds.angular_speed.as_urad_per_s())),
        )
    } else {
        (
            vertex.twist.linear.as_um_per_s(),
            magnitude(measured.linear.as_um_per_s())
                .saturating_add(magnitude(bounds.speed.as_um_per_s())),
        )
    };
    if magnitude(set) <= is {
        return vertex;
    }
    let part = i64::try_from(is).unwrap_or(i64::MAX);
    scaled(vertex, part, i64::from(set).saturating_abs())
}

/// The command on the curvature-holding ramp to rest, `step` after `reference`.
///
/// Speed and turn rate reach zero together at the assumed decelerations.
#[must_use]
pub fn braked<const S: usize>(config: &Config<S>, reference: Vertex, step: Duration) -> Vertex {
    let limits = &config.limits;
    let time = |value: i32, per_s2: u32| {
        magnitude(value)
            .saturating_mul(1_000_000)
            .checked_div(u64::from(per_s2))
            .unwrap_or(0)
    };
    let mut stop = time(
        reference.twist.linear.as_um_per_s(),
        limits.braking.as_um_per_s2(),
    );
    if matches!(config.kinematics, Kinematics::Differential) {
        stop = stop.max(time(
            reference.twist.angular.as_urad_per_s(),
            limits.angular_braking.as_urad_per_s2(),
        ));
    }
    let left = stop.saturating_sub(step.as_us());
    //= spec/brake.md#brake-07
    //# A braking manoeuvre that is not replaced by an accepted motion MUST end with a set point of exactly zero.
    if left == 0 {
        return Vertex {
            twist: Twist::default(),
            curvature: reference.curvature,
        };
    }
    //= spec/brake.md#brake-03
    //# Braking set points of a differential drive MUST keep the ratio of speed to turn rate.
    //= spec/brake.md#brake-04
    //# Braking set points of an Ackermann drive MUST keep the commanded curvature.
    scaled(
        reference,
        i64::try_from(left).unwrap_or(0),
        i64::try_from(stop).unwrap_or(i64::MAX),
    )
}

/// Whether `candidate` lies in V_s ∩ V_d: what every accepted command must satisfy (LIMIT-01..05).
#[must_use]
pub fn admissible<const S: usize>(
    config: &Config<S>,
    reference: Vertex,
    candidate: Vertex,
    step: Duration,
) -> bool {
    let limits = &config.limits;
    let (v, w) = (
        candidate.twist.linear.as_um_per_s(),
        candidate.twist.angular.as_urad_per_s(),
    );
    //= spec/limit.md#limit-01
    //# The speed of every set point MUST lie between minus the reverse limit and the forward limit.
    let within_speeds = v <= limits.speed_forward.as_um_per_s()
        && v >= limits.speed_reverse.as_um_per_s().saturating_neg();
    let near = |value: i32, from: i32, fast: u32, slow: u32| {
        magnitude(value.saturating_sub(from)) <= magnitude(rate_step(fast.max(slow), step))
    };
    //= spec/limit.md#limit-04
    //# An accepted set point MUST differ from the one before by no more than the acceleration limits allow in the
    //# time between them.
    let reachable = near(
        v,
        reference.twist.linear.as_um_per_s(),
        limits.acceleration.as_um_per_s2(),
        limits.braking.as_um_per_s2(),
    );
    let turn = match config.kinematics {
        Kinematics::Ackermann { curvature_max, .. } => {
            //= spec/limit.md#limit-05
            //# The curvature of every Ackermann set point MUST NOT exceed the curvature limit in magnitude.
            magnitude(candidate.curvature.as_urad_per_m())
                <= magnitude(curvature_max.as_urad_per_m())
        }
        Kinematics::Differential => {
            //= spec/limit.md#limit-02
            //# The turn rate of every set point MUST NOT exceed the turn rate limit in magnitude.
            magnitude(w) <= magnitude(limits.angular_speed.as_urad_per_s())
                && near(
                    w,
                    reference.twist.angular.as_urad_per_s(),
                    limits.angular_acceleration.as_urad_per_s2(),
                    limits.angular_braking.as_urad_per_s2(),
                )
        }
    };
    within_speeds && reachable && turn
}

/// A vertex as a set point for the drive.
#[must_use]
pub fn setpoint<const S: usize>(config: &Config<S>, vertex: Vertex) -> Motion {
    match config.kinematics {
        Kinematics::Differential => Motion::Twist(vertex.twist),
        Kinematics::Ackermann { .. } => Motion::Arc {
            linear: vertex.twist.linear,
            curvature: vertex.curvature,
        },
    }
}
