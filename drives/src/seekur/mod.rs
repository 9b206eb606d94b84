//! Adapter of the Seekur Jr and its family: ARCOS over a serial line or TCP.
//!
//! The robot's watchdog stops it when nobody speaks, and *any* later packet revives the old set
//! point. So nothing but set points is sent while the motors are on, and after every gap the first
//! of them is zero.

mod drive;
mod handshake;
mod odometry;
mod outbox;
mod skid;
mod wire;

use haltline::time::{Duration, Instant};

use crate::arcos::command::number;
use crate::arcos::server::{self, Message};
use crate::arcos::sip::Flags;
use crate::arcos::{Command, Deframer, Packet, Sip, config};
use crate::drive::{DriveError, Fault, Feedback, Frame};
use crate::governor::{Governor, Setpoint};
use handshake::{Handshake, Step};
use odometry::WheelOdometry;
use outbox::Outbox;

pub use skid::{SkidFit, skid_factor};
pub use wire::{Seekur as Config, Wheels, from_wire, to_wire};

/// Silence after which the handshake starts again.
const LOST: Duration = Duration::from_ms(1000);
/// How often the motors are asked to come on.
const ENABLE_EVERY: Duration = Duration::from_ms(500);
/// How long the robot may take to rest after the ramp of a farewell.
const FAREWELL: Duration = Duration::from_ms(1500);
/// Measured speeds below these count as rest in a farewell: 10 mm/s, 0.01 rad/s.
const REST: f64 = 0.01;

/// The adapter.
#[derive(Clone, Debug)]
pub struct Adapter {
    config: Config,
    governor: Governor,
    deframer: Deframer,
    outbox: Outbox,
    link: Link,
    odometry: WheelOdometry,
    feedback: Option<Feedback>,
    fault: Option<DriveError>,
    /// What the robot said of itself.
    told: Option<config::Config>,
    heard: Instant,
    /// The operator wants the motors on, and when they were last asked to come on.
    wanted: Option<Instant>,
    motors: bool,
    /// E_STALL was set in the SIP before.
    e_stall: bool,
    /// Something touches a bumper or blocks a wheel.
    touching: bool,
    /// The feedback is interrupted.
    silent: bool,
    clock_us: Option<u32>,
}

#[derive(Clone, Copy, Debug)]
enum Link {
    Shaking(Handshake),
    Open,
    Closing { since: Instant, emergency: bool },
    Closed,
}

impl Adapter {
    /// An adapter that starts to shake hands at its first tick.
    #[must_use]
    pub fn new(config: Config, now: Instant) -> Self {
        Self {
            config,
            governor: Governor::new(config.braking, false),
            deframer: Deframer::default(),
            outbox: Outbox::default(),
            link: Link::Shaking(Handshake::new(now)),
            odometry: WheelOdometry::new(&config),
            feedback: None,
            fault: None,
            told: None,
            heard: now,
            wanted: None,
            motors: false,
            e_stall: false,
            touching: false,
            silent: false,
            clock_us: None,
        }
    }

    /// What the robot said of itself, once it has.
    #[must_use]
    pub const fn told(&self) -> Option<&config::Config> {
        self.told.as_ref()
    }

    fn report(&mut self, frame: Frame, fault: Fault) {
        self.fault = Some(DriveError::new(frame, fault));
    }

    /// Zero on the wire at once, motion withheld.
    fn interrupt(&mut self, now: Instant) {
        let zero = self.governor.interrupt(now);
        self.outbox.stop();
        self.put(zero);
    }

    fn put(&mut self, setpoint: Setpoint) {
        let words = to_wire(&self.config, setpoint.linear, setpoint.turn);
        self.outbox.set(words);
    }

    /// Everything from the start; what is sent before that is up to the caller.
    fn restart(&mut self, now: Instant) {
        self.outbox.clear();
        let _ = self.governor.interrupt(now);
        self.link = Link::Shaking(Handshake::new(now));
        self.odometry.restart();
        (self.motors, self.wanted, self.told) = (false, None, None);
        (self.touching, self.silent, self.clock_us) = (false, false, None);
        self.heard = now;
    }

    fn packet(&mut self, packet: &Packet, now: Instant) {
        let frame = Frame::ArcosServer(packet.id());
        if let Link::Shaking(handshake) = &mut self.link {
            match handshake.message(packet, now, &mut self.outbox) {
                Ok(Step::Going) => return,
                Ok(Step::Open) => self.opened(now),
                Err(fault) => return self.report(frame, fault),
            }
        }
        match server::decode(packet) {
            None => self.report(frame, Fault::Unreadable),
            Some(Message::Sip(sip)) => self.sip(&sip, now),
            Some(Message::Config(config)) => self.configured(config, now),
            Some(Message::Sync(_)) => self.report(frame, Fault::Unexpected),
            // A server that wants to be synchronised is not open any more, and obeys nothing.
            Some(Message::RestartSync) if matches!(self.link, Link::Open) => {
                self.restart(now);
                self.report(frame, Fault::Reboot);
            }
            Some(_) => {}
        }
    }

    /// The robot tells its configuration, possibly another one than before.
    fn configured(&mut self, config: config::Config, now: Instant) {
        self.told = Some(config);
        if let (Some(_), Err(error)) = (self.wanted, self.watchdog_fits()) {
            self.wanted = None;
            self.interrupt(now);
            self.fault = Some(error);
        }
    }

    /// The robot answers: limits first, then zero, before anybody may enable the motors.
    fn opened(&mut self, now: Instant) {
        self.link = Link::Open;
        self.heard = now;
        for command in self.config.setup() {
            self.outbox.admin(command);
        }
        self.interrupt(now);
    }

    fn sip(&mut self, sip: &Sip, now: Instant) {
        self.heard = now;
        let frame = Frame::ArcosServer(if sip.moving { 0x33 } else { 0x32 });
        if self.restarted(sip) {
            self.restart(now);
            self.outbox.stop();
            return self.report(frame, Fault::Reboot);
        }
        let stamp = now.minus(self.config.transport);
        match self.odometry.take(sip, stamp) {
            Some(feedback) => self.feedback = Some(feedback),
            None => {
                // Where it is now nobody knows: the caller hears of no motion, and none is sent.
                self.interrupt(now);
                self.report(frame, Fault::Impossible);
            }
        }
        self.silent = false;
        self.flags(sip, now);
    }

    /// The controller's clock ran backwards otherwise than by its wrap after 71 minutes.
    fn restarted(&mut self, sip: &Sip) -> bool {
        let before = core::mem::replace(&mut self.clock_us, sip.tail.clock_us);
        match (before, sip.tail.clock_us) {
            (Some(before), Some(now)) => now < before && before < u32::MAX - 60_000_000,
            _ => false,
        }
    }

    fn flags(&mut self, sip: &Sip, now: Instant) {
        let frame = Frame::ArcosServer(if sip.moving { 0x33 } else { 0x32 });
        let before = self.motors;
        self.motors = sip.flags.has(Flags::MOTORS);
        // The stall that the button leaves behind ends only when the motors are enabled again, so it
        // is news only once.
        let stalled = sip.flags.has(Flags::E_STALL);
        let newly = stalled && !core::mem::replace(&mut self.e_stall, stalled);
        let button = sip.flags.has(Flags::STOP_BUTTON) || newly;
        if (before && !self.motors) || (button && self.wanted.is_some()) {
            //= spec/drive.md#drive-15
            //# An adapter MUST stop and wait for the operator when the drive reports a pressed stop button or that its motors went off.
            // Only the operator switches them on again.
            self.wanted = None;
            self.interrupt(now);
            self.report(
                frame,
                if button {
                    Fault::StopButton
                } else {
                    Fault::MotorsOff
                },
            );
        }
        let bumper = sip.bumpers.front() != 0 || sip.bumpers.rear() != 0;
        let stalled = sip.bumpers.left_stall() || sip.bumpers.right_stall();
        if (bumper || stalled) && !self.touching {
            self.interrupt(now);
            if bumper {
                self.outbox.emergency();
            }
            self.report(
                frame,
                if bumper {
                    Fault::Bumper
                } else {
                    Fault::Stalled
                },
            );
        }
        self.touching = bumper || stalled;
    }

    fn is_ready(&self) -> bool {
        matches!(self.link, Link::Open) && self.motors && self.wanted.is_some() && !self.silent
    }

    /// The dead-man time the robot tells is no longer than the robot file's.
    //= spec/drive.md#drive-14
    //# When the controlling process is killed, the robot MUST rest no later than its dead-man time plus `v /
    //# b_silent` after it last heard a set point.
    fn watchdog_fits(&self) -> Result<(), DriveError> {
        let found = self.told.and_then(|told| told.watchdog_ms);
        let wanted_ms = self.config.watchdog_max_ms;
        match found {
            //= spec/drive.md#drive-10
            //# An adapter MUST read back the dead-man time of its drive and refuse to enable it when it is off or longer than the robot file says.
            Some(ms) if ms > 0 && ms <= wanted_ms => Ok(()),
            None if self.config.accept_untold_watchdog => Ok(()),
            found => Err(DriveError::new(
                Frame::ArcosServer(config::ID),
                Fault::DeadMan {
                    wanted_ms,
                    found_ms: found.unwrap_or(u16::MAX),
                },
            )),
        }
    }

    fn half_watchdog(&self) -> Duration {
        let told = self.told.and_then(|told| told.watchdog_ms);
        let ms = told.unwrap_or(self.config.watchdog_max_ms);
        Duration::from_ms(u64::from(ms) / 2)
    }

    /// Silence of the robot, and of ourselves.
    fn watch(&mut self, now: Instant) {
        let quiet = now.since(self.heard).unwrap_or_default();
        if quiet > LOST {
            self.restart(now);
            // It was open, and may be.
            self.outbox.stop();
            return self.report(Frame::Stream, Fault::Silent);
        }
        if quiet > self.config.feedback_max && !self.silent {
            self.silent = true;
            if self.motors {
                self.report(Frame::Stream, Fault::Silent);
            }
            let ramp = self.governor.withhold(now);
            self.put(ramp);
        }
        let half = self.half_watchdog();
        let unsent = now.since(self.outbox.sent()).unwrap_or_default();
        if self.motors && !self.governor.wire().is_rest() && (quiet > half || unsent > half) {
            // The robot may have stopped by itself; whatever arrives next must not revive it.
            if unsent > half {
                self.report(Frame::Stream, Fault::Gap);
            }
            self.interrupt(now);
        }
    }

    fn ask_for_motors(&mut self, now: Instant) {
        if let Some(asked) = self.wanted
            && !self.motors
            && now.since(asked).is_some_and(|gap| gap > ENABLE_EVERY)
        {
            self.outbox.admin(Command::int(number::ENABLE, 1));
            self.wanted = Some(now);
        }
    }

    fn keep_alive(&mut self, now: Instant) {
        let quarter = Duration::from_us(self.half_watchdog().as_us() / 2);
        let quiet = now.since(self.outbox.sent()).unwrap_or_default();
        if quiet < quarter || !self.outbox.is_empty() {
            return;
        }
        if self.wanted.is_some() || self.motors {
            //= spec/drive.md#drive-02
            //# The first set point after a handshake, a gap, a reconnection or a restart of the drive MUST be zero.
            // Never a bare PULSE: it would revive whatever set point the robot remembers.
            self.put(self.governor.wire());
        } else {
            self.outbox.admin(Command::bare(number::PULSE));
        }
    }

    fn farewell(&mut self, since: Instant, emergency: bool, now: Instant) {
        let ramp = self.governor.withhold(now);
        self.put(ramp);
        let moving = self.feedback_moves();
        let waited = now.since(since).unwrap_or_default();
        if ramp.is_rest() && (!moving || waited > FAREWELL) {
            if moving && !emergency {
                // It should rest by now: the hardest stop there is, once more as long.
                self.outbox.emergency();
                self.link = Link::Closing {
                    since: now,
                    emergency: true,
                };
                return;
            }
            self.outbox.stop();
            self.outbox.admin(Command::int(number::ENABLE, 0));
            self.outbox.admin(Command::int(number::CLOSE, 1));
            self.link = Link::Closed;
        } else if !ramp.is_rest() {
            self.link = Link::Closing {
                since: now,
                emergency,
            };
        }
    }

    fn feedback_moves(&self) -> bool {
        let [v, w] = self.odometry.twist();
        v.abs() > REST || w.abs() > REST
    }
}
