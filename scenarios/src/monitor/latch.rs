//! LATCH: stops hold until they may be released, and release never replays an old command.

use haltline::decision::{Action, StopStatus};
use haltline_robots::Robot;

use super::{Ledger, Tick};
use crate::drive::SetPoint;

/// Rounding of the kernel's integers, m/s and rad/s.
const ROUNDING: f64 = 5e-6;

pub(super) struct Latch {
    pub(super) ledger: Ledger,
    latched: bool,
    status: StopStatus,
    released_us: Option<u64>,
    /// The last release of a latched stop: an older order is void.
    unlatched_us: Option<u64>,
    before: Option<SetPoint>,
    /// When a protective stop last had a cause: its first tick, or one whose inputs called for it.
    cause_us: u64,
}

impl Latch {
    pub(super) fn new() -> Self {
        Self {
            ledger: Ledger::new("LATCH"),
            latched: true,
            status: StopStatus::Latched,
            released_us: None,
            unlatched_us: None,
            before: None,
            cause_us: 0,
        }
    }

    /// `caused`: this tick's inputs call for a protective stop.
    pub(super) fn tick(&mut self, robot: &Robot, tick: &Tick<'_>, caused: bool) {
        let decision = tick.decision;
        self.ledger
            .judged(self.latched || self.status != StopStatus::Running);
        let line = tick.inputs.emergency_stop;
        if line {
            self.latched = true;
        } else if self.latched && tick.inputs.reset_us.is_some() && tick.rested {
            self.latched = false;
        }
        let (t_s, action) = (tick.t_s, decision.action);
        if self.latched && action != Action::EmergencyStop {
            let why = if line {
                "line is pulled"
            } else {
                "stop is latched"
            };
            self.ledger.violated(
                t_s,
                format!("the emergency {why}, but the kernel says {action:?}"),
            );
        }
        self.check_release(robot, tick, caused);
        if self.status != StopStatus::Running && decision.status == StopStatus::Running {
            self.released_us = Some(tick.now_us);
            if self.status == StopStatus::Latched {
                self.unlatched_us = Some(tick.now_us);
            }
        }
        self.status = decision.status;
        self.check_replay(tick);
        self.check_growth(tick);
        self.before = Some(decision.set_point);
    }

    /// LATCH-05: a protective stop holds until the robot rests and its cause has been gone for the clear time.
    fn check_release(&mut self, robot: &Robot, tick: &Tick<'_>, caused: bool) {
        let stops = tick.decision.status == StopStatus::Protective;
        if caused || (stops && self.status != StopStatus::Protective) {
            self.cause_us = self.cause_us.max(tick.now_us);
        }
        if self.status != StopStatus::Protective || tick.decision.status != StopStatus::Running {
            return;
        }
        if !tick.rested {
            let what = "a protective stop was released before the robot rested";
            self.ledger.violated(tick.t_s, what.to_owned());
        }
        let gone_s = tick.now_us.saturating_sub(self.cause_us) as f64 * 1e-6;
        let clear_s = robot.values.timing.clear_s;
        if gone_s < clear_s - 1e-6 {
            let what = format!(
                "a protective stop was released {gone_s:.3} s after its last cause, {clear_s} s are the clear time"
            );
            self.ledger.violated(tick.t_s, what);
        }
    }

    /// LATCH-06: after a release only newer commands move the robot.
    fn check_replay(&mut self, tick: &Tick<'_>) {
        if !tick.decision.moves() {
            return;
        }
        let (released, wanted) = match tick.inputs.order_us {
            // A protective stop leaves the operator's order standing.
            Some(order) => (self.unlatched_us, Some(order)),
            None => (self.released_us, tick.newest.command),
        };
        let replayed = match (released, wanted) {
            (Some(released), Some(wanted)) => wanted <= released,
            _ => true,
        };
        if replayed {
            let what = "motion was let through on a command that is not newer than the release";
            self.ledger.violated(tick.t_s, what.to_owned());
        }
    }

    /// LATCH-07: the set point must not grow while a stop is active.
    fn check_growth(&mut self, tick: &Tick<'_>) {
        let Some(before) = self.before else {
            return;
        };
        if tick.decision.action < Action::ProtectiveStop {
            return;
        }
        let now = tick.decision.set_point;
        let grew = |a: f64, b: f64| b.abs() > a.abs() + ROUNDING;
        let turned =
            matches!(now, SetPoint::Twist { .. }) && grew(before.turn_rate(), now.turn_rate());
        if grew(before.speed(), now.speed()) || turned {
            let what = format!("the set point grew during a stop: {before:?} to {now:?}");
            self.ledger.violated(tick.t_s, what);
        }
    }
}
