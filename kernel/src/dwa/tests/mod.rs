//! Tests of the planner: oracle, errata, properties, closed loop.

mod closed_loop;
mod errata;
mod oracle;
mod properties;

use super::*;
use std::vec::Vec;

/// xorshift64*: fixed seeds make every run the same.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }
}

/// Seekur Jr (Loh 4.1): 0.84 m × 1.20 m.
const SEEKUR: Footprint = Footprint {
    front_m: 0.60,
    rear_m: 0.60,
    left_m: 0.42,
    right_m: 0.42,
};

fn seekur_limits() -> Limits {
    Limits {
        speed_mps: 1.2,
        acceleration_mps2: 0.5,
        braking_mps2: 0.5,
        angular_speed_radps: 80.0_f64.to_radians(),
        angular_acceleration_radps2: 1.0,
        angular_braking_radps2: 1.0,
        period_s: 0.04,
        reaction_s: 0.14,
        curvature_max_per_m: None,
    }
}

fn seekur(velocity: Velocity, goal: Point) -> Situation<'static> {
    Situation {
        footprint: SEEKUR,
        limits: seekur_limits(),
        margin: Margin {
            fixed_m: 0.015,
            speed_tolerance_mps: 0.01,
            turn_tolerance_radps: 0.01,
            obstacle_speed_mps: 0.0,
            near_m: 0.05,
            separate_ramps: false,
        },
        tuning: Tuning::default(),
        velocity,
        in_flight: &[],
        goal: Goal {
            position: goal,
            heading_rad: None,
            arrival: Arrival::Stop,
            position_tolerance_m: 0.15,
            heading_tolerance_rad: 0.1,
        },
    }
}

fn obstacles(points: &[Point]) -> Vec<Obstacle> {
    points.iter().copied().map(Obstacle::from).collect()
}
