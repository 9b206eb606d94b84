//! The kernel at the wheel: a goal instead of somebody's commands.

use std::io;

use haltline::convert::{self, Round};
use haltline::decision::Decision;
use haltline::input::Inputs;
use haltline::kernel::navigate::{Destination, Navigation, Planning, Route};
use haltline::time::Instant;
use haltline_robots::Robot;
use haltline_scenarios::controller::Controller;
use haltline_scenarios::math::Pose;
use haltline_scenarios::navigation::Said;
use haltline_scenarios::pilot::{RobotNavigator, boxed, said};

/// The goal counts as reached within this distance and angle.
const NEAR_M: f64 = 0.15;
const HEADING_RAD: f64 = 0.1;
struct Goal {
    navigator: Box<RobotNavigator>,
    goal: Destination,
    ordered: Option<Instant>,
    answer: Option<Navigation>,
}

/// A controller that drives to `[x, y]`, metres in the odometry frame, and takes the heading there
/// (radians) if one is given.
///
/// # Errors
/// The kernel refuses the robot, or the goal does not fit its integers.
pub fn navigate(
    robot: &Robot,
    [x_m, y_m]: [f64; 2],
    heading_rad: Option<f64>,
) -> io::Result<Box<dyn Controller>> {
    let bad = |what: String| io::Error::new(io::ErrorKind::InvalidInput, what);
    let place = |metres| convert::length(metres, Round::Nearest).map(|um| i64::from(um.as_um()));
    let heading = match heading_rad {
        Some(angle) => convert::angle(angle).map(Some),
        None => Some(None),
    };
    let goal = || {
        Some(Destination {
            x_um: place(x_m)?,
            y_um: place(y_m)?,
            tolerance: convert::length(NEAR_M, Round::Nearest)?,
            heading: heading?,
            heading_tolerance: convert::angle(HEADING_RAD)?.as_counts(),
        })
    };
    let goal = goal().ok_or_else(|| bad(format!("no goal the kernel can hold: {x_m}, {y_m}")))?;
    let navigator = boxed(robot, Planning::default())
        .map_err(|error| bad(format!("the kernel refuses: {error:?}")))?;
    Ok(Box::new(Goal {
        navigator,
        goal,
        ordered: None,
        answer: None,
    }))
}

impl Controller for Goal {
    fn order(&mut self, stamp: Option<Instant>) {
        self.ordered = stamp;
    }

    fn via_points(&self) -> Option<usize> {
        Some(0)
    }

    fn step(&mut self, inputs: &Inputs<'_>, now: Instant) -> Decision {
        let route = self.ordered.map(|stamp| Route {
            stamp,
            id: 1,
            via: &[],
            goal: self.goal,
            ..Route::default()
        });
        let answer = self.navigator.step(inputs, route.as_ref(), now);
        self.answer = Some(answer);
        answer.decision
    }

    fn said(&self, pose: &Pose, base_us: u64) -> Option<Said> {
        Some(said(&self.answer?, pose, base_us))
    }
}
