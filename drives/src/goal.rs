//! The kernel at the wheel: a goal instead of somebody's commands.

use std::io;

use haltline::Navigator;
use haltline::convert::{self, Round};
use haltline::decision::Decision;
use haltline::input::Inputs;
use haltline::kernel::navigate::{Destination, Planning, Route};
use haltline::time::Instant;
use haltline_robots::{BEAMS, MEMORY, Robot, SCANNERS};
use haltline_scenarios::controller::Controller;

/// Cells of the planning grid along each side: 20 m at 0.1 m.
const CELLS: usize = 200;
/// The goal counts as reached within this distance and angle.
const NEAR_M: f64 = 0.15;
const HEADING_RAD: f64 = 0.1;
/// Stack on which a navigator is put together before it goes to the heap.
const BUILDER_STACK: usize = 16 << 20;

type RobotNavigator = Navigator<SCANNERS, BEAMS, MEMORY, CELLS, CELLS>;

struct Goal {
    navigator: Box<RobotNavigator>,
    goal: Destination,
    ordered: Option<Instant>,
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
    let config = robot.config;
    let builder = std::thread::Builder::new().stack_size(BUILDER_STACK);
    let built = builder
        .spawn(move || RobotNavigator::new(config, Planning::default()).map(Box::new))?
        .join()
        .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    let navigator = built.map_err(|error| bad(format!("the kernel refuses: {error:?}")))?;
    Ok(Box::new(Goal {
        navigator,
        goal,
        ordered: None,
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
        });
        self.navigator.step(inputs, route.as_ref(), now).decision
    }
}
