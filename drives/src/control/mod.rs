//! The loop that drives a robot: fixed rate, every deadline accounted for, every end a stop.

mod types;

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::time::Duration as Wall;

use haltline::decision::{Decision, Reason, StopStatus};
use haltline::time::{Duration, Instant};
use haltline_robots::Robot;
use haltline_scenarios::controller::{Controller, RobotKernel, TickInputs, tick};
use haltline_scenarios::drive::SetPoint;
use haltline_scenarios::odometry::RawOdometry;
use haltline_scenarios::proposer::RawCommand;
use haltline_scenarios::sensor::RawScan;

use crate::clock::Clock;
use crate::drive::{Drive, DriveError, Feedback, State};
use crate::eye::Eye;
use crate::link::Link;

pub use types::{Account, Ending, Operator, Tick, View};

/// How often the wire is served between two ticks.
const SERVE: Wall = Wall::from_millis(1);
/// How often a lost link is tried again.
const RETRY: Duration = Duration::from_ms(500);
/// Longest farewell.
const FAREWELL: Duration = Duration::from_ms(8000);

/// Opens the robot's link; called again after a loss.
pub type Opener = Box<dyn FnMut() -> io::Result<Box<dyn Link>>>;

/// Everything that drives one robot.
pub struct Control {
    robot: Robot,
    controller: Box<dyn Controller>,
    drive: Box<dyn Drive>,
    opener: Opener,
    link: Option<Box<dyn Link>>,
    retry: Instant,
    eye: Eye,
    eye_open: bool,
    clock: Clock,
    unsent: Vec<u8>,
    scans: Vec<RawScan>,
    feedback: Feedback,
    fresh: bool,
    decision: Option<Decision>,
    resetting: bool,
    /// When the controller's own route was ordered: after the last release of a latched stop.
    ordered: Option<Instant>,
    account: Account,
    fault: Option<DriveError>,
}

impl Control {
    /// Connects everything; nothing moves before [`Control::run`].
    ///
    /// - `controller`: [`shield`], or anything that answers ticks with decisions of the kernel
    ///
    /// # Errors
    /// The link cannot be opened.
    pub fn new(
        robot: &Robot,
        controller: Box<dyn Controller>,
        drive: Box<dyn Drive>,
        mut opener: Opener,
        eye: Eye,
        clock: Clock,
    ) -> io::Result<Self> {
        let link = Some(opener()?);
        Ok(Self {
            robot: robot.clone(),
            controller,
            drive,
            opener,
            link,
            retry: clock.now(),
            eye,
            eye_open: true,
            clock,
            unsent: Vec::new(),
            scans: Vec::new(),
            feedback: Feedback::default(),
            fresh: false,
            decision: None,
            resetting: false,
            ordered: None,
            account: Account::default(),
            fault: None,
        })
    }

    /// Drives until somebody ends it; always says good-bye to the robot.
    ///
    /// - `propose`: the motion somebody wants, m/s with rad/s or 1/m; `None` ends the drive
    /// - `observe`: called after each tick
    pub fn run(
        &mut self,
        operator: &Operator,
        mut propose: impl FnMut(&View) -> Option<[f64; 2]>,
        mut observe: impl FnMut(&Tick<'_>),
    ) -> Ending {
        let driven = catch_unwind(AssertUnwindSafe(|| {
            self.ticks(operator, &mut propose, &mut observe)
        }));
        //= spec/drive.md#drive-13
        //# Ctrl-C, a request to terminate and a panic MUST end the drive with a ramp to rest on the wire.
        let rested = self.farewell();
        match driven {
            Err(payload) => Ending::Panicked(payload),
            Ok(_) if !rested => Ending::Unreachable,
            Ok(ending) => ending,
        }
    }

    fn ticks(
        &mut self,
        operator: &Operator,
        propose: &mut dyn FnMut(&View) -> Option<[f64; 2]>,
        observe: &mut dyn FnMut(&Tick<'_>),
    ) -> Ending {
        let timing = &self.robot.config.timing;
        let (period, most) = (timing.period, timing.period.plus(timing.jitter));
        let mut due = self.clock.now().plus(period);
        let mut last: Option<Instant> = None;
        while !operator.end.load(Ordering::Relaxed) {
            self.serve_until(due);
            let now = self.clock.now();
            let late = now.since(due).unwrap_or_default().as_us();
            self.account.latest_us = self.account.latest_us.max(late);
            //= spec/drive.md#drive-12
            //# The drive loop MUST count a tick that comes later than control period plus jitter after the one before, and stop for it.
            let gap = last.and_then(|last| now.since(last)).unwrap_or_default();
            self.account.missed += u64::from(gap > most);
            last = Some(now);
            // Ticks that were missed are not made up for.
            due = if late > period.as_us() { now } else { due }.plus(period);
            let view = View {
                now,
                feedback: self.feedback,
                decision: self.decision,
            };
            let Some(wanted) = propose(&view) else {
                return Ending::Finished;
            };
            self.tick(operator, wanted, now, observe);
        }
        Ending::Asked
    }

    fn tick(
        &mut self,
        operator: &Operator,
        wanted: [f64; 2],
        now: Instant,
        observe: &mut dyn FnMut(&Tick<'_>),
    ) {
        self.account.ticks += 1;
        self.resetting |= operator.reset.swap(false, Ordering::Relaxed);
        if self.resetting && self.drive.state() == State::Disabled {
            self.drive.enable(now);
        }
        let inputs = self.inputs(operator, wanted, now);
        let decision = tick(self.controller.as_mut(), &self.robot, &inputs, now.as_us());
        if decision.status == StopStatus::Latched {
            self.ordered = None;
        } else {
            self.resetting = false;
        }
        self.decision = Some(decision);
        let refused = self.drive.send(&decision, now).err();
        self.serve(now);
        let fault = refused.or(self.fault.take());
        self.account.faults += u64::from(fault.is_some());
        observe(&Tick {
            inputs: &inputs,
            now,
            decision,
            state: self.drive.state(),
            feedback: self.feedback,
            fault,
            scan_fault: self.eye.fault(),
            account: self.account,
        });
    }

    fn inputs(&mut self, operator: &Operator, [v, turn]: [f64; 2], now: Instant) -> TickInputs {
        let steered = matches!(
            self.robot.values.kinematics,
            haltline_robots::Kinematics::Ackermann(_)
        );
        let motion = if steered {
            SetPoint::Arc { v, curvature: turn }
        } else {
            SetPoint::Twist { v, omega: turn }
        };
        let odometry = self.fresh.then_some(RawOdometry {
            stamp_us: self.feedback.stamp.as_us(),
            pose: self.feedback.pose,
            twist: self.feedback.twist,
            curvature_per_m: None,
        });
        self.fresh = false;
        // The motors must be on, and zero on the wire, before the kernel may run.
        let own_route = self.controller.via_points().is_some();
        let released = self
            .decision
            .is_some_and(|last| last.status != StopStatus::Latched);
        if own_route && released {
            self.ordered = self.ordered.or(Some(now));
        }
        let ready = self.resetting && self.drive.state() == State::Driving;
        TickInputs {
            scans: core::mem::take(&mut self.scans),
            odometry,
            command: (!own_route).then_some(RawCommand {
                stamp_us: now.as_us(),
                motion,
            }),
            order_us: self.ordered.map(Instant::as_us),
            emergency_stop: operator.emergency.load(Ordering::Relaxed),
            reset_us: ready.then_some(now.as_us()),
        }
    }

    fn serve_until(&mut self, due: Instant) {
        loop {
            let now = self.clock.now();
            self.serve(now);
            let left = due.since(now).unwrap_or_default();
            if left == Duration::ZERO {
                return;
            }
            std::thread::sleep(SERVE.min(Wall::from_micros(left.as_us())));
        }
    }

    /// Moves bytes both ways; never waits.
    fn serve(&mut self, now: Instant) {
        if self.eye_open && self.eye.exchange(now, &mut self.scans).is_err() {
            // No scans any more: the kernel stops by itself.
            self.eye_open = false;
        }
        if self.link.is_none() && now >= self.retry {
            self.retry = now.plus(RETRY);
            self.link = (self.opener)().ok();
            if self.link.is_some() {
                self.account.reconnections += 1;
                self.unsent.clear();
                self.drive.reconnected(now);
            }
        }
        if self.exchange(now).is_err() {
            self.link = None;
            self.unsent.clear();
            self.retry = now.plus(RETRY);
        }
        self.fault = self.drive.fault().or(self.fault.take());
        if let Some(feedback) = self.drive.feedback() {
            self.feedback = feedback;
            self.fresh = true;
        }
    }

    fn exchange(&mut self, now: Instant) -> io::Result<()> {
        let Some(link) = &mut self.link else {
            return Ok(());
        };
        let mut heard = Vec::new();
        let read = link.read(&mut heard);
        self.drive.receive(&heard, now);
        read?;
        self.drive.tick(now);
        // What the wire does not take is not queued: old set points must not pile up behind it.
        let mut room = [0; 512];
        if self.unsent.is_empty() {
            let count = self.drive.outgoing(&mut room, now);
            self.unsent
                .extend_from_slice(room.get(..count).unwrap_or_default());
        }
        let written = link.write(&self.unsent)?;
        self.unsent.drain(..written);
        Ok(())
    }

    /// Ramps to rest, motors off, good-bye; `false` if the robot could not be reached.
    fn farewell(&mut self) -> bool {
        let start = self.clock.now();
        self.drive.shut_down(start);
        loop {
            let now = self.clock.now();
            if self.exchange(now).is_err() {
                return false;
            }
            let waited = now.since(start).unwrap_or_default();
            if self.drive.state() == State::Closed && self.unsent.is_empty() {
                return self.link.is_some();
            }
            if self.link.is_none() || waited > FAREWELL {
                return false;
            }
            std::thread::sleep(SERVE);
        }
    }

    /// Deadlines and incidents so far.
    #[must_use]
    pub const fn account(&self) -> Account {
        self.account
    }
}

/// The kernel in shield mode: somebody else proposes.
///
/// # Errors
/// The kernel refuses the robot.
pub fn shield(robot: &Robot) -> io::Result<Box<dyn Controller>> {
    match RobotKernel::new(robot.config) {
        Ok(kernel) => Ok(Box::new(kernel)),
        Err(error) => Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            format!("the kernel refuses the robot: {error:?}"),
        )),
    }
}

/// Whether a decision holds the robot for lack of an operator.
#[must_use]
pub fn waits_for_operator(decision: &Decision) -> bool {
    decision.status == StopStatus::Latched && decision.reason != Reason::EmergencyStopLine
}
