//! The guard: certifies that the tube of a motion touches no known point and enters no unknown space.

use crate::time::Duration;
use crate::units::Length;

/// Why a tube was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Refusal {
    /// A known point lies in the tube.
    KnownPoint,
    /// The tube enters space nobody has looked at, or looked at too long ago.
    UnknownSpace,
    /// The hull mixes turning on the spot with driving, or both directions of travel.
    MixedMotion,
    /// The tube is longer or wider than the guard can cover.
    TooLong,
}

/// A point in the body frame at the decision pose, millimetres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BodyPoint {
    /// Forward.
    pub x_mm: i16,
    /// Left.
    pub y_mm: i16,
}

/// Inflation of one sample, term by term (spec: GUARD, "inflation").
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Budget {
    /// Range and position error of the scanner.
    pub sensor: Length,
    /// What may hide between two beams at the blocking point (or at the footprint's distance).
    pub beam_gap: Length,
    /// Odometry error since the point was seen; memory drift for remembered points.
    pub odometry: Length,
    /// Motion of the obstacle: its speed bound times age plus latest time.
    pub moving: Length,
    /// Tracking error of the drive.
    pub tracking: Length,
    /// Half the longest corner path between two samples.
    pub sampling: Length,
    /// Spread of speed and curvature within the hull.
    pub spread: Length,
    /// Integer rounding of the computation itself.
    pub rounding: Length,
}

/// What the guard found for one motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Verdict {
    /// `None` if the tube was accepted.
    pub refusal: Option<Refusal>,
    /// The point (or centre of the unknown cell) that decided, if any.
    pub point: Option<BodyPoint>,
    /// Number of samples of the tube.
    pub samples: u16,
    /// Longest path to rest.
    pub stopping_path: Length,
    /// Latest time until rest.
    pub stopping_time: Duration,
    /// Inflation of the deciding sample, or of the last one if accepted.
    pub budget: Budget,
}

impl Budget {
    /// Sum of all terms; saturates.
    #[must_use]
    pub const fn total(&self) -> Length {
        Length::from_um(
            self.sensor
                .as_um()
                .saturating_add(self.beam_gap.as_um())
                .saturating_add(self.odometry.as_um())
                .saturating_add(self.moving.as_um())
                .saturating_add(self.tracking.as_um())
                .saturating_add(self.sampling.as_um())
                .saturating_add(self.spread.as_um())
                .saturating_add(self.rounding.as_um()),
        )
    }
}
