//! From an image to the plane: which detections are fit for use, and their planar pose.
//!
//! It refuses markers that are seen too small or too squarely (Loh 3.1, 3.2), and markers
//! that lie in the floor plane, whose heading means nothing (Loh 3.1.2).

use super::linear::{Matrix, Vector, add, apply, times};
use super::pose::Pose2;

/// Which detections of a square marker are used (Loh 3.1, 3.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerRules {
    /// Least length of the shortest edge, pixels.
    pub edge_px: f64,
    /// Least difference between opposite edges, summed over both pairs, pixels.
    pub distortion_px: f64,
}

impl Default for CornerRules {
    /// The thesis' values (6.1).
    fn default() -> Self {
        Self {
            edge_px: 30.0,
            distortion_px: 10.0,
        }
    }
}

impl CornerRules {
    /// Whether a marker with these corners is used; the corners in order round the marker,
    /// pixels. Corners that are not finite are not used.
    #[must_use]
    pub fn accepts(&self, corners: &[[f64; 2]; 4]) -> bool {
        let [a, b, c, d] = corners;
        let edges = [length(a, b), length(b, c), length(c, d), length(d, a)];
        let shortest = edges.iter().copied().fold(f64::INFINITY, f64::min);
        let distortion = (edges[0] - edges[2]).abs() + (edges[1] - edges[3]).abs();
        edges.iter().all(|edge| edge.is_finite())
            && shortest >= self.edge_px
            && distortion >= self.distortion_px
    }
}

fn length(a: &[f64; 2], b: &[f64; 2]) -> f64 {
    libm::hypot(b[0] - a[0], b[1] - a[1])
}

/// A rigid motion in space: `p ↦ rotation p + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Isometry3 {
    /// Rows of a rotation matrix.
    pub rotation: [[f64; 3]; 3],
    /// m.
    pub translation_m: [f64; 3],
}

impl Isometry3 {
    /// First `inner`, then this (Loh 3.3).
    #[must_use]
    pub fn then(&self, inner: &Self) -> Self {
        Self {
            rotation: times(&self.rotation, &inner.rotation),
            translation_m: add(
                apply(&self.rotation, inner.translation_m),
                self.translation_m,
            ),
        }
    }

    fn is_rigid(&self) -> bool {
        let square = super::linear::times_transposed(&self.rotation, &self.rotation);
        let off = |a: &Vector, b: &Vector| {
            a.iter()
                .zip(b)
                .all(|(x, y)| (x - y).abs() <= ROTATION_TOLERANCE)
        };
        let unit: Matrix = super::linear::IDENTITY;
        square.iter().zip(&unit).all(|(a, b)| off(a, b))
            && self.translation_m.iter().all(|t| t.is_finite())
    }
}

/// How far `R Rᵀ` of a rotation may be off the identity, per entry.
const ROTATION_TOLERANCE: f64 = 1e-6;
/// Least length of the normal's shadow on the floor: 10° off the vertical.
const SHADOW_MIN: f64 = 0.173_648_177_666_930_35;

/// Why a pose in space has none in the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[must_use]
pub enum ProjectionRefused {
    /// The marker faces the floor or the ceiling: within 10° it has no heading.
    FloorParallel,
    /// Not a rigid motion, or not finite.
    Malformed,
}

/// The marker's planar pose in the robot frame; its heading is its normal (z axis) seen from
/// above.
///
/// - `camera`: the camera in the robot frame
/// - `marker`: the marker in the camera frame
///
/// # Errors
/// See [`ProjectionRefused`].
/// # Source
/// Loh 3.3 and 3.1.2.
pub fn project(camera: &Isometry3, marker: &Isometry3) -> Result<Pose2, ProjectionRefused> {
    if !camera.is_rigid() || !marker.is_rigid() {
        return Err(ProjectionRefused::Malformed);
    }
    let seen = camera.then(marker);
    let normal = apply(&seen.rotation, [0.0, 0.0, 1.0]);
    //= spec/ekf.md#ekf-14
    //# A marker whose normal is within 10 degrees of the vertical MUST NOT be projected to the plane.
    if libm::hypot(normal[0], normal[1]) < SHADOW_MIN {
        return Err(ProjectionRefused::FloorParallel);
    }
    let [x_m, y_m, _] = seen.translation_m;
    Ok(Pose2::new(x_m, y_m, libm::atan2(normal[1], normal[0])))
}
