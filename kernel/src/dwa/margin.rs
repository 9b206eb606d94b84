//! How much the outline must grow so that the guard does not refuse what the planner proposes.
//!
//! Follows the guard's inflation term by term (spec/model.md) in f64: what does not
//! depend on the motion comes from the caller, what grows with it is added here. It
//! proves nothing; the guard decides.

use super::types::{Limits, Situation, Velocity};

/// Steps of the guard's tube along a driving path; half a step is not sampled.
const GUARD_STEPS: f64 = 48.0;

/// Inflation of the outline.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Margin {
    /// Whatever does not depend on the motion: sensor, tracking, rounding, V_obs · age, m.
    pub fixed_m: f64,
    /// Speed tolerance of the drive, m/s.
    pub speed_tolerance_mps: f64,
    /// Turn rate tolerance of the drive, rad/s.
    pub turn_tolerance_radps: f64,
    /// Speed bound of the obstacles, m/s.
    pub obstacle_speed_mps: f64,
}

/// Stopping of one motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stop {
    /// Travel to rest, m (rad on the spot).
    pub travel: f64,
    /// Time to rest, s.
    pub time_s: f64,
}

/// Travel and time to rest of `velocity`: reaction, then v and ω brought to rest together.
///
/// `v T + v/2 · max(v/b, |ω|/β)`: v T + v²/(2b) where the speed decides, and where the turn
/// rate does, the same as |ω| T + ω²/(2β) in angle. Without `v` the angle of a turn on the spot.
/// # Source
/// Loh 4.5, corrected.
pub(super) fn stop(limits: &Limits, velocity: Velocity) -> Stop {
    let (speed, turn) = (velocity.linear_mps.abs(), velocity.angular_radps.abs());
    let braking = (speed / limits.braking_mps2).max(turn / limits.angular_braking_radps2);
    let rate = if speed > 0.0 { speed } else { turn };
    Stop {
        travel: rate * (limits.reaction_s + braking / 2.0),
        time_s: limits.reaction_s + braking,
    }
}

/// Stop of `velocity` while anything possible in `situation` may be executing for the reaction time.
pub(super) fn worst_stop(situation: &Situation<'_>, velocity: Velocity) -> Stop {
    let turn = situation
        .fastest_turn_radps()
        .max(velocity.angular_radps.abs());
    let linear_mps = if velocity.linear_mps > 0.0 {
        situation.fastest_mps().max(velocity.linear_mps)
    } else {
        0.0
    };
    let angular_radps = turn;
    stop(
        &situation.limits,
        Velocity {
            linear_mps,
            angular_radps,
        },
    )
}

/// The largest rate whose stop fits into `travel`: `r T + r²/(2d) = travel`.
pub(super) fn rate_for(travel: f64, deceleration: f64, reaction_s: f64) -> f64 {
    let lost = deceleration * reaction_s;
    (libm::sqrt(lost * lost + 2.0 * deceleration * travel.max(0.0)) - lost).max(0.0)
}

impl Margin {
    pub(super) fn is_valid(&self) -> bool {
        [
            self.fixed_m,
            self.speed_tolerance_mps,
            self.turn_tolerance_radps,
            self.obstacle_speed_mps,
        ]
        .iter()
        .all(|value| value.is_finite() && *value >= 0.0)
    }

    /// Inflation for driving `velocity` while the motions `in_flight` may still be executing, m.
    ///
    /// Takes the spread at the end of the path for the whole path. The curvature spread counts
    /// in full, not by half as in the guard, whose nominal arc lies in the middle.
    #[must_use]
    pub fn driving_m(&self, situation: &Situation<'_>, velocity: Velocity) -> f64 {
        let limits = &situation.limits;
        let fastest = situation.fastest_mps().max(velocity.linear_mps);
        let curvature = velocity.angular_radps / velocity.linear_mps.max(1e-3);
        let (mut bend, mut slip) = (0.0_f64, 0.0_f64);
        for other in situation.possible() {
            if other.linear_mps >= fastest / 2.0 && other.linear_mps > 0.0 {
                bend = bend.max((other.angular_radps / other.linear_mps - curvature).abs());
            } else {
                slip = slip.max((other.angular_radps - curvature * other.linear_mps).abs());
            }
        }
        let stop = stop(
            limits,
            Velocity {
                linear_mps: fastest + self.speed_tolerance_mps,
                angular_radps: curvature * fastest,
            },
        );
        let corner = situation.footprint.corner_m();
        let slip = slip + self.turn_tolerance_radps + curvature.abs() * self.speed_tolerance_mps;
        let path = stop.travel;
        self.fixed_m
            + self.obstacle_speed_mps * stop.time_s
            + slip * stop.time_s * (path + corner)
            + bend * path * (path / 2.0 + corner)
            + path * (1.0 + curvature.abs() * corner) / (2.0 * GUARD_STEPS)
    }

    /// Inflation for driving `velocity` as if nothing else had been commanded before, m.
    #[must_use]
    pub fn alone_m(&self, situation: &Situation<'_>, velocity: Velocity) -> f64 {
        let alone = Situation {
            velocity,
            in_flight: &[],
            ..*situation
        };
        self.driving_m(&alone, velocity)
    }

    /// Inflation for turning on the spot at `angular_radps`, m.
    #[must_use]
    pub fn turning_m(&self, situation: &Situation<'_>, angular_radps: f64) -> f64 {
        let limits = &situation.limits;
        let speed = situation.fastest_mps() + self.speed_tolerance_mps;
        let turn = angular_radps.abs() + self.turn_tolerance_radps;
        let braking = (turn / limits.angular_braking_radps2).max(speed / limits.braking_mps2);
        let time = limits.reaction_s + braking;
        self.fixed_m + (self.obstacle_speed_mps + speed) * time
    }
}
