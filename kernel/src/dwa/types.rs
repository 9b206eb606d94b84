//! What the planner is told, and what it answers. SI units and radians, body frame.

use super::arc::Clearance;
use super::footprint::{Footprint, Point};
use super::margin::Margin;

/// Most candidates of a [`Plan`].
pub const CANDIDATES: usize = 8;

/// Speed and turn rate, body frame; counter-clockwise positive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Velocity {
    /// Forward, m/s.
    pub linear_mps: f64,
    /// To the left, rad/s.
    pub angular_radps: f64,
}

impl Velocity {
    pub(super) fn is_finite(&self) -> bool {
        self.linear_mps.is_finite() && self.angular_radps.is_finite()
    }
}

/// What the drive may be asked to do. All values finite and positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest forward speed, m/s.
    pub speed_mps: f64,
    /// Acceleration away from rest, m/s².
    pub acceleration_mps2: f64,
    /// Deceleration surely reached, m/s².
    pub braking_mps2: f64,
    /// Largest turn rate, rad/s.
    pub angular_speed_radps: f64,
    /// Angular acceleration away from rest, rad/s².
    pub angular_acceleration_radps2: f64,
    /// Angular deceleration surely reached, rad/s².
    pub angular_braking_radps2: f64,
    /// Control period Δt: how far the dynamic window opens, s.
    pub period_s: f64,
    /// Time T a command may last before braking starts, period and latency included, s.
    pub reaction_s: f64,
    /// Largest path curvature of a steered drive, 1/m; `None` for one that turns on the spot.
    pub curvature_max_per_m: Option<f64>,
}

/// What to do at the goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arrival {
    /// Come to rest there.
    #[default]
    Stop,
    /// A via point: drive on without slowing down for it.
    Pass,
}

/// Where to go, body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Position, metres.
    pub position: Point,
    /// Heading to take once there, radians from the robot's present heading; `None`: any.
    pub heading_rad: Option<f64>,
    /// Whether to come to rest there.
    pub arrival: Arrival,
    /// The position counts as reached within this distance, m.
    pub position_tolerance_m: f64,
    /// The heading counts as reached within this angle, rad.
    pub heading_tolerance_rad: f64,
}

/// A point that must not be touched.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Obstacle {
    /// Body frame, metres.
    pub position: Point,
    /// Inflation of this point on top of the common margin (beam gap, memory drift), m, ≥ 0.
    pub inflation_m: f64,
}

impl Obstacle {
    pub(super) fn is_valid(&self) -> bool {
        self.position.iter().all(|value| value.is_finite())
            && self.inflation_m.is_finite()
            && self.inflation_m >= 0.0
    }
}

impl From<Point> for Obstacle {
    fn from(position: Point) -> Self {
        Self {
            position,
            inflation_m: 0.0,
        }
    }
}

impl From<crate::guard::check::CloudPoint> for Obstacle {
    /// The guard's point with its own inflation; exact.
    fn from(point: crate::guard::check::CloudPoint) -> Self {
        Self {
            position: [f64::from(point.x_mm) / 1e3, f64::from(point.y_mm) / 1e3],
            inflation_m: f64::from(point.extra_mm) / 1e3,
        }
    }
}

/// Preferences: none of these can make an inadmissible command a candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// α of Loh 4.11.
    pub heading_weight: f64,
    /// β of Loh 4.11.
    pub clearance_weight: f64,
    /// γ of Loh 4.11.
    pub speed_weight: f64,
    /// How far ahead heading and clearance are judged, s.
    pub lookahead_s: f64,
    /// Distance beyond the inscribed circle at which clearance counts as perfect, m.
    pub clearance_range_m: f64,
    /// Within this distance of the goal slow is better than fast (Loh A.5), m.
    pub goal_near_m: f64,
    /// With an object this near, speed is limited in proportion to its distance, m.
    pub object_near_m: f64,
    /// Part of the braking deceleration that planned slowing down uses, 0–1.
    pub comfort: f64,
    /// Speed below which driving is not worth it, m/s.
    pub creep_mps: f64,
    /// Free way beyond its stop that makes it worth to leave rest, m.
    pub start_m: f64,
    /// Bearing of the goal beyond which the robot stops and turns on the spot, rad.
    pub turn_first_rad: f64,
    /// Bearing of the goal below which turning on the spot is not worth it, rad.
    pub aligned_rad: f64,
}

impl Default for Tuning {
    /// α = β = γ = 0.2 as in Loh A.2; the rest is ours.
    fn default() -> Self {
        Self {
            heading_weight: 0.2,
            clearance_weight: 0.2,
            speed_weight: 0.2,
            lookahead_s: 1.5,
            clearance_range_m: 0.5,
            goal_near_m: 0.5,
            object_near_m: 0.3,
            comfort: 0.7,
            creep_mps: 0.05,
            start_m: 0.03,
            turn_first_rad: 1.05,
            aligned_rad: 0.05,
        }
    }
}

/// Everything one planning step depends on, besides the points.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// The bare outline.
    pub footprint: Footprint,
    /// What the drive may be asked to do.
    pub limits: Limits,
    /// What the outline must be inflated by, the guard's terms included.
    pub margin: Margin,
    /// Preferences.
    pub tuning: Tuning,
    /// The command in force: the centre of the dynamic window.
    pub velocity: Velocity,
    /// What the robot may do besides: the measured twist and earlier commands still in flight.
    pub in_flight: &'a [Velocity],
    /// Where to go.
    pub goal: Goal,
}

/// One command worth trying.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The command, in V_s ∩ V_d ∩ V_a.
    pub velocity: Velocity,
    /// The objective, 0–1 with weights that sum to 1; larger is better.
    pub score: f64,
    /// First contact of the inflated outline on this path, if within the planner's horizon.
    pub clearance: Clearance,
}

impl Default for Candidate {
    fn default() -> Self {
        Self {
            velocity: Velocity::default(),
            score: 0.0,
            clearance: Clearance::Contact(0.0),
        }
    }
}

/// Why a plan is as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub enum Outcome {
    /// There are candidates.
    Moving,
    /// Position and heading are reached: stop.
    Arrived,
    /// Nothing admissible leads on: stop. The point that ends the way towards the goal, if one does.
    Blocked(Option<Point>),
    /// The motion cannot be continued (backwards, or rolling where the goal asks for a turn): stop first.
    Unsuitable,
    /// A number is not finite or out of its range: stop.
    Malformed,
}

/// The answer: the best candidates, see [`Plan::candidates`]. Without any the robot must stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Why.
    pub outcome: Outcome,
    pub(super) candidates: [Candidate; CANDIDATES],
    pub(super) count: usize,
}

impl Plan {
    pub(super) fn without_candidates(outcome: Outcome) -> Self {
        Self {
            outcome,
            candidates: [Candidate::default(); CANDIDATES],
            count: 0,
        }
    }

    /// The best candidate, then going on as commanded where that is admissible, then the others by
    /// their scores, last the slowest on the best path; try the next when the guard refuses one.
    #[must_use]
    pub fn candidates(&self) -> &[Candidate] {
        self.candidates.get(..self.count).unwrap_or_default()
    }
}
