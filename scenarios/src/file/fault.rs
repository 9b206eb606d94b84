//! What can go wrong with the inputs and the host.

use serde::Deserialize;

use super::value::{Fraction, NonNegative, Number, Positive};

/// One fault and its time window.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FaultEntry {
    /// What goes wrong.
    pub kind: FaultKind,
    /// First moment.
    pub from_s: NonNegative,
    /// Last moment; default for ever.
    pub until_s: Option<NonNegative>,
    /// Part of the beams concerned; default all.
    pub fraction: Option<Fraction>,
    /// Time shift of late or future stamps.
    pub offset_s: Option<Positive>,
    /// Odometry jump along x.
    pub jump_m: Option<Number>,
    /// Odometry jump of the heading.
    pub jump_deg: Option<Number>,
}

/// Sorts of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// Ranges are NaN.
    RangesNan,
    /// Ranges are +infinity.
    RangesInfinite,
    /// Ranges are zero.
    RangesZero,
    /// Ranges are negative.
    RangesNegative,
    /// Beams come back from nowhere: what the format writes for no return.
    BeamsLost,
    /// Scans do not arrive.
    ScanMissing,
    /// Scans carry the same ranges with fresh stamps.
    ScanFrozen,
    /// Scans lack half their beams.
    ScanShort,
    /// Scans arrive late by `offset_s`.
    ScanLate,
    /// Scan stamps lie `offset_s` in the future.
    ScanFuture,
    /// Each scan is followed by the one before it.
    ScanReordered,
    /// Scan stamps are truncated to 32 bits of microseconds, and wrap within the run.
    ScanWrapped,
    /// Odometry does not arrive.
    OdometryMissing,
    /// Odometry is NaN.
    OdometryNan,
    /// The odometry pose jumps by `jump_m` and `jump_deg` and stays there.
    OdometryJump,
    /// The measured speed has the wrong sign, the pose goes backwards.
    OdometrySign,
    /// Odometry repeats the same pose and twist with fresh stamps.
    OdometryFrozen,
    /// Odometry stamps lie `offset_s` in the future.
    OdometryFuture,
    /// Each odometry sample is replaced by an older one.
    OdometryReordered,
    /// Commands are NaN.
    CommandNan,
    /// Commands do not arrive.
    CommandMissing,
    /// Commands arrive late by `offset_s`.
    CommandLate,
    /// Command stamps lie `offset_s` in the future.
    CommandFuture,
    /// Each command is replaced by an older one.
    CommandReordered,
    /// The kernel is not called; the drive's adapter lives on.
    HostPause,
    /// Kernel and adapter are silent for good; only the drive's own watchdog is left.
    HostDeath,
    /// The host's clock jumps back by `offset_s`.
    ClockBackwards,
}

impl FaultKind {
    /// Whether it needs `offset_s`.
    #[must_use]
    pub const fn needs_offset(self) -> bool {
        matches!(
            self,
            Self::ScanLate
                | Self::ScanFuture
                | Self::OdometryFuture
                | Self::CommandLate
                | Self::CommandFuture
                | Self::ClockBackwards
        )
    }

    /// Whether it befalls the commands of a planner.
    #[must_use]
    pub const fn hits_commands(self) -> bool {
        matches!(
            self,
            Self::CommandNan
                | Self::CommandMissing
                | Self::CommandLate
                | Self::CommandFuture
                | Self::CommandReordered
        )
    }

    /// Whether it may have `fraction`.
    #[must_use]
    pub const fn takes_fraction(self) -> bool {
        matches!(
            self,
            Self::RangesNan
                | Self::RangesInfinite
                | Self::RangesZero
                | Self::RangesNegative
                | Self::BeamsLost
        )
    }
}
