//! BRAKE: where no motion is accepted, set points fall to zero along the arc, at least as fast as the sure decelerations.
//!
//! Judges what the kernel sends (BRAKE-01, -03, -04, -05, -07). Whether the robot obeys is
//! judged by CLAIM, in the only way that counts.

use haltline::decision::Action;
use haltline_robots::Robot;

use super::{Ledger, Tick};
use crate::drive::SetPoint;

/// Rounding of the kernel's integers, m/s, rad/s and 1/m.
const ROUNDING: f64 = 5e-6;

/// A ramp to rest.
#[derive(Clone, Copy)]
struct Ramp {
    /// Set point before the first braking tick.
    from: SetPoint,
    /// Time since that tick on a clock that never runs backwards.
    spent_us: u64,
}

pub(super) struct Brake {
    pub(super) ledger: Ledger,
    ramp: Option<Ramp>,
    before: SetPoint,
    before_us: Option<u64>,
    /// Whether the newest usable command, or the kernel at its destination, asks for standstill: the kernel is then on
    /// its ramp, although nothing was refused.
    rest_wanted: bool,
}

impl Brake {
    pub(super) fn new() -> Self {
        Self {
            ledger: Ledger::new("BRAKE"),
            ramp: None,
            // Nothing was ever sent: the drive rests.
            before: SetPoint::Twist { v: 0.0, omega: 0.0 },
            before_us: None,
            rest_wanted: false,
        }
    }

    fn hear(&mut self, tick: &Tick<'_>) {
        if let Some(command) = tick.inputs.command
            && tick.newest.command == Some(command.stamp_us)
        {
            let motion = command.motion;
            self.rest_wanted = motion.speed() == 0.0 && motion.turn_rate() == 0.0;
        }
        if tick.inputs.order_us.is_some() {
            self.rest_wanted = tick.decision.wants_rest;
        }
    }

    pub(super) fn tick(&mut self, robot: &Robot, tick: &Tick<'_>) {
        self.hear(tick);
        // A ramp that began with the wish to stand goes on when something is refused; it does not begin again.
        let brakes = tick.decision.action >= Action::Brake || self.rest_wanted;
        let moved = self.before.speed() != 0.0 || self.before.turn_rate() != 0.0;
        self.ledger.judged(brakes && moved);
        let passed_us = self
            .before_us
            .map_or(0, |before| tick.now_us.saturating_sub(before));
        self.ramp = match self.ramp {
            Some(ramp) if brakes => Some(Ramp {
                spent_us: ramp.spent_us + passed_us,
                ..ramp
            }),
            None if brakes => Some(Ramp {
                from: self.before,
                spent_us: 0,
            }),
            _ => None,
        };
        let now = tick.decision.set_point;
        if let Some(ramp) = self.ramp {
            let ahead_us = tick.decision.expires_us.saturating_sub(tick.now_us);
            let spent_s = (ramp.spent_us + ahead_us) as f64 * 1e-6;
            let found = too_fast(robot, ramp.from, now, spent_s).or_else(|| bent(self.before, now));
            if let Some(what) = found {
                self.ledger.violated(tick.t_s, what);
            }
        }
        self.before = now;
        self.before_us = self.before_us.max(Some(tick.now_us));
    }
}

/// BRAKE-01, -05, -07: more than a ramp at the sure decelerations leaves of `from` after `spent_s`.
fn too_fast(robot: &Robot, from: SetPoint, now: SetPoint, spent_s: f64) -> Option<String> {
    let limits = &robot.values.limits;
    let (v, omega) = (from.speed().abs(), from.turn_rate().abs());
    let mut whole_s = v / limits.braking_mps2;
    // The wheels hold the arc of a steered robot: its turn rate ends with its speed.
    if matches!(from, SetPoint::Twist { .. }) {
        whole_s = whole_s.max(omega / limits.angular_braking_radps2);
    }
    let left = if whole_s > spent_s {
        1.0 - spent_s / whole_s
    } else {
        0.0
    };
    let over = now.speed().abs() > v * left + ROUNDING
        || (matches!(now, SetPoint::Twist { .. })
            && now.turn_rate().abs() > omega * left + ROUNDING);
    over.then(|| {
        format!(
            "braking from {v:.4} m/s and {omega:.4} rad/s, {:.4} m/s and {:.4} rad/s are sent for up to {spent_s:.3} s \
             after the first braking tick; the sure decelerations leave {:.4} and {:.4}",
            now.speed().abs(),
            now.turn_rate().abs(),
            v * left,
            omega * left
        )
    })
}

/// BRAKE-03, -04: a set point that leaves the arc of the one before.
fn bent(before: SetPoint, now: SetPoint) -> Option<String> {
    let leaves = match (before, now) {
        (
            SetPoint::Twist { v, omega },
            SetPoint::Twist {
                v: to_v,
                omega: to_omega,
            },
        ) => {
            // Each of the two is off by at most the rounding.
            (to_v * omega - to_omega * v).abs() > ROUNDING * (v.abs() + omega.abs() + ROUNDING)
        }
        (SetPoint::Arc { curvature, v }, SetPoint::Arc { curvature: to, .. }) => {
            v != 0.0 && (to - curvature).abs() > ROUNDING
        }
        // Before the first tick nothing was sent, in no form.
        _ => false,
    };
    leaves.then(|| format!("braking leaves the arc: {before:?}, then {now:?}"))
}
