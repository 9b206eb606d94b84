//! Whoever wants to move: a script, or a reckless driver who avoids nothing.

use haltline_robots::{Kinematics, Robot};

use crate::drive::SetPoint;
use crate::file::value::floats;
use crate::file::{NakedPath, ProposerKind, Scenario, Step};
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
    /// Whether it only counts once the robot rests inside.
    pub at_rest: bool,
}

impl GoalDisc {
    /// The scenario's goal.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Option<Self> {
        scenario.goal.map(|goal| Self {
            centre: floats(goal.position_m),
            radius: goal.radius_m.get(),
            at_rest: goal.at_rest,
        })
    }

    /// Whether the rotation centre is inside.
    #[must_use]
    pub fn holds(&self, pose: &Pose) -> bool {
        libm::hypot(self.centre[0] - pose.x, self.centre[1] - pose.y) <= self.radius
    }
}

/// The naked twin has passed a via point within this distance.
const VIA_PASSED_M: f64 = 0.2;

/// The via points of the naked twin, in the world.
fn naked_via(scenario: &Scenario) -> Vec<[f64; 2]> {
    let path = scenario.naked.as_ref().and_then(|n| n.get_ref().path);
    match path.unwrap_or_default() {
        NakedPath::Goal => Vec::new(),
        NakedPath::Via => scenario.via_m(),
    }
}

/// Proposes a motion at every tick.
#[derive(Clone, Debug)]
pub struct Driver {
    kind: ProposerKind,
    steps: Vec<Step>,
    goal: Option<GoalDisc>,
    /// Points that the naked twin of a navigate scenario passes before it heads for the goal.
    via: Vec<[f64; 2]>,
    /// How many of them lie behind it.
    passed: usize,
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
        let limits = &robot.values.limits;
        let speed = match proposer.kind {
            // Only the naked twin asks: a reckless driver in the kernel's place.
            ProposerKind::Navigate => {
                let naked = scenario.naked.as_ref().and_then(|n| n.get_ref().speed_mps);
                naked.map_or(limits.speed_forward_mps, |v| v.get())
            }
            _ => proposer.speed_mps.map_or(0.0, |v| v.get()),
        };
        Self {
            via: naked_via(scenario),
            passed: 0,
            kind: proposer.kind,
            steps: proposer.step.iter().map(|step| *step.get_ref()).collect(),
            goal: GoalDisc::of(scenario),
            speed,
            gain: proposer.heading_gain_per_s.map_or(1.5, |v| v.get()),
            turn_rate_max: limits.angular_speed_radps,
            curvature_max: match robot.values.kinematics {
                Kinematics::Differential => None,
                Kinematics::Ackermann(steering) => Some(1.0 / steering.turning_radius_m),
            },
        }
    }

    /// What it wants at `pose`, `since_s` after the robot was first allowed to move.
    #[must_use]
    pub fn propose(&mut self, pose: &Pose, since_s: f64) -> SetPoint {
        match self.kind {
            ProposerKind::Reckless | ProposerKind::Navigate => self.charge(pose),
            ProposerKind::Script => self.play(since_s),
        }
    }

    /// A command that asks for standstill.
    #[must_use]
    pub fn rest(&self) -> SetPoint {
        self.motion(0.0, 0.0, 0.0)
    }

    /// Straight for the next point, then the goal; turns on the spot first where that lies behind.
    fn charge(&mut self, pose: &Pose) -> SetPoint {
        let Some(goal) = self.goal else {
            return self.rest();
        };
        let away = |[x, y]: [f64; 2]| libm::hypot(x - pose.x, y - pose.y);
        while self
            .via
            .get(self.passed)
            .is_some_and(|via| away(*via) < VIA_PASSED_M)
        {
            self.passed += 1;
        }
        let [x, y] = self.via.get(self.passed).copied().unwrap_or(goal.centre);
        let [dx, dy] = [x - pose.x, y - pose.y];
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
