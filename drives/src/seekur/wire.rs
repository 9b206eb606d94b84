//! From µm/s and µrad/s to the robot's counts and back; saturation keeps the curvature.

use haltline::time::Duration;
use haltline::units::{Acceleration, AngularAcceleration};

use crate::arcos::command::number;
use crate::arcos::{Command, VEL2_DIVISOR};
use crate::governor::Braking;

/// rad/s for one mm/s of half the difference of both sides (seekurjr.p: DiffConvFactor).
pub(super) const DIFF_CONV: f64 = 0.0056;

/// How the wheels are told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wheels {
    /// VEL and RVEL: 1 mm/s and 1 deg/s, in two packets.
    VelRvel,
    /// VEL2: 20 mm/s a side, in one packet.
    Vel2,
}

/// Everything the adapter must know of its robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seekur {
    /// Sure decelerations: of ramps, and of the robot's own stops.
    pub braking: Braking,
    /// Acceleration the robot is told to use.
    pub acceleration: Acceleration,
    /// Angular acceleration the robot is told to use.
    pub angular_acceleration: AngularAcceleration,
    /// Largest speed, mm/s.
    pub speed_max_mmps: u16,
    /// Largest turn rate of the wheels, deg/s.
    pub turn_max_degps: u16,
    /// Longest watchdog time the robot file allows, ms.
    pub watchdog_max_ms: u16,
    /// Take a robot that does not tell its watchdog time at its file's word.
    pub accept_untold_watchdog: bool,
    /// Skid factor xi in (0, 1]: true turn rate for each turn rate of the wheels.
    pub skid: f64,
    /// How the wheels are told.
    pub wheels: Wheels,
    /// Longest time between two SIPs.
    pub feedback_max: Duration,
    /// Time from the measurement to the arrival of a SIP.
    pub transport: Duration,
}

/// What goes on the wire for one set point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // the names carry the units
pub enum Words {
    /// Speed and turn rate.
    VelRvel { mmps: i32, degps: i32 },
    /// Counts of 20 mm/s.
    Vel2 { left: i8, right: i8 },
}

/// Set point as the robot takes it.
///
/// - `linear_umps`, `angular_uradps`: the decision
///
/// Speed is cut to whole mm/s towards zero, the turn rate goes to the nearest deg/s: at most
/// 0.5 deg/s = 0.0088 rad/s off. Beyond a limit both are scaled by the same factor.
#[must_use]
pub fn to_wire(config: &Seekur, linear_umps: i32, angular_uradps: i32) -> Words {
    let v_mmps = f64::from(linear_umps) * 1e-3;
    // The wheels must turn faster than the robot: skid eats the rest.
    let w_radps = f64::from(angular_uradps) * 1e-6 / config.skid.clamp(0.05, 1.0);
    let limit = |value: f64, most: f64| {
        if value.abs() > most {
            most / value.abs()
        } else {
            1.0
        }
    };
    let speed_max = f64::from(config.speed_max_mmps);
    let turn_max = f64::from(config.turn_max_degps).to_radians();
    //= spec/drive.md#drive-06
    //# A set point beyond a limit of the drive MUST be scaled on its curvature; one whose curvature cannot be steered becomes a stop.
    let mut factor = limit(v_mmps, speed_max).min(limit(w_radps, turn_max));
    match config.wheels {
        Wheels::VelRvel => Words::VelRvel {
            //= spec/drive.md#drive-08
            //# The set point on the wire MUST be the decision's within the stated resolution of the wire.
            mmps: whole(libm::trunc(v_mmps * factor)),
            degps: whole(libm::round((w_radps * factor).to_degrees())),
        },
        Wheels::Vel2 => {
            let half = w_radps / DIFF_CONV;
            let side_max = 127.0 * f64::from(VEL2_DIVISOR);
            factor = factor.min(limit(v_mmps.abs() + half.abs(), side_max));
            let side = |mmps: f64| whole(libm::round(mmps * factor / f64::from(VEL2_DIVISOR)));
            Words::Vel2 {
                left: i8::try_from(side(v_mmps - half)).unwrap_or_default(),
                right: i8::try_from(side(v_mmps + half)).unwrap_or_default(),
            }
        }
    }
}

/// What the robot is told by `words`: m/s and rad/s of the robot, skid included.
#[must_use]
pub fn from_wire(config: &Seekur, words: Words) -> [f64; 2] {
    let (mmps, wheels_radps) = match words {
        Words::VelRvel { mmps, degps } => (f64::from(mmps), f64::from(degps).to_radians()),
        Words::Vel2 { left, right } => {
            let side = |count: i8| f64::from(count) * f64::from(VEL2_DIVISOR);
            let (left, right) = (side(left), side(right));
            (f64::midpoint(left, right), (right - left) / 2.0 * DIFF_CONV)
        }
    };
    [mmps * 1e-3, wheels_radps * config.skid]
}

/// A whole number of small magnitude; everything else, NaN included, is zero.
#[allow(clippy::cast_possible_truncation)] // the range was checked
pub(super) fn whole(value: f64) -> i32 {
    if value.abs() <= 65_535.0 {
        value as i32
    } else {
        0
    }
}

impl Seekur {
    /// Limits and habits the robot is told before its motors come on.
    pub(super) fn setup(&self) -> [Command<'static>; 7] {
        let milli = |um: u32| {
            i32::try_from(um.div_ceil(1000))
                .unwrap_or(i32::MAX)
                .min(65_535)
        };
        let degrees = |urad: u32| whole(libm::ceil((f64::from(urad) * 1e-6).to_degrees()));
        let turn = |rate: AngularAcceleration| degrees(rate.as_urad_per_s2());
        [
            // The joystick must not drive while we do.
            Command::int(number::JOYDRIVE, 0),
            Command::int(number::SETV, i32::from(self.speed_max_mmps)),
            Command::int(number::SETRV, i32::from(self.turn_max_degps)),
            Command::int(number::SETA, milli(self.acceleration.as_um_per_s2())),
            Command::int(number::SETA, -milli(self.braking.linear.as_um_per_s2())),
            Command::int(number::SETRA, turn(self.angular_acceleration)),
            Command::int(number::SETRA, -turn(self.braking.angular)),
        ]
    }
}
