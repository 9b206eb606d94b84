//! Tests of the filter: against a dense reference, finite differences, and bad input.

mod behaviour;
mod cycle;
mod dense;
mod factor;
mod hostile;
mod jacobians;
mod order;
mod projection;

use super::*;
use crate::time::{Duration, Instant};

/// A filter of the size most tests use.
pub(super) type Small = MarkerEkf<6, 8>;

pub(super) fn noise() -> SightingNoise {
    SightingNoise::isotropic(0.02, 0.02)
}

pub(super) fn small(learn: bool) -> Small {
    let rules = FilterRules {
        learn,
        ..FilterRules::default()
    };
    Small::new(rules, Pose2::default(), [1e-4, 1e-4, 1e-4]).unwrap()
}

/// Drives a filter in 50 ms cycles and shows it markers as they truly are, or are not.
pub(super) struct Drive<F> {
    pub(super) filter: F,
    pub(super) truth: Pose2,
    pub(super) now: Instant,
}

impl<F: MarkerFilter> Drive<F> {
    pub(super) fn new(filter: F) -> Self {
        let mut drive = Self {
            truth: filter.pose(),
            filter,
            now: Instant::from_us(1_000_000),
        };
        drive.step(Increment::default());
        drive
    }

    pub(super) fn step(&mut self, increment: Increment) {
        self.now = self.now.plus(Duration::from_ms(50));
        self.truth = self.truth.then(&Pose2::new(
            increment.forward_m,
            increment.left_m,
            increment.turn_rad,
        ));
        let done = self.filter.predict(self.now, &increment);
        assert_eq!(done, Prediction::Done);
    }

    /// What the robot would see of a marker at this pose.
    pub(super) fn sees(&self, id: u16, marker: Pose2) -> Sighting {
        Sighting::pose(id, self.truth.sees(&marker), noise())
    }

    pub(super) fn show(&mut self, sightings: &[Sighting]) -> FrameReport {
        self.show_by(0, sightings)
    }

    pub(super) fn show_by(&mut self, camera: u8, sightings: &[Sighting]) -> FrameReport {
        self.filter.correct(&Frame {
            camera,
            stamp: self.now,
            sightings,
        })
    }

    /// One cycle at rest with one frame.
    pub(super) fn look(&mut self, sightings: &[Sighting]) -> FrameReport {
        self.step(Increment::default());
        self.show(sightings)
    }
}

pub(super) fn verdicts(report: &FrameReport) -> std::vec::Vec<Verdict> {
    report.records().map(|record| record.verdict).collect()
}
