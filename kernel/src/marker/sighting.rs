//! What cameras report, and what is made of it: plain data in, one record per sighting out.

use super::linear::{Matrix, Vector, ZERO};
use super::pose::Pose2;
use crate::time::Instant;

/// Marker ids are below this; an index of this many entries is all that an id costs.
pub const IDS: usize = 1024;
/// Most sightings of one frame; further ones are counted and dropped.
pub const FRAME_MAX: usize = 16;
/// Farthest sighting that is believed, per axis, m.
pub const SIGHT_MAX_M: f64 = 1e3;
/// Least variance that a sighting may claim, m² or rad²: (1 µm)², (1 µrad)².
pub const NOISE_MIN: f64 = 1e-12;
/// Largest variance that a sighting may claim, m² or rad².
pub const NOISE_MAX: f64 = 1e6;

/// How wrong one sighting may be: variances in the robot frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SightingNoise {
    /// Variance along x, m².
    pub xx_m2: f64,
    /// Covariance of x and y, m².
    pub xy_m2: f64,
    /// Variance along y, m².
    pub yy_m2: f64,
    /// Variance of the heading, rad²; not used for position-only sightings.
    pub heading_rad2: f64,
}

impl SightingNoise {
    /// The same standard deviation in every direction.
    #[must_use]
    pub fn isotropic(position_sigma_m: f64, heading_sigma_rad: f64) -> Self {
        let position_m2 = position_sigma_m * position_sigma_m;
        Self {
            xx_m2: position_m2,
            xy_m2: 0.0,
            yy_m2: position_m2,
            heading_rad2: heading_sigma_rad * heading_sigma_rad,
        }
    }

    /// Of a range and a bearing with independent errors, for a marker seen at (x, y).
    #[must_use]
    pub fn range_bearing(x_m: f64, y_m: f64, range_sigma_m: f64, bearing_sigma_rad: f64) -> Self {
        let square = x_m * x_m + y_m * y_m;
        let (range_m2, bearing) = (range_sigma_m * range_sigma_m, bearing_sigma_rad);
        // Along the ray the range's, across it the bearing's.
        let (xx, xy, yy) = if square > 0.0 {
            (x_m * x_m / square, x_m * y_m / square, y_m * y_m / square)
        } else {
            (1.0, 0.0, 1.0)
        };
        let across_m2 = bearing * bearing * square;
        Self {
            xx_m2: range_m2 * xx + across_m2 * yy,
            xy_m2: (range_m2 - across_m2) * xy,
            yy_m2: range_m2 * yy + across_m2 * xx,
            heading_rad2: 1.0,
        }
    }

    fn is_usable(&self, oriented: bool) -> bool {
        let range = NOISE_MIN..=NOISE_MAX;
        let determinant = self.xx_m2 * self.yy_m2 - self.xy_m2 * self.xy_m2;
        range.contains(&self.xx_m2)
            && range.contains(&self.yy_m2)
            && determinant >= NOISE_MIN * self.xx_m2.max(self.yy_m2)
            && (!oriented || range.contains(&self.heading_rad2))
    }

    /// As a covariance of [x m, y m, heading rad], the heading's 1 where there is none.
    #[must_use]
    pub fn matrix(&self, oriented: bool) -> Matrix {
        let heading = if oriented { self.heading_rad2 } else { 1.0 };
        [
            [self.xx_m2, self.xy_m2, 0.0],
            [self.xy_m2, self.yy_m2, 0.0],
            [0.0, 0.0, heading],
        ]
    }
}

/// One marker in one image: where it is in the robot frame (REP 103).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// The id that was read.
    pub id: u16,
    /// Position along x, forward, m.
    pub x_m: f64,
    /// Position along y, to the left, m.
    pub y_m: f64,
    /// Direction of the marker's normal, rad; `None` for landmarks without one.
    pub heading_rad: Option<f64>,
    /// How wrong this may be.
    pub noise: SightingNoise,
}

impl Sighting {
    /// A marker's whole pose.
    #[must_use]
    pub const fn pose(id: u16, seen: Pose2, noise: SightingNoise) -> Self {
        Self {
            id,
            x_m: seen.x_m,
            y_m: seen.y_m,
            heading_rad: Some(seen.heading_rad),
            noise,
        }
    }

    /// A landmark's position only.
    #[must_use]
    pub const fn position(id: u16, x_m: f64, y_m: f64, noise: SightingNoise) -> Self {
        Self {
            id,
            x_m,
            y_m,
            heading_rad: None,
            noise,
        }
    }

    pub(super) fn seen(&self) -> Pose2 {
        Pose2::new(self.x_m, self.y_m, self.heading_rad.unwrap_or_default())
    }

    pub(super) fn is_usable(&self) -> bool {
        usize::from(self.id) < IDS
            && self.seen().is_within(SIGHT_MAX_M)
            && self.heading_rad.is_none_or(|h| h.abs() <= SIGHT_MAX_M)
            && self.noise.is_usable(self.heading_rad.is_some())
    }
}

/// The markers of one image; none is a valid frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Which camera, below [`super::CAMERAS`].
    pub camera: u8,
    /// When the image was taken.
    pub stamp: Instant,
    /// What was found in it, in any order.
    pub sightings: &'a [Sighting],
}

/// What became of one sighting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[must_use]
pub enum Verdict {
    /// Inside the gate: the state was corrected by it.
    Fused,
    /// A marker nobody knew; it is in the state now.
    Added,
    /// Outside the gate: ignored.
    Gated,
    /// Outside the gate once too often: ignored, and the marker was taken out of the state.
    Removed,
    /// The same id more than once in this frame, and the gate cannot tell which is meant.
    Ambiguous,
    /// A marker nobody knows, and the filter is told not to learn.
    Unknown,
    /// A marker nobody knows, while sightings of known ones are being rejected.
    Postponed,
    /// A marker nobody knows, and no room for it.
    Full,
    /// Not finite, out of range, an id that does not exist, or a noise that is none.
    Malformed,
}

/// One sighting's fate, for logs and for monitors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// The id that was read, valid or not.
    pub id: u16,
    /// What was decided.
    pub verdict: Verdict,
    /// Measured minus expected, robot frame, [x m, y m, heading rad]; zero where nothing
    /// was expected, and in the heading of position-only sightings.
    pub innovation: [f64; 3],
    /// Covariance of the innovation; zero where nothing was expected.
    pub covariance: [[f64; 3]; 3],
    /// Numbers measured: 3 for a pose, 2 for a position.
    pub degrees_of_freedom: u8,
    /// Normalised innovation squared; zero where nothing was expected.
    pub nis: f64,
}

impl Record {
    /// A sighting that was not compared with anything.
    pub const fn unjudged(sighting: &Sighting, verdict: Verdict) -> Self {
        Self {
            id: sighting.id,
            verdict,
            innovation: [0.0; 3],
            covariance: ZERO,
            degrees_of_freedom: if sighting.heading_rad.is_some() { 3 } else { 2 },
            nis: 0.0,
        }
    }

    /// A sighting compared with what was expected.
    pub(super) const fn judged(
        sighting: &Sighting,
        innovation: Vector,
        covariance: Matrix,
        nis: f64,
        verdict: Verdict,
    ) -> Self {
        Self {
            innovation,
            covariance,
            nis,
            ..Self::unjudged(sighting, verdict)
        }
    }
}

/// What became of a frame as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[must_use]
pub enum FrameVerdict {
    /// Its sightings were judged, see the records.
    Used,
    /// It shows no marker; the camera may still correct in this cycle.
    Empty,
    /// No odometry since this camera's last correction (Loh 3.2.4), or none at all.
    AwaitsOdometry,
    /// Taken too long before the last odometry.
    Stale,
    /// Taken too long after the last odometry.
    Future,
    /// Not newer than this camera's last used frame.
    Reordered,
    /// No such camera.
    UnknownCamera,
}

/// Everything that happened to one frame.
#[derive(Clone, Copy, Debug)]
pub struct FrameReport {
    /// Camera of the frame.
    pub camera: u8,
    /// Stamp of the frame.
    pub stamp: Instant,
    /// What became of it.
    pub verdict: FrameVerdict,
    /// Sightings beyond [`FRAME_MAX`], not looked at.
    pub dropped: usize,
    /// The robot's pose was set anew from sightings that agree with each other.
    pub relocated: bool,
    records: [Option<Record>; FRAME_MAX],
}

impl FrameReport {
    /// A report without records.
    pub const fn new(frame: &Frame<'_>, verdict: FrameVerdict) -> Self {
        Self {
            camera: frame.camera,
            stamp: frame.stamp,
            verdict,
            dropped: frame.sightings.len().saturating_sub(FRAME_MAX),
            relocated: false,
            records: [None; FRAME_MAX],
        }
    }

    /// Enters what became of the sighting at `index` of the frame; beyond [`FRAME_MAX`] nothing.
    pub fn set(&mut self, index: usize, record: Record) {
        if let Some(place) = self.records.get_mut(index) {
            *place = Some(record);
        }
    }

    /// The record of the sighting at `index` of the frame.
    #[must_use]
    pub fn record(&self, index: usize) -> Option<&Record> {
        self.records.get(index)?.as_ref()
    }

    /// The records in the order of the frame's sightings.
    pub fn records(&self) -> impl Iterator<Item = &Record> {
        self.records.iter().flatten()
    }

    /// How many sightings got this verdict.
    #[must_use]
    pub fn count(&self, verdict: Verdict) -> usize {
        self.records().filter(|r| r.verdict == verdict).count()
    }

    pub(super) fn set_verdict(&mut self, index: usize, verdict: Verdict) {
        if let Some(Some(record)) = self.records.get_mut(index) {
            record.verdict = verdict;
        }
    }
}
