//! Which frames may correct: after each odometry sample, one frame per camera (Loh 3.2.4).
//!
//! It refuses frames out of order and far from the last odometry, and moves the others to the
//! moment of that odometry along the motion of the last samples: backwards as it was driven,
//! forwards as if it went on so.

use super::pose::{Increment, Pose2};
use super::sighting::{Frame, FrameVerdict};
use crate::time::{Duration, Instant};

/// Cameras are numbered below this.
pub const CAMERAS: usize = 32;
/// Motions that are remembered: 160 ms of odometry at 100 Hz.
pub const MOTIONS: usize = 16;

/// The cycle of odometry and cameras.
///
/// Public, so that another filter behind [`super::MarkerFilter`] keeps the same time.
#[derive(Clone, Debug)]
pub struct Cycle {
    odometry: Option<Instant>,
    /// The last increments and how long each took, newest first; those of no time are none.
    motions: [(Increment, Duration); MOTIONS],
    /// Whether a camera has corrected since the last odometry.
    corrected: [bool; CAMERAS],
    frames: [Option<Instant>; CAMERAS],
}

impl Default for Cycle {
    fn default() -> Self {
        Self {
            odometry: None,
            motions: [(Increment::default(), Duration::ZERO); MOTIONS],
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
        if let Some(took) = took.filter(|took| *took > Duration::ZERO) {
            let mut newer = (*increment, took);
            for place in &mut self.motions {
                core::mem::swap(place, &mut newer);
            }
        }
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
        //= spec/ekf.md#ekf-08
        //# A frame or an odometry sample that is out of order, too old or from the future MUST be refused and leave
        //# the state as it is.
        if last.is_some_and(|last| frame.stamp <= last) {
            FrameVerdict::Reordered
        } else if odometry.since(frame.stamp).is_some_and(|late| late > age) {
            FrameVerdict::Stale
        } else if frame.stamp.since(odometry).is_some_and(|early| early > age) {
            FrameVerdict::Future
        } else if self.carry(frame.stamp).is_none() {
            if frame.stamp < odometry {
                FrameVerdict::Stale
            } else {
                FrameVerdict::Future
            }
        } else if *corrected {
            FrameVerdict::AwaitsOdometry
        } else if frame.sightings.is_empty() {
            FrameVerdict::Empty
        } else {
            FrameVerdict::Used
        }
    }

    /// The robot's pose at `stamp` in the frame of the robot at the last odometry.
    ///
    /// `None` if that is farther away than the remembered motions reach. Before its first motion
    /// the robot is taken to have stood still.
    /// # Bound
    /// [`MOTIONS`] steps.
    #[must_use]
    pub fn carry(&self, stamp: Instant) -> Option<Pose2> {
        let Some(odometry) = self.odometry else {
            return Some(Pose2::default());
        };
        if let Some(away) = odometry.since(stamp) {
            return self.back(away);
        }
        // On as it went for as long before.
        let before = self.back(stamp.since(odometry)?)?;
        Some(before.sees(&Pose2::default()))
    }

    /// The robot's pose so long before the last odometry, in its frame of then.
    fn back(&self, away: Duration) -> Option<Pose2> {
        let mut pose = Pose2::default();
        let mut left_us = away.as_us();
        for (increment, took) in &self.motions {
            let took_us = took.as_us();
            if left_us == 0 || took_us == 0 {
                return Some(pose);
            }
            let step = if took_us <= left_us {
                increment.as_pose().sees(&Pose2::default())
            } else {
                let part = left_us as f64 / took_us as f64;
                increment.scaled(-part).as_pose()
            };
            pose = pose.then(&step);
            left_us = left_us.saturating_sub(took_us);
        }
        (left_us == 0).then_some(pose)
    }

    /// This camera has corrected in this cycle, with a frame of this moment.
    //= spec/ekf.md#ekf-07
    //# Between two odometry samples at most one frame per camera MUST correct: the first with a usable sighting.
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
