//! The robot as the safety core sees it, and the one place where it can be refused.
//!
//! [`Config`] is plain data; [`crate::checked::KernelConfig`] is a `Config` that passed every check.

use crate::time::Duration;
use crate::units::{
    Acceleration, AngularAcceleration, AngularSpeed, BinaryAngle, Curvature, Length, Ppm, Speed,
};

/// Rectangle around the robot in the body frame, distances from the rotation centre, all ≥ 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Footprint {
    /// To the front edge (x forward).
    pub front: Length,
    /// To the rear edge.
    pub rear: Length,
    /// To the left edge (y left).
    pub left: Length,
    /// To the right edge.
    pub right: Length,
}

/// How the robot moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kinematics {
    /// Two driven sides; turns on the spot. Commands are [`crate::input::Motion::Twist`].
    Differential,
    /// Steered front wheels. Commands are [`crate::input::Motion::Arc`].
    Ackermann {
        /// Largest path curvature, 1 / least turning radius.
        curvature_max: Curvature,
        /// Tolerance of the path curvature (steering error).
        curvature_tolerance: Curvature,
        /// Longest time the wheels need from one stop to the other.
        steering_sweep: Duration,
    },
}

/// Whether the drive brings v and ω to rest together or each by its own ramp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ramps {
    /// Speed and turn rate keep their ratio.
    Together,
    /// Speed and turn rate ramp independently.
    Separate,
}

/// Speed and acceleration limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest forward speed.
    pub speed_forward: Speed,
    /// Largest reverse speed as a magnitude; zero where the rear is not watched.
    pub speed_reverse: Speed,
    /// Largest turn rate.
    pub angular_speed: AngularSpeed,
    /// Largest forward acceleration of a command.
    pub acceleration: Acceleration,
    /// Least deceleration the brakes are sure to give (assumption A-BRAKE).
    pub braking: Acceleration,
    /// Largest angular acceleration of a command.
    pub angular_acceleration: AngularAcceleration,
    /// Least angular deceleration the brakes are sure to give.
    pub angular_braking: AngularAcceleration,
    /// How the drive ramps between commands.
    pub ramps: Ramps,
}

/// Times after which data are worthless, and reaction times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Control period.
    pub period: Duration,
    /// How much later than one period a tick may come; later is a host pause.
    pub jitter: Duration,
    /// Longest time from a decision to its effect at the wheels (assumption A-LATENCY).
    pub actuation_latency: Duration,
    /// Oldest usable scan, counted from its first beam.
    pub scan_age_max: Duration,
    /// Oldest usable odometry.
    pub odometry_age_max: Duration,
    /// Oldest usable command.
    pub command_age_max: Duration,
    /// How long the twist must be within tolerance of zero to count as rest.
    pub rest: Duration,
    /// How long a hazard must be gone before a protective stop releases.
    pub clear: Duration,
    /// Window over which the measured twist must have followed the commands.
    pub tracking_window: Duration,
}

/// Bounds of errors (assumptions, each checked at run time where it can be).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tolerances {
    /// Error of measured or executed speed.
    pub speed: Speed,
    /// Error of measured or executed turn rate.
    pub angular_speed: AngularSpeed,
    /// Lateral and longitudinal error of the drive along a commanded arc.
    pub tracking: Length,
    /// Odometry position error per distance travelled.
    pub odometry_linear: Ppm,
    /// Odometry heading error per angle turned.
    pub odometry_angular: Ppm,
    /// Speed below which the robot counts as resting.
    pub rest_speed: Speed,
    /// Turn rate below which the robot counts as resting.
    pub rest_angular_speed: AngularSpeed,
    /// How far the measured speed may leave the hull of recent commands.
    pub follow_speed: Speed,
    /// How far the measured turn rate may leave the hull of recent commands.
    pub follow_angular_speed: AngularSpeed,
}

/// The critical zone: the footprint and these margins around it (Loh 4.1, 4.2 corrected).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ZoneMargins {
    /// In front of the front edge.
    pub front: Length,
    /// On every other side.
    pub side: Length,
}

/// A rectangle in the body frame, signed coordinates; returns inside it are the robot's own parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MaskRect {
    /// Least x.
    pub x_min: Length,
    /// Largest x.
    pub x_max: Length,
    /// Least y.
    pub y_min: Length,
    /// Largest y.
    pub y_max: Length,
}

/// Largest number of self-mask rectangles of one scanner.
pub const MASKS_MAX: usize = 4;

/// One laser scanner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scanner {
    /// Mounting position in the body frame, x.
    pub x: Length,
    /// Mounting position in the body frame, y.
    pub y: Length,
    /// Direction of the first beam in the body frame (yaw of the scanner included).
    pub first_beam: BinaryAngle,
    /// Angle from one beam to the next, counts of 2⁻³² turn; negative if mounted upside down.
    pub increment: i32,
    /// Number of beams.
    pub beams: u16,
    /// Time from the first beam to the last.
    pub scan_duration: Duration,
    /// Least measurable range.
    pub range_min: Length,
    /// Largest measurable range.
    pub range_max: Length,
    /// Bound of the range error (systematic + 3 sigma), and of the point error in the plane.
    pub error: Length,
    /// Up to this range a beam without return is taken as free (printed assumption).
    pub no_return_clear: Length,
    /// Largest part of the beams that may be invalid.
    pub invalid_max: Ppm,
    /// Largest angular gap of consecutive invalid beams, counts of 2⁻³² turn.
    pub invalid_gap_max: u32,
    /// Robot parts in view.
    pub masks: [Option<MaskRect>; MASKS_MAX],
}

/// How long and how exactly points and free space are remembered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryRules {
    /// Consecutive scans that must look past a point before it is forgotten.
    pub clear_after_scans: u8,
    /// Age at which remembered points and free space become unknown.
    pub age_max: Duration,
    /// Radius around the rotation centre that the operator vouches for at a reset.
    pub clear_at_start: Length,
    /// Margin around the footprint that the operator vouches for at a reset, beyond the disc
    /// (printed assumption).
    pub skirt: Length,
    /// Bodies at least this wide are seen (assumption A-WIDTH).
    pub body_width_min: Length,
}

/// Silence of the host, if the tube is to cover it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HostDeath {
    /// Time until the drive notices the silence.
    pub watchdog: Duration,
    /// Deceleration of the drive after that.
    pub braking: Acceleration,
    /// Angular deceleration of the drive after that.
    pub angular_braking: AngularAcceleration,
}

/// Everything the safety core knows about the robot; room for `S` scanners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config<const S: usize> {
    /// The robot's outline.
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
    pub zone: ZoneMargins,
    /// Laser scanners; at least one.
    pub scanners: [Option<Scanner>; S],
    /// Memory rules.
    pub memory: MemoryRules,
    /// Largest speed of anything that moves (assumption A-OBSTACLE); zero: a static world.
    pub obstacle_speed: Speed,
    /// Present if the guard's tube covers a host that dies.
    pub host_death: Option<HostDeath>,
}
