//! Derivatives against finite differences; the printed ones of the thesis fail.

use super::dense::{derivative, pose, vector};
use crate::marker::linear::Matrix;
use crate::marker::{Increment, Pose2, model};
use nalgebra::{Matrix3, Matrix3x2, Vector2, Vector3};
use proptest::prelude::*;

fn matrix(m: &Matrix) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| m[row][column])
}

fn off(ours: &Matrix, theirs: &Matrix3<f64>) -> f64 {
    (matrix(ours) - theirs).abs().max()
}

fn any_pose(reach: f64) -> impl Strategy<Value = Pose2> {
    (-reach..reach, -reach..reach, -3.1..3.1).prop_map(|(x, y, h)| Pose2::new(x, y, h))
}

proptest! {
    //= spec/ekf.md#ekf-01
    //= type=test
    //# Every derivative used MUST be the derivative of the function it belongs to.
    #[test]
    fn derivatives_are_derivatives(
        robot in any_pose(5.0),
        marker in any_pose(5.0),
        step in any_pose(1.0),
    ) {
        let increment = Increment { forward_m: step.x_m, left_m: step.y_m, turn_rad: step.heading_rad };
        let (_, moved) = model::moved(&robot, &increment);
        prop_assert!(off(&moved, &derivative(|v| vector(&pose(v).then(&step)), vector(&robot))) < 1e-8);

        let seen = robot.sees(&marker);
        let sighting = model::sighting(&robot, &marker);
        let by_robot = derivative(|v| vector(&pose(v).sees(&marker)), vector(&robot));
        let by_marker = derivative(|v| vector(&robot.sees(&pose(v))), vector(&marker));
        prop_assert!(off(&sighting.robot, &by_robot) < 1e-8);
        prop_assert!(off(&sighting.marker, &by_marker) < 1e-8);

        let placed = model::placed(&robot, &seen);
        prop_assert!(off(&placed.robot, &derivative(|v| vector(&pose(v).then(&seen)), vector(&robot))) < 1e-8);
        prop_assert!(off(&placed.marker, &derivative(|v| vector(&robot.then(&pose(v))), vector(&seen))) < 1e-8);

        let (found, located) = model::located(&marker, &seen);
        prop_assert!(found.distance_m(&robot) < 1e-12);
        let place = |m: Vector3<f64>, z: Vector3<f64>| vector(&model::located(&pose(m), &pose(z)).0);
        prop_assert!(off(&located.marker, &derivative(|v| place(v, vector(&seen)), vector(&marker))) < 1e-8);
        prop_assert!(off(&located.robot, &derivative(|v| place(vector(&marker), v), vector(&seen))) < 1e-8);
    }

    /// The noise of an arc: errors of its length and of its turn, to first order in the turn.
    #[test]
    fn motion_noise_is_that_of_an_arc(
        robot in any_pose(5.0),
        way in -0.5..0.5_f64,
        turn in -0.05..0.05_f64,
    ) {
        let after = |u: Vector3<f64>| {
            let arc = Increment::arc(way + u[0], turn + u[2]);
            vector(&robot.then(&Pose2::new(arc.forward_m, arc.left_m + u[1], arc.turn_rad)))
        };
        let exact = derivative(after, Vector3::zeros());
        let ours = model::motion_noise(&robot, &Increment::arc(way, turn));
        prop_assert!(off(&ours, &exact) < 0.03, "{}", off(&ours, &exact));
    }
}

/// Loh 3.5 in the thesis' own frame: y forward, rotation counted against theta.
fn thesis_motion(x: Vector3<f64>, u: Vector2<f64>) -> Vector3<f64> {
    Vector3::new(
        x[0] - u[0] * x[2].sin(),
        x[1] + u[0] * x[2].cos(),
        x[2] - u[1],
    )
}

fn thesis_input_derivative(x: Vector3<f64>, u: Vector2<f64>) -> Matrix3x2<f64> {
    let step = 1e-6;
    let column = |delta: Vector2<f64>| {
        (thesis_motion(x, u + delta) - thesis_motion(x, u - delta)) / (2.0 * step)
    };
    Matrix3x2::from_columns(&[
        column(Vector2::new(step, 0.0)),
        column(Vector2::new(0.0, step)),
    ])
}

#[test]
fn printed_3_9_fails_and_corrected_3_9_passes() {
    let (x, u) = (Vector3::new(1.0, 2.0, 0.7), Vector2::new(0.3, 0.1));
    let heading: f64 = x[2];
    let (sin, cos) = heading.sin_cos();
    let exact = thesis_input_derivative(x, u);
    let printed = Matrix3x2::new(-sin, 0.0, -cos, 0.0, 0.0, 1.0);
    let corrected = Matrix3x2::new(-sin, 0.0, cos, 0.0, 0.0, -1.0);
    assert!((exact - printed).abs().max() > 1.0);
    assert!((exact - corrected).abs().max() < 1e-9);
}

#[test]
fn printed_3_10_fails_and_corrected_3_10_passes() {
    // 3.6 is the same function in both frames.
    let (robot, marker) = (Pose2::new(1.0, 2.0, 0.7), Pose2::new(3.0, 1.0, -2.0));
    let exact = derivative(|v| vector(&pose(v).sees(&marker)), vector(&robot));
    let corrected = matrix(&model::sighting(&robot, &marker).robot);
    let mut printed = corrected;
    printed[(2, 2)] = 1.0;
    assert!((exact - printed).abs().max() > 1.0);
    assert!((exact - corrected).abs().max() < 1e-8);
}

/// REP 103 from the thesis' frame: x = y, y = −x, heading + 90°, the turn's sign reversed.
#[test]
fn straight_motion_is_the_thesis_motion_in_our_frame() {
    let (x, u) = (Vector3::new(1.0, 2.0, 0.7), Vector2::new(0.3, 0.0));
    let thesis = thesis_motion(x, u);
    // In one frame with the thesis' world axes, only the heading's zero differs.
    let ours = Pose2::new(x[0], x[1], x[2] + core::f64::consts::FRAC_PI_2);
    let moved = model::moved(&ours, &Increment::arc(u[0], -u[1])).0;
    assert!((moved.x_m - thesis[0]).abs() < 1e-12);
    assert!((moved.y_m - thesis[1]).abs() < 1e-12);
}
