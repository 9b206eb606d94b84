//! The dynamic window V_s ∩ V_d (Loh 4.3, 4.4).

use super::types::{Limits, Velocity};

/// What the window keeps clear of its own edge, so that rounding a command to whole µm/s
/// or µrad/s does not leave it.
const EDGE: f64 = 2e-6;

/// A closed interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interval {
    /// Least value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
}

impl Interval {
    /// Whether `low ≤ high`.
    #[must_use]
    pub fn is_some(&self) -> bool {
        self.low <= self.high
    }

    /// Whether `value` lies inside.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// What both have in common.
    #[must_use]
    pub fn intersection(&self, other: Self) -> Self {
        Self {
            low: self.low.max(other.low),
            high: self.high.min(other.high),
        }
    }

    /// The nearest value inside; the low end of an empty interval.
    #[must_use]
    pub fn clamp(&self, value: f64) -> f64 {
        value.min(self.high).max(self.low)
    }
}

/// Speeds and turn rates that the drive may be commanded one period from now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DynamicWindow {
    /// Speeds, m/s; never negative.
    pub linear: Interval,
    /// Turn rates, rad/s.
    pub angular: Interval,
}

impl DynamicWindow {
    /// The window around `velocity`; `None` if no admissible speed is reachable.
    ///
    /// A rate grows by the acceleration, shrinks by the braking deceleration, and never
    /// passes through zero within one period.
    /// # Source
    /// LIMIT-01; Loh 4.3 with v ≥ 0, 4.4.
    #[must_use]
    pub fn new(limits: &Limits, velocity: Velocity) -> Option<Self> {
        let linear = reachable(
            velocity.linear_mps,
            limits.acceleration_mps2 * limits.period_s,
            limits.braking_mps2 * limits.period_s,
        )
        .intersection(Interval {
            low: 0.0,
            high: limits.speed_mps,
        });
        let angular = reachable(
            velocity.angular_radps,
            limits.angular_acceleration_radps2 * limits.period_s,
            limits.angular_braking_radps2 * limits.period_s,
        )
        .intersection(Interval {
            low: -limits.angular_speed_radps,
            high: limits.angular_speed_radps,
        });
        (linear.is_some() && angular.is_some()).then_some(Self { linear, angular })
    }

    /// Whether `velocity` lies inside.
    #[must_use]
    pub fn contains(&self, velocity: Velocity) -> bool {
        self.linear.contains(velocity.linear_mps) && self.angular.contains(velocity.angular_radps)
    }
}

/// Rates reachable from `rate`: `faster` away from zero, `slower` towards it, zero at most.
fn reachable(rate: f64, faster: f64, slower: f64) -> Interval {
    if rate < 0.0 {
        let mirrored = reachable(-rate, faster, slower);
        return Interval {
            low: -mirrored.high,
            high: -mirrored.low,
        };
    }
    let grown = (rate + faster - EDGE).max(rate);
    if rate > 0.0 {
        Interval {
            low: (rate - slower + EDGE).max(0.0).min(rate),
            high: grown,
        }
    } else {
        Interval {
            low: -grown,
            high: grown,
        }
    }
}
