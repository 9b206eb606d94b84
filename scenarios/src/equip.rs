//! Robot and scenario meet: what the file says about the robot is applied, and what does not fit refused.

use std::collections::BTreeMap;

use haltline_robots::{Change, Kinematics, Robot};
use toml::{Spanned, Value};

use crate::contact::Judge;
use crate::controller::RobotKernel;
use crate::engine::STEP_US;
use crate::file::{Scenario, ScenarioError};
use crate::math::Pose;
use crate::pilot::{Pilot, PilotError};
use crate::populate::populate;

/// A scenario with its robot, ready to run.
#[derive(Clone, Debug)]
pub struct Case {
    /// The scenario.
    pub scenario: Scenario,
    /// Its robot, with the scenario's values, obstacle speed and host death settings.
    pub robot: Robot,
    /// What the kernel is told about the robot: the truth, or with the values of `[told]`.
    pub told: Robot,
    /// Where the robot differs from its file; keys of `[told]` begin with `told.`.
    pub changes: Vec<Change>,
}

/// Keys that a scenario states in their own place.
const OWN_KEYS: [(&str, &str); 2] = [
    ("obstacles.speed_mps", "obstacle_speed_mps"),
    ("host_death.cover_host_death", "cover_host_death"),
];

/// Applies what a scenario says about the robot.
///
/// # Errors
/// A value that the rules of robot files refuse, a robot that stands on a body at the start, a script
/// that its drive cannot follow, an obstacle speed that does not fit the kernel, a robot that the kernel
/// refuses, or a control period that is no multiple of a dynamics step.
pub fn equip(scenario: Scenario, robot: &Robot) -> Result<Case, ScenarioError> {
    let wrong = |path: &str, message: String| scenario.places.complain(path, message);
    let mut changes = changes(&scenario)?;
    let equipped = ordered(&scenario, changed(&scenario, robot, &mut changes)?)?;
    let told = told(&scenario, robot, &equipped, &mut changes)?;
    check_steps(&scenario, &equipped)?;
    if let Some((path, body)) = overlapped(&scenario, &equipped) {
        let message = format!(
            "the robot stands on {body} at the start; move the body, or write another [start]"
        );
        return Err(wrong(&path, message));
    }
    let period_us = crate::math::microseconds(equipped.values.timing.period_s);
    if period_us == 0 || !period_us.is_multiple_of(STEP_US) {
        let message = format!(
            "the control period of {} is {period_us} us; the simulator needs a multiple of {STEP_US} us",
            robot.name
        );
        return Err(wrong("robot_values.timing.period_s", message));
    }
    check_kernel(&scenario, &told)?;
    changes.retain(Change::differs);
    Ok(Case {
        scenario,
        robot: equipped,
        told,
        changes,
    })
}

/// Obstacle speed and host death as the scenario orders them.
fn ordered(scenario: &Scenario, robot: Robot) -> Result<Robot, ScenarioError> {
    let wrong = |message: String| scenario.places.complain("", message);
    let speed = scenario.obstacle_speed_mps.get();
    let robot = robot.with_obstacle_speed(speed).ok_or_else(|| {
        wrong(format!(
            "obstacle_speed_mps = {speed} does not fit the kernel; write at most 10"
        ))
    })?;
    match scenario.cover_host_death {
        None => Ok(robot),
        Some(cover) => robot
            .with_cover_host_death(cover)
            .ok_or_else(|| wrong("cover_host_death does not fit this robot".to_owned())),
    }
}

/// What the kernel is told: the truth, but for the values of `[told]`, which join the changes.
fn told(
    scenario: &Scenario,
    robot: &Robot,
    truth: &Robot,
    changes: &mut Vec<Change>,
) -> Result<Robot, ScenarioError> {
    if scenario.told.is_empty() {
        return Ok(truth.clone());
    }
    let lies = unfolded(&scenario.told);
    let lied = |key: &str| lies.iter().any(|(_, lie)| lie.key == key);
    let mut all: Vec<Change> = changes.iter().filter(|c| !lied(&c.key)).cloned().collect();
    let first = all.len();
    all.extend(lies.iter().map(|(_, lie)| lie.clone()));
    let place = |index: Option<usize>| {
        let blamed = index.and_then(|at| lies.get(at.checked_sub(first)?));
        blamed.map_or_else(String::new, |(head, _)| format!("told.{head}"))
    };
    let told = robot
        .with_changes(&mut all)
        .map_err(|error| scenario.places.complain(&place(error.index), error.message))?;
    changes.extend(all.into_iter().skip(first).map(|lie| Change {
        key: format!("told.{}", lie.key),
        ..lie
    }));
    let speed = told.values.obstacle_speed_mps;
    let told = ordered(scenario, told)?;
    if !lied("obstacles.speed_mps") {
        return Ok(told);
    }
    told.with_obstacle_speed(speed).ok_or_else(|| {
        let message = "obstacles.speed_mps does not fit the kernel; write at most 10".to_owned();
        scenario
            .places
            .complain("told.obstacles.speed_mps", message)
    })
}

/// Whether the kernel takes robot and route. Both pass over the stack, hence a frame of their own.
#[inline(never)]
fn check_kernel(scenario: &Scenario, robot: &Robot) -> Result<(), ScenarioError> {
    let places = &scenario.places;
    if scenario.navigates() {
        return match Pilot::new(scenario, robot) {
            Ok(_) => Ok(()),
            Err(error) => Err(places.complain("proposer", refused(&error))),
        };
    }
    match RobotKernel::new(robot.config) {
        Ok(_) => Ok(()),
        Err(error) => {
            let message = format!("the kernel refuses {}: {error:?}", robot.name);
            Err(places.complain("", message))
        }
    }
}

/// A route or planning that the kernel cannot take, in words.
fn refused(error: &PilotError) -> String {
    match error {
        PilotError::Route => {
            "the kernel cannot hold a place or tolerance of the route; write metres \
                              within 2000 of the start"
                .to_owned()
        }
        PilotError::Navigator(error) => {
            format!(
                "the kernel refuses to navigate like this: {error:?}; write other values into [proposer.navigate]"
            )
        }
    }
}

/// A table of dotted keys as changes, each with the key it stands under; nested tables spell dotted keys.
fn unfolded(table: &BTreeMap<Spanned<String>, Value>) -> Vec<(&str, Change)> {
    let mut found = Vec::new();
    for (key, value) in table {
        let key = key.get_ref();
        let mut open = vec![(key.clone(), value)];
        while let Some((path, value)) = open.pop() {
            match value {
                Value::Table(table) => {
                    let inner = table.iter().rev();
                    open.extend(inner.map(|(name, value)| (format!("{path}.{name}"), value)));
                }
                plain => found.push((key.as_str(), Change::new(&path, &plain.to_string()))),
            }
        }
    }
    found
}

/// The table `[robot_values]` as changes.
fn changes(scenario: &Scenario) -> Result<Vec<Change>, ScenarioError> {
    let found = unfolded(&scenario.robot_values);
    for (key, change) in &found {
        if let Some((_, own)) = OWN_KEYS.iter().find(|(path, _)| *path == change.key) {
            let message = format!(
                "`{}` has its own key in a scenario; write {own}",
                change.key
            );
            let path = format!("robot_values.{key}");
            return Err(scenario.places.complain(&path, message));
        }
    }
    Ok(found.into_iter().map(|(_, change)| change).collect())
}

fn changed(
    scenario: &Scenario,
    robot: &Robot,
    changes: &mut [Change],
) -> Result<Robot, ScenarioError> {
    if changes.is_empty() {
        return Ok(robot.clone());
    }
    robot.with_changes(changes).map_err(|error| {
        let blamed = error
            .index
            .and_then(|index| changes.get(index))
            .or(changes.first());
        let place = blamed.map_or_else(String::new, |change| place_of(scenario, &change.key));
        scenario.places.complain(&place, error.message)
    })
}

/// Place of the entry of `[robot_values]` that spells `key`, which may be the head of nested tables.
fn place_of(scenario: &Scenario, key: &str) -> String {
    let spelt = |head: &str| key == head || key.starts_with(&format!("{head}."));
    let mut keys = scenario.robot_values.keys().map(toml::Spanned::get_ref);
    let head = keys.find(|head| spelt(head)).map_or("", String::as_str);
    format!("robot_values.{head}")
}

/// A steered robot cannot follow a turn rate: it has none at standstill.
fn check_steps(scenario: &Scenario, robot: &Robot) -> Result<(), ScenarioError> {
    if robot.values.kinematics == Kinematics::Differential {
        return Ok(());
    }
    let mut steps = scenario.proposer.get_ref().step.iter().enumerate();
    match steps.find(|(_, step)| step.get_ref().angular_radps.is_some()) {
        None => Ok(()),
        Some((index, _)) => {
            let message = format!(
                "{} steers by its wheels and has no turn rate to command; write curvature_per_m instead \
                 of angular_radps",
                robot.name
            );
            Err(scenario.places.complain(&format!("step.{index}"), message))
        }
    }
}

/// Place and name of a body that the footprint overlaps before anything has moved.
fn overlapped(scenario: &Scenario, robot: &Robot) -> Option<(String, String)> {
    let world = populate(scenario);
    let judge = Judge::new(&robot.values.footprint, &world);
    let start = &scenario.start;
    let heading = start.heading_deg.get().to_radians();
    let pose = Pose::new(start.x_m.get(), start.y_m.get(), heading);
    let distances = judge.distances(&world, &pose, 0.0);
    let index = distances.iter().position(|distance| *distance <= 0.0)?;
    let name = world.bodies().get(index).map(|body| body.name.clone())?;
    // The world holds walls, then boxes, then circles.
    let (walls, boxes) = (scenario.wall.len(), scenario.boxes.len());
    let path = match index {
        wall if wall < walls => format!("wall.{wall}"),
        within if within < walls + boxes => format!("box.{}", within - walls),
        circle => format!("circle.{}", circle - walls - boxes),
    };
    Some((path, name))
}

#[cfg(test)]
mod tests;
