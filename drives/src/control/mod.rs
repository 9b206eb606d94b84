//! The loop that drives a robot: fixed rate, every deadline accounted for, every end a stop.

mod types;
mod wires;

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;

use haltline::decision::{Decision, StopStatus};
use haltline::time::Instant;
use haltline_robots::Robot;
use haltline_scenarios::controller::{Controller, RobotKernel, TickInputs, tick};
use haltline_scenarios::drive::SetPoint;
use haltline_scenarios::math::Pose;
use haltline_scenarios::navigation::Said;
use haltline_scenarios::odometry::RawOdometry;
use haltline_scenarios::proposer::RawCommand;
use haltline_scenarios::sensor::RawScan;

use crate::clock::Clock;
use crate::drive::{Drive, DriveError, Feedback, State};
use crate::eye::Eye;
use crate::link::Link;

pub use types::{Account, Ending, Operator, Tick, View, Wish};

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
    eye_opener: Option<Opener>,
    eye_retry: Instant,
    clock: Clock,
    unsent: Vec<u8>,
    scans: Vec<RawScan>,
    feedback: Feedback,
    fresh: bool,
    decision: Option<Decision>,
    said: Option<Said>,
    resetting: bool,
    /// When the controller's own route was ordered: after the last release of a latched stop.
    ordered: Option<Instant>,
    account: Account,
    fault: Option<DriveError>,
    /// What was wrong at the tick before.
    objected: Option<DriveError>,
    opened: bool,
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
            eye_opener: None,
            eye_retry: clock.now(),
            clock,
            unsent: Vec::new(),
            scans: Vec::new(),
            feedback: Feedback::default(),
            fresh: false,
            decision: None,
            said: None,
            resetting: false,
            ordered: None,
            account: Account::default(),
            fault: None,
            objected: None,
            opened: false,
        })
    }

    /// How to connect to the scanner again after a loss; it must not take longer than 100 ms or so.
    #[must_use]
    pub fn with_scanner_opener(mut self, opener: Opener) -> Self {
        self.eye_opener = Some(opener);
        self
    }

    /// Drives until somebody ends it; always says good-bye to the robot.
    ///
    /// - `propose`: what somebody wants; asked in every tick, and not heard where the controller has
    ///   a route of its own
    /// - `observe`: called after each tick
    pub fn run(
        &mut self,
        operator: &Operator,
        mut propose: impl FnMut(&View) -> Wish,
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
        propose: &mut dyn FnMut(&View) -> Wish,
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
                said: self.said.clone(),
            };
            let wish = propose(&view);
            if wish == Wish::End {
                return Ending::Finished;
            }
            self.tick(operator, wish, now, observe);
        }
        Ending::Asked
    }

    fn tick(
        &mut self,
        operator: &Operator,
        wish: Wish,
        now: Instant,
        observe: &mut dyn FnMut(&Tick<'_>),
    ) {
        self.account.ticks += 1;
        self.opened |= self.drive.state() != State::Connecting;
        self.resetting |= operator.reset.swap(false, Ordering::Relaxed);
        if self.resetting && self.drive.state() == State::Disabled {
            self.drive.enable(now);
        }
        let inputs = self.inputs(operator, wish, now);
        let decision = tick(self.controller.as_mut(), &self.robot, &inputs, now.as_us());
        if decision.status == StopStatus::Latched {
            self.ordered = None;
        } else if self.drive.state() == State::Driving {
            self.resetting = false;
        }
        self.decision = Some(decision);
        let [x, y, theta] = self.feedback.pose;
        self.said = self.controller.said(&Pose::new(x, y, theta), 0);
        // By the clock of the sending: a decision that took too long has expired by now.
        let sent = self.clock.now();
        let refused = self.drive.send(&decision, sent).err();
        self.serve(sent);
        // That decisions are not sent says less than why.
        let fault = self.fault.take().or(refused);
        self.account.faults += u64::from(fault.is_some() && fault != self.objected);
        self.objected = fault;
        observe(&Tick {
            inputs: &inputs,
            now,
            decision,
            said: self.said.clone(),
            state: self.drive.state(),
            resetting: self.resetting,
            feedback: self.feedback,
            fault,
            scan_fault: self.eye.fault(),
            account: self.account,
        });
    }

    fn inputs(&mut self, operator: &Operator, wish: Wish, now: Instant) -> TickInputs {
        let steered = matches!(
            self.robot.values.kinematics,
            haltline_robots::Kinematics::Ackermann(_)
        );
        let motion = |[v, turn]: [f64; 2]| {
            if steered {
                SetPoint::Arc { v, curvature: turn }
            } else {
                SetPoint::Twist { v, omega: turn }
            }
        };
        let command = match wish {
            Wish::Motion(stamp, wanted) => Some(RawCommand {
                stamp_us: stamp.as_us(),
                motion: motion(wanted),
            }),
            Wish::Nothing | Wish::End => None,
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
        // A drive that does not obey is not asked to: the kernel would only find that it does not.
        let obeys = self.drive.state() == State::Driving;
        self.ordered = match self.ordered {
            _ if !obeys => None,
            None if own_route && released => Some(now),
            ordered => ordered,
        };
        let ready = self.resetting && obeys;
        TickInputs {
            scans: core::mem::take(&mut self.scans),
            odometry,
            command: command.filter(|_| !own_route && obeys),
            order_us: self.ordered.map(Instant::as_us),
            emergency_stop: operator.emergency.load(Ordering::Relaxed),
            reset_us: ready.then_some(now.as_us()),
        }
    }

    /// Whether the robot has ever answered as a robot of this kind does.
    #[must_use]
    pub const fn was_open(&self) -> bool {
        self.opened
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
