//! The robot as its file states it: SI units, `f64`, nothing rounded.

use serde::Serialize;

use crate::RobotConfig;

/// A robot file that passed every check.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// Name in reports.
    pub name: String,
    /// File name it was read from.
    pub file: String,
    /// The file's text, for hashes and pictures of it.
    pub text: String,
    /// What the file says, in SI units.
    pub values: Values,
    /// The same for the kernel, rounded outward.
    pub config: RobotConfig,
}

/// Everything the file says, in SI units (angles in radians).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Values {
    /// Outline.
    pub footprint: Footprint,
    /// How it moves.
    pub kinematics: Kinematics,
    /// Speed and acceleration limits.
    pub limits: Limits,
    /// Reaction times and ages.
    pub timing: Timing,
    /// Error bounds.
    pub tolerances: Tolerances,
    /// Critical zone.
    pub zone: Zone,
    /// Memory rules.
    pub memory: Memory,
    /// Largest speed of anything that moves, m/s.
    pub obstacle_speed_mps: f64,
    /// Behaviour of the drive when the host is silent.
    pub host_death: HostDeath,
    /// Scanners in the order of the file, which is the kernel's scanner index.
    pub scanners: Vec<Scanner>,
}

/// Distances from the rotation centre to the edges, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs)] // the struct's doc covers its fields
pub struct Footprint {
    pub front_m: f64,
    pub rear_m: f64,
    pub left_m: f64,
    pub right_m: f64,
}

impl Footprint {
    /// Whole length, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.front_m + self.rear_m
    }

    /// Whole width, metres.
    #[must_use]
    pub fn width_m(&self) -> f64 {
        self.left_m + self.right_m
    }

    /// Distance of the farthest corner from the rotation centre, metres.
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        let x = self.front_m.max(self.rear_m);
        x.hypot(self.left_m.max(self.right_m))
    }
}

/// How the robot moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Kinematics {
    /// Two driven sides; turns on the spot.
    Differential,
    /// Steered front wheels, rotation centre at the rear axle's midpoint.
    Ackermann(Steering),
}

/// Front wheel steering.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Steering {
    /// Rear axle to front axle, metres.
    pub wheelbase_m: f64,
    /// Least radius of the path of the rear axle's midpoint, metres.
    pub turning_radius_m: f64,
    /// Longest time from stop to stop, seconds.
    pub sweep_s: f64,
    /// Error of the wheel angle, radians.
    pub tolerance_rad: f64,
}

impl Steering {
    /// Wheel angle at the least turning radius, radians.
    #[must_use]
    pub fn angle_max_rad(&self) -> f64 {
        (self.wheelbase_m / self.turning_radius_m).atan()
    }

    /// Bound of the curvature error that the wheel's error can cause, 1/m.
    ///
    /// The tangent is steepest at the stop, so the error there bounds all others.
    #[must_use]
    pub fn curvature_tolerance_per_m(&self) -> f64 {
        let stop = self.angle_max_rad();
        ((stop + self.tolerance_rad).tan() - stop.tan()) / self.wheelbase_m
    }
}

/// Speed and acceleration limits; keys and meaning as in the file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs)] // schema.rs documents each key once for file, README and messages
pub struct Limits {
    pub speed_forward_mps: f64,
    pub speed_reverse_mps: f64,
    pub reverse_into_memory: bool,
    pub angular_speed_radps: f64,
    pub acceleration_mps2: f64,
    pub braking_mps2: f64,
    pub angular_acceleration_radps2: f64,
    pub angular_braking_radps2: f64,
    pub ramps: Ramps,
}

/// Whether speed and turn rate ramp together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ramps {
    /// They keep their ratio.
    Together,
    /// Each by itself.
    Separate,
}

/// Reaction times and ages; keys and meaning as in the file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs)] // schema.rs documents each key
pub struct Timing {
    pub period_s: f64,
    pub jitter_s: f64,
    pub actuation_latency_s: f64,
    pub scan_age_max_s: f64,
    pub odometry_age_max_s: f64,
    pub command_age_max_s: f64,
    pub rest_s: f64,
    pub clear_s: f64,
    pub tracking_window_s: f64,
}

/// Error bounds; keys and meaning as in the file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs)] // schema.rs documents each key
pub struct Tolerances {
    pub speed_mps: f64,
    pub angular_speed_radps: f64,
    pub tracking_m: f64,
    pub odometry_m_per_m: f64,
    pub odometry_rad_per_rad: f64,
    pub rest_speed_mps: f64,
    pub rest_angular_speed_radps: f64,
    pub follow_speed_mps: f64,
    pub follow_angular_speed_radps: f64,
}

/// Critical zone margins, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs)] // schema.rs documents each key
pub struct Zone {
    pub front_m: f64,
    pub side_m: f64,
}

/// Memory rules; keys and meaning as in the file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs)] // schema.rs documents each key
pub struct Memory {
    pub clear_after_scans: u8,
    pub age_max_s: f64,
    pub clear_at_start_m: f64,
    pub skirt_m: f64,
    pub body_width_min_m: f64,
}

/// What the drive does when the host is silent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs)] // schema.rs documents each key
pub struct HostDeath {
    pub watchdog_s: f64,
    pub behaviour: Silence,
    pub braking_mps2: f64,
    pub angular_braking_radps2: f64,
    pub cover_host_death: bool,
}

/// Behaviour of a drive whose watchdog expired.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Silence {
    /// It lets the wheels run out.
    Coast,
    /// It brakes.
    Brake,
}

/// One scanner.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scanner {
    /// Name in reports.
    pub name: String,
    /// Position in the body frame, forward, metres.
    pub x_m: f64,
    /// Position in the body frame, left, metres.
    pub y_m: f64,
    /// Direction of the middle of the field of view, radians.
    pub yaw_rad: f64,
    /// Angle from the first beam to the last, radians.
    pub field_of_view_rad: f64,
    /// Beams run clockwise seen from above.
    pub upside_down: bool,
    /// Number of beams.
    pub beams: u16,
    /// Time from the first beam to the last, seconds.
    pub scan_time_s: f64,
    /// Scans each second.
    pub rate_hz: f64,
    /// How "no return" and its like are written.
    pub encoding: Encoding,
    /// Shortest measured range, metres.
    pub range_min_m: f64,
    /// Longest measured range, metres.
    pub range_max_m: f64,
    /// Systematic range error, metres.
    pub error_systematic_m: f64,
    /// Standard deviation of the range, metres.
    pub error_sigma_m: f64,
    /// Up to here a beam without return counts as free, metres.
    pub no_return_clear_m: f64,
    /// Largest part of invalid beams, 0 to 1.
    pub invalid_fraction_max: f64,
    /// Largest angle of neighbouring invalid beams, radians.
    pub invalid_gap_max_rad: f64,
    /// Robot parts in view.
    pub masks: Vec<Mask>,
}

impl Scanner {
    /// Error bound of a range: systematic error and three standard deviations, metres.
    #[must_use]
    pub fn error_m(&self) -> f64 {
        self.error_systematic_m + 3.0 * self.error_sigma_m
    }

    /// Magnitude of the angle between neighbouring beams, radians.
    #[must_use]
    pub fn beam_angle_rad(&self) -> f64 {
        self.field_of_view_rad / f64::from(self.beams.saturating_sub(1).max(1))
    }

    /// Direction of the first beam in the body frame, radians (not wrapped).
    #[must_use]
    pub fn first_beam_rad(&self) -> f64 {
        let half = self.field_of_view_rad / 2.0;
        self.yaw_rad + if self.upside_down { half } else { -half }
    }

    /// Signed angle from one beam to the next in the body frame, radians.
    #[must_use]
    pub fn increment_rad(&self) -> f64 {
        let step = self.beam_angle_rad();
        if self.upside_down { -step } else { step }
    }

    /// Whether a body-frame point (metres) lies within field of view and range.
    #[must_use]
    pub fn sees(&self, x_m: f64, y_m: f64) -> bool {
        let (dx, dy) = (x_m - self.x_m, y_m - self.y_m);
        let range = dx.hypot(dy);
        let off_axis = wrap(dy.atan2(dx) - self.yaw_rad).abs();
        off_axis <= self.field_of_view_rad / 2.0
            && range >= self.range_min_m
            && range <= self.range_max_m
    }
}

/// How "no return" is written; as [`haltline::convert::BeamEncoding`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Encoding {
    /// +∞ none, −∞ too near, NaN invalid.
    Rep117,
    /// Zero is no return.
    ZeroIsNone,
    /// Zero is a lost measurement.
    ZeroIsInvalid,
}

impl From<Encoding> for haltline::convert::BeamEncoding {
    fn from(encoding: Encoding) -> Self {
        match encoding {
            Encoding::Rep117 => Self::Rep117,
            Encoding::ZeroIsNone => Self::ZeroIsNone,
            Encoding::ZeroIsInvalid => Self::ZeroIsInvalid,
        }
    }
}

/// Self-mask rectangle in the body frame, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs)] // schema.rs documents each key
pub struct Mask {
    pub x_min_m: f64,
    pub x_max_m: f64,
    pub y_min_m: f64,
    pub y_max_m: f64,
}

/// Wraps an angle to (−π, π].
pub(crate) fn wrap(angle_rad: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let wrapped = angle_rad.rem_euclid(TAU);
    if wrapped > PI { wrapped - TAU } else { wrapped }
}
