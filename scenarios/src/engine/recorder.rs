//! Writes down what happens: trace, course, stops, contacts, changes of decision.

use super::{Engine, STEP_US};
use crate::engine::host::Host;
use crate::math::{Pose, seconds, wrap};
use crate::monitor::Judged;
use crate::result::{Contact, DecisionChange, RunResult, Sample, Stop, WorldRecord};
use crate::trace::{TraceStep, push_line};
use crate::world::{Body, pose_record};

/// Dynamics steps between two samples of the course.
const SAMPLE_STEPS: u64 = 10;

/// Seconds between two drawn poses of a moving body.
const BODY_STEP_S: f64 = 0.1;

pub(super) struct Recorder {
    trace: String,
    result: RunResult,
    /// For each body the contact that has not ended yet.
    open: Vec<Option<usize>>,
    names: Vec<String>,
    in_force: (String, String),
    was_moving: bool,
    before: Option<Pose>,
}

impl Recorder {
    pub(super) fn new(bodies: &[Body], guarded: bool) -> Self {
        Self {
            trace: String::new(),
            result: empty(guarded),
            open: vec![None; bodies.len()],
            names: bodies.iter().map(|body| body.name.clone()).collect(),
            in_force: (String::new(), String::new()),
            was_moving: false,
            before: None,
        }
    }

    /// One dynamics step; returns the bodies that a moving robot began to overlap.
    pub(super) fn step(
        &mut self,
        t_us: u64,
        engine: &Engine<'_>,
        host: &Host<'_>,
        distances: &[f64],
        moving: bool,
    ) -> Vec<usize> {
        let (t_s, pose) = (seconds(t_us), engine.pose());
        let clearance = distances.iter().copied().reduce(f64::min);
        self.decision(t_s, &pose, host);
        self.measure(&pose, clearance, moving);
        if self.was_moving && !moving {
            self.result.stops.push(Stop {
                t_s,
                decision: self.in_force.0.clone(),
                reason: self.in_force.1.clone(),
                pose: pose_record(&pose),
                clearance_m: clearance,
            });
        }
        self.was_moving = moving;
        let [v_mps, omega_radps] = engine.drive.ground();
        if (t_us / STEP_US).is_multiple_of(SAMPLE_STEPS) {
            self.result.samples.push(Sample {
                t_s,
                pose: pose_record(&pose),
                v_mps,
                omega_radps,
                clearance_m: clearance,
            });
        }
        push_line(
            &mut self.trace,
            &TraceStep {
                t_s,
                x_m: pose.x,
                y_m: pose.y,
                theta_rad: wrap(pose.theta),
                v_mps,
                omega_radps,
                decision: &self.in_force.0,
                reason: &self.in_force.1,
            },
        );
        self.contacts(t_s, engine, distances, moving)
    }

    fn decision(&mut self, t_s: f64, pose: &Pose, host: &Host<'_>) {
        let (now, point) = match host.decision() {
            Some(record) => (
                (
                    format!("{:?}", record.action),
                    format!("{:?}", record.reason),
                ),
                record.point_m.map(|point| pose.apply(point)),
            ),
            None => (("naked".to_owned(), "None".to_owned()), None),
        };
        if now != self.in_force {
            self.result.decisions.push(DecisionChange {
                t_s,
                decision: now.0.clone(),
                reason: now.1.clone(),
                pose: pose_record(pose),
                point_m: point,
            });
            self.in_force = now;
        }
    }

    fn measure(&mut self, pose: &Pose, clearance: Option<f64>, moving: bool) {
        let least = |so_far: Option<f64>| match (so_far, clearance) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        self.result.min_clearance_m = least(self.result.min_clearance_m);
        if moving {
            self.result.min_clearance_moving_m = least(self.result.min_clearance_moving_m);
        }
        if let Some(before) = self.before {
            self.result.travelled_m += libm::hypot(pose.x - before.x, pose.y - before.y);
            self.result.turned_rad += (pose.theta - before.theta).abs();
        }
        self.before = Some(*pose);
    }

    fn contacts(
        &mut self,
        t_s: f64,
        engine: &Engine<'_>,
        distances: &[f64],
        moving: bool,
    ) -> Vec<usize> {
        let [v_mps, omega_radps] = engine.drive.ground();
        let mut touches = Vec::new();
        for (body, distance) in distances.iter().enumerate() {
            let Some(open) = self.open.get_mut(body) else {
                continue;
            };
            if *distance > 0.0 {
                *open = None;
                continue;
            }
            let index = *open.get_or_insert(self.result.contacts.len());
            if index == self.result.contacts.len() {
                self.result.contacts.push(Contact {
                    t_s,
                    body: self.names.get(body).cloned().unwrap_or_default(),
                    robot_moving: false,
                    v_mps,
                    omega_radps,
                    pose: pose_record(&engine.pose()),
                    assumptions: Vec::new(),
                    outside: None,
                });
            }
            if let Some(contact) = self.result.contacts.get_mut(index)
                && moving
                && !contact.robot_moving
            {
                contact.robot_moving = true;
                (contact.t_s, contact.v_mps, contact.omega_radps) = (t_s, v_mps, omega_radps);
                contact.pose = pose_record(&engine.pose());
                touches.push(body);
            }
        }
        touches
    }

    /// What the monitors say of the contact with `body` that has just begun in motion.
    pub(super) fn judged(&mut self, body: usize, judged: Judged) {
        let open = self.open.get(body).copied().flatten();
        if let Some(contact) = open.and_then(|index| self.result.contacts.get_mut(index)) {
            contact.assumptions = judged.assumptions;
            contact.outside = judged.outside.map(str::to_owned);
        }
    }

    pub(super) fn finish(
        mut self,
        engine: &Engine<'_>,
        time_s: f64,
        reached: bool,
    ) -> (RunResult, String) {
        self.result.time_s = time_s;
        self.result.reached = reached;
        self.result.at_rest = !self.was_moving;
        let mut broken: Vec<_> = engine.broken.iter().map(|b| b.record()).collect();
        broken.sort();
        broken.dedup();
        self.result.assumptions_broken = broken;
        self.result.world = WorldRecord {
            bodies: engine.world.record(time_s, BODY_STEP_S),
            goal_m: engine.goal.map(|goal| goal.centre),
            goal_radius_m: engine.goal.map(|goal| goal.radius),
            via_m: engine.via_m.clone(),
        };
        (self.result, self.trace)
    }
}

fn empty(guarded: bool) -> RunResult {
    RunResult {
        guarded,
        time_s: 0.0,
        reached: false,
        travelled_m: 0.0,
        turned_rad: 0.0,
        at_rest: true,
        contacts: Vec::new(),
        min_clearance_m: None,
        min_clearance_moving_m: None,
        stops: Vec::new(),
        decisions: Vec::new(),
        samples: Vec::new(),
        world: WorldRecord::default(),
        remembered_m: Vec::new(),
        monitors: Vec::new(),
        navigation: None,
        assumptions_broken: Vec::new(),
    }
}
