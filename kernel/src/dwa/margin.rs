//! How far a command may carry the robot, and how much the outline must grow on the way.
//!
//! Follows the guard's tube term by term (spec/model.md) in f64, so that the guard does not
//! refuse what the planner proposes: what does not depend on the motion comes from the
//! caller, what grows with it is added here. It proves nothing; the guard decides.

use super::types::{Limits, Situation, Velocity};
use super::window::Interval;

/// Steps of the guard's tube along a driving path, its least step (m), its largest turn (rad).
const GUARD_STEPS: f64 = 48.0;
const GUARD_STEP_MIN_M: f64 = 2e-3;
const GUARD_SPOT_STEP_RAD: f64 = 0.034_906;
/// What the guard adds for chords instead of arcs, per path.
const GUARD_CHORDS: f64 = 1.0 / 2048.0;
/// Speeds below this have no curvature worth naming, m/s.
const SPEED_LEAST_MPS: f64 = 1e-6;

/// Inflation of the outline.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Margin {
    /// Whatever does not depend on the motion: sensor, tracking, rounding (3 mm), V_obs · age, m.
    pub fixed_m: f64,
    /// Speed tolerance of the drive, m/s.
    pub speed_tolerance_mps: f64,
    /// Turn rate tolerance of the drive, rad/s.
    pub turn_tolerance_radps: f64,
    /// Speed bound of the obstacles, m/s.
    pub obstacle_speed_mps: f64,
    /// Least inflation that a point has once the robot has come near to it, m: what slowing down
    /// and scoring look ahead with. Stopping in time respects each point's own inflation.
    pub near_m: f64,
    /// Whether speed and turn rate may come to rest each by its own ramp.
    pub separate_ramps: bool,
}

/// How much the outline grows for one command, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Inflation {
    /// Where the robot is now.
    pub start_m: f64,
    /// Where it comes to rest at the latest; used for the whole path.
    pub end_m: f64,
}

/// What stopping from a command takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Stop {
    /// Longest travel to rest, m (rad on the spot).
    pub travel: f64,
    /// Latest time of rest, s.
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

/// The longest stop when `velocity` is commanded and anything possible in `situation` may go
/// on for the reaction time, tolerances included.
pub(super) fn worst_stop(situation: &Situation<'_>, velocity: Velocity) -> Stop {
    let (limits, margin) = (&situation.limits, &situation.margin);
    let turn = situation
        .fastest_turn_radps()
        .max(velocity.angular_radps.abs());
    let speed = situation.fastest_mps().max(velocity.linear_mps) + margin.speed_tolerance_mps;
    if velocity.linear_mps > 0.0 {
        let bend = velocity.angular_radps.abs() / velocity.linear_mps.max(SPEED_LEAST_MPS);
        return stop(
            limits,
            Velocity {
                linear_mps: speed,
                angular_radps: turn + margin.slip_radps(bend),
            },
        );
    }
    // Both rates reach zero together, so a creeping v may prolong the turn.
    let rate = turn + margin.turn_tolerance_radps;
    let braking = (rate / limits.angular_braking_radps2).max(speed / limits.braking_mps2);
    let own = margin.turn_tolerance_radps;
    Stop {
        travel: rate * (limits.reaction_s + braking / 2.0)
            + own * own / (2.0 * limits.angular_braking_radps2),
        time_s: limits.reaction_s + braking,
    }
}

/// The largest rate whose stop fits into `travel`: `r T + r²/(2d) = travel`.
pub(super) fn rate_for(travel: f64, deceleration: f64, reaction_s: f64) -> f64 {
    let lost = deceleration * reaction_s;
    (libm::sqrt(lost * lost + 2.0 * deceleration * travel.max(0.0)) - lost).max(0.0)
}

/// What the possible motions and a command have in common.
struct Spread {
    /// Curvatures of all that are at least half as fast as the fastest, 1/m.
    curvatures: Interval,
    /// Turn rate that no curvature of the interval explains, rad/s.
    residual_radps: f64,
    /// Whether some motion is so slow that the robot may roll back.
    may_roll_back: bool,
}

/// The motions that a hull must contain, at most: all of them, or the corners of their box.
struct Hull<'a> {
    situation: &'a Situation<'a>,
    velocity: Velocity,
    /// Where the ramps are separate.
    corners: Option<[Velocity; 4]>,
}

impl<'a> Hull<'a> {
    fn of(situation: &'a Situation<'_>, velocity: Velocity) -> Self {
        let mut hull = Self {
            situation,
            velocity,
            corners: None,
        };
        if situation.margin.separate_ramps && situation.limits.curvature_max_per_m.is_none() {
            let span = |rate: fn(Velocity) -> f64| {
                let start = rate(velocity);
                hull.motions()
                    .map(rate)
                    .fold((start, start), |(low, high), one| {
                        (one.min(low), one.max(high))
                    })
            };
            let (slow, fast) = span(|one| one.linear_mps);
            let (right, left) = span(|one| one.angular_radps);
            hull.corners = Some(
                [(slow, right), (slow, left), (fast, right), (fast, left)].map(
                    |(linear_mps, angular_radps)| Velocity {
                        linear_mps,
                        angular_radps,
                    },
                ),
            );
        }
        hull
    }

    fn motions(&self) -> impl Iterator<Item = Velocity> {
        let corners = self.corners.iter().flatten().copied();
        let plain = self.corners.is_none().then(|| {
            let own = core::iter::once(self.velocity);
            self.situation.possible().chain(own)
        });
        corners.chain(plain.into_iter().flatten())
    }
}

impl Spread {
    fn of(situation: &Situation<'_>, velocity: Velocity) -> Self {
        let hull = Hull::of(situation, velocity);
        let fastest = hull.motions().map(|one| one.linear_mps).fold(0.0, f64::max);
        let slowest = hull
            .motions()
            .map(|one| one.linear_mps)
            .fold(fastest, f64::min);
        // Separate ramps may straighten the path.
        let own = if hull.corners.is_some() {
            0.0
        } else {
            velocity.angular_radps / velocity.linear_mps.max(SPEED_LEAST_MPS)
        };
        let mut curvatures = Interval {
            low: own,
            high: own,
        };
        let quick = (fastest / 2.0).max(SPEED_LEAST_MPS);
        for one in hull.motions().filter(|one| one.linear_mps >= quick) {
            let curvature = one.angular_radps / one.linear_mps;
            curvatures.low = curvatures.low.min(curvature);
            curvatures.high = curvatures.high.max(curvature);
        }
        let unexplained = |one: Velocity| {
            let below = curvatures.low * one.linear_mps - one.angular_radps;
            let above = one.angular_radps - curvatures.high * one.linear_mps;
            below.max(above).max(0.0)
        };
        Self {
            curvatures,
            residual_radps: hull.motions().map(unexplained).fold(0.0, f64::max),
            may_roll_back: slowest < situation.margin.speed_tolerance_mps,
        }
    }
}

impl Margin {
    pub(super) fn is_valid(&self) -> bool {
        [
            self.fixed_m,
            self.speed_tolerance_mps,
            self.turn_tolerance_radps,
            self.obstacle_speed_mps,
            self.near_m,
        ]
        .iter()
        .all(|value| value.is_finite() && *value >= 0.0)
    }

    /// Turn rate error while driving with curvatures up to `bend` (1/m).
    fn slip_radps(&self, bend: f64) -> f64 {
        self.turn_tolerance_radps + bend * self.speed_tolerance_mps
    }

    /// Inflation for driving `velocity` while anything possible may still be executing.
    ///
    /// Takes the guard's nominal arc (the middle of all curvatures) for as far from this one
    /// as it can be.
    pub(super) fn driving(&self, situation: &Situation<'_>, velocity: Velocity) -> Inflation {
        let limits = &situation.limits;
        let corner = situation.footprint.corner_m();
        let spread = Spread::of(situation, velocity);
        let Interval { low, high } = spread.curvatures;
        let bend = low.abs().max(high.abs());
        let slip = self.slip_radps(bend) + spread.residual_radps;
        let Stop { travel, time_s } = worst_stop(situation, velocity);
        let step = (travel / GUARD_STEPS).max(GUARD_STEP_MIN_M);
        let path = travel + step;
        let back_s = (self.speed_tolerance_mps / limits.braking_mps2)
            .max(slip / limits.angular_braking_radps2);
        let rolling_back = if spread.may_roll_back {
            self.speed_tolerance_mps * (limits.reaction_s + back_s)
        } else {
            0.0
        };
        // Separate ramps: what the robot may turn on after v has come to rest.
        let rate = situation
            .fastest_turn_radps()
            .max(velocity.angular_radps.abs())
            + slip;
        let after_turn = if self.separate_ramps && limits.curvature_max_per_m.is_none() {
            rate * rate / (2.0 * limits.angular_braking_radps2)
        } else {
            0.0
        };
        let start_m = self.fixed_m
            + self.obstacle_speed_mps * time_s
            + rolling_back
            + (slip * time_s + after_turn) * corner
            + step * (1.0 + bend * corner) / 2.0;
        let grown =
            slip * time_s + after_turn + (high - low) * (path / 2.0 + corner) + GUARD_CHORDS;
        Inflation {
            start_m,
            end_m: start_m + path * grown,
        }
    }

    /// Inflation for driving `velocity` as if nothing else had been commanded before.
    pub(super) fn alone(&self, situation: &Situation<'_>, velocity: Velocity) -> Inflation {
        let alone = Situation {
            velocity,
            in_flight: &[],
            ..*situation
        };
        self.driving(&alone, velocity)
    }

    /// Inflation for turning on the spot at `angular_radps`.
    pub(super) fn turning(&self, situation: &Situation<'_>, angular_radps: f64) -> Inflation {
        let velocity = Velocity {
            linear_mps: 0.0,
            angular_radps,
        };
        let Stop { travel, time_s } = worst_stop(situation, velocity);
        let corner = situation.footprint.corner_m();
        let speed = situation.fastest_mps() + self.speed_tolerance_mps;
        // The tolerance alone may turn the robot the other way first.
        let against = self.turn_tolerance_radps * time_s;
        let step = (travel + against).min(GUARD_SPOT_STEP_RAD);
        let all_m = self.fixed_m
            + (self.obstacle_speed_mps + speed) * time_s
            + corner * (against + step / 2.0);
        Inflation {
            start_m: all_m,
            end_m: all_m,
        }
    }
}
