//! Which frames may correct: after each odometry sample, one frame per camera (Loh 3.2.4).
//!
//! It refuses frames out of order and far from the last odometry, and moves the others to the
//! moment of that odometry with the motion last seen.

use super::pose::{Increment, Pose2};
use super::sighting::{Frame, FrameVerdict};
use crate::time::{Duration, Instant};

/// Cameras are numbered below this.
pub const CAMERAS: usize = 32;
/// A motion is carried on for at most this many of its own durations.
const CARRY_MAX: f64 = 4.0;

/// The cycle of odometry and cameras.
///
/// Public, so that another filter behind [`super::MarkerFilter`] keeps the same time.
#[derive(Clone, Debug)]
pub struct Cycle {
    odometry: Option<Instant>,
    /// The last increment and how long it took.
    motion: (Increment, Duration),
    /// Whether a camera has corrected since the last odometry.
    corrected: [bool; CAMERAS],
    frames: [Option<Instant>; CAMERAS],
}

impl Default for Cycle {
    fn default() -> Self {
        Self {
            odometry: None,
            motion: (Increment::default(), Duration::ZERO),
            corrected: [false; CAMERAS],
            frames: [None; CAMERAS],
        }
    }
}

impl Cycle {
    /// When the last odometry was taken.
    #[must_use]
    pub const fn odometry(&self) -> Option<Instant> {
        self.odometry
    }

    /// Whether odometry of this moment is newer than all before.
    #[must_use]
    pub fn is_news(&self, stamp: Instant) -> bool {
        self.odometry.is_none_or(|last| stamp > last)
    }

    /// A new cycle begins.
    pub fn begin(&mut self, stamp: Instant, increment: &Increment) {
        let took = self.odometry.and_then(|last| stamp.since(last));
        self.motion = (*increment, took.unwrap_or_default());
        self.odometry = Some(stamp);
        self.corrected = [false; CAMERAS];
    }

    /// What is to be done with a frame; [`FrameVerdict::Used`] if it may correct.
    pub fn admit(&self, frame: &Frame<'_>, age: Duration) -> FrameVerdict {
        let camera = usize::from(frame.camera);
        let Some(corrected) = self.corrected.get(camera) else {
            return FrameVerdict::UnknownCamera;
        };
        let last = self.frames.get(camera).copied().flatten();
        let Some(odometry) = self.odometry else {
            return FrameVerdict::AwaitsOdometry;
        };
        if last.is_some_and(|last| frame.stamp <= last) {
            FrameVerdict::Reordered
        } else if odometry.since(frame.stamp).is_some_and(|late| late > age) {
            FrameVerdict::Stale
        } else if frame.stamp.since(odometry).is_some_and(|early| early > age) {
            FrameVerdict::Future
        } else if *corrected {
            FrameVerdict::AwaitsOdometry
        } else if frame.sightings.is_empty() {
            FrameVerdict::Empty
        } else {
            FrameVerdict::Used
        }
    }

    /// The robot's pose at `stamp` in the frame of the robot at the last odometry.
    #[must_use]
    pub fn carry(&self, stamp: Instant) -> Pose2 {
        let (increment, took) = self.motion;
        let (Some(odometry), true) = (self.odometry, took > Duration::ZERO) else {
            return Pose2::default();
        };
        let seconds = |span: Duration| span.as_us() as f64;
        let ahead = stamp.since(odometry).map(seconds);
        let behind = odometry.since(stamp).map(seconds);
        let away = ahead.or(behind.map(|us| -us)).unwrap_or_default();
        let part = (away / seconds(took)).clamp(-CARRY_MAX, CARRY_MAX);
        increment.scaled(part).as_pose()
    }

    /// This camera has corrected in this cycle, with a frame of this moment.
    pub fn corrected(&mut self, frame: &Frame<'_>) {
        let camera = usize::from(frame.camera);
        if let Some(corrected) = self.corrected.get_mut(camera) {
            *corrected = true;
        }
        if let Some(last) = self.frames.get_mut(camera) {
            *last = Some(frame.stamp);
        }
    }
}
