//! The host: planner, kernel (or none), and the adapter that talks to the drive.

use haltline::decision::{Decision, StopStatus};
use haltline_robots::Robot;

use super::Engine;
use crate::assumption::Broken;
use crate::controller::{Controller, TickInputs, set_point, tick};
use crate::drive::SetPoint;
use crate::faults::Faults;
use crate::file::Scenario;
use crate::math::{microseconds, seconds};
use crate::monitor::{DecisionRecord, Monitors, Tick, Touch};
use crate::proposer::{Driver, RawCommand};
use crate::result::MonitorReport;

/// State of the host.
pub(super) struct Host<'a> {
    robot: &'a Robot,
    controller: Option<Box<dyn Controller>>,
    monitors: Monitors<'a>,
    driver: Driver,
    faults: Faults,
    operator: Operator,
    period_us: u64,
    next_us: u64,
    base_us: u64,
    honours_expiry: bool,
    /// When the robot was first allowed to move.
    released_us: Option<u64>,
    sent: SetPoint,
    decision: Option<DecisionRecord>,
}

/// Resets and the emergency stop line.
struct Operator {
    /// Times of resets still to be given; `None` waits for the robot to be able to take one.
    resets_us: Option<Vec<u64>>,
    lines_us: Vec<[u64; 2]>,
    wait_us: u64,
}

impl Operator {
    fn new(scenario: &Scenario, robot: &Robot) -> Self {
        let times = |list: &Vec<crate::file::value::NonNegative>| {
            list.iter().map(|t| microseconds(t.get())).collect()
        };
        let stops = &scenario.operator.emergency_stops_s;
        Self {
            resets_us: scenario.operator.resets_s.as_ref().map(times),
            lines_us: stops
                .iter()
                .map(|p| p.map(|t| microseconds(t.get())))
                .collect(),
            wait_us: microseconds(0.2 + robot.values.timing.rest_s),
        }
    }

    fn line(&self, t_us: u64) -> bool {
        self.lines_us
            .iter()
            .any(|[from, until]| t_us >= *from && t_us < *until)
    }

    /// Whether a reset is given at this tick; each is given once.
    fn reset(&mut self, t_us: u64, rested: bool) -> bool {
        match &mut self.resets_us {
            Some(times) => {
                let before = times.len();
                times.retain(|time| *time > t_us);
                times.len() < before
            }
            None if t_us >= self.wait_us && rested => {
                self.resets_us = Some(Vec::new());
                true
            }
            None => false,
        }
    }
}

impl<'a> Host<'a> {
    pub(super) fn new(
        scenario: &Scenario,
        robot: &'a Robot,
        engine: &Engine<'_>,
        controller: Option<Box<dyn Controller>>,
    ) -> Self {
        let faults = Faults::new(scenario);
        let driver = Driver::new(robot, scenario);
        let start = &scenario.start;
        let (v, omega) = (start.linear_mps.get(), start.angular_radps.get());
        let sent = match driver.rest() {
            SetPoint::Twist { .. } => SetPoint::Twist { v, omega },
            SetPoint::Arc { .. } => SetPoint::Arc {
                v,
                curvature: if v.abs() > 1e-6 { omega / v } else { 0.0 },
            },
        };
        Self {
            controller,
            monitors: Monitors::new(robot, &engine.world),
            driver,
            operator: Operator::new(scenario, robot),
            period_us: microseconds(robot.values.timing.period_s).max(super::STEP_US),
            next_us: 0,
            base_us: engine.base_us,
            honours_expiry: scenario.drive.honours_expiry.unwrap_or(true),
            released_us: None,
            sent,
            decision: None,
            faults,
            robot,
        }
    }

    /// The decision in force.
    pub(super) const fn decision(&self) -> Option<&DecisionRecord> {
        self.decision.as_ref()
    }

    /// One dynamics step of the host.
    pub(super) fn step(&mut self, t_us: u64, engine: &mut Engine<'_>) {
        let (called, alive) = self.faults.host(t_us);
        if t_us >= self.next_us {
            self.next_us += self.period_us;
            if called {
                self.tick(t_us, engine);
                return;
            }
        }
        if !called && alive && self.honours_expiry {
            self.expire(t_us, engine);
        }
    }

    fn tick(&mut self, t_us: u64, engine: &mut Engine<'_>) {
        let inputs = self.collect(t_us, engine);
        let set_point = if self.controller.is_some() {
            self.decide(t_us, &inputs, engine)
        } else {
            self.pass_on(t_us, &inputs)
        };
        self.sent = set_point;
        engine.drive.command(t_us, set_point);
    }

    fn collect(&mut self, t_us: u64, engine: &mut Engine<'_>) -> TickInputs {
        let host_us = t_us + self.base_us;
        let since_s = self.released_us.map_or(0.0, |from| seconds(t_us - from));
        let command = RawCommand {
            stamp_us: host_us,
            motion: self.driver.propose(&engine.pose(), since_s),
        };
        let (scans, odometry) = engine.receive(t_us, &mut self.faults);
        let rested = engine.rested(t_us, self.robot.values.timing.rest_s + 0.1);
        let reset = self.operator.reset(t_us, rested);
        TickInputs {
            scans,
            odometry,
            command: self.faults.command(t_us, command),
            emergency_stop: self.operator.line(t_us),
            reset_us: reset.then_some(host_us),
        }
    }

    /// The guarded way: kernel, then monitors.
    fn decide(&mut self, t_us: u64, inputs: &TickInputs, engine: &mut Engine<'_>) -> SetPoint {
        let now_us = (t_us + self.base_us).saturating_sub(self.faults.clock_back_us(t_us));
        let Some(controller) = &mut self.controller else {
            return self.sent;
        };
        let decision = tick(controller.as_mut(), self.robot, inputs, now_us);
        let record = record(&decision);
        if decision.status == StopStatus::Running && self.released_us.is_none() {
            self.released_us = Some(t_us);
        }
        let pose_at = |at_us: u64| engine.pose_at(at_us);
        let rested = engine.rested(t_us, self.robot.values.timing.rest_s);
        self.monitors.tick(Tick::new(
            (seconds(t_us), now_us),
            inputs,
            &record,
            &pose_at,
            (engine.pose(), rested),
        ));
        let before = self.decision.map(|d| d.status);
        if before != Some(StopStatus::Running)
            && record.status == StopStatus::Running
            && inputs.reset_us.is_some()
        {
            engine.vouch(t_us);
        }
        self.decision = Some(record);
        record.set_point
    }

    /// The naked way: the proposal goes straight to the drive, within the acceleration limits.
    /// What is not a number is ignored, so the last set point stays.
    fn pass_on(&mut self, t_us: u64, inputs: &TickInputs) -> SetPoint {
        if inputs.reset_us.is_some() && self.released_us.is_none() {
            self.released_us = Some(t_us);
        }
        let wanted = inputs.command.map(|command| command.motion);
        match wanted.filter(|motion| motion.is_finite()) {
            Some(wanted) if self.released_us.is_some() => self.slew(wanted),
            _ => self.sent,
        }
    }

    fn slew(&self, wanted: SetPoint) -> SetPoint {
        let limits = &self.robot.values.limits;
        let dt_s = seconds(self.period_us);
        let towards =
            |from: f64, to: f64, rate: f64| from + (to - from).clamp(-rate * dt_s, rate * dt_s);
        let v = towards(self.sent.speed(), wanted.speed(), limits.acceleration_mps2);
        match wanted {
            SetPoint::Twist { omega, .. } => SetPoint::Twist {
                v,
                omega: towards(
                    self.sent.turn_rate(),
                    omega,
                    limits.angular_acceleration_radps2,
                ),
            },
            SetPoint::Arc { curvature, .. } => SetPoint::Arc { v, curvature },
        }
    }

    /// The adapter brakes along the curve when the decision has expired and none follows.
    fn expire(&mut self, t_us: u64, engine: &mut Engine<'_>) {
        let Some(decision) = &self.decision else {
            return;
        };
        if t_us + self.base_us <= decision.expires_us {
            return;
        }
        let limits = &self.robot.values.limits;
        let dt_s = seconds(super::STEP_US);
        let left = |value: f64, rate: f64| {
            if value.abs() > rate * dt_s {
                1.0 - rate * dt_s / value.abs()
            } else {
                0.0
            }
        };
        let v_left = left(self.sent.speed(), limits.braking_mps2);
        self.sent = match self.sent {
            SetPoint::Twist { v, omega } => {
                let both = v_left.max(left(omega, limits.angular_braking_radps2));
                SetPoint::Twist {
                    v: v * both,
                    omega: omega * both,
                }
            }
            SetPoint::Arc { v, curvature } => SetPoint::Arc {
                v: v * v_left,
                curvature,
            },
        };
        engine.drive.command(t_us, self.sent);
    }

    /// A moving robot began to overlap a body.
    pub(super) fn touch(&mut self, touch: Touch, broken: &[Broken]) {
        if self.controller.is_some() {
            self.monitors.touch(touch, broken);
        }
    }

    /// Monitor reports, and what the controller remembers, in the world.
    pub(super) fn finish(self, engine: &Engine<'_>) -> (Vec<MonitorReport>, Vec<[f64; 2]>) {
        let Some(controller) = self.controller else {
            return (Vec::new(), Vec::new());
        };
        let start = engine.history.first().copied().unwrap_or_default();
        let points = controller.remembered();
        let remembered = points.into_iter().map(|point| start.apply(point)).collect();
        (self.monitors.finish(), remembered)
    }
}

fn record(decision: &Decision) -> DecisionRecord {
    let point = decision.verdict.and_then(|verdict| verdict.point);
    DecisionRecord {
        action: decision.action,
        reason: decision.reason,
        status: decision.status,
        set_point: set_point(decision.setpoint),
        expires_us: decision.expires.as_us(),
        point_m: point.map(|p| [f64::from(p.x_mm) * 1e-3, f64::from(p.y_mm) * 1e-3]),
    }
}
