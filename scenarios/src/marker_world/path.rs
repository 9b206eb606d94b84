//! Where the robot truly is: arcs of constant speed, in closed form.

use crate::math::Pose;

/// A piece of the way at constant speed and turn rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Forward speed, m/s.
    pub speed_mps: f64,
    /// Turn rate, rad/s.
    pub turn_radps: f64,
    /// How long, s.
    pub time_s: f64,
}

/// A whole way.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Where it begins.
    pub start: Pose,
    /// Its pieces in order.
    pub legs: Vec<Leg>,
}

impl Path {
    /// How long it takes, s.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.legs.iter().map(|leg| leg.time_s).sum()
    }

    /// Where the robot is after this time, and how far it has driven, m; at rest after the end.
    #[must_use]
    pub fn at(&self, time_s: f64) -> (Pose, f64) {
        let (mut pose, mut way_m, mut left_s) = (self.start, 0.0, time_s);
        for leg in &self.legs {
            let time_s = leg.time_s.min(left_s).max(0.0);
            pose = pose.advance(leg.speed_mps, leg.turn_radps, time_s);
            way_m += leg.speed_mps.abs() * time_s;
            left_s -= time_s;
        }
        (pose, way_m)
    }
}
