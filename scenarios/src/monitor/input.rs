//! INPUT: a value that cannot be used stops or brakes the robot in the tick that receives it.

use haltline::decision::Action;
use haltline_robots::Robot;

use super::usable::{command_finite, odometry_finite, scan_usable};
use super::{Ledger, Tick};

pub(super) struct Input {
    pub(super) ledger: Ledger,
}

impl Input {
    pub(super) fn new() -> Self {
        Self {
            ledger: Ledger::new("INPUT"),
        }
    }

    /// Returns whether scan or odometry cannot be used; without a command the robot brakes and does not stop.
    pub(super) fn tick(&mut self, robot: &Robot, tick: &Tick<'_>) -> bool {
        let inputs = tick.inputs;
        let bad = [
            (
                "scan",
                inputs.scans.iter().any(|scan| !scan_usable(robot, scan)),
            ),
            (
                "odometry",
                inputs.odometry.is_some_and(|o| !odometry_finite(&o)),
            ),
            (
                "command",
                inputs.command.is_some_and(|c| !command_finite(&c)),
            ),
        ];
        self.ledger.judged(bad.iter().any(|(_, is_bad)| *is_bad));
        for (what, _) in bad.iter().filter(|(_, is_bad)| *is_bad) {
            if tick.decision.action < Action::Brake {
                self.ledger.violated(
                    tick.t_s,
                    format!(
                        "an unusable {what} was answered with {:?}",
                        tick.decision.action
                    ),
                );
            }
        }
        bad.iter()
            .any(|(what, is_bad)| *is_bad && *what != "command")
    }
}
