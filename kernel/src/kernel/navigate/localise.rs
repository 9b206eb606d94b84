//! From the marker filter to the route: where the odometry frame lies in the map.
//!
//! The guard goes on in the odometry frame and never learns of the map, so that a wrong pose
//! can lead the robot the wrong way, but into nothing.

use super::route::radians;
use crate::convert::{self, Round};
use crate::input::{Odometry, Pose};
use crate::marker::{Frame, FrameReport, Health, Increment, MarkerFilter, Pose2, Prediction};
use crate::time::Instant;

/// A marker filter that is fed with the kernel's odometry and says where that frame lies.
#[derive(Clone, Debug)]
pub struct Localiser<F> {
    filter: F,
    /// The last odometry sample that moved the filter.
    newest: Option<(Instant, Pose2)>,
}

impl<F: MarkerFilter> Localiser<F> {
    /// A localiser whose filter holds the robot's pose in the map when the first odometry comes.
    pub const fn new(filter: F) -> Self {
        Self {
            filter,
            newest: None,
        }
    }

    /// Moves the filter by what the robot has moved since the last sample.
    ///
    /// A sample that the filter refuses is recorded by its answer and changes nothing; the next
    /// one is then compared with the last that it took.
    pub fn odometry(&mut self, sample: &Odometry) -> Prediction {
        let pose = metres(&sample.pose);
        let increment = match &self.newest {
            Some((_, before)) => Increment::between(before, &pose),
            None => Increment::default(),
        };
        let answer = self.filter.predict(sample.stamp, &increment);
        if answer == Prediction::Done {
            self.newest = Some((sample.stamp, pose));
        }
        answer
    }

    /// Corrects by the markers of one image.
    pub fn frame(&mut self, frame: &Frame<'_>) -> FrameReport {
        self.filter.correct(frame)
    }

    /// Pose of the odometry frame in the map (REP 105 `map` to `odom`), for
    /// [`super::Route::odometry_frame`].
    ///
    /// `None` while the filter is lost, and when its odometry is not the one of `stamp`, which is
    /// that of the newest sample the kernel got. Without it there is no route to follow, and the
    /// robot stops (NAV-06).
    #[must_use]
    pub fn odometry_frame(&self, stamp: Instant) -> Option<Pose> {
        //= spec/navigate.md#nav-14
        //# While the filter is lost, or has not taken the newest odometry, the localiser MUST NOT give a frame.
        let (_, seen) = self.newest.as_ref().filter(|(at, _)| *at == stamp)?;
        if self.filter.health() != Health::Tracking {
            return None;
        }
        // The origin as the robot sees it, from where the robot is in the map.
        let origin = seen.sees(&Pose2::default());
        let frame = self.filter.pose().then(&origin);
        Some(Pose {
            x_um: convert::round(frame.x_m * 1e6, Round::Nearest)?,
            y_um: convert::round(frame.y_m * 1e6, Round::Nearest)?,
            heading: convert::angle(frame.heading_rad)?,
        })
    }

    /// The filter.
    pub const fn filter(&self) -> &F {
        &self.filter
    }
}

fn metres(pose: &Pose) -> Pose2 {
    Pose2::new(
        pose.x_um as f64 * 1e-6,
        pose.y_um as f64 * 1e-6,
        radians(pose.heading),
    )
}
