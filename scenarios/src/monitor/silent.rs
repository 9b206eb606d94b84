//! SILENT: decisions expire, late ticks and a standing clock stop the robot.

use haltline::decision::Action;
use haltline_robots::Robot;

use super::{Ledger, Tick};

pub(super) struct Silent {
    pub(super) ledger: Ledger,
    before_us: Option<u64>,
}

impl Silent {
    pub(super) fn new() -> Self {
        Self {
            ledger: Ledger::new("SILENT"),
            before_us: None,
        }
    }

    /// Returns whether the tick is late or a repetition.
    pub(super) fn tick(&mut self, robot: &Robot, tick: &Tick<'_>) -> bool {
        let timing = &robot.values.timing;
        let patience_us = ((timing.period_s + timing.jitter_s) * 1e6).round() as u64;
        let expires_us = tick.decision.expires_us;
        let allowed_us = tick.now_us + patience_us;
        if expires_us > allowed_us {
            self.ledger.violated(
                tick.t_s,
                format!(
                    "the decision expires {} us after its tick, {patience_us} are allowed",
                    expires_us - tick.now_us
                ),
            );
        }
        let late = self
            .before_us
            .is_some_and(|before| tick.now_us <= before || tick.now_us > before + patience_us);
        if late && tick.decision.action < Action::ProtectiveStop {
            self.ledger.violated(
                tick.t_s,
                format!(
                    "a late or repeated tick was answered with {:?}",
                    tick.decision.action
                ),
            );
        }
        self.ledger.judged(late || tick.decision.moves());
        self.before_us = Some(tick.now_us);
        late
    }
}
