//! The motion and the sighting model with their derivatives (Loh 3.5 to 3.11, REP 103).
//!
//! 3.9 and 3.10 are corrected: as printed, two signs contradict 3.5 and 3.6.

use super::linear::Matrix;
use super::pose::{Increment, Pose2, sin_cos};

/// A linear relation between small changes: `robot` and `marker` blocks of one function.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jacobians {
    /// With respect to the robot's pose.
    pub(super) robot: Matrix,
    /// With respect to the marker's pose.
    pub(super) marker: Matrix,
}

/// The pose after `increment`, and its derivative with respect to the pose before.
pub(super) fn moved(robot: &Pose2, increment: &Increment) -> (Pose2, Matrix) {
    let after = robot.then(&increment.as_pose());
    let jacobian = [
        [1.0, 0.0, robot.y_m - after.y_m],
        [0.0, 1.0, after.x_m - robot.x_m],
        [0.0, 0.0, 1.0],
    ];
    (after, jacobian)
}

/// Derivative of [`moved`] with respect to errors along, across and in turn of the motion.
///
/// An error in turn grows evenly on the way, so the end is displaced by half of it.
pub(super) fn motion_noise(robot: &Pose2, increment: &Increment) -> Matrix {
    let (sin, cos) = sin_cos(robot.heading_rad);
    let (x, y) = (-increment.left_m / 2.0, increment.forward_m / 2.0);
    [
        [cos, -sin, cos * x - sin * y],
        [sin, cos, sin * x + cos * y],
        [0.0, 0.0, 1.0],
    ]
}

/// Derivatives of `robot.sees(marker)` (Loh 3.10 corrected, 3.11).
//= spec/ekf.md#ekf-01
//# Every derivative used MUST be the derivative of the function it belongs to.
pub(super) fn sighting(robot: &Pose2, marker: &Pose2) -> Jacobians {
    let (sin, cos) = sin_cos(robot.heading_rad);
    let (dx, dy) = (marker.x_m - robot.x_m, marker.y_m - robot.y_m);
    Jacobians {
        robot: [
            [-cos, -sin, -dx * sin + dy * cos],
            [sin, -cos, -dx * cos - dy * sin],
            [0.0, 0.0, -1.0],
        ],
        marker: [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]],
    }
}

/// Derivatives of the marker's pose `robot.then(seen)`: with respect to the robot and, in
/// `marker`, to what was seen (Loh 3.18).
pub(super) fn placed(robot: &Pose2, seen: &Pose2) -> Jacobians {
    let [x, y] = turned(robot, seen);
    Jacobians {
        robot: [[1.0, 0.0, -y], [0.0, 1.0, x], [0.0, 0.0, 1.0]],
        marker: robot.rotation(),
    }
}

/// The robot's pose from a known marker, and its derivatives: with respect to the marker and,
/// in `robot`, to what was seen.
pub(super) fn located(marker: &Pose2, seen: &Pose2) -> (Pose2, Jacobians) {
    let heading = Pose2::new(0.0, 0.0, marker.heading_rad - seen.heading_rad);
    let [x, y] = turned(&heading, seen);
    let robot = Pose2 {
        x_m: marker.x_m - x,
        y_m: marker.y_m - y,
        ..Pose2::default().then(&heading)
    };
    let (sin, cos) = sin_cos(robot.heading_rad);
    let jacobians = Jacobians {
        marker: [[1.0, 0.0, y], [0.0, 1.0, -x], [0.0, 0.0, 1.0]],
        robot: [[-cos, sin, -y], [-sin, -cos, x], [0.0, 0.0, -1.0]],
    };
    (robot, jacobians)
}

/// What was seen, turned into the frame in which the robot's pose is given.
fn turned(robot: &Pose2, seen: &Pose2) -> [f64; 2] {
    let (sin, cos) = sin_cos(robot.heading_rad);
    [
        cos * seen.x_m - sin * seen.y_m,
        sin * seen.x_m + cos * seen.y_m,
    ]
}
