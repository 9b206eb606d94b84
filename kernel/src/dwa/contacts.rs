//! First contact of the inflated outline on every lane, over all points.
//!
//! Skips a point only where it provably cannot be the first contact, so that the result is
//! the plain minimum over [`super::arc_distance`], whatever the order of the points.

use super::arc::{Clearance, Course, Track, Turn, line_travel, turn_key};
use super::footprint::{Footprint, Point};
use super::lanes::{LANES, Lane};
use super::survey::along;
use super::types::{Obstacle, Situation, Velocity};

/// Lanes padded to a multiple of what vector units take.
const PADDED: usize = 64;
/// So many lanes are skipped at once.
const GROUP: usize = 8;
/// Relative slack of every comparison that skips a point; far above rounding.
const SLACK: f64 = 1e-6;
/// A corner moves by less than this times the inflation (the root of two).
const CORNER_GROWTH: f64 = 1.5;
/// How slowly a motion in flight may come nearer to a point without spoiling all that follow, m/s.
const SLOWLY_MPS: f64 = 5e-3;
/// What the guard's rounding may add to a margin, m.
const SHELL_M: f64 = 5e-4;
/// A point this near to an edge lies on it, m.
const ON_EDGE_M: f64 = 1e-6;

/// What is swept along a lane, and how far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Swept {
    /// The inflated outline.
    pub rect: Footprint,
    /// The margin where the robot is now, m.
    pub start_m: f64,
    /// Travel beyond which a contact does not matter.
    pub horizon: f64,
}

/// First contacts on all lanes so far.
#[derive(Clone, Debug)]
pub(super) struct Contacts {
    swept: [Swept; LANES],
    /// Turn key (circles) or travel (the straight lane) of the first contact.
    key: [f64; PADDED],
    /// Which point that was.
    contact: [Point; PADDED],
    sieve: Sieve,
    /// Largest margin of any lane, m.
    widest_m: f64,
    /// Longest path of any point of the outline within the horizon, m.
    reach_m: f64,
    /// How much longer per metre of a point's own inflation.
    reach_per_inflation: f64,
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

impl Contacts {
    /// Nothing touched yet within the horizon of any lane.
    pub fn new(lanes: &[Lane; LANES], bare: &Footprint, sweep: impl Fn(&Lane) -> Swept) -> Self {
        let mut contacts = Self {
            swept: [Swept::default(); LANES],
            key: [f64::INFINITY; PADDED],
            contact: [[0.0; 2]; PADDED],
            sieve: Sieve {
                centre_y: [0.0; PADDED],
                least: [f64::INFINITY; PADDED],
                largest: [-1.0; PADDED],
                chord: [0.0; PADDED],
            },
            widest_m: 0.0,
            reach_m: 0.0,
            reach_per_inflation: 0.0,
        };
        for (index, lane) in lanes.iter().enumerate() {
            if lane.rates.is_some() {
                contacts.prepare(index, lane, sweep(lane), bare);
            }
        }
        contacts
    }

    /// Fills one column of the sieve; empty lanes stay out of it.
    fn prepare(&mut self, index: usize, lane: &Lane, swept: Swept, bare: &Footprint) {
        set(&mut self.swept, index, swept);
        self.widest_m = self.widest_m.max(swept.rect.front_m - bare.front_m);
        let (own, turn) = match lane.curvature_per_m() {
            Some(curvature) => (swept.horizon, swept.horizon * curvature.abs()),
            None => (0.0, swept.horizon),
        };
        self.reach_m = self.reach_m.max(own + turn * swept.rect.corner_m());
        self.reach_per_inflation = self.reach_per_inflation.max(turn * CORNER_GROWTH);
        match lane.track {
            Track::Line { .. } => set(&mut self.key, index, swept.horizon),
            Track::Circle(circle) => {
                let key = circle.key_of(swept.horizon);
                let (least, largest) = swept.rect.annulus_m(circle.centre_y);
                set(&mut self.key, index, key);
                set(&mut self.sieve.centre_y, index, circle.centre_y);
                set(&mut self.sieve.least, index, least);
                set(&mut self.sieve.largest, index, largest);
                set(&mut self.sieve.chord, index, chord_of(key));
            }
        }
    }

    /// Takes in one point.
    /// # Bound
    /// O(lanes).
    pub fn add(&mut self, situation: &Situation<'_>, lanes: &[Lane; LANES], obstacle: Obstacle) {
        let widest = self.widest_m + obstacle.inflation_m;
        let outline = situation.footprint.inflated(widest);
        let away = outline.distance_squared(obstacle.position) * (1.0 - SLACK);
        let reach = self.reach_m + self.reach_per_inflation * obstacle.inflation_m;
        if away > reach * reach {
            return;
        }
        let passes = self.sieve.passes(obstacle, away);
        // Only the first lane is straight, and the sieve does not know it.
        if let Some(lane) = lanes.first().filter(|lane| lane.is_straight()) {
            self.touch(situation, (0, lane), obstacle);
        }
        for (group, (lanes, passes)) in lanes.chunks(GROUP).zip(passes.chunks(GROUP)).enumerate() {
            if passes == [0; GROUP] {
                continue;
            }
            let first = group.saturating_mul(GROUP);
            for (offset, (lane, pass)) in lanes.iter().zip(passes).enumerate() {
                if *pass != 0 {
                    self.touch(situation, (first.saturating_add(offset), lane), obstacle);
                }
            }
        }
    }

    fn touch(
        &mut self,
        situation: &Situation<'_>,
        (index, lane): (usize, &Lane),
        obstacle: Obstacle,
    ) {
        let (Some(least), Some(contact), Some(swept)) = (
            self.key.get_mut(index),
            self.contact.get_mut(index),
            self.swept.get(index),
        ) else {
            return;
        };
        let key = contact_key(situation, lane, swept, obstacle);
        //= spec/navigate.md#nav-04
        //# A plan MUST depend on nothing but its input, and not on the order of the points.
        if key < *least {
            *least = key;
            *contact = obstacle.position;
            set(&mut self.sieve.chord, index, chord_of(key));
        } else if key <= *least && precedes(obstacle.position, *contact) {
            *contact = obstacle.position;
        }
    }

    /// First contact on lane `index`; `Free` beyond its horizon.
    pub fn clearance(&self, index: usize, lane: &Lane) -> Clearance {
        let key = self.key.get(index).copied().unwrap_or(0.0);
        let horizon = self.swept.get(index).map_or(0.0, |swept| swept.horizon);
        let touched = match lane.track {
            Track::Line { .. } => Clearance::Contact(key),
            Track::Circle(circle) => circle.travel(key),
        };
        match touched {
            Clearance::Contact(travel) if travel < horizon * (1.0 - SLACK) => touched,
            _ => Clearance::Free,
        }
    }

    /// The point of that contact; meaningless where the lane is free.
    pub fn contact(&self, index: usize) -> Option<Point> {
        self.contact.get(index).copied()
    }

    /// What is swept along lane `index`.
    #[cfg(test)]
    pub fn swept(&self, index: usize) -> Swept {
        self.swept[index]
    }
}

impl Sieve {
    /// Which circular lanes (1) a point may matter to, when it is `away` (squared, m²) from the
    /// outline inflated for it; branch-free, so that it vectorises.
    fn passes(&self, obstacle: Obstacle, away: f64) -> [u8; PADDED] {
        let [x, y] = obstacle.position;
        // An edge moves by the inflation, a corner by the root of two of it.
        let (edge, corner) = (
            obstacle.inflation_m + SLACK,
            CORNER_GROWTH * obstacle.inflation_m + SLACK,
        );
        let mut passes = [0; PADDED];
        let columns = self.centre_y.iter().zip(&self.least);
        let columns = columns.zip(self.largest.iter().zip(&self.chord));
        for (pass, ((centre, least), (largest, chord))) in passes.iter_mut().zip(columns) {
            let across = y - centre;
            let squared = x * x + across * across;
            let inner = (least - edge).max(0.0);
            let outer = largest + corner;
            let may = (squared >= inner * inner * (1.0 - SLACK))
                & (squared <= outer * outer * (1.0 + SLACK))
                & (away <= chord * squared);
            *pass = u8::from(may);
        }
        passes
    }
}

/// The key of the first contact with `obstacle` on `lane`.
///
/// A point that is within the margin already, but not within that of the start (at rest: not
/// within the outline), blocks only a motion that brings it nearer, now or by what may be
/// executing still.
fn contact_key(situation: &Situation<'_>, lane: &Lane, swept: &Swept, obstacle: Obstacle) -> f64 {
    let point = obstacle.position;
    let inflated = swept.rect.inflated(obstacle.inflation_m);
    let rect = if inflated.contains(point) {
        let outside = situation.footprint.outside_m(point);
        let start = swept.start_m + obstacle.inflation_m;
        // At rest the guard excuses what lies within the margin of the start; it decides.
        let excused = situation.is_at_rest() && outside > 0.0;
        let reached = situation.footprint.inflated(outside);
        let mut possible = situation.possible();
        if (outside <= start && !excused)
            || approaches(lane.direction(), &reached, point, 0.0)
            || possible.any(|motion| approaches(motion, &reached, point, SLOWLY_MPS))
            || (!excused && catches_up(situation, lane, swept, obstacle))
        {
            return 0.0;
        }
        // Just inside of the point: whether it comes back later.
        situation.footprint.inflated((outside - ON_EDGE_M).max(0.0))
    } else {
        inflated
    };
    match lane.track {
        Track::Line { sense } => line_travel(&rect, sense, point),
        Track::Circle(circle) => turn_key(&rect, circle, point),
    }
}

/// Whether the margin, which grows along the way, reaches a point that the robot leaves aside.
fn catches_up(situation: &Situation<'_>, lane: &Lane, swept: &Swept, obstacle: Obstacle) -> bool {
    let end_m = swept.rect.front_m - situation.footprint.front_m;
    [0.5, 1.0].into_iter().any(|part| {
        let travel = swept.horizon * part;
        let (place, heading) = match lane.course {
            Course::Arc {
                curvature_per_m, ..
            } => along(curvature_per_m, travel),
            Course::Spot(Turn::Left) => ([0.0; 2], travel),
            Course::Spot(Turn::Right) => ([0.0; 2], -travel),
        };
        let grown = swept.start_m + (end_m - swept.start_m) * part + obstacle.inflation_m + SHELL_M;
        let seen = seen_from(place, heading, obstacle.position);
        situation.footprint.inflated(grown).contains(seen)
    })
}

/// `point` in the frame of a robot at `place`.
fn seen_from([x, y]: Point, heading: f64, point: Point) -> Point {
    let [to_x, to_y] = point;
    let (dx, dy) = (to_x - x, to_y - y);
    let (sin, cos) = libm::sincos(heading);
    [cos * dx + sin * dy, cos * dy - sin * dx]
}

/// Whether `point`, on the edge of `rect`, moves inward faster than `slowly_mps` when the robot
/// moves with `velocity`.
fn approaches(velocity: Velocity, rect: &Footprint, [x, y]: Point, slowly_mps: f64) -> bool {
    let along = velocity.angular_radps * y - velocity.linear_mps;
    let across = -velocity.angular_radps * x;
    let on = |beyond: f64| beyond > -ON_EDGE_M;
    (on(x - rect.front_m) && along < -slowly_mps)
        || (on(-rect.rear_m - x) && along > slowly_mps)
        || (on(y - rect.left_m) && across < -slowly_mps)
        || (on(-rect.right_m - y) && across > slowly_mps)
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
