//! Small worlds and controllers that tests of several modules share.

use haltline::decision::{Action, Decision, Reason, StopStatus};
use haltline::input::{Inputs, Motion, Reading, Twist};
use haltline::time::{Duration, Instant};
use haltline_robots::Robot;

use crate::batch::{Case, equip};
use crate::controller::Controller;
use crate::file::{Scenario, parse};

/// A closed room with a wall 3 m ahead, towards which the script drives at 0.5 m/s.
pub(crate) const ROOM: &str = r#"title = "Room"
requirements = ["GUARD-01"]
robot = "seekur_jr"
obstacle_speed_mps = 0.0
seed = 5
timeout_s = 10.0

[[box]]
name = "target"
center_m = [3.25, 0.0]
size_m = [0.5, 1.0]

[[wall]]
from_m = [-4.0, 3.0]
to_m = [6.0, 3.0]

[[wall]]
from_m = [-4.0, -3.0]
to_m = [6.0, -3.0]

[[wall]]
from_m = [6.0, -3.0]
to_m = [6.0, 3.0]

[[wall]]
from_m = [-4.0, -3.0]
to_m = [-4.0, 3.0]

[proposer]
kind = "script"

[[proposer.step]]
until_s = 30.0
linear_mps = 0.5

[expect]
blocked = true
"#;

pub(crate) fn scenario(text: &str) -> Scenario {
    parse(text, "test.toml", "test")
        .expect("the test's scenario is good")
        .remove(0)
}

pub(crate) fn robot() -> Robot {
    Robot::embedded("seekur_jr").expect("the shipped robot is good")
}

pub(crate) fn case(text: &str) -> Case {
    equip(scenario(text), &robot()).expect("the robot can be equipped")
}

/// A controller that passes every command on at once and claims to be content.
pub(crate) struct PassThrough {
    pub(crate) last: Motion,
    /// What it says about the expiry.
    pub(crate) patience: Duration,
    /// Whether it waits for a reset before it moves.
    pub(crate) waits: bool,
}

impl Default for PassThrough {
    fn default() -> Self {
        Self {
            last: Motion::Twist(Twist::default()),
            patience: Duration::from_ms(42),
            waits: true,
        }
    }
}

impl Controller for PassThrough {
    fn step(&mut self, inputs: &Inputs<'_>, now: Instant) -> Decision {
        let waiting = self.waits && inputs.reset.is_none();
        if let (false, Reading::Value(command)) = (waiting, inputs.command) {
            self.last = command.motion;
        }
        self.waits = waiting;
        let (action, reason, status) = if waiting {
            (Action::EmergencyStop, Reason::Startup, StopStatus::Latched)
        } else {
            (Action::Pass, Reason::None, StopStatus::Running)
        };
        Decision {
            action,
            setpoint: self.last,
            reason,
            status,
            expires: now.plus(self.patience),
            verdict: None,
            factor_permille: 1000,
        }
    }
}
