//! The Dynamic Window Approach for a rectangular robot: proposes commands, decides nothing.
//!
//! One step samples the dynamic window radially (61 curvatures × 11 speeds, and turning on
//! the spot both ways), computes for each curvature in closed form how far the outline may
//! go before it touches a point, keeps the commands that can be stopped before that, and
//! lists the best by heading, clearance and speed. "DWA proposes, guard disposes": a
//! candidate still has to pass [`crate::guard`], and when it is refused the caller tries the
//! next. Without candidates the robot must stop.
//!
//! Refuses to plan on numbers that are not finite, and to drive backwards: nobody looks there.
//!
//! Body frame: x forward, y left, metres and radians; the points may come in any order.
//!
//! # Source
//! Loh 2018, chapter 4 and appendix A.2, with equations 4.5, 4.10, A.4 and A.5 corrected;
//! Fox, Burgard, Thrun 1997; Maroti et al. 2013 (radial sampling).

pub mod arc;
mod choice;
mod contacts;
pub mod footprint;
mod lanes;
pub mod margin;
mod objective;
mod situation;
mod survey;
mod types;
pub mod window;

pub use arc::{Clearance, Course, Direction, Turn, arc_distance, clearance};
pub use footprint::{Footprint, Point};
pub use lanes::{CURVATURES, LANES, SPEEDS};
pub use margin::Margin;
pub use types::{
    Arrival, CANDIDATES, Candidate, Goal, Limits, Obstacle, Outcome, Plan, Situation, Tuning,
    Velocity,
};
pub use window::{DynamicWindow, Interval};

use objective::Sighting;
use survey::Survey;

/// Plans one step towards the goal around `obstacles`.
///
/// The answer does not depend on the order of the obstacles, and the same input gives the
/// same answer. Every candidate lies in the dynamic window around `situation.velocity`
/// and can be stopped within its clearance, even if any motion of `situation.in_flight`
/// goes on for the reaction time.
/// # Bound
/// O(points × lanes + lanes × speeds); no allocation.
/// # Source
/// Loh, Algorithm 4.1.
pub fn plan(situation: &Situation<'_>, obstacles: impl IntoIterator<Item = Obstacle>) -> Plan {
    if !situation.is_valid() {
        return Plan::without_candidates(Outcome::Malformed);
    }
    let Some((window, lanes)) = lanes::lanes(situation) else {
        return Plan::without_candidates(Outcome::Unsuitable);
    };
    let mut survey = Survey::new(situation, &lanes);
    for obstacle in obstacles {
        if !obstacle.is_valid() {
            return Plan::without_candidates(Outcome::Malformed);
        }
        survey.add(situation, &lanes, obstacle);
    }
    let sighting = Sighting::of(situation.goal.position);
    choice::Choice {
        situation,
        window: &window,
        lanes: &lanes,
        survey: &survey,
        sighting,
        speeds: objective::speeds(situation, &survey, sighting, &window),
    }
    .plan()
}

#[cfg(test)]
mod tests;
