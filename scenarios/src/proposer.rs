//! Whoever wants to move: a script, or a reckless driver who avoids nothing.

use haltline_robots::{Kinematics, Robot};

use crate::drive::SetPoint;
use crate::file::value::floats;
use crate::file::{ProposerKind, Scenario, Step};
use crate::math::{Pose, wrap};

/// A desired motion as it leaves the planner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawCommand {
    /// Stamp, microseconds.
    pub stamp_us: u64,
    /// What is wanted.
    pub motion: SetPoint,
}

/// Where the driver wants to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoalDisc {
    /// Centre.
    pub centre: [f64; 2],
    /// Radius.
    pub radius: f64,
}

impl GoalDisc {
    /// The scenario's goal.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Option<Self> {
        scenario.goal.map(|goal| Self {
            centre: floats(goal.position_m),
            radius: goal.radius_m.get(),
        })
    }

    /// Whether the rotation centre is inside.
    #[must_use]
    pub fn holds(&self, pose: &Pose) -> bool {
        libm::hypot(self.centre[0] - pose.x, self.centre[1] - pose.y) <= self.radius
    }
}

/// Proposes a motion at every tick.
#[derive(Clone, Debug)]
pub struct Driver {
    kind: ProposerKind,
    steps: Vec<Step>,
    goal: Option<GoalDisc>,
    speed: f64,
    gain: f64,
    turn_rate_max: f64,
    curvature_max: Option<f64>,
}

impl Driver {
    /// The driver of a scenario.
    #[must_use]
    pub fn new(robot: &Robot, scenario: &Scenario) -> Self {
        let proposer = scenario.proposer.get_ref();
        Self {
            kind: proposer.kind,
            steps: proposer.step.iter().map(|step| *step.get_ref()).collect(),
            goal: GoalDisc::of(scenario),
            speed: proposer.speed_mps.map_or(0.0, |v| v.get()),
            gain: proposer.heading_gain_per_s.map_or(1.5, |v| v.get()),
            turn_rate_max: robot.values.limits.angular_speed_radps,
            curvature_max: match robot.values.kinematics {
                Kinematics::Differential => None,
                Kinematics::Ackermann(steering) => Some(1.0 / steering.turning_radius_m),
            },
        }
    }

    /// What it wants at `pose`, `since_s` after the robot was first allowed to move.
    #[must_use]
    pub fn propose(&self, pose: &Pose, since_s: f64) -> SetPoint {
        match self.kind {
            ProposerKind::Reckless => self.charge(pose),
            ProposerKind::Script => self.play(since_s),
        }
    }

    /// A command that asks for standstill.
    #[must_use]
    pub fn rest(&self) -> SetPoint {
        self.motion(0.0, 0.0, 0.0)
    }

    /// Straight for the goal; turns on the spot first where the goal lies behind.
    fn charge(&self, pose: &Pose) -> SetPoint {
        let Some(goal) = self.goal else {
            return self.rest();
        };
        let [dx, dy] = [goal.centre[0] - pose.x, goal.centre[1] - pose.y];
        let error = wrap(libm::atan2(dy, dx) - pose.theta);
        let omega = (self.gain * error).clamp(-self.turn_rate_max, self.turn_rate_max);
        let v = match self.curvature_max {
            None if error.abs() > 0.8 => 0.0,
            _ => self.speed,
        };
        let curvature = if v > 0.0 { omega / v } else { 0.0 };
        self.motion(v, omega, curvature)
    }

    fn play(&self, since_s: f64) -> SetPoint {
        let current = self.steps.iter().find(|step| since_s < step.until_s.get());
        let Some(step) = current else {
            return self.rest();
        };
        let v = step.linear_mps.get();
        let curvature = step.curvature_per_m.map_or(0.0, |k| k.get());
        let omega = step.angular_radps.map_or(v * curvature, |w| w.get());
        self.motion(v, omega, curvature)
    }

    fn motion(&self, v: f64, omega: f64, curvature: f64) -> SetPoint {
        match self.curvature_max {
            None => SetPoint::Twist { v, omega },
            Some(max) => SetPoint::Arc {
                v,
                curvature: curvature.clamp(-max, max),
            },
        }
    }
}
