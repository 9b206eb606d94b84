//! What the caller hands to one tick of the kernel: plain data, no callbacks.
//!
//! Floats enter only through [`crate::convert`], which turns what it cannot
//! represent into [`Reading::Malformed`] or [`Beam::Invalid`].

use crate::time::Instant;
use crate::units::{AngularSpeed, BinaryAngle, Curvature, Speed};

/// A channel's news in this tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reading<T> {
    /// Nothing new arrived.
    #[default]
    Absent,
    /// Something arrived that cannot be used (not finite, out of range, undecodable).
    Malformed,
    /// A usable value.
    Value(T),
}

/// One laser beam after decoding (design: hit, no-return, too-near, invalid).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beam {
    /// A return at this range in whole millimetres, rounded towards the scanner.
    Hit(u16),
    /// The beam came back from nowhere.
    NoReturn,
    /// Something nearer than the scanner can measure: an obstacle at minimum range.
    TooNear,
    /// Not a measurement.
    Invalid,
}

/// One complete sweep of one scanner.
#[derive(Clone, Copy, Debug)]
pub struct Scan<'a> {
    /// Index into [`crate::config::Config::scanners`].
    pub scanner: usize,
    /// Time of the *first* beam; beam `i` of `n` is `i / n` of the scan duration later.
    pub stamp: Instant,
    /// Beams in the order of the scanner's angles; the count must be the configured one.
    pub beams: &'a [Beam],
}

/// Pose in the odometry frame (REP 105 `odom`), rotation centre of the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pose {
    /// Position along x in micrometres.
    pub x_um: i64,
    /// Position along y in micrometres.
    pub y_um: i64,
    /// Heading, counter-clockwise from x.
    pub heading: BinaryAngle,
}

/// Body-frame velocity at the rotation centre (Ackermann: rear axle).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Twist {
    /// Forward speed.
    pub linear: Speed,
    /// Counter-clockwise turn rate.
    pub angular: AngularSpeed,
}

/// One odometry sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Odometry {
    /// Time of the measurement.
    pub stamp: Instant,
    /// Pose in the odometry frame.
    pub pose: Pose,
    /// Measured velocity.
    pub twist: Twist,
    /// Measured path curvature of the front wheels (Ackermann with a steering sensor).
    pub steering: Option<Curvature>,
}

/// A desired or commanded motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Speed and turn rate (differential drive).
    Twist(Twist),
    /// Speed and path curvature (Ackermann: curvature = tan(wheel angle) / wheelbase).
    Arc {
        /// Forward speed.
        linear: Speed,
        /// Path curvature, positive to the left; meaningful also at standstill.
        curvature: Curvature,
    },
}

/// A motion somebody wants, with the time at which they wanted it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Command {
    /// When the command was issued.
    pub stamp: Instant,
    /// What is wanted.
    pub motion: Motion,
}

/// Everything that arrived since the last tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Inputs<'a> {
    /// New scans in the order of arrival.
    pub scans: &'a [Reading<Scan<'a>>],
    /// The newest odometry.
    pub odometry: Reading<Odometry>,
    /// The newest command.
    pub command: Reading<Command>,
    /// Emergency stop line; `true` latches.
    pub emergency_stop: bool,
    /// Stamp of an operator's reset, if one was given since the last tick.
    pub reset: Option<Instant>,
}
