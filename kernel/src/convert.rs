//! The one file in which floats become integers: total, and outward where it matters.
//!
//! Whatever is not finite or out of range becomes `None`, [`Reading::Malformed`]
//! or [`Beam::Invalid`]; nothing is clamped, nothing panics. Lengths that bound
//! an error round up, lengths that promise something round down, measured
//! values round to nearest.

// Float arithmetic cannot overflow into undefined behaviour and every cast below
// is guarded by an explicit range check.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use crate::input::{Beam, Command, Motion, Odometry, Pose, Reading, Twist};
use crate::time::{Duration, Instant};
use crate::units::{
    Acceleration, AngularAcceleration, AngularSpeed, BinaryAngle, Curvature, Length, Ppm, Speed,
};

/// Which way a quantity is rounded to its integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Round {
    /// To the nearest count.
    Nearest,
    /// Towards positive infinity: for what enlarges the tube.
    Up,
    /// Towards negative infinity: for what promises something (braking, speed limits).
    Down,
}

/// Rounds `value` as told without needing `std`; `None` unless |value| < 2⁵².
#[doc(hidden)]
#[must_use]
pub fn round(value: f64, how: Round) -> Option<i64> {
    const EXACT: f64 = 4_503_599_627_370_496.0;
    //= spec/input.md#input-09
    //# A number that is not finite or out of range MUST make the value it belongs to malformed.
    // A NaN fails both comparisons.
    if !(value > -EXACT && value < EXACT) {
        return None;
    }
    let shifted = match how {
        Round::Nearest => value + 0.5,
        Round::Up | Round::Down => value,
    };
    let truncated = shifted as i64;
    let back = truncated as f64;
    Some(match how {
        Round::Nearest | Round::Down if back > shifted => truncated.saturating_sub(1),
        Round::Up if back < shifted => truncated.saturating_add(1),
        _ => truncated,
    })
}

fn signed(value: f64, per_unit: f64, how: Round) -> Option<i32> {
    i32::try_from(round(value * per_unit, how)?).ok()
}

fn unsigned(value: f64, per_unit: f64, how: Round) -> Option<u32> {
    u32::try_from(round(value * per_unit, how)?).ok()
}

/// Length from metres; `None` if not finite or beyond ±2147 m.
#[must_use]
pub fn length(metres: f64, how: Round) -> Option<Length> {
    signed(metres, 1e6, how).map(Length::from_um)
}

/// Speed from metres per second; `None` if not finite or beyond ±2147 m/s.
#[must_use]
pub fn speed(metres_per_second: f64, how: Round) -> Option<Speed> {
    signed(metres_per_second, 1e6, how).map(Speed::from_um_per_s)
}

/// Turn rate from radians per second; `None` if not finite or beyond ±2147 rad/s.
#[must_use]
pub fn angular_speed(radians_per_second: f64, how: Round) -> Option<AngularSpeed> {
    signed(radians_per_second, 1e6, how).map(AngularSpeed::from_urad_per_s)
}

/// Acceleration magnitude from m/s²; `None` if negative, not finite or beyond 4294 m/s².
#[must_use]
pub fn acceleration(value: f64, how: Round) -> Option<Acceleration> {
    unsigned(value, 1e6, how).map(Acceleration::from_um_per_s2)
}

/// Angular acceleration magnitude from rad/s²; `None` if negative, not finite or too large.
#[must_use]
pub fn angular_acceleration(value: f64, how: Round) -> Option<AngularAcceleration> {
    unsigned(value, 1e6, how).map(AngularAcceleration::from_urad_per_s2)
}

/// Curvature from 1/m; `None` if not finite or beyond ±2147 /m.
#[must_use]
pub fn curvature(per_metre: f64, how: Round) -> Option<Curvature> {
    signed(per_metre, 1e6, how).map(Curvature::from_urad_per_m)
}

/// Ratio from a plain number; `None` if negative, not finite or above 4294.
#[must_use]
pub fn ratio(value: f64, how: Round) -> Option<Ppm> {
    unsigned(value, 1e6, how).map(Ppm::from_ppm)
}

/// Duration from seconds; `None` if negative or not finite.
#[must_use]
pub fn duration(seconds: f64, how: Round) -> Option<Duration> {
    u64::try_from(round(seconds * 1e6, how)?)
        .ok()
        .map(Duration::from_us)
}

/// Angle from radians, to the nearest count; `None` if not finite or beyond ±10⁶ rad.
#[must_use]
pub fn angle(radians: f64) -> Option<BinaryAngle> {
    signed_angle(radians).map(|counts| BinaryAngle::from_counts(counts as u32))
}

/// Angle from radians as a signed count of 2⁻³² turn before wrapping; `None` beyond ±10⁶ rad.
#[must_use]
pub fn signed_angle(radians: f64) -> Option<i64> {
    if !(radians > -1e6 && radians < 1e6) {
        return None;
    }
    round(
        radians * (4_294_967_296.0 / core::f64::consts::TAU),
        Round::Nearest,
    )
}

/// How a driver writes "no return" and its like into a range (REP 117 and other habits).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BeamEncoding {
    /// REP 117: +∞ no return, −∞ too near, NaN invalid.
    Rep117,
    /// Zero means no return; everything else not finite or negative is invalid.
    ZeroIsNone,
    /// Zero means a lost measurement (many SICK exports): nothing is known about the ray.
    ZeroIsInvalid,
}

/// Beam from a range in metres; total over all bit patterns.
///
/// Ranges round to the nearest millimetre; the guard's rounding term covers the
/// half millimetre, since neither direction is safe for every robot. Below `range_min` is [`Beam::TooNear`],
/// beyond `range_max` is [`Beam::NoReturn`]; negative ranges are invalid.
//= spec/input.md#input-01
//# Every bit pattern of a beam MUST be classified as exactly one of hit, no-return, too-near and invalid.
#[must_use]
pub fn beam(range_m: f32, encoding: BeamEncoding, range_min: Length, range_max: Length) -> Beam {
    let metres = f64::from(range_m);
    if encoding == BeamEncoding::Rep117 && range_m.is_infinite() {
        return if range_m > 0.0 {
            Beam::NoReturn
        } else {
            Beam::TooNear
        };
    }
    if metres.abs() < f64::MIN_POSITIVE {
        return match encoding {
            BeamEncoding::Rep117 => Beam::TooNear,
            BeamEncoding::ZeroIsNone => Beam::NoReturn,
            BeamEncoding::ZeroIsInvalid => Beam::Invalid,
        };
    }
    let Some(um) = round(metres * 1e6, Round::Nearest) else {
        return Beam::Invalid;
    };
    if um < 0 {
        Beam::Invalid
    } else if um < i64::from(range_min.as_um()) {
        Beam::TooNear
    } else if um > i64::from(range_max.as_um()) {
        Beam::NoReturn
    } else {
        u16::try_from(um.saturating_add(500).div_euclid(1000)).map_or(Beam::NoReturn, Beam::Hit)
    }
}

/// Odometry from floats: pose in the odometry frame (m, rad), body twist (m/s, rad/s),
/// measured path curvature (1/m) where the car has a steering sensor.
///
/// Any value not finite or out of range makes the whole sample [`Reading::Malformed`].
#[must_use]
pub fn odometry(
    stamp: Instant,
    pose_m_rad: [f64; 3],
    twist_mps_radps: [f64; 2],
    steering_per_m: Option<f64>,
) -> Reading<Odometry> {
    let value = || -> Option<Odometry> {
        let [x, y, theta] = pose_m_rad;
        let [linear, angular] = twist_mps_radps;
        Some(Odometry {
            stamp,
            pose: Pose {
                x_um: round(x * 1e6, Round::Nearest)?,
                y_um: round(y * 1e6, Round::Nearest)?,
                heading: angle(theta)?,
            },
            twist: Twist {
                linear: speed(linear, Round::Nearest)?,
                angular: angular_speed(angular, Round::Nearest)?,
            },
            steering: match steering_per_m {
                None => None,
                Some(value) => Some(curvature(value, Round::Nearest)?),
            },
        })
    };
    value().map_or(Reading::Malformed, Reading::Value)
}

/// A desired twist from floats (m/s, rad/s); not finite is [`Reading::Malformed`].
#[must_use]
pub fn twist_command(stamp: Instant, linear_mps: f64, angular_radps: f64) -> Reading<Command> {
    let twist = || -> Option<Twist> {
        Some(Twist {
            linear: speed(linear_mps, Round::Nearest)?,
            angular: angular_speed(angular_radps, Round::Nearest)?,
        })
    };
    twist().map_or(Reading::Malformed, |twist| {
        Reading::Value(Command {
            stamp,
            motion: Motion::Twist(twist),
        })
    })
}

/// A desired speed and path curvature from floats (m/s, 1/m); not finite is [`Reading::Malformed`].
#[must_use]
pub fn arc_command(stamp: Instant, linear_mps: f64, curvature_per_m: f64) -> Reading<Command> {
    let motion = || -> Option<Motion> {
        Some(Motion::Arc {
            linear: speed(linear_mps, Round::Nearest)?,
            curvature: curvature(curvature_per_m, Round::Nearest)?,
        })
    };
    motion().map_or(Reading::Malformed, |motion| {
        Reading::Value(Command { stamp, motion })
    })
}
