//! The robot as its file states it: SI units, `f64`, nothing rounded.

use serde::Serialize;

use crate::RobotConfig;
use crate::scanner::Scanner;

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
