//! What one tick of the kernel answers: a set point, how long it is good for, and why.

use crate::guard::Verdict;
use crate::input::Motion;
use crate::time::Instant;

/// What the kernel does with the desired motion, from least to most restrictive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[must_use]
pub enum Action {
    /// The desired motion was certified, possibly slewed within the acceleration limits.
    Pass,
    /// A slower motion on the same curvature was certified.
    Slow,
    /// No motion could be certified: brake along the present curvature, then try again.
    Brake,
    /// A protective stop: brake, release by rule.
    ProtectiveStop,
    /// An emergency stop: brake, hold until reset at rest.
    EmergencyStop,
}

/// Why the kernel did not simply pass the desired motion.
///
/// Exhaustive on purpose: a new fault does not compile until it is handled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Reason {
    /// Nothing to object to.
    None,
    /// The guard certified only a slower motion.
    GuardLimited,
    /// The guard refused every speed on the list; see [`Decision::verdict`].
    GuardBlocked,
    /// The planner finds no admissible motion towards its goal.
    PathBlocked,
    /// The desired motion exceeds a speed limit and was scaled on its curvature.
    LimitExceeded,
    /// The desired motion reverses although the rear is not watched.
    ReverseNotAllowed,
    /// Speed and acceleration limits leave no admissible command.
    EmptyWindow,
    /// No command since the last release.
    CommandMissing,
    /// The newest command is older than its limit.
    CommandStale,
    /// The newest command is stamped in the future.
    CommandFuture,
    /// A command older than the newest arrived.
    CommandReordered,
    /// The command is not finite or of the wrong kind for the drive.
    CommandMalformed,
    /// A protective stop waits for rest, its clear time and a new command.
    WaitingForRelease,
    /// A point lies in the critical zone.
    CriticalZone,
    /// A scanner has not delivered anything yet.
    ScanMissing,
    /// The newest usable scan is older than its limit.
    ScanStale,
    /// A scan is stamped in the future.
    ScanFuture,
    /// A scan older than the newest arrived.
    ScanReordered,
    /// A scan has the wrong size or scanner, too many invalid beams or too wide a blind gap.
    ScanMalformed,
    /// Scans repeat bit by bit although the robot moves.
    ScanFrozen,
    /// No odometry arrived yet.
    OdometryMissing,
    /// The newest odometry is older than its limit.
    OdometryStale,
    /// Odometry is stamped in the future.
    OdometryFuture,
    /// Odometry older than the newest arrived.
    OdometryReordered,
    /// Odometry is not finite or out of range.
    OdometryMalformed,
    /// The pose moved farther than the robot can.
    OdometryJump,
    /// Pose and twist contradict each other.
    OdometryInconsistent,
    /// The measured twist does not follow the commands.
    DriveMismatch,
    /// The tick came later than period and jitter allow.
    TickLate,
    /// `now` did not increase.
    TimeReversed,
    /// The kernel was just started and waits for its first reset.
    Startup,
    /// The emergency stop line was pulled.
    EmergencyStopLine,
}

/// State of the stop logic after the tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopStatus {
    /// Motion is allowed.
    Running,
    /// A protective stop is active.
    Protective,
    /// An emergency stop is latched.
    Latched,
}

/// The answer to one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Decision {
    /// What was done with the desired motion.
    pub action: Action,
    /// What the drive must execute now.
    pub setpoint: Motion,
    /// The most restrictive reason.
    pub reason: Reason,
    /// The stop logic's state.
    pub status: StopStatus,
    /// After this instant without a newer decision the drive must stop by itself.
    pub expires: Instant,
    /// The guard's last verdict in this tick, with the inflation budget term by term.
    pub verdict: Option<Verdict>,
    /// Speed factor of the certified motion in thousandths of the desired one.
    pub factor_permille: u16,
}
