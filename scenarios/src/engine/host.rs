//! The host: planner, kernel (or none), and the adapter that talks to the drive.

use haltline::decision::{Decision, StopStatus};
use haltline_robots::Robot;

use super::operator::{Operator, Route};
use super::{Engine, STEP_US};
use crate::controller::{Controller, TickInputs, set_point, tick};
use crate::drive::SetPoint;
use crate::faults::Faults;
use crate::file::Scenario;
use crate::math::{microseconds, seconds};
use crate::monitor::{DecisionRecord, Judged, Monitors, Standing, Tick, Touch};
use crate::navigation::NavigationRecord;
use crate::proposer::{Driver, RawCommand};
use crate::result::RunResult;

/// When a speed falls to just the rest threshold is a matter of rounding and of whole dynamics steps, seconds.
const THRESHOLD_S: f64 = 2.0 * STEP_US as f64 * 1e-6;

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
    /// Whether the controller follows a route of its own, and since when it is ordered to.
    route: Option<Route>,
    navigation: Option<NavigationRecord>,
    sent: SetPoint,
    decision: Option<DecisionRecord>,
}

impl<'a> Host<'a> {
    pub(super) fn new(
        scenario: &Scenario,
        robot: &'a Robot,
        engine: &Engine<'_>,
        controller: Option<Box<dyn Controller>>,
    ) -> Self {
        let faults = Faults::new(scenario, robot);
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
        let via_points = controller.as_ref().and_then(|c| c.via_points());
        Self {
            route: via_points.map(|_| Route::default()),
            navigation: via_points.map(NavigationRecord::new),
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
            // Counted from a late tick: a host never ticks faster than its period.
            self.next_us += self.period_us;
            let late_us = self.faults.tick_delay_us(self.next_us);
            self.next_us += late_us.next_multiple_of(super::STEP_US);
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
        let taken = self.faults.set_point(t_us, set_point);
        engine.drive.command(t_us, taken);
    }

    fn collect(&mut self, t_us: u64, engine: &mut Engine<'_>) -> TickInputs {
        let host_us = t_us + self.base_us;
        let since_s = self.released_us.map_or(0.0, |from| seconds(t_us - from));
        let order_us = self
            .route
            .as_mut()
            .and_then(|route| route.order(self.decision.map(|d| d.status), host_us));
        let command = match &self.route {
            // The kernel drives itself: nobody sends commands.
            Some(_) => None,
            None => {
                let motion = self.driver.propose(&engine.pose(), since_s);
                let stamp_us = host_us;
                self.faults.command(t_us, RawCommand { stamp_us, motion })
            }
        };
        let (scans, odometry) = engine.receive(t_us, &mut self.faults);
        let rested = engine.rested(t_us, self.robot.values.timing.rest_s + 0.1);
        let reset = self.operator.reset(t_us, rested);
        TickInputs {
            scans,
            odometry,
            command,
            order_us,
            emergency_stop: self.operator.line(t_us),
            reset_us: reset.then_some(host_us),
        }
    }

    /// The guarded way: kernel, then monitors.
    fn decide(&mut self, t_us: u64, inputs: &TickInputs, engine: &mut Engine<'_>) -> SetPoint {
        let now_us = self.faults.clock_us(t_us, t_us + self.base_us);
        let Some(controller) = &mut self.controller else {
            return self.sent;
        };
        controller.sense(&engine.pose(), haltline::time::Instant::from_us(now_us));
        let decision = tick(controller.as_mut(), self.robot, inputs, now_us);
        let mut record = record(&decision);
        let pose = engine.pose();
        if let (Some(log), Some(said)) =
            (&mut self.navigation, controller.said(&pose, self.base_us))
        {
            record.wants_rest = said.progress.kind == "arrived";
            log.note(seconds(t_us), &pose, said);
        }
        if decision.status == StopStatus::Running && self.released_us.is_none() {
            self.released_us = Some(t_us);
        }
        let pose_at = |at_us: u64| engine.pose_at(at_us);
        let rested = engine.rested(t_us, self.robot.values.timing.rest_s);
        let standing = match (engine.moving(), rested) {
            (true, _) => Standing::Moving,
            (false, false) => Standing::Still,
            (false, true) => Standing::Rested,
        };
        self.monitors.stands(&engine.distances(t_us), standing);
        let nearly = engine.rested(t_us, self.robot.values.timing.rest_s - THRESHOLD_S);
        let mut tick = Tick::new(
            (seconds(t_us), now_us),
            inputs,
            &record,
            &pose_at,
            (pose, nearly),
        );
        let mut broken = engine.broken.iter();
        tick.assumptions_hold = !broken.any(|one| one.concerns_all(seconds(t_us)));
        self.monitors.tick(tick);
        let before = self.decision.map(|d| d.status);
        if before != Some(StopStatus::Running)
            && record.status == StopStatus::Running
            && inputs.reset_us.is_some()
        {
            let bodies = engine.vouch(t_us);
            self.monitors.vouched(&bodies);
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
        let taken = self.faults.set_point(t_us, self.sent);
        engine.drive.command(t_us, taken);
    }

    /// A moving robot began to overlap a body.
    pub(super) fn touch(&mut self, t_us: u64, body: usize, engine: &Engine<'_>) -> Judged {
        if self.controller.is_none() {
            return Judged::default();
        }
        let pose = engine.pose();
        let stood = self.monitors.settled_s().is_some_and(|then_s| {
            let distances = engine.judge.distances(&engine.world, &pose, then_s);
            distances.get(body).is_some_and(|distance| *distance <= 0.0)
        });
        let touch = Touch {
            t_s: seconds(t_us),
            body,
            pose,
            stood,
        };
        self.monitors.touch(touch, &engine.broken)
    }

    /// What the run leaves behind on this side: monitor reports, memory in the world, navigation.
    pub(super) fn finish(self, engine: &Engine<'_>, result: &mut RunResult) {
        let Some(controller) = self.controller else {
            return;
        };
        let start = engine.history.first().copied().unwrap_or_default();
        let points = controller.remembered();
        result.remembered_m = points.into_iter().map(|point| start.apply(point)).collect();
        result.monitors = self.monitors.finish();
        result.navigation = self.navigation;
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
        wants_rest: false,
        point_m: point.map(|p| [f64::from(p.x_mm) * 1e-3, f64::from(p.y_mm) * 1e-3]),
    }
}
