//! The place that a refusal names, where the tube leaves known space and where it leaves the window.

use super::*;
use crate::guard::hull::{Hull, Vertex};
use crate::guard::plan::Dynamics;
use crate::guard::tube::TubeParameters;
use crate::input::Twist;
use crate::units::{AngularSpeed, Curvature, Speed};

const FOOTPRINT: Rect = Rect {
    front: 4_000,
    rear: 4_000,
    left: 2_400,
    right: 2_400,
};

/// Straight on, at rest after `path_mm`; the robot brakes with 1 m/s².
fn straight(path_mm: f64) -> Tube {
    let parameters = TubeParameters {
        dynamics: Dynamics {
            braking: 1_000_000,
            angular_braking: 1_000_000,
            corner: 583_096,
            ..Dynamics::default()
        },
        footprint: FOOTPRINT,
        ..TubeParameters::default()
    };
    let speed = (2.0 * path_mm * 1e-3).sqrt();
    let mut hull = Hull::default();
    hull.push(Vertex {
        twist: Twist {
            linear: Speed::from_um_per_s((speed * 1e6) as i32),
            angular: AngularSpeed::ZERO,
        },
        curvature: Curvature::ZERO,
    });
    Tube::new(&parameters, &hull, 0).unwrap()
}

fn all_known() -> Seen {
    let mut seen = Seen::default();
    seen.mark(&[u128::MAX; CELLS]);
    seen
}

//= spec/guard.md#guard-20
//= type=test
//# Every verdict MUST carry the inflation of the deciding sample, term by term, and the point or cell that decided.
#[test]
fn where_the_window_ends_the_refusal_names_the_sample_that_leaves_it() {
    let seen = all_known();
    let near = entered(&straight(3_000.0), FOOTPRINT, &seen, LocalPose::default());
    assert_eq!(near, None, "3.5 m are inside the window of 4.1 m");
    let left = entered(&straight(3_900.0), FOOTPRINT, &seen, LocalPose::default()).unwrap();
    // The front edge, 500 mm before the centre, and a few millimetres of inflation leave it.
    let front = i32::from(left.x_mm) + 500;
    assert!((3_900..4_200).contains(&front), "{left:?}");
    assert!(left.y_mm.abs() <= 1, "{left:?}");
}

#[test]
fn the_refusal_names_a_cell_that_is_unknown() {
    let mut seen = all_known();
    let body = PointMm { x: 2_000, y: 0 };
    seen.forget(body);
    let cell = entered(&straight(2_500.0), FOOTPRINT, &seen, LocalPose::default()).unwrap();
    let named = PointMm {
        x: i32::from(cell.x_mm),
        y: i32::from(cell.y_mm),
    };
    assert!(!seen.is_known(named), "{cell:?}");
    assert!((1_800..2_200).contains(&named.x), "{cell:?}");
}
