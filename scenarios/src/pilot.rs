//! The kernel at the wheel: its navigator with a scenario's route, behind the common trait.

use haltline::Navigator;
use haltline::convert::{self, Round};
use haltline::decision::Decision;
use haltline::dwa::Tuning;
use haltline::input::Inputs;
use haltline::kernel::navigate::{
    Destination, Navigation, NavigatorError, Obstruction, Planning, Progress, ProgressRules, Route,
    Via,
};
use haltline::time::Instant;
use haltline::units::Length;
use haltline_robots::{BEAMS, MEMORY, Robot, SCANNERS};

use crate::controller::{Controller, remembered};
use crate::file::{Navigate, Scenario};
use crate::math::{Pose, seconds};
use crate::navigation::{ProgressRecord, Said};

/// The navigator at the capacities of the robot files.
pub type RobotNavigator = Navigator<SCANNERS, BEAMS, MEMORY>;

/// A via point counts as passed within this distance where the scenario says nothing.
const VIA_TOLERANCE_M: f64 = 0.3;
/// A goal counts as reached within this part of its radius where the scenario says nothing.
const GOAL_TOLERANCE_PART: f64 = 1.0 / 3.0;
/// A heading counts as taken within this angle where the scenario says nothing.
const HEADING_TOLERANCE_DEG: f64 = 5.0;

/// A navigator on the way along a scenario's route.
pub struct Pilot {
    navigator: Box<RobotNavigator>,
    via: Vec<Via>,
    goal: Destination,
    /// When the operator last ordered the route.
    ordered: Option<Instant>,
    said: Option<Navigation>,
}

/// Why a scenario's route cannot be driven.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PilotError {
    /// There is no goal, or a place or tolerance does not fit the kernel's integers.
    Route,
    /// The navigator refuses robot or planning.
    Navigator(NavigatorError),
}

impl Pilot {
    /// The navigator of `robot` with the scenario's route, which starts at the scenario's start.
    ///
    /// # Errors
    /// No goal, numbers that the kernel cannot hold, or a planning it refuses.
    pub fn new(scenario: &Scenario, robot: &Robot) -> Result<Self, PilotError> {
        let navigate = scenario.proposer.get_ref().navigate.unwrap_or_default();
        let tolerance_m = navigate
            .via_tolerance_m
            .map_or(VIA_TOLERANCE_M, |v| v.get());
        let frame = odometry_frame(scenario);
        let via = |point: [f64; 2]| {
            let [x_um, y_um] = micrometres(frame.apply_inverse(point))?;
            Some(Via {
                x_um,
                y_um,
                tolerance: convert::length(tolerance_m, Round::Nearest)?,
            })
        };
        let points = scenario.via_m();
        let via: Option<Vec<Via>> = points.into_iter().map(via).collect();
        Ok(Self {
            navigator: boxed(robot, planning(&navigate)?).map_err(PilotError::Navigator)?,
            via: via.ok_or(PilotError::Route)?,
            goal: destination(scenario, &navigate, &frame).ok_or(PilotError::Route)?,
            ordered: None,
            said: None,
        })
    }
}

/// Stack on which a navigator is put together: some copies of it, which unoptimised builds make.
const BUILDER_STACK: usize = 16 << 20;

/// A navigator on the heap. It is put together on the stack first, so on a thread that has enough.
///
/// # Errors
/// What [`Navigator::new`] refuses.
pub fn boxed(robot: &Robot, planning: Planning) -> Result<Box<RobotNavigator>, NavigatorError> {
    let config = robot.config;
    let make = move || RobotNavigator::new(config, planning).map(Box::new);
    match std::thread::Builder::new()
        .stack_size(BUILDER_STACK)
        .spawn(make)
    {
        Ok(builder) => builder
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
        // No thread to be had: this one may do.
        Err(_) => make(),
    }
}

/// The odometry starts at zero where the robot starts.
fn odometry_frame(scenario: &Scenario) -> Pose {
    let start = &scenario.start;
    Pose::new(
        start.x_m.get(),
        start.y_m.get(),
        start.heading_deg.get().to_radians(),
    )
}

fn micrometres(point: [f64; 2]) -> Option<[i64; 2]> {
    let um = |metres: f64| convert::length(metres, Round::Nearest).map(|um| i64::from(um.as_um()));
    let [x, y] = point.map(um);
    Some([x?, y?])
}

fn destination(scenario: &Scenario, navigate: &Navigate, frame: &Pose) -> Option<Destination> {
    let goal = scenario.goal?;
    let [x_um, y_um] =
        micrometres(frame.apply_inverse(crate::file::value::floats(goal.position_m)))?;
    let tolerance_m = navigate
        .goal_tolerance_m
        .map_or(GOAL_TOLERANCE_PART * goal.radius_m.get(), |v| v.get());
    let angle = navigate
        .heading_tolerance_deg
        .map_or(HEADING_TOLERANCE_DEG, |v| v.get());
    let heading = match navigate.goal_heading_deg {
        Some(heading) => Some(convert::angle(heading.get().to_radians() - frame.theta)?),
        None => None,
    };
    let tolerance: Length = convert::length(tolerance_m, Round::Nearest)?;
    Some(Destination {
        x_um,
        y_um,
        tolerance,
        heading,
        heading_tolerance: convert::angle(angle.to_radians())?.as_counts(),
    })
}

fn planning(navigate: &Navigate) -> Result<Planning, PilotError> {
    let own = Planning::default();
    let preset = own.tuning;
    let or = |given: Option<f64>, preset: f64| given.unwrap_or(preset);
    let angle = |given: Option<f64>, preset: f64| given.map_or(preset, f64::to_radians);
    let plain = |v: crate::file::value::NonNegative| v.get();
    let tuning = Tuning {
        heading_weight: or(navigate.heading_weight.map(plain), preset.heading_weight),
        clearance_weight: or(
            navigate.clearance_weight.map(plain),
            preset.clearance_weight,
        ),
        speed_weight: or(navigate.speed_weight.map(plain), preset.speed_weight),
        lookahead_s: or(navigate.lookahead_s.map(|v| v.get()), preset.lookahead_s),
        clearance_range_m: or(
            navigate.clearance_range_m.map(|v| v.get()),
            preset.clearance_range_m,
        ),
        goal_near_m: or(navigate.goal_near_m.map(plain), preset.goal_near_m),
        object_near_m: or(navigate.object_near_m.map(plain), preset.object_near_m),
        comfort: or(navigate.comfort.map(|v| v.get()), preset.comfort),
        creep_mps: or(navigate.creep_mps.map(plain), preset.creep_mps),
        start_m: or(navigate.start_m.map(plain), preset.start_m),
        turn_first_rad: angle(navigate.turn_first_deg.map(plain), preset.turn_first_rad),
        aligned_rad: angle(navigate.aligned_deg.map(plain), preset.aligned_rad),
    };
    let rules = own.progress;
    let time = match navigate.give_up_s {
        Some(time) => convert::duration(time.get(), Round::Up).ok_or(PilotError::Route)?,
        None => rules.time,
    };
    Ok(Planning {
        tuning,
        progress: ProgressRules {
            distance_m: or(navigate.nearer_m.map(plain), rules.distance_m),
            time,
        },
    })
}

impl Controller for Pilot {
    fn order(&mut self, stamp: Option<Instant>) {
        self.ordered = stamp;
    }

    fn step(&mut self, inputs: &Inputs<'_>, now: Instant) -> Decision {
        let route = self.ordered.map(|stamp| Route {
            stamp,
            id: 1,
            via: &self.via,
            goal: self.goal,
            ..Route::default()
        });
        let answer = self.navigator.step(inputs, route.as_ref(), now);
        self.said = Some(answer);
        answer.decision
    }

    fn remembered(&self) -> Vec<[f64; 2]> {
        remembered(self.navigator.kernel())
    }

    fn via_points(&self) -> Option<usize> {
        Some(self.via.len())
    }

    fn said(&self, pose: &Pose, base_us: u64) -> Option<Said> {
        Some(said(&self.said?, pose, base_us))
    }
}

/// A navigator's answer in the words of the results; `pose` is the true pose at that tick,
/// `base_us` the origin of the host's clock.
#[must_use]
pub fn said(answer: &Navigation, pose: &Pose, base_us: u64) -> Said {
    Said {
        progress: progress(&answer.progress, pose, base_us),
        refused: u32::from(answer.refused),
    }
}

/// The kernel's progress in the words of the results, its point in the world.
fn progress(progress: &Progress, pose: &Pose, base_us: u64) -> ProgressRecord {
    let kind = match progress {
        Progress::Idle => "idle",
        Progress::Held => "held",
        Progress::Driving { .. } => "driving",
        Progress::Arrived => "arrived",
        Progress::Blocked(_) => "blocked",
    };
    let mut record = ProgressRecord {
        kind: kind.to_owned(),
        ..ProgressRecord::default()
    };
    match progress {
        Progress::Driving { next } => record.via = Some(*next),
        Progress::Blocked(blocked) => {
            record.reason = Some(reason(blocked.reason));
            record.point_m = blocked.point.map(|point| {
                pose.apply([f64::from(point.x_mm) * 1e-3, f64::from(point.y_mm) * 1e-3])
            });
            record.since_s = Some(seconds(blocked.since.as_us().saturating_sub(base_us)));
        }
        Progress::Idle | Progress::Held | Progress::Arrived => {}
    }
    record
}

/// Name of an obstruction in scenario files and results.
#[must_use]
pub fn reason(obstruction: Obstruction) -> String {
    match obstruction {
        Obstruction::Guard(refusal) => format!("Guard{refusal:?}"),
        other => format!("{other:?}"),
    }
}
