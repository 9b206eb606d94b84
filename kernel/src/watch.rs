//! Judges every input before anything uses it: stamps, sizes, plausibility (INPUT, FRESH).
//!
//! An input that is not usable becomes a reason to stop, never a silent omission.

use crate::arith::{MICRO, magnitude, mul_micro_up};
use crate::config::{Config, Scanner};
use crate::decision::Reason;
use crate::geometry::frame::{PointMm, Rotation, polar};
use crate::geometry::rect::Rect;
use crate::guard::sweep::masks;
use crate::input::{Beam, Odometry};
use crate::odometry::{distance_um, turn_urad};
use crate::time::{Duration, Instant};
use crate::units::{BinaryAngle, Length};

/// How a stamp relates to the newest one of its channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Newer, and not from the future.
    Newer,
    /// The same stamp again: nothing new.
    Same,
    /// Older than the newest.
    Older,
    /// Later than now.
    Future,
}

/// Classifies `stamp` against the newest accepted stamp and the present.
#[must_use]
pub fn order(stamp: Instant, newest: Option<Instant>, now: Instant) -> Order {
    if stamp > now {
        return Order::Future;
    }
    //= spec/input.md#input-08
    //# A value stamped no later than the newest of its channel MUST NOT replace it.
    //= spec/fresh.md#fresh-05
    //# A channel found stale MUST stay stale until a usable value with a newer stamp arrives.
    match newest {
        Some(newest) if stamp < newest => Order::Older,
        Some(newest) if stamp == newest => Order::Same,
        _ => Order::Newer,
    }
}

/// Whether something stamped `stamp` is too old at `now`; the future is stale.
#[must_use]
pub fn is_stale(stamp: Instant, now: Instant, age_max: Duration) -> bool {
    //= spec/fresh.md#fresh-04
    //# Data stamped later than `now` MUST be treated as stale.
    //= spec/fresh.md#fresh-08
    //# An age limit of zero MUST NOT switch a freshness check off.
    now.since(stamp).is_none_or(|age| age > age_max)
}

/// Whether the beams of a scan can be used: their number, and how many of them are invalid.
///
/// # Source
/// INPUT-05, INPUT-06, INPUT-07.
#[must_use]
pub fn beams_usable(scanner: &Scanner, beams: &[Beam]) -> bool {
    //= spec/input.md#input-07
    //# A scan with the wrong number of beams or an unknown scanner MUST be unusable.
    if beams.len() != usize::from(scanner.beams) {
        return false;
    }
    let (mut invalid, mut run, mut longest) = (0_u64, 0_u64, 0_u64);
    for beam in beams {
        if *beam == Beam::Invalid {
            invalid = invalid.saturating_add(1);
            run = run.saturating_add(1);
            longest = longest.max(run);
        } else {
            run = 0;
        }
    }
    //= spec/input.md#input-05
    //# A scan with a larger part of invalid beams than `invalid_max` MUST be unusable.
    let allowed = u64::from(scanner.beams).saturating_mul(u64::from(scanner.invalid_max.as_ppm()));
    //= spec/input.md#input-06
    //# A scan with a wider run of consecutive invalid beams than `invalid_gap_max` MUST be unusable.
    let gap = longest.saturating_mul(u64::from(scanner.increment.unsigned_abs()));
    invalid.saturating_mul(MICRO) <= allowed && gap <= u64::from(scanner.invalid_gap_max)
}

/// Whether a scan returns from inside `zone` (millimetres, body frame), as the scanner stands on
/// the robot: needs no odometry, so no scan waits for it. A too-near beam does, whatever the zone.
///
/// # Source
/// ZONE-01, INPUT-02.
#[must_use]
pub fn returns_from_zone(scanner: &Scanner, beams: &[Beam], zone: Rect) -> bool {
    let millimetres = |length: Length| length.as_um().div_euclid(1000);
    let mut direction = scanner.first_beam;
    beams.iter().any(|beam| {
        let along = direction;
        direction = direction.plus(BinaryAngle::from_counts(scanner.increment.cast_unsigned()));
        match beam {
            // It may stand anywhere before the least range, up to the scanner itself.
            Beam::TooNear => true,
            Beam::NoReturn | Beam::Invalid => false,
            Beam::Hit(range) => {
                let hit = polar(i32::from(*range), along);
                let body = PointMm {
                    x: hit.x.saturating_add(millimetres(scanner.x)),
                    y: hit.y.saturating_add(millimetres(scanner.y)),
                };
                //= spec/zone.md#zone-03
                //# A return MUST NOT be dropped as a part of the robot unless it lies in a self-mask of the scanner that
                //# saw it.
                let mut own = scanner.masks.iter().flatten();
                zone.contains(body) && !own.any(|mask| masks(mask, body))
            }
        }
    })
}

/// A number that differs, but for chance, between different scans (FNV-1a).
#[must_use]
pub fn fingerprint(beams: &[Beam]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for beam in beams {
        let code = match beam {
            Beam::Hit(range) => u64::from(*range),
            Beam::NoReturn => 0x1_0000,
            Beam::TooNear => 0x1_0001,
            Beam::Invalid => 0x1_0002,
        };
        hash = (hash ^ code).wrapping_mul(0x0000_0100_0000_01b3);
    }
    hash
}

/// Whether a scan contains anything that would change when the robot moves.
#[must_use]
pub fn has_returns(beams: &[Beam]) -> bool {
    beams.iter().any(|beam| matches!(beam, Beam::Hit(_)))
}

/// Slack of the pose checks, µm and µrad: quantisation of ordinary odometry.
const POSE_SLACK_UM: u64 = 10_000;
const POSE_SLACK_URAD: u64 = 10_000;

/// Why `after` cannot follow `before`, if it cannot.
///
/// A jump is farther than the robot's speed limits plus the follow tolerance allow;
/// an inconsistency is a pose that moved otherwise than the twists say.
/// # Source
/// INPUT-11, INPUT-12.
#[must_use]
pub fn odometry_fault<const S: usize>(
    config: &Config<S>,
    before: &Odometry,
    after: &Odometry,
) -> Option<Reason> {
    let span = after.stamp.since(before.stamp)?.as_us();
    let bounds = &config.tolerances;
    let limits = &config.limits;
    let turned = turn_urad(after.pose.heading.minus(before.pose.heading));
    let fastest = magnitude(limits.speed_forward.as_um_per_s())
        .max(magnitude(limits.speed_reverse.as_um_per_s()))
        .saturating_add(magnitude(bounds.follow_speed.as_um_per_s()));
    let turning = magnitude(limits.angular_speed.as_urad_per_s())
        .saturating_add(magnitude(bounds.follow_angular_speed.as_urad_per_s()));
    let far = mul_micro_up(fastest, span).saturating_add(POSE_SLACK_UM);
    let wide = mul_micro_up(turning, span).saturating_add(POSE_SLACK_URAD);
    //= spec/input.md#input-11
    //# The kernel MUST stop when the odometry pose moved farther between two samples than the robot can.
    if distance_um(before, after) > far || turned > wide {
        return Some(Reason::OdometryJump);
    }
    consistency(config, before, after, span)
}

fn consistency<const S: usize>(
    config: &Config<S>,
    before: &Odometry,
    after: &Odometry,
    span: u64,
) -> Option<Reason> {
    let bounds = &config.tolerances;
    let span_i = i64::try_from(span).ok()?;
    let mean = |a: i32, b: i32| {
        i64::from(a)
            .saturating_add(i64::from(b))
            .saturating_mul(span_i)
            .div_euclid(2_000_000)
    };
    let driven = mean(
        before.twist.linear.as_um_per_s(),
        after.twist.linear.as_um_per_s(),
    );
    let turned = mean(
        before.twist.angular.as_urad_per_s(),
        after.twist.angular.as_urad_per_s(),
    );
    let counts = after.pose.heading.minus(before.pose.heading);
    let measured_turn = i64::try_from(turn_urad(counts))
        .ok()?
        .saturating_mul(i64::from(counts.signum()));
    let slack = mul_micro_up(magnitude(bounds.follow_angular_speed.as_urad_per_s()), span)
        .saturating_add(POSE_SLACK_URAD);
    //= spec/input.md#input-12
    //# The kernel MUST stop when odometry pose and odometry twist contradict each other.
    if turned.saturating_sub(measured_turn).unsigned_abs() > slack {
        return Some(Reason::OdometryInconsistent);
    }
    let forward = forward_um(before, after)?;
    let slack = mul_micro_up(magnitude(bounds.follow_speed.as_um_per_s()), span)
        .saturating_add(POSE_SLACK_UM);
    (driven.saturating_sub(forward).unsigned_abs() > slack).then_some(Reason::OdometryInconsistent)
}

/// Displacement along the heading halfway between two samples, µm.
fn forward_um(before: &Odometry, after: &Odometry) -> Option<i64> {
    // Hundredths of a millimetre keep a jump-free displacement within the rotation's range.
    let tens = |to: i64, from: i64| i32::try_from(to.saturating_sub(from).div_euclid(100)).ok();
    let offset = PointMm {
        x: tens(after.pose.x_um, before.pose.x_um)?,
        y: tens(after.pose.y_um, before.pose.y_um)?,
    };
    let half = after.pose.heading.minus(before.pose.heading) / 2;
    let middle = before
        .pose
        .heading
        .plus(BinaryAngle::from_counts(half.cast_unsigned()));
    let local = Rotation::new(middle).inverse().apply(offset);
    Some(i64::from(local.x).saturating_mul(100))
}
