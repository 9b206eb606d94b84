//! What can go wrong with the inputs and the host.

use serde::Deserialize;

use super::value::{Fraction, NonNegative, Number, Pair, Positive, perhaps};

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
    /// Range that is reported, range at which the sensor saturates, or step of quantised ranges.
    pub range_m: Option<Positive>,
    /// Bearings on the robot between which a sector lies, counter-clockwise from the first.
    #[serde(default, deserialize_with = "perhaps")]
    pub sector_deg: Option<Pair>,
    /// Angle by which a scan is turned, counter-clockwise.
    pub turn_deg: Option<Number>,
    /// What is reported for each metre, or each radian.
    pub factor: Option<Positive>,
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
    /// Ranges beyond `range_m` read `range_m`.
    RangesSaturated,
    /// Ranges are rounded to whole multiples of `range_m`.
    RangesQuantised,
    /// Ranges are `factor` times what they should be.
    RangesScaled,
    /// Beams between the bearings `sector_deg` are invalid.
    SectorLost,
    /// Beams between the bearings `sector_deg` read `range_m`.
    SectorSpoofed,
    /// Beams come in the opposite order.
    ScanMirrored,
    /// The scanner is turned on its mount by `turn_deg`.
    ScanRotated,
    /// Each scan arrives twice.
    ScanDuplicated,
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
    /// Scan stamps lie `offset_s` in the past.
    ScanPast,
    /// Scan stamps err by up to `offset_s` either way, each by another time.
    ScanJitter,
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
    /// Distance, angle and speeds are `factor` times what they should be.
    OdometryScaled,
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
    /// Each call of the kernel comes late by up to `offset_s`, each by another time.
    HostJitter,
    /// The host's clock jumps back by `offset_s`.
    ClockBackwards,
    /// The host's clock jumps ahead by `offset_s`.
    ClockForwards,
    /// The drive keeps the set point it has and takes no other.
    DriveStuck,
    /// The drive takes no set point that is slower than the one it has.
    DriveIgnoresStop,
}

/// All sorts.
pub const KINDS: [FaultKind; 42] = {
    use FaultKind as F;
    [
        F::RangesNan,
        F::RangesInfinite,
        F::RangesZero,
        F::RangesNegative,
        F::BeamsLost,
        F::RangesSaturated,
        F::RangesQuantised,
        F::RangesScaled,
        F::SectorLost,
        F::SectorSpoofed,
        F::ScanMirrored,
        F::ScanRotated,
        F::ScanDuplicated,
        F::ScanMissing,
        F::ScanFrozen,
        F::ScanShort,
        F::ScanLate,
        F::ScanFuture,
        F::ScanPast,
        F::ScanJitter,
        F::ScanReordered,
        F::ScanWrapped,
        F::OdometryMissing,
        F::OdometryNan,
        F::OdometryJump,
        F::OdometrySign,
        F::OdometryFrozen,
        F::OdometryScaled,
        F::OdometryFuture,
        F::OdometryReordered,
        F::CommandNan,
        F::CommandMissing,
        F::CommandLate,
        F::CommandFuture,
        F::CommandReordered,
        F::HostPause,
        F::HostDeath,
        F::HostJitter,
        F::ClockBackwards,
        F::ClockForwards,
        F::DriveStuck,
        F::DriveIgnoresStop,
    ]
};

impl FaultKind {
    /// Its name in scenario files.
    #[must_use]
    pub fn name(self) -> String {
        let mut name = String::new();
        for letter in format!("{self:?}").chars() {
            if letter.is_ascii_uppercase() && !name.is_empty() {
                name.push('_');
            }
            name.push(letter.to_ascii_lowercase());
        }
        name
    }

    /// Whether it needs `offset_s`.
    #[must_use]
    pub const fn needs_offset(self) -> bool {
        matches!(
            self,
            Self::ScanLate
                | Self::ScanFuture
                | Self::ScanPast
                | Self::ScanJitter
                | Self::OdometryFuture
                | Self::CommandLate
                | Self::CommandFuture
                | Self::HostJitter
                | Self::ClockBackwards
                | Self::ClockForwards
        )
    }

    /// Whether it needs `range_m`.
    #[must_use]
    pub const fn needs_range(self) -> bool {
        matches!(
            self,
            Self::RangesSaturated | Self::RangesQuantised | Self::SectorSpoofed
        )
    }

    /// Whether it needs `sector_deg`.
    #[must_use]
    pub const fn needs_sector(self) -> bool {
        matches!(self, Self::SectorLost | Self::SectorSpoofed)
    }

    /// Whether it needs `factor`.
    #[must_use]
    pub const fn needs_factor(self) -> bool {
        matches!(self, Self::RangesScaled | Self::OdometryScaled)
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
