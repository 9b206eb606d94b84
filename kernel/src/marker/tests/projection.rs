//! The pose filter and the projection to the plane.

use crate::marker::{CornerRules, Isometry3, Pose2, ProjectionRefused, project};

const UNTURNED: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// A camera that looks forward: its z is the robot's x, its x the robot's −y.
const FORWARD: [[f64; 3]; 3] = [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
/// A marker that faces the camera, upright: its z is the camera's −z.
const FACING: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];

fn at(rotation: [[f64; 3]; 3], translation_m: [f64; 3]) -> Isometry3 {
    Isometry3 {
        rotation,
        translation_m,
    }
}

#[test]
fn a_marker_ahead_faces_the_robot() {
    let camera = at(FORWARD, [0.4, 0.1, 0.9]);
    let seen = project(&camera, &at(FACING, [0.5, 0.3, 2.0])).unwrap();
    let expected = Pose2::new(2.4, -0.4, core::f64::consts::PI);
    assert!(seen.distance_m(&expected) < 1e-12, "{seen:?}");
    assert!((seen.heading_rad.abs() - core::f64::consts::PI).abs() < 1e-12);
}

#[test]
fn tilt_does_not_change_the_heading() {
    let tilt = 0.6_f64;
    let (sin, cos) = tilt.sin_cos();
    let tilted = [[1.0, 0.0, 0.0], [0.0, -cos, sin], [0.0, -sin, -cos]];
    let seen = project(&at(FORWARD, [0.0; 3]), &at(tilted, [0.0, 0.0, 2.0])).unwrap();
    assert!((seen.heading_rad.abs() - core::f64::consts::PI).abs() < 1e-12);
}

//= spec/ekf.md#ekf-14
//= type=test
//# A marker whose normal is within 10 degrees of the vertical MUST NOT be projected to the plane.
#[test]
fn floor_parallel_markers_are_refused() {
    let project = |off_deg: f64| {
        // A marker on the floor, turned up by this angle: normal (sin, 0, cos) in the robot.
        let (sin, cos) = off_deg.to_radians().sin_cos();
        let rotation = [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]];
        project(&at(UNTURNED, [0.0; 3]), &at(rotation, [1.0, 0.0, 0.0]))
    };
    assert_eq!(project(0.0), Err(ProjectionRefused::FloorParallel));
    assert_eq!(project(9.9), Err(ProjectionRefused::FloorParallel));
    assert!(project(10.1).is_ok());
    assert_eq!(project(180.0), Err(ProjectionRefused::FloorParallel));
}

#[test]
fn what_is_no_rigid_motion_is_refused() {
    let good = at(UNTURNED, [0.0; 3]);
    let mut stretched = UNTURNED;
    stretched[0][0] = 1.1;
    let bad = [
        at(stretched, [0.0; 3]),
        at(UNTURNED, [f64::NAN, 0.0, 0.0]),
        at([[f64::NAN; 3]; 3], [0.0; 3]),
        at([[f64::INFINITY; 3]; 3], [0.0; 3]),
        at([[0.0; 3]; 3], [0.0; 3]),
    ];
    for bad in bad {
        assert_eq!(project(&bad, &good), Err(ProjectionRefused::Malformed));
        assert_eq!(project(&good, &bad), Err(ProjectionRefused::Malformed));
    }
}

#[test]
fn pose_filter_wants_size_and_distortion() {
    let rules = CornerRules::default();
    let square = [[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0]];
    let skewed = [[0.0, 0.0], [40.0, 4.0], [40.0, 36.0], [0.0, 44.0]];
    let small = skewed.map(|corner| corner.map(|part| part * 0.7));
    assert!(!rules.accepts(&square), "seen squarely: ambiguous");
    assert!(rules.accepts(&skewed));
    assert!(!rules.accepts(&small));
    let mut bad = skewed;
    bad[2][1] = f64::NAN;
    assert!(!rules.accepts(&bad));
    bad[2][1] = f64::INFINITY;
    assert!(!rules.accepts(&bad));
}
