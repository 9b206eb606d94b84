//! What follows from a situation alone: whether it can be planned on, and what may be moving.

use super::types::{Situation, Tuning, Velocity};

/// Rates up to this count as rest where the drive has no tolerance, m/s and rad/s.
const REST: f64 = 1e-3;

impl Situation<'_> {
    /// Every motion that may be executing: the command in force and what is in flight.
    pub(super) fn possible(&self) -> impl Iterator<Item = Velocity> {
        core::iter::once(self.velocity).chain(self.in_flight.iter().copied())
    }

    /// How far ahead heading and clearance are judged at full speed, m.
    pub(super) fn lookahead_m(&self) -> f64 {
        2.0 * self.tuning.lookahead_s * self.limits.speed_mps
    }

    /// The largest speed among them, m/s.
    pub(super) fn fastest_mps(&self) -> f64 {
        let speed = |velocity: Velocity| velocity.linear_mps.abs();
        self.possible().map(speed).fold(0.0, f64::max)
    }

    /// The largest turn rate among them as a magnitude, rad/s.
    pub(super) fn fastest_turn_radps(&self) -> f64 {
        let rate = |velocity: Velocity| velocity.angular_radps.abs();
        self.possible().map(rate).fold(0.0, f64::max)
    }

    /// Whether nothing moves or is about to.
    pub(super) fn is_at_rest(&self) -> bool {
        self.fastest_mps() <= self.margin.speed_tolerance_mps.max(REST)
            && self.fastest_turn_radps() <= self.margin.turn_tolerance_radps.max(REST)
    }

    /// Whether every number is finite and within its range.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let (limits, goal) = (&self.limits, &self.goal);
        let positive = [
            limits.speed_mps,
            limits.acceleration_mps2,
            limits.braking_mps2,
            limits.angular_speed_radps,
            limits.angular_acceleration_radps2,
            limits.angular_braking_radps2,
            limits.period_s,
            limits.reaction_s,
            limits.curvature_max_per_m.unwrap_or(1.0),
            goal.position_tolerance_m,
            goal.heading_tolerance_rad,
        ];
        let [goal_x, goal_y] = goal.position;
        let finite = [goal_x, goal_y, goal.heading_rad.unwrap_or(0.0)];
        // Written so that NaN fails.
        self.footprint.is_valid()
            && self.margin.is_valid()
            && positive
                .iter()
                .all(|value| value.is_finite() && *value > 0.0)
            && finite.iter().all(|value| value.is_finite())
            && self.tuning.is_valid()
            && self.velocity.is_finite()
            && self.in_flight.iter().all(Velocity::is_finite)
    }
}

impl Tuning {
    /// Whether every preference is finite and within its range.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let positive = [self.lookahead_s, self.clearance_range_m, self.comfort];
        let not_negative = [
            self.heading_weight,
            self.clearance_weight,
            self.speed_weight,
            self.goal_near_m,
            self.object_near_m,
            self.creep_mps,
            self.start_m,
            self.turn_first_rad,
            self.aligned_rad,
        ];
        // Written so that NaN fails.
        positive
            .iter()
            .all(|value| value.is_finite() && *value > 0.0)
            && not_negative
                .iter()
                .all(|value| value.is_finite() && *value >= 0.0)
            && self.comfort <= 1.0
    }
}
