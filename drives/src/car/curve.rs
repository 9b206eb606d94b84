//! The two calibration curves of the model car, as printed but for two signs, and their safe inverses.
//!
//! Both maps are total, monotone, sign-preserving and saturating over every input there is; the
//! tests enumerate them.
//! # Source
//! DCAD 2018, 2.1. The offsets of the speed curve are printed with the wrong sign: a level must
//! *overcome* static friction. As printed, +0.1 m/s gives level −57 and drives backwards.

use crate::uc::command::{DriveLevel, SteeringLevel};
use crate::uc::{FORWARD, REVERSE, STEERING};

/// Levels for each m/s and levels that only overcome friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedCurve {
    /// Levels per m/s forward.
    pub forward_slope: f64,
    /// Level at which the car just stands, forward.
    pub forward_offset: f64,
    /// Levels per m/s backward.
    pub reverse_slope: f64,
    /// Level at which the car just stands, backward.
    pub reverse_offset: f64,
}

/// The measured speed curve, with the offsets' signs put right.
pub const SPEED: SpeedCurve = SpeedCurve {
    forward_slope: 477.518_514,
    forward_offset: 104.623_299,
    reverse_slope: 439.8038,
    reverse_offset: 116.136_943,
};

impl SpeedCurve {
    /// Level that drives no faster than `speed_mmps`; thrust has the sign of the speed, always.
    #[must_use]
    pub fn level(&self, speed_mmps: i16) -> DriveLevel {
        let speed = f64::from(speed_mmps).abs() * 1e-3;
        //= spec/drive.md#drive-11
        //# A speed MUST become a drive level of the same sign, and a larger speed a level that is no smaller, for every speed that can be asked for.
        let level = if speed_mmps > 0 {
            let level = self.forward_slope * speed + self.forward_offset;
            DriveLevel::forward(cut(level, *FORWARD.end()))
        } else if speed_mmps < 0 {
            let level = self.reverse_slope * speed + self.reverse_offset;
            DriveLevel::reverse(cut(level, *REVERSE.end()))
        } else {
            None
        };
        level.unwrap_or(DriveLevel::NEUTRAL)
    }

    /// Steady speed of a level, m/s, with the sign of its thrust; 0 where friction holds the car.
    #[must_use]
    pub fn speed(&self, level: DriveLevel) -> f64 {
        let thrust = f64::from(level.thrust());
        if thrust > 0.0 {
            ((thrust - self.forward_offset) / self.forward_slope).max(0.0)
        } else {
            ((thrust + self.reverse_offset) / self.reverse_slope).min(0.0)
        }
    }
}

/// Whole levels towards zero, from 1 to `most`: what asks for motion never becomes zero or less.
#[allow(clippy::cast_possible_truncation)] // clamped to 16 bits before
fn cut(level: f64, most: i16) -> i16 {
    libm::trunc(level).clamp(1.0, f64::from(most)) as i16
}

/// Steering level from wheel angle: a polynomial on the interval where it falls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteeringCurve {
    /// Coefficients from the constant on; the angle in rad, left positive.
    pub coefficients: [f64; 7],
    /// Interval on which the polynomial strictly decreases, rad.
    pub angles: [f64; 2],
}

/// The measured steering curve.
pub const STEER: SteeringCurve = SteeringCurve {
    coefficients: [
        143.78, -2442.1, 2459.5, 5979.7, -47_550.0, -50_518.0, 196_814.0,
    ],
    angles: [-0.50, 0.48],
};

impl SteeringCurve {
    fn polynomial(&self, angle: f64) -> f64 {
        let terms = self.coefficients.iter().rev();
        terms.fold(0.0, |sum, coefficient| sum * angle + coefficient)
    }

    /// Level for a wheel angle in units of 0.1 mrad, left positive; saturates at both ends.
    #[must_use]
    pub fn level(&self, angle_100urad: i16) -> SteeringLevel {
        let angle = (f64::from(angle_100urad) * 1e-4).clamp(self.angles[0], self.angles[1]);
        let level = libm::round(self.polynomial(angle));
        level_of(level.clamp(f64::from(*STEERING.start()), f64::from(*STEERING.end())))
    }

    /// Wheel angle of a level, rad: the inverse by halving, within 10⁻⁹ rad.
    #[must_use]
    pub fn angle(&self, level: SteeringLevel) -> f64 {
        let wanted = f64::from(level.level());
        let [mut low, mut high] = self.angles;
        for _ in 0..32 {
            let middle = f64::midpoint(low, high);
            // Falling: too much level means too far right.
            if self.polynomial(middle) > wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        f64::midpoint(low, high)
    }

    /// Whether the wheels reach this angle (0.1 mrad) before their level saturates.
    #[must_use]
    pub fn reaches(&self, angle_100urad: i16) -> bool {
        let angle = f64::from(angle_100urad) * 1e-4;
        angle >= self.angles[0]
            && angle <= self.angles[1]
            && self.polynomial(angle).abs() <= f64::from(*STEERING.end())
    }
}

#[allow(clippy::cast_possible_truncation)] // clamped to ±1000 before
fn level_of(level: f64) -> SteeringLevel {
    SteeringLevel::new(level as i16).unwrap_or(CENTRE)
}

/// Level of straight wheels by the curve's constant term, rounded.
const CENTRE: SteeringLevel = match SteeringLevel::checked(144) {
    Some(level) => level,
    None => SteeringLevel::ZERO,
};
