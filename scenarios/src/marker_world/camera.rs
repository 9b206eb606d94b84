//! Cameras that see markers, and how wrong they are about them.

use super::chance::Chance;
use super::places::Marker;
use crate::math::{Pose, wrap};
use haltline::marker::{Pose2, Sighting, SightingNoise};

/// A camera on the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it sits and looks, in the robot frame.
    pub mount: Pose,
    /// Whole horizontal opening angle, rad.
    pub opening_rad: f64,
    /// Farthest marker that is detected, m.
    pub range_m: f64,
    /// Time between images, µs.
    pub period_us: u64,
    /// Time of the first image, µs.
    pub offset_us: u64,
}

/// Markers seen more obliquely than this are not detected, rad off their normal.
const OBLIQUE_RAD: f64 = 1.309;

impl Camera {
    /// Whether a marker is detected from the robot's true pose.
    #[must_use]
    pub fn detects(&self, robot: &Pose, marker: &Pose) -> bool {
        let eye = robot.then(self.mount);
        let [x, y] = eye.apply_inverse([marker.x, marker.y]);
        let range = libm::hypot(x, y);
        let bearing = libm::atan2(y, x);
        let towards = libm::atan2(eye.y - marker.y, eye.x - marker.x);
        (0.3..=self.range_m).contains(&range)
            && bearing.abs() <= self.opening_rad / 2.0
            && wrap(towards - marker.theta).abs() <= OBLIQUE_RAD
    }
}

/// How wrong a sighting is: normal errors in proportion to the range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SightErrors {
    /// Standard deviation of each coordinate, as a part of the range.
    pub position_per_range: f64,
    /// Standard deviation of the heading, rad.
    pub heading_rad: f64,
}

impl SightErrors {
    /// What the filter is told about a sighting at this range.
    #[must_use]
    pub fn noise(&self, range_m: f64) -> SightingNoise {
        SightingNoise::isotropic(self.position_per_range * range_m.max(0.1), self.heading_rad)
    }

    /// A sighting of a marker from the robot's true pose.
    pub fn sighting(&self, robot: &Pose, marker: &Marker, chance: &mut Chance) -> Sighting {
        let [x, y] = robot.apply_inverse([marker.pose.x, marker.pose.y]);
        let range = libm::hypot(x, y).max(0.1);
        let sigma = self.position_per_range * range;
        let seen = Pose2::new(
            x + sigma * chance.normal(),
            y + sigma * chance.normal(),
            wrap(marker.pose.theta - robot.theta + self.heading_rad * chance.normal()),
        );
        Sighting::pose(marker.id, seen, self.noise(range))
    }
}
