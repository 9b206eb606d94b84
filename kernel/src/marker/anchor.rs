//! How errors are counted: as a small motion of the whole plane, not of one pose by itself.
//!
//! Nothing that a robot sees tells where the map as a whole lies and which way it is turned. A
//! filter that counts errors of x, y and heading pose by pose, and differentiates at estimates
//! that change, comes to believe that it was told (Julier and Uhlmann 2001), and grows
//! overconfident after turns. Here the error of a pose is the motion of the plane that would
//! mend it, given as a turn about a fixed point and a shift; the direction "all of it moves" is
//! then the same at every estimate, and no sighting ever narrows it.
//!
//! The fixed point, the anchor, is where the pose was estimated first; the robot's goes along with the
//! odometry. Only the distance of pose and anchor enters, so that nothing is lost far from the
//! origin. It refuses nothing.
//!
//! # Source
//! Barrau and Bonnabel 2015, "An EKF-SLAM algorithm with consistency properties" (anchored at
//! the origin there).

use super::linear::{Matrix, Vector};
use super::pose::{Pose2, sin_cos};

/// The point about which the turn of one pose's error is counted.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Anchor {
    x_m: f64,
    y_m: f64,
}

impl Anchor {
    /// At this pose, where both ways to count are the same.
    pub(super) const fn at(pose: &Pose2) -> Self {
        Self {
            x_m: pose.x_m,
            y_m: pose.y_m,
        }
    }

    /// Goes along with a motion of the robot.
    pub(super) fn follow(&mut self, from: &Pose2, to: &Pose2) {
        self.x_m += to.x_m - from.x_m;
        self.y_m += to.y_m - from.y_m;
    }

    /// The derivative of the error [x, y, heading] of `pose` by the error as counted here.
    //= spec/ekf.md#ekf-15
    //# Sightings of learned markers MUST NOT narrow the pose of the map as a whole.
    pub(super) fn error_of(&self, pose: &Pose2) -> Matrix {
        let (x, y) = (pose.x_m - self.x_m, pose.y_m - self.y_m);
        [[1.0, 0.0, -y], [0.0, 1.0, x], [0.0, 0.0, 1.0]]
    }

    /// The inverse of [`Self::error_of`].
    pub(super) fn counted(&self, pose: &Pose2) -> Matrix {
        let (x, y) = (pose.x_m - self.x_m, pose.y_m - self.y_m);
        [[1.0, 0.0, y], [0.0, 1.0, -x], [0.0, 0.0, 1.0]]
    }

    /// The pose moved with the plane: exactly, not to first order.
    pub(super) fn corrected(&self, pose: &Pose2, error: Vector) -> Pose2 {
        let [shift_x, shift_y, turn_rad] = error;
        let (sin, cos) = sin_cos(turn_rad);
        let (along, across) = arc(turn_rad, sin, cos);
        let (x, y) = (pose.x_m - self.x_m, pose.y_m - self.y_m);
        let to = [
            cos * x - sin * y + along * shift_x - across * shift_y,
            sin * x + cos * y + across * shift_x + along * shift_y,
        ];
        pose.corrected([to[0] - x, to[1] - y, turn_rad])
    }
}

/// `sin(a)/a` and `(1 − cos(a))/a`, by their series where the quotients lose digits.
fn arc(angle_rad: f64, sin: f64, cos: f64) -> (f64, f64) {
    if angle_rad.abs() < 1e-4 {
        let square = angle_rad * angle_rad;
        (1.0 - square / 6.0, angle_rad * (0.5 - square / 24.0))
    } else {
        (sin / angle_rad, (1.0 - cos) / angle_rad)
    }
}
