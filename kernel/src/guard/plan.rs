//! From a hull of motions to the numbers of its tube: how far, how long, how wide (spec/model.md).
//!
//! Everything here is an upper bound and rounds up; what is too large to be
//! useful is refused by [`super::tube`].

use super::Refusal;
use super::hull::{CurvatureInterval, Hull};
use crate::arith::{add, div_up, magnitude, mul_div_up, mul_micro_up};

/// What the tube needs to know about the robot, in plain micro-units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dynamics {
    /// Deceleration surely reached, µm/s².
    pub braking: u64,
    /// Angular deceleration surely reached, µrad/s²; `u64::MAX` where the wheels hold the arc.
    pub angular_braking: u64,
    /// Whether v and ω may ramp separately while braking.
    pub separate_ramps: bool,
    /// Whether the steered wheels determine the curvature.
    pub steered: bool,
    /// Steering error, µrad/m.
    pub curvature_tolerance: i32,
    /// Speed tolerance, µm/s.
    pub speed_tolerance: u64,
    /// Turn rate tolerance, µrad/s.
    pub turn_tolerance: u64,
    /// Distance of the farthest corner from the rotation centre, µm.
    pub corner: u64,
}

/// The bounds of one tube.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    /// −1 for a robot that drives backwards, +1 otherwise.
    pub direction: i32,
    /// Curvature of the nominal arc, µrad/m.
    pub curvature: i32,
    /// Largest difference of a driven curvature from the nominal one, µrad/m.
    pub curvature_spread: u64,
    /// Turn rate that no curvature of the interval explains, µrad/s.
    pub turn_tolerance: u64,
    /// Angle the robot may turn on after v came to rest by its own ramp, µrad.
    pub after_turn: u64,
    /// Longest path, µm; zero when turning on the spot.
    pub path: u64,
    /// Largest angle turned to the left on the spot, µrad.
    pub turn_left: u64,
    /// Largest angle turned to the right on the spot, µrad.
    pub turn_right: u64,
    /// Time during which any motion of the hull may be followed, µs.
    pub reaction: u64,
    /// Latest time at which the robot can still move, µs.
    pub latest: u64,
    /// Inflation that holds for the whole tube, µm.
    pub constant_spread: u64,
    /// C of the latest-time lemma in 10⁻⁶ s²/m, and its offset in µs; `None` if only `latest` holds.
    pub late: Option<(u64, u64)>,
}

impl Plan {
    /// Plans the tube of `hull` when any of its motions may last for `reaction_us`.
    ///
    /// # Errors
    /// [`Refusal::MixedMotion`] if the hull contains both directions of travel.
    pub fn new(dynamics: &Dynamics, hull: &Hull, reaction_us: u64) -> Result<Self, Refusal> {
        if !hull.is_complete() {
            return Err(Refusal::TooLong);
        }
        let boxed;
        let hull = if dynamics.separate_ramps && !dynamics.steered {
            boxed = hull.boxed();
            &boxed
        } else {
            hull
        };
        let (slowest, fastest) = hull.speed_range();
        let tolerance = i64::try_from(dynamics.speed_tolerance).unwrap_or(i64::MAX);
        let forward = i64::from(slowest) >= tolerance.saturating_neg();
        let backward = i64::from(fastest) <= tolerance;
        // Within the tolerance both hold. What creeps is still judged along its way, or it would
        // creep into unknown space unseen; what mainly turns is judged as turning.
        let creep = magnitude(slowest).max(magnitude(fastest));
        let corner_speed = mul_micro_up(hull.turn_max(), dynamics.corner);
        if forward && backward && !dynamics.steered && corner_speed >= creep {
            return Ok(Self::on_the_spot(dynamics, hull, reaction_us));
        }
        let rather_back = backward && magnitude(slowest) > magnitude(fastest);
        if forward && !rather_back {
            Ok(Self::driving(dynamics, hull, reaction_us, 1))
        } else if backward {
            Ok(Self::driving(dynamics, &hull.mirrored(), reaction_us, -1))
        } else {
            //= spec/guard.md#guard-10
            //# The guard MUST refuse a motion whose hull contains driving speeds of both signs, or turning on the
            //# spot together with driving beyond what the residual turn rate covers.
            Err(Refusal::MixedMotion)
        }
    }

    /// Turning on the spot, both directions at once; speeds within the tolerance widen it.
    //= spec/guard.md#guard-09
    //# The tube of a turn on the spot MUST cover, in both directions, the angle turned in the hold time at the
    //# largest turn rate of the hull plus the angle of braking from it.
    fn on_the_spot(dynamics: &Dynamics, hull: &Hull, reaction: u64) -> Self {
        let (slowest, fastest) = hull.speed_range();
        let creep = magnitude(slowest).max(magnitude(fastest));
        let speed = add(dynamics.speed_tolerance, creep);
        let own = dynamics.turn_tolerance;
        // Both rates reach zero together, so a creeping v may prolong the turn:
        // w (T + max(w/β, v/b)/2) + tol²/(2β)
        let roll_out = mul_div_up(speed, 1_000_000, dynamics.braking);
        let turned = |rate: u64| {
            let w = add(rate, own);
            let stop = mul_div_up(w, 1_000_000, dynamics.angular_braking).max(roll_out);
            let twice = dynamics.angular_braking.saturating_mul(2);
            add(
                mul_micro_up(w, add(reaction, stop.div_ceil(2))),
                mul_div_up(own, own, twice),
            )
        };
        let rate = add(hull.turn_max(), own);
        let stop = mul_div_up(rate, 1_000_000, dynamics.angular_braking).max(roll_out);
        let latest = add(reaction, stop);
        Self {
            direction: 1,
            turn_left: turned(hull.turn_towards(1)),
            turn_right: turned(hull.turn_towards(-1)),
            reaction,
            latest,
            constant_spread: mul_micro_up(speed, latest),
            ..Self::default()
        }
    }

    /// Driving along an arc with speeds of one sign (already mirrored for reverse).
    fn driving(dynamics: &Dynamics, hull: &Hull, reaction: u64, direction: i32) -> Self {
        let (slowest, fastest) = hull.speed_range();
        let backwards = u64::from(slowest.min(0).unsigned_abs());
        let speed_tolerance = add(dynamics.speed_tolerance, backwards);
        let interval = Self::interval(dynamics, hull);
        let bend = interval.magnitude();
        let speed = add(u64::from(fastest.max(0).unsigned_abs()), speed_tolerance);
        let slip = add(mul_micro_up(bend, speed_tolerance), dynamics.turn_tolerance);
        let (turn_tolerance, rate) = if dynamics.steered {
            (slip, add(mul_micro_up(bend, speed), slip))
        } else {
            let residual = hull.curvature_residual(interval);
            (add(slip, residual), add(hull.turn_max(), slip))
        };
        let stop = mul_div_up(speed, 1_000_000, dynamics.braking).max(mul_div_up(
            rate,
            1_000_000,
            dynamics.angular_braking,
        ));
        let latest = add(reaction, stop);
        let nominal = interval.middle();
        let may_roll_back = u64::from(slowest.max(0).unsigned_abs()) < speed_tolerance;
        Self {
            direction,
            curvature: nominal,
            curvature_spread: bend_difference(interval, nominal),
            turn_tolerance,
            after_turn: if dynamics.separate_ramps && !dynamics.steered {
                mul_div_up(rate, rate, dynamics.angular_braking.saturating_mul(2))
            } else {
                0
            },
            path: mul_micro_up(speed, add(reaction, stop.div_ceil(2))),
            reaction,
            latest,
            constant_spread: if may_roll_back {
                let stop = mul_div_up(speed_tolerance, 1_000_000, dynamics.braking).max(
                    mul_div_up(turn_tolerance, 1_000_000, dynamics.angular_braking),
                );
                mul_micro_up(speed_tolerance, add(reaction, stop))
            } else {
                0
            },
            late: Self::late_terms(dynamics, bend, turn_tolerance, speed_tolerance),
            ..Self::default()
        }
    }

    fn interval(dynamics: &Dynamics, hull: &Hull) -> CurvatureInterval {
        //= spec/guard.md#guard-13
        //# The curvature interval of an Ackermann tube MUST contain every wheel angle the steering can have at any
        //# moment of the tube, widened by the curvature tolerance.
        if dynamics.steered {
            return hull.wheel_interval().widened(dynamics.curvature_tolerance);
        }
        //= spec/guard.md#guard-11
        //# Where the drive may ramp speed and turn rate separately, the tube MUST contain every trajectory in which
        //# either of them reaches zero first.
        if dynamics.separate_ramps {
            // ω may come to rest before v does: the path may straighten.
            return hull
                .curvature_interval()
                .joined(CurvatureInterval::default());
        }
        hull.curvature_interval()
    }

    /// C = max(1/b, k/β) in 10⁻⁶ s²/m, and tol_ω/β + C·tol_v in µs.
    fn late_terms(
        dynamics: &Dynamics,
        bend: u64,
        turn_tolerance: u64,
        speed_tolerance: u64,
    ) -> Option<(u64, u64)> {
        if dynamics.separate_ramps {
            return None;
        }
        let straight = div_up(1_000_000_000_000, dynamics.braking);
        let bent = mul_div_up(bend, 1_000_000, dynamics.angular_braking);
        let offset = mul_div_up(turn_tolerance, 1_000_000, dynamics.angular_braking);
        // Rolling back within the speed tolerance takes time C·tol_v without path.
        let slope = straight.max(bent);
        let back = mul_micro_up(slope, speed_tolerance);
        Some((slope, add(offset, back)))
    }

    /// Inflation by spread of speed and curvature at arc length `s` (µm), in µm.
    ///
    /// `dk (s²/2 + ρ s) + (tol_ω t_max + after_turn) (s + ρ) + constant`: convex and
    /// nondecreasing in `s`.
    //= spec/guard.md#guard-08
    //# The spread term of a sample MUST bound the distance of every footprint point from its nominal place at equal
    //# arc length, for every curvature of the interval and every residual turn rate of the hull.
    #[must_use]
    pub fn spread(&self, path: u64, corner: u64) -> u64 {
        if self.path == 0 {
            return self.constant_spread;
        }
        let lever = add(path, corner);
        let turn = add(
            mul_micro_up(self.turn_tolerance, self.latest),
            self.after_turn,
        );
        let bent = mul_micro_up(
            mul_micro_up(self.curvature_spread, path),
            add(path.div_ceil(2), corner),
        );
        add(self.constant_spread, add(bent, mul_micro_up(turn, lever)))
    }

    /// Latest time (µs) at which the robot can be at arc length `path` (µm) and still move.
    ///
    /// `T + min(t_brake, sqrt(2 s C) + tol_ω/β)`; see spec/model.md, "Latest time".
    //= spec/guard.md#guard-07
    //# The obstacle term of a point at a sample MUST be no less than the obstacle speed bound times the sum of the
    //# point's age at the odometry stamp and the latest time at which the robot can be at that sample and still move.
    #[must_use]
    pub fn latest_at(&self, path: u64) -> u64 {
        let Some((slope, offset)) = self.late else {
            return self.latest;
        };
        // µm times 10⁻⁶ s²/m is 10⁻¹² s², that is µs².
        let squared = path.saturating_mul(2).saturating_mul(slope);
        let root = crate::arith::sqrt_up(squared);
        self.latest.min(add(self.reaction, add(root, offset)))
    }
}

/// Largest distance of the interval's ends from `nominal`.
fn bend_difference(interval: CurvatureInterval, nominal: i32) -> u64 {
    let above = i64::from(interval.high).saturating_sub(i64::from(nominal));
    let below = i64::from(nominal).saturating_sub(i64::from(interval.low));
    above.max(below).max(0).unsigned_abs()
}
