//! One pass over the points: first contact on every lane, and how near objects are.
//!
//! Each result is a minimum over the points, so their order cannot matter; what is
//! skipped is skipped only where it provably could not have been the minimum.

use super::arc::{Clearance, Track, line_travel, turn_key};
use super::footprint::Point;
use super::lanes::{CURVATURES, LANES, Lane};
use super::types::{Obstacle, Situation};

/// Places on each lane at which the objective asks how near the objects are.
pub(super) const PLACES: usize = 3;
/// Lanes padded to a multiple of what vector units take.
const PADDED: usize = 64;
/// Relative slack of every comparison that skips a point; far above rounding.
const SLACK: f64 = 1e-6;
/// How much nearer a point within the margin may come before it blocks, m.
const NEARER_M: f64 = 1e-3;

/// What the points say about each lane.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    /// Turn key (circles) or travel (the straight lane) of the first contact.
    key: [f64; PADDED],
    /// Which point that was.
    contact: [Point; PADDED],
    sieve: Sieve,
    /// Squared distance of the nearest point from each place, m².
    near_squared: [[f64; CURVATURES]; PLACES],
    places: [[Point; CURVATURES]; PLACES],
    /// Radius around the robot outside of which no place is nearer than the range that counts, m.
    reach_m: f64,
    /// Largest margin of any lane, m.
    widest_m: f64,
    /// Distance of the nearest point from the bare outline, m.
    pub nearest_m: f64,
    /// Distance of the nearest point from the rotation centre, m.
    pub here_m: f64,
    /// Margin that the nearest point leaves (maximum norm, its own inflation taken off), m.
    pub room_m: f64,
}

/// What decides quickly whether a point can matter to a circular lane.
#[derive(Clone, Debug)]
struct Sieve {
    centre_y: [f64; PADDED],
    /// Annulus swept by the inflated outline.
    least: [f64; PADDED],
    largest: [f64; PADDED],
    /// Four times the key: (longest chord the point may still move / radius)².
    chord: [f64; PADDED],
}

impl Survey {
    pub fn new(situation: &Situation<'_>, lanes: &[Lane; LANES]) -> Self {
        let mut survey = Self {
            key: [f64::INFINITY; PADDED],
            contact: [[0.0; 2]; PADDED],
            sieve: Sieve {
                centre_y: [0.0; PADDED],
                least: [f64::INFINITY; PADDED],
                largest: [-1.0; PADDED],
                chord: [0.0; PADDED],
            },
            near_squared: [[f64::INFINITY; CURVATURES]; PLACES],
            places: [[[0.0; 2]; CURVATURES]; PLACES],
            reach_m: 0.0,
            widest_m: 0.0,
            nearest_m: f64::INFINITY,
            here_m: f64::INFINITY,
            room_m: f64::INFINITY,
        };
        for (index, lane) in lanes.iter().enumerate() {
            let margin = lane.rect.front_m - situation.footprint.front_m;
            survey.widest_m = survey.widest_m.max(margin);
            survey.prepare(index, lane);
        }
        survey.place(situation, lanes);
        survey
    }

    /// Fills one column of the sieve; empty lanes stay out of it.
    fn prepare(&mut self, index: usize, lane: &Lane) {
        if !lane.rates.is_some() {
            return;
        }
        let key = match lane.track {
            Track::Line { .. } => lane.horizon,
            Track::Circle(circle) => circle.key_of(lane.horizon),
        };
        set(&mut self.key, index, key);
        if let Track::Circle(circle) = lane.track {
            let (least, largest) = lane.rect.annulus_m(circle.centre_y);
            set(&mut self.sieve.centre_y, index, circle.centre_y);
            set(&mut self.sieve.least, index, least);
            set(&mut self.sieve.largest, index, largest);
            set(&mut self.sieve.chord, index, chord_of(key));
        }
    }

    /// Spreads the places at which clearance is judged over each lane's look-ahead.
    fn place(&mut self, situation: &Situation<'_>, lanes: &[Lane; LANES]) {
        let mut farthest = 0.0_f64;
        for (row, part) in self.places.iter_mut().zip([1.0 / 3.0, 2.0 / 3.0, 1.0]) {
            for (place, lane) in row.iter_mut().zip(lanes) {
                let ahead = lane.rates.high.max(0.0) * situation.tuning.lookahead_s;
                let travel = ahead * part;
                *place = along(lane.curvature_per_m().unwrap_or(0.0), travel).0;
                farthest = farthest.max(travel);
            }
        }
        let range = situation.footprint.inscribed_m() + situation.tuning.clearance_range_m;
        self.reach_m = farthest + range;
    }

    /// Takes in one point.
    /// # Bound
    /// O(lanes).
    pub fn add(&mut self, situation: &Situation<'_>, lanes: &[Lane; LANES], obstacle: Obstacle) {
        let [x, y] = obstacle.position;
        let bare = &situation.footprint;
        self.nearest_m = self
            .nearest_m
            .min(libm::sqrt(bare.distance_squared(obstacle.position)));
        let room = bare.outside_m(obstacle.position) - obstacle.inflation_m;
        self.room_m = self.room_m.min(room);
        self.here_m = self.here_m.min(libm::hypot(x, y));
        if x * x + y * y < self.reach_m * self.reach_m {
            self.approach(obstacle.position);
        }
        self.touch(situation, lanes, obstacle);
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

    fn touch(&mut self, situation: &Situation<'_>, lanes: &[Lane; LANES], obstacle: Obstacle) {
        let largest = situation
            .footprint
            .inflated(self.widest_m + obstacle.inflation_m);
        let away = largest.distance_squared(obstacle.position) * (1.0 - SLACK);
        let passes = self.sieve.passes(obstacle, away);
        for (index, (lane, pass)) in lanes.iter().zip(passes).enumerate() {
            let straight = matches!(lane.track, Track::Line { .. }) && lane.rates.is_some();
            if !pass && !straight {
                continue;
            }
            let key = contact_key(situation, lane, obstacle);
            let (Some(least), Some(contact)) =
                (self.key.get_mut(index), self.contact.get_mut(index))
            else {
                continue;
            };
            let nearer = key < *least;
            let equal = key <= *least && precedes(obstacle.position, *contact);
            if nearer || equal {
                *least = key;
                *contact = obstacle.position;
            }
            if nearer {
                set(&mut self.sieve.chord, index, chord_of(key));
            }
        }
    }

    /// First contact on lane `index`; `Free` beyond its horizon.
    pub fn clearance(&self, index: usize, lane: &Lane) -> Clearance {
        let key = self.key.get(index).copied().unwrap_or(0.0);
        let travel = match lane.track {
            Track::Line { .. } => key,
            Track::Circle(circle) => match circle.travel(key) {
                Clearance::Contact(travel) => travel,
                Clearance::Free => return Clearance::Free,
            },
        };
        if travel < lane.horizon * (1.0 - SLACK) {
            Clearance::Contact(travel)
        } else {
            Clearance::Free
        }
    }

    /// The point of that contact; meaningless where the lane is free.
    pub fn contact(&self, index: usize) -> Option<Point> {
        self.contact.get(index).copied()
    }

    /// Distance of the nearest point from the rotation centre on the way to `part` (0–1)
    /// of the look-ahead on lane `index`, m: the same for every orientation of the robot.
    pub fn near_m(&self, index: usize, part: f64) -> f64 {
        let mut squared = f64::INFINITY;
        for (row, begins) in self.near_squared.iter().zip([0.0, 1.0 / 3.0, 2.0 / 3.0]) {
            if begins <= 0.0 || part > begins {
                squared = squared.min(row.get(index).copied().unwrap_or(0.0));
            }
        }
        libm::sqrt(squared)
    }
}

impl Sieve {
    /// Which circular lanes a point may matter to, when it is `away` (squared, m²) from the
    /// outline inflated for it; branch-free, so that it vectorises.
    fn passes(&self, obstacle: Obstacle, away: f64) -> [bool; PADDED] {
        let [x, y] = obstacle.position;
        // An edge moves by the inflation, a corner by the root of two of it.
        let (edge, corner) = (
            obstacle.inflation_m + SLACK,
            1.5 * obstacle.inflation_m + SLACK,
        );
        let mut passes = [false; PADDED];
        let columns = self.centre_y.iter().zip(&self.least);
        let columns = columns.zip(self.largest.iter().zip(&self.chord));
        for (pass, ((centre, least), (largest, chord))) in passes.iter_mut().zip(columns) {
            let across = y - centre;
            let squared = x * x + across * across;
            let inner = (least - edge).max(0.0);
            let outer = largest + corner;
            *pass = (squared >= inner * inner * (1.0 - SLACK))
                & (squared <= outer * outer * (1.0 + SLACK))
                & (away <= chord * squared);
        }
        passes
    }
}

/// The key of the first contact with `obstacle` on `lane`.
///
/// A point that is within the margin already, but not within its fixed part (at rest: not
/// within the outline), blocks only a motion that brings it nearer.
fn contact_key(situation: &Situation<'_>, lane: &Lane, obstacle: Obstacle) -> f64 {
    let point = obstacle.position;
    let inflated = lane.rect.inflated(obstacle.inflation_m);
    let rect = if inflated.contains(point) {
        let outside = situation.footprint.outside_m(point);
        let least = if situation.is_at_rest() {
            0.0
        } else {
            situation.margin.fixed_m + obstacle.inflation_m
        };
        if outside <= least {
            return 0.0;
        }
        situation.footprint.inflated((outside - NEARER_M).max(0.0))
    } else {
        inflated
    };
    match lane.track {
        Track::Line { sense } => line_travel(&rect, sense, point),
        Track::Circle(circle) => turn_key(&rect, circle, point),
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

/// What a point must be nearer than to be touched within `key`: (chord / radius)².
fn chord_of(key: f64) -> f64 {
    if key <= 1.0 { 4.0 * key } else { f64::INFINITY }
}

/// A fixed order of points, so that of two equal contacts the same one is reported.
fn precedes(one: Point, other: Point) -> bool {
    let ([x, y], [other_x, other_y]) = (one, other);
    x.total_cmp(&other_x).then(y.total_cmp(&other_y)).is_lt()
}

fn set<T, const N: usize>(array: &mut [T; N], index: usize, value: T) {
    if let Some(slot) = array.get_mut(index) {
        *slot = value;
    }
}
