//! The deterministic engine: 10 ms dynamics, control ticks at the robot's period.

mod host;
mod operator;
mod recorder;
mod vouch;

#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use haltline_robots::{Kinematics, Robot};

use crate::assumption::{self, Broken};
use crate::contact::Judge;
use crate::controller::Controller;
use crate::drive::{Drive, DriveModel};
use crate::faults::Faults;
use crate::file::Scenario;
use crate::math::{Pose, microseconds, seconds};
use crate::noise::{Noise, Stream};
use crate::odometry::{Odometer, RawOdometry};
use crate::populate::populate;
use crate::proposer::GoalDisc;
use crate::result::RunResult;
use crate::sensor::{RawScan, Sensors};
use crate::skid::Slide;
use crate::world::World;
use host::Host;
use recorder::Recorder;

/// Length of a dynamics step.
pub const STEP_US: u64 = 10_000;

/// What a run yields.
#[derive(Clone, Debug)]
pub struct Run {
    /// Everything a report needs.
    pub result: RunResult,
    /// `trace.jsonl`: every dynamics step.
    pub trace: String,
}

/// Sensor data on their way to the host, with arrival times.
#[derive(Debug, Default)]
struct Transit {
    scans: VecDeque<(u64, RawScan)>,
    odometry: VecDeque<(u64, RawOdometry)>,
}

/// Everything that changes during a run.
struct Engine<'a> {
    robot: &'a Robot,
    world: World,
    judge: Judge,
    sensors: Sensors,
    odometer: Odometer,
    drive: Drive,
    slide: Slide,
    goal: Option<GoalDisc>,
    via_m: Vec<[f64; 2]>,
    transit: Transit,
    /// True pose at every dynamics step so far.
    history: Vec<Pose>,
    rest_since_us: Option<u64>,
    /// The newest scan of each scanner that reached the host.
    newest: Vec<Option<RawScan>>,
    /// Origin of the host's clock, for the stamps of all data.
    base_us: u64,
    broken: Vec<Broken>,
}

/// Runs a scenario with `controller` between proposal and drive, or naked without one.
///
/// `robot` must be the scenario's robot with its obstacle speed and host death settings applied
/// (see [`crate::batch::equip`]). The control period must be a multiple of [`STEP_US`].
#[must_use]
pub fn run(scenario: &Scenario, robot: &Robot, controller: Option<Box<dyn Controller>>) -> Run {
    let mut engine = Engine::new(scenario, robot);
    let guarded = controller.is_some();
    let mut host = Host::new(scenario, robot, &engine, controller);
    let mut recorder = Recorder::new(engine.world.bodies(), guarded);
    let end_us = microseconds(scenario.timeout_s.get());
    let mut t_us = 0;
    loop {
        engine.sense(t_us);
        host.step(t_us, &mut engine);
        let distances = engine.distances(t_us);
        let moving = engine.moving();
        let touches = recorder.step(t_us, &engine, &host, &distances, moving);
        for body in touches {
            recorder.judged(body, host.touch(t_us, body, &engine));
        }
        let reached = engine.reached(t_us);
        if reached || t_us >= end_us {
            return finish(recorder, host, &engine, t_us, reached);
        }
        engine.advance(t_us);
        t_us += STEP_US;
    }
}

fn finish(
    recorder: Recorder,
    host: Host<'_>,
    engine: &Engine<'_>,
    t_us: u64,
    reached: bool,
) -> Run {
    let (mut result, trace) = recorder.finish(engine, seconds(t_us), reached);
    host.finish(engine, &mut result);
    Run { result, trace }
}

impl<'a> Engine<'a> {
    fn new(scenario: &Scenario, robot: &'a Robot) -> Self {
        let world = populate(scenario);
        let start = &scenario.start;
        let steered = matches!(robot.values.kinematics, Kinematics::Ackermann(_));
        let odometer = Odometer::new(robot, scenario, Noise::new(scenario.seed, Stream::Odometry));
        Self {
            judge: Judge::new(&robot.values.footprint, &world),
            sensors: Sensors::new(robot, scenario, Noise::new(scenario.seed, Stream::Sensor)),
            drive: Drive::new(
                DriveModel::new(robot, scenario),
                steered,
                [start.linear_mps.get(), start.angular_radps.get()],
            ),
            slide: Slide::new(scenario),
            goal: GoalDisc::of(scenario),
            via_m: scenario.via_m(),
            transit: Transit::default(),
            history: vec![Pose::new(
                start.x_m.get(),
                start.y_m.get(),
                start.heading_deg.get().to_radians(),
            )],
            rest_since_us: Some(0),
            newest: vec![None; robot.values.scanners.len()],
            base_us: Faults::clock_base_us(scenario),
            broken: assumption::broken(robot, scenario, &world, odometer.error),
            odometer,
            robot,
            world,
        }
    }

    /// True pose now.
    fn pose(&self) -> Pose {
        self.history.last().copied().unwrap_or_default()
    }

    /// True pose at any time up to now.
    fn pose_at(&self, t_us: u64) -> Pose {
        let index = (t_us / STEP_US) as usize;
        let part = (t_us % STEP_US) as f64 / STEP_US as f64;
        let from = self.history.get(index).copied().unwrap_or(self.pose());
        let to = self.history.get(index + 1).copied().unwrap_or(from);
        from.towards(&to, part)
    }

    /// Whether the robot moves faster than its rest thresholds.
    fn moving(&self) -> bool {
        let [v, omega] = self.drive.ground();
        let tolerances = &self.robot.values.tolerances;
        v.abs() > tolerances.rest_speed_mps || omega.abs() > tolerances.rest_angular_speed_radps
    }

    /// Whether it has been at rest for `span_s`.
    fn rested(&self, t_us: u64, span_s: f64) -> bool {
        self.rest_since_us
            .is_some_and(|since| t_us - since >= microseconds(span_s))
    }

    fn reached(&self, t_us: u64) -> bool {
        let rested = || self.rested(t_us, self.robot.values.timing.rest_s);
        self.goal
            .is_some_and(|goal| goal.holds(&self.pose()) && (!goal.at_rest || rested()))
    }

    fn distances(&self, t_us: u64) -> Vec<f64> {
        self.judge
            .distances(&self.world, &self.pose(), seconds(t_us))
    }

    /// Triggers, sweeps and odometry samples that are complete at `t_us`.
    fn sense(&mut self, t_us: u64) {
        let pose = self.pose();
        self.world.observe_robot(seconds(t_us), pose.x);
        if self.moving() {
            self.rest_since_us = None;
        } else if self.rest_since_us.is_none() {
            self.rest_since_us = Some(t_us);
        }
        let history = &self.history;
        let pose_at = |at_us: u64| {
            let index = (at_us / STEP_US) as usize;
            let part = (at_us % STEP_US) as f64 / STEP_US as f64;
            let from = history.get(index).copied().unwrap_or(pose);
            let to = history.get(index + 1).copied().unwrap_or(from);
            from.towards(&to, part)
        };
        for (arrival, mut scan) in self.sensors.sweep(t_us, &self.world, &pose_at) {
            scan.stamp_us += self.base_us;
            self.transit.scans.push_back((arrival, scan));
        }
        if let Some((arrival, mut sample)) = self.odometer.sample(t_us) {
            sample.stamp_us += self.base_us;
            self.transit.odometry.push_back((arrival, sample));
        }
    }

    /// What has arrived at the host by `t_us`.
    fn receive(&mut self, t_us: u64, faults: &mut Faults) -> (Vec<RawScan>, Option<RawOdometry>) {
        let scans = arrived(&mut self.transit.scans, t_us);
        let scans = faults.scans(t_us, scans);
        for scan in &scans {
            if let Some(newest) = self.newest.get_mut(scan.scanner) {
                *newest = Some(scan.clone());
            }
        }
        let samples = arrived(&mut self.transit.odometry, t_us);
        let odometry = samples
            .into_iter()
            .filter_map(|sample| faults.odometry(t_us, sample))
            .last();
        (scans, odometry)
    }

    /// Integrates drive, pose and odometer over one step.
    fn advance(&mut self, t_us: u64) {
        let dt_s = STEP_US as f64 * 1e-6;
        let moved = self.drive.step(t_us, dt_s);
        let [v, omega] = moved.ground;
        let slid = self.slide.step(t_us, dt_s, self.moving());
        let pose = self.pose().advance(v, omega, dt_s).then(slid);
        self.history.push(pose);
        let curvature = self.drive.curvature();
        self.odometer
            .advance(moved.wheels, self.drive.wheels(), curvature, dt_s);
        self.odometer.slide(slid);
    }
}

/// Takes what arrived by `t_us` from the front of a queue.
fn arrived<T>(queue: &mut VecDeque<(u64, T)>, t_us: u64) -> Vec<T> {
    let count = queue.iter().take_while(|(when, _)| *when <= t_us).count();
    queue.drain(..count).map(|(_, item)| item).collect()
}
