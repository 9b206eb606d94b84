//! Where markers hang: the thesis' corridor and field test, and a long loop.

use crate::math::Pose;
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// A marker on a wall; its heading is its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marker {
    /// Its id.
    pub id: u16,
    /// Pose in the world.
    pub pose: Pose,
}

/// A marker of the thesis' tables in our frame: there the robot drives along +y, here along +x.
#[must_use]
pub fn thesis_marker(id: u16, x_m: f64, y_m: f64, theta_rad: f64) -> Marker {
    Marker {
        id,
        pose: Pose::new(y_m, -x_m, theta_rad - FRAC_PI_2),
    }
}

/// The simulated corridor, 3 m wide (Loh, table B.3).
#[must_use]
pub fn corridor() -> Vec<Marker> {
    [
        (0, -1.499, 0.9, 0.0),
        (1, 1.499, 1.1, PI),
        (2, -1.499, 3.9, 0.0),
        (3, 1.499, 4.1, PI),
        (4, 1.499, -1.9, PI),
        (5, -1.499, -2.1, 0.0),
        (6, -1.499, -0.6, 0.0),
        (7, 1.499, -0.4, PI),
        (8, 1.499, 2.6, PI),
        (9, -1.499, 2.4, 0.0),
        (10, -1.499, 5.4, 0.0),
        (11, 1.499, 5.6, PI),
    ]
    .map(|(id, x, y, theta)| thesis_marker(id, x, y, theta))
    .to_vec()
}

/// The field test's corridor, 3.65 m wide (Loh, table B.4).
#[must_use]
pub fn field() -> Vec<Marker> {
    [
        (0, -1.825, 1.231, 0.0),
        (5, -1.825, 5.643, 0.0),
        (14, -1.825, 11.249, 0.0),
        (17, -1.825, 15.238, 0.0),
        (20, -1.825, 19.232, 0.0),
        (26, -1.825, 23.235, 0.0),
        (34, 1.825, 3.393, PI),
        (39, 1.825, 7.996, PI),
        (41, 1.825, 12.900, PI),
        (44, 1.825, 16.887, PI),
        (63, 1.825, 21.285, PI),
        (101, -2.625, 9.306, PI),
        (102, -2.950, 10.938, -FRAC_PI_2),
        (103, -1.825, 28.350, 0.0),
        (104, 1.825, 28.350, PI),
        (105, -1.825, 32.350, 0.0),
        (106, 1.825, 32.850, PI),
        (107, -1.825, 36.350, 0.0),
        (108, 1.825, 36.350, PI),
    ]
    .map(|(id, x, y, theta)| thesis_marker(id, x, y, theta))
    .to_vec()
}

/// `count` markers on the outer wall of a ring corridor, facing its centre (0, radius of the
/// way); `way_m` is the length of the way, the wall is 1.5 m outside of it.
#[must_use]
pub fn ring(count: u16, way_m: f64) -> Vec<Marker> {
    let radius = way_m / TAU;
    (0..count)
        .map(|id| {
            let angle = TAU * (f64::from(id) + 0.5) / f64::from(count) - FRAC_PI_2;
            let wall = radius + 1.5;
            let (sin, cos) = (libm::sin(angle), libm::cos(angle));
            Marker {
                id,
                pose: Pose::new(wall * cos, radius + wall * sin, angle + PI),
            }
        })
        .collect()
}
