//! Where the robot is, from odometry and fiducial markers: an EKF over its pose and theirs.
//!
//! Markers whose pose is known beforehand are a table; the others enter the state when they
//! are first seen (SLAM). A sighting is a marker's pose in the robot frame, or only its
//! position. Each one leaves a [`Record`]: what was expected, how far off it was, and what was
//! done about it. The filter refuses to believe a sighting outside its gate, a frame out of
//! order, and numbers that cannot be; it says [`Health::Lost`] instead of following them.
//!
//! Tested, not proved: this module counts in `f64`, and unlike the safety core nothing about
//! it is verified beyond its tests. The guard never asks it, so a wrong pose makes a plan
//! worse and a motion never unsafe.
//!
//! Invariants (tested): the state is finite, headings lie in (−π, π]; the covariance is
//! symmetric and positive because it is stored as a factor (see `factor.rs`); sightings of
//! learned markers do not narrow the pose of the map as a whole (see `anchor.rs`); nothing
//! allocates or panics for any input; a correction costs O(markers²), a prediction O(markers).
//!
//! Frames: poses in the frame of the map, sightings and increments in the robot frame
//! (REP 103: x forward, y left, counter-clockwise); metres and radians.
//!
//! # Source
//! Loh 2018, chapter 3, with 3.9, 3.10 and 3.19 corrected.

mod account;
mod anchor;
mod correct;
mod cycle;
mod ekf;
mod factor;
mod index;
mod linear;
mod model;
mod pose;
mod projection;
mod recovery;
mod rotation;
mod rules;
mod sighting;
mod state;
#[cfg(test)]
mod tests;

pub use cycle::{CAMERAS, Cycle, MOTIONS};
pub use ekf::{INCREMENT_MAX_M, INCREMENT_MAX_RAD, MarkerEkf};
pub use pose::{Increment, Pose2, wrap};
pub use projection::{CornerRules, Isometry3, ProjectionRefused, project};
pub use recovery::{Health, SUPPORT};
pub use rules::{FilterError, FilterRules, OdometryNoise};
pub use sighting::{
    FRAME_MAX, Frame, FrameReport, FrameVerdict, IDS, NOISE_MAX, NOISE_MIN, Record, SIGHT_MAX_M,
    Sighting, SightingNoise, Verdict,
};

use crate::time::Instant;

/// Farthest from the origin that the filter works, per axis, m.
pub const POSITION_MAX_M: f64 = 1e6;

/// What became of an odometry sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[must_use]
pub enum Prediction {
    /// The state moved.
    Done,
    /// Not newer than the last sample: ignored.
    Reordered,
    /// Not finite, too large, or out of the filter's range: ignored.
    Malformed,
}

/// What is known about one marker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkerEstimate {
    /// Pose in the frame of the map.
    pub pose: Pose2,
    /// Covariance [x m, y m, heading rad]; zero for markers of the map given beforehand.
    pub covariance: [[f64; 3]; 3],
    /// Whether the heading means anything: position-only sightings never show it.
    pub oriented: bool,
    /// Sightings fused; zero for markers of the map given beforehand.
    pub sightings: u16,
}

/// A filter that estimates the robot's pose from odometry and markers.
pub trait MarkerFilter {
    /// The robot has moved by `increment` since the last sample; opens a new cycle.
    fn predict(&mut self, stamp: Instant, increment: &Increment) -> Prediction;

    /// Corrects by the markers of one image, at most once per camera and cycle (Loh 3.2.4).
    ///
    /// All sightings of the frame are judged and linearised at the state before it, so their
    /// order is irrelevant.
    fn correct(&mut self, frame: &Frame<'_>) -> FrameReport;

    /// The robot's pose at the last odometry.
    fn pose(&self) -> Pose2;

    /// Its covariance, [x m, y m, heading rad].
    fn pose_covariance(&self) -> [[f64; 3]; 3];

    /// A marker, if it is known.
    fn marker(&self, id: u16) -> Option<MarkerEstimate>;

    /// Whether the pose is to be trusted.
    fn health(&self) -> Health;
}
