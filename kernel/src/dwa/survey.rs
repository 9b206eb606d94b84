//! One pass over the points: first contacts on every lane, and how near objects are.
//!
//! Each result is a minimum over the points, so their order cannot matter.

use super::contacts::{Contacts, Swept};
use super::footprint::Point;
use super::lanes::{CURVATURES, LANES, Lane};
use super::types::{Obstacle, Situation, Velocity};

/// Places on each lane at which the objective asks how near the objects are.
pub(super) const PLACES: usize = 3;
/// Where along the look-ahead (or to the goal, if that is nearer) they lie.
pub(super) const PARTS: [f64; PLACES] = [1.0 / 3.0, 2.0 / 3.0, 1.0];

/// What the points say about each lane.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    /// With all margins, as far as the guard looks: what stopping must respect.
    pub firm: Contacts,
    /// With the margins of creeping, farther ahead: what slowing down in time must respect.
    pub ahead: Contacts,
    /// Squared distance of the nearest point from each place, m².
    near_squared: [[f64; CURVATURES]; PLACES],
    places: [[Point; CURVATURES]; PLACES],
    /// Radius around the robot outside of which no place is nearer than the range that counts, m.
    reach_m: f64,
    /// Distance of the nearest point from the bare outline, m.
    pub nearest_m: f64,
    /// Distance of the nearest point from the rotation centre, m.
    pub here_m: f64,
    /// Margin that the nearest point leaves (maximum norm, its own inflation taken off), m.
    pub room_m: f64,
}

impl Survey {
    pub fn new(situation: &Situation<'_>, lanes: &[Lane; LANES]) -> Self {
        let bare = &situation.footprint;
        let creeping = Velocity {
            linear_mps: situation.tuning.creep_mps,
            angular_radps: 0.0,
        };
        let creep = situation.margin.alone(situation, creeping);
        let mut survey = Self {
            firm: Contacts::new(lanes, bare, |lane| Swept {
                rect: lane.rect,
                start_m: lane.start_m,
                horizon: lane.horizon,
            }),
            ahead: Contacts::new(lanes, bare, |lane| Swept {
                rect: bare.inflated(creep.end_m),
                start_m: creep.start_m,
                horizon: lane.horizon_ahead,
            }),
            near_squared: [[f64::INFINITY; CURVATURES]; PLACES],
            places: [[[0.0; 2]; CURVATURES]; PLACES],
            reach_m: 0.0,
            nearest_m: f64::INFINITY,
            here_m: f64::INFINITY,
            room_m: f64::INFINITY,
        };
        survey.place(situation, lanes);
        survey
    }

    /// Spreads the places at which clearance is judged over each lane's look-ahead.
    fn place(&mut self, situation: &Situation<'_>, lanes: &[Lane; LANES]) {
        let mut farthest = 0.0_f64;
        let [goal_x, goal_y] = situation.goal.position;
        let goal_m = libm::hypot(goal_x, goal_y);
        for (row, part) in self.places.iter_mut().zip(PARTS) {
            for (place, lane) in row.iter_mut().zip(lanes) {
                let ahead = lane.rates.high.max(0.0) * situation.tuning.lookahead_s;
                let travel = ahead.min(goal_m) * part;
                *place = along(lane.curvature_per_m().unwrap_or(0.0), travel).0;
                farthest = farthest.max(travel);
            }
        }
        let range = situation.footprint.corner_m() + situation.tuning.clearance_range_m;
        self.reach_m = farthest + range;
    }

    /// Takes in one point.
    /// # Bound
    /// O(lanes).
    pub fn add(&mut self, situation: &Situation<'_>, lanes: &[Lane; LANES], obstacle: Obstacle) {
        let point @ [x, y] = obstacle.position;
        let bare = &situation.footprint;
        let here = libm::sqrt(x * x + y * y);
        self.here_m = self.here_m.min(here);
        self.nearest_m = self.nearest_m.min(libm::sqrt(bare.distance_squared(point)));
        self.room_m = self
            .room_m
            .min(bare.outside_m(point) - obstacle.inflation_m);
        if here < self.reach_m {
            self.approach(point);
        }
        self.firm.add(situation, lanes, obstacle);
        let near = Obstacle {
            inflation_m: obstacle.inflation_m.min(situation.margin.near_m),
            ..obstacle
        };
        self.ahead.add(situation, lanes, near);
    }

    fn approach(&mut self, [x, y]: Point) {
        for (row, places) in self.near_squared.iter_mut().zip(&self.places) {
            for (near, [place_x, place_y]) in row.iter_mut().zip(places) {
                let (along, across) = (x - place_x, y - place_y);
                let squared = along * along + across * across;
                *near = if squared < *near { squared } else { *near };
            }
        }
    }

    /// Distances of the nearest point from the rotation centre at the places of lane `index`, m,
    /// nearest place first: the same for every orientation of the robot.
    pub fn near_m(&self, index: usize) -> [f64; PLACES] {
        let mut near = [0.0; PLACES];
        for (slot, row) in near.iter_mut().zip(&self.near_squared) {
            *slot = libm::sqrt(row.get(index).copied().unwrap_or(0.0));
        }
        near
    }
}
/// Pose after `travel` along `curvature` (1/m), as position and heading.
pub(super) fn along(curvature: f64, travel: f64) -> (Point, f64) {
    let heading = curvature * travel;
    // Half turn, chord, half turn: no case for the straight line, no cancellation.
    let half = heading / 2.0;
    let chord = if half.abs() < 1e-6 {
        travel
    } else {
        travel * libm::sin(half) / half
    };
    ([chord * libm::cos(half), chord * libm::sin(half)], heading)
}
