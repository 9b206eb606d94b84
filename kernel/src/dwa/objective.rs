//! The objective (Loh 4.11, A.3–A.5 corrected) and the speed that the surroundings call for (4.2.5).
//!
//! Preferences only: admissibility is decided elsewhere, and nothing here can
//! override it. Refuses to reward nearness to objects by the robot's orientation:
//! that made the robot of the thesis orbit them.

use super::footprint::Point;
use super::lanes::Lane;
use super::margin::rate_for;
use super::survey::{PARTS, PLACES, Survey, along};
use super::types::{Arrival, Situation, Velocity};
use super::window::{DynamicWindow, Interval};
use core::f64::consts::PI;

/// Part of the distance to the goal up to which heading is judged.
const TOWARDS_GOAL: f64 = 0.5;
/// Part of the largest turn rate that following the arc to the goal may take.
const TURN_RESERVE: f64 = 0.8;
/// Part of the heading's worth that small angles decide, and what is small, rad. In proportion
/// to π alone, a hundredth of a radian weighs less than a millimetre per second.
const FINE_PART: f64 = 0.05;
const FINE_RAD: f64 = 0.05;
/// Halvings in the search for the speed that the lateral room allows.
const ROOM_STEPS: u8 = 12;

/// The goal as seen from the robot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sighting {
    /// Distance, m.
    pub distance_m: f64,
    /// Angle from straight ahead, left positive, rad.
    pub bearing_rad: f64,
}

impl Sighting {
    pub fn of([x, y]: Point) -> Self {
        Self {
            distance_m: libm::hypot(x, y),
            bearing_rad: libm::atan2(y, x),
        }
    }
}

/// Angle between `heading` and the direction from `from` to `to`, in [0, π]; zero if they coincide.
fn angle_off(heading: f64, from: Point, to: Point) -> f64 {
    let ([from_x, from_y], [to_x, to_y]) = (from, to);
    let (along, across) = (to_x - from_x, to_y - from_y);
    let (sin, cos) = libm::sincos(heading);
    libm::atan2(cos * across - sin * along, cos * along + sin * across).abs()
}

/// `head` (A.3): 1 facing the goal, 0 facing away, judged where the command leads.
fn head(situation: &Situation<'_>, sighting: Sighting, lane: &Lane, travel: f64) -> f64 {
    let off = match lane.curvature_per_m() {
        Some(curvature) => {
            let (place, heading) = along(curvature, travel.min(TOWARDS_GOAL * sighting.distance_m));
            angle_off(heading, place, situation.goal.position)
        }
        // It can stop turning when it faces the goal.
        None => (sighting.bearing_rad.abs() - travel).max(0.0),
    };
    let fine = libm::sqrt((off / FINE_RAD).min(1.0));
    1.0 - (1.0 - FINE_PART) * off / PI - FINE_PART * fine
}

/// `clear` (A.4, corrected): distance to the nearest point in [0, 1], without orientation.
///
/// 0 at the inscribed circle of the outline, 1 beyond the range that counts. Farther along
/// the path nearness counts less, or the robot would rather turn round than enter a gap.
pub(super) fn clear(situation: &Situation<'_>, near_m: [f64; PLACES]) -> f64 {
    let inscribed = situation.footprint.inscribed_m();
    let turning = (situation.footprint.corner_m() - inscribed).max(1e-6);
    let [first, ..] = PARTS;
    near_m.iter().zip(PARTS).fold(1.0, |least, (near, part)| {
        let spare = (near - inscribed).max(0.0);
        let tight = (spare / turning).min(1.0);
        let wide = (spare - turning).max(0.0) / situation.tuning.clearance_range_m;
        (0.5 * tight + 0.5 * wide + part - first).min(least)
    })
}

/// `vel` (A.5, corrected): fast is good, near the goal slow is good.
pub(super) fn vel(speed_mps: f64, speed_max_mps: f64, near_goal: bool) -> f64 {
    let part = speed_mps / speed_max_mps;
    if near_goal { 1.0 - part } else { part }
}

/// G(v, ω) (4.11) of driving `lane` at `rate`, with σ = 1.
pub(super) fn score(
    situation: &Situation<'_>,
    survey: &Survey,
    sighting: Sighting,
    (index, lane): (usize, &Lane),
    rate: f64,
    open: f64,
) -> f64 {
    let tuning = &situation.tuning;
    // Not cut at the first contact: a path into a wall must not look good for ending early,
    // and where it ends depends on the outline's orientation.
    let travel = rate * tuning.lookahead_s;
    let (near_m, speed) = match lane.curvature_per_m() {
        Some(_) => (survey.near_m(index), rate),
        // Turning leads nowhere.
        None => ([survey.here_m; PLACES], 0.0),
    };
    let stops = situation.goal.arrival == Arrival::Stop;
    let near_goal = stops && sighting.distance_m < tuning.goal_near_m;
    tuning.heading_weight * open * head(situation, sighting, lane, travel)
        + tuning.clearance_weight * clear(situation, near_m)
        + tuning.speed_weight * vel(speed, situation.limits.speed_mps, near_goal)
}

/// The part of the window's speeds that goal, objects and lateral room call for, m/s.
///
/// A modification of the dynamic window, as in Loh 4.2.5: no lane may keep a higher speed
/// only because it meets the window there. If the goal lies far to the side, as slow as possible.
pub(super) fn speeds(
    situation: &Situation<'_>,
    survey: &Survey,
    sighting: Sighting,
    window: &DynamicWindow,
) -> Interval {
    let tuning = &situation.tuning;
    let turns = situation.limits.curvature_max_per_m.is_none();
    let turn_first = turns && sighting.bearing_rad.abs() > tuning.turn_first_rad;
    let (least, most) = if turn_first {
        (0.0, 0.0)
    } else {
        let most = called_for_mps(situation, survey, sighting);
        (tuning.creep_mps.min(window.linear.high), most)
    };
    Interval {
        low: window.linear.low.max(least),
        high: window.linear.clamp(most.max(least)),
    }
}

/// The speed that goal, objects and lateral room call for; at least creeping, m/s.
///
/// Slow near the goal, slow near objects (Loh 4.2.5), slow enough for the arc to the goal, and
/// slow enough that the margin, which grows with speed, leaves the room there is.
fn called_for_mps(situation: &Situation<'_>, survey: &Survey, sighting: Sighting) -> f64 {
    let (limits, tuning) = (&situation.limits, &situation.tuning);
    let to_goal = match situation.goal.arrival {
        Arrival::Stop => rate_for(
            sighting.distance_m,
            tuning.comfort * limits.braking_mps2,
            limits.reaction_s,
        ),
        Arrival::Pass => limits.speed_mps,
    };
    let near_objects = if tuning.object_near_m > 0.0 {
        limits.speed_mps * survey.nearest_m / tuning.object_near_m
    } else {
        limits.speed_mps
    };
    let bend = 2.0 * libm::sin(sighting.bearing_rad).abs() / sighting.distance_m;
    let on_arc = TURN_RESERVE * limits.angular_speed_radps / bend.max(1e-6);
    let on_arc = if limits.curvature_max_per_m.is_some() {
        limits.speed_mps
    } else {
        on_arc
    };
    to_goal
        .min(near_objects)
        .min(on_arc)
        .min(room_mps(situation, survey.room_m))
        .max(tuning.creep_mps)
        .min(limits.speed_mps)
}

/// The largest speed straight on whose margin leaves `room_m`, m/s.
fn room_mps(situation: &Situation<'_>, room_m: f64) -> f64 {
    let fits = |speed: f64| {
        let straight = Velocity {
            linear_mps: speed,
            angular_radps: 0.0,
        };
        situation.margin.alone(situation, straight).end_m <= room_m
    };
    let mut range = Interval {
        low: 0.0,
        high: situation.limits.speed_mps,
    };
    if fits(range.high) {
        return range.high;
    }
    for _ in 0..ROOM_STEPS {
        let middle = (range.low + range.high) / 2.0;
        if fits(middle) {
            range.low = middle;
        } else {
            range.high = middle;
        }
    }
    range.low
}
