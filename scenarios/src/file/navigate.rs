//! How the kernel's own planner is asked to drive: tolerances of the way, and its preferences.

use serde::Deserialize;

use super::value::{Fraction, NonNegative, Number, Positive};

/// The table `[proposer.navigate]`; what is left out is the kernel's default.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Navigate {
    /// The goal counts as reached within this distance; default a third of the goal's radius.
    pub goal_tolerance_m: Option<Positive>,
    /// A via point counts as passed within this distance; default 0.3.
    pub via_tolerance_m: Option<Positive>,
    /// Heading to take at the goal, in the world; default any.
    pub goal_heading_deg: Option<Number>,
    /// The heading counts as taken within this angle; default 5.
    pub heading_tolerance_deg: Option<Positive>,
    /// Weight of the heading towards the goal.
    pub heading_weight: Option<NonNegative>,
    /// Weight of the distance to objects.
    pub clearance_weight: Option<NonNegative>,
    /// Weight of the speed.
    pub speed_weight: Option<NonNegative>,
    /// How far ahead heading and clearance are judged.
    pub lookahead_s: Option<Positive>,
    /// Distance to objects beyond which more is not better.
    pub clearance_range_m: Option<Positive>,
    /// Within this distance of the goal slow is better than fast.
    pub goal_near_m: Option<NonNegative>,
    /// With an object this near, speed is limited in proportion to its distance.
    pub object_near_m: Option<NonNegative>,
    /// Part of the braking deceleration that planned slowing down uses.
    pub comfort: Option<Fraction>,
    /// Speed below which driving is not worth it.
    pub creep_mps: Option<NonNegative>,
    /// Free way beyond its stop that makes it worth to leave rest.
    pub start_m: Option<NonNegative>,
    /// Bearing of the goal beyond which the robot stops and turns on the spot.
    pub turn_first_deg: Option<NonNegative>,
    /// Bearing of the goal below which turning on the spot is not worth it.
    pub aligned_deg: Option<NonNegative>,
    /// Moving for so long without coming nearer ends the route.
    pub give_up_s: Option<Positive>,
    /// Coming nearer by less than this does not count.
    pub nearer_m: Option<NonNegative>,
}
