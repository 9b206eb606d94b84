//! Adapter of the model car: text lines to its control board.
//!
//! The board's dead-man switch is off after a reset, so the adapter sets it and reads it back. A
//! board that restarted has forgotten it: motion is only sent in answer to a session number that
//! is still ours, asked for in the same period.

mod answers;
pub mod curve;
mod drive;
mod odometry;
mod setup;

use haltline::time::{Duration, Instant};

use crate::cursor::Buffer;
use crate::drive::{DriveError, Fault, Feedback, Frame};
use crate::governor::{Braking, Governor, Setpoint};
use crate::uc::command::{Command, DriveLevel, SteeringLevel};
use crate::uc::line::{Deframer, Kind, LINE_MAX, Message};
use crate::uc::{ANSWER_MS, daq, reply};
use answers::Pending;
use odometry::CarOdometry;
use setup::Setup;

/// Data group of the wheel pulses.
pub(crate) const WHEEL_GROUP: u8 = 1;
/// Data group of the turn rate.
pub(crate) const GYRO_GROUP: u8 = 2;
/// Ends a line that somebody else has begun so that it is refused: it gets longer than any that the
/// board takes. (Two equal numbers may stand there already, and a third is not known to be refused.)
const SPOIL: [u8; LINE_MAX + 3] = {
    let mut line = [b'X'; LINE_MAX + 3];
    (line[0], line[1], line[LINE_MAX + 2]) = (b' ', b'0', b'\n');
    line
};
/// How often something is said while nothing is decided.
const KEEP_ALIVE: Duration = Duration::from_ms(40);
/// How long the brake is held after the car was last seen moving.
const BRAKE_AFTER: Duration = Duration::from_ms(500);
/// Time between two steps of the ramp of a farewell.
const FAREWELL_EVERY: Duration = Duration::from_ms(10);
/// Longest farewell after its ramp.
const FAREWELL: Duration = Duration::from_ms(1500);
/// Faster than the set point by this, m/s, and the car brakes.
const BRAKE_MARGIN: f64 = 0.05;

/// Everything the adapter must know of its car.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Sure decelerations.
    pub braking: Braking,
    /// Largest speed, mm/s.
    pub speed_max_mmps: i16,
    /// Largest reverse speed, mm/s, as a magnitude.
    pub reverse_max_mmps: i16,
    /// Rear axle to front axle, metres.
    pub wheelbase_m: f64,
    /// Distance of the rear wheels, metres.
    pub track_m: f64,
    /// Dead-man time that is set, ms; not 0.
    pub dead_man_ms: u16,
    /// Longest time between two data messages.
    pub feedback_max: Duration,
    /// Session number; any but 0. A new one for each run.
    pub session: u32,
}

/// The adapter.
#[derive(Clone, Debug)]
pub struct Adapter {
    config: Config,
    governor: Governor,
    deframer: Deframer,
    out: Buffer<2048>,
    /// The last byte that was handed out did not end its line.
    mid_line: bool,
    pending: Pending,
    link: Link,
    odometry: CarOdometry,
    feedback: Option<Feedback>,
    fault: Option<DriveError>,
    heard: Instant,
    sent: Instant,
    wanted: bool,
    silent: bool,
    /// A thrust that waits for the session number.
    waiting: bool,
    moved: Instant,
    /// The last thrust was forward: a brake works.
    forward: bool,
}

#[derive(Clone, Copy, Debug)]
enum Link {
    SettingUp(Setup),
    Open,
    Closing(Instant),
    Closed,
}

impl Adapter {
    /// An adapter that sets up its board from the first tick on.
    #[must_use]
    pub fn new(config: Config, now: Instant) -> Self {
        let mut adapter = Self {
            config,
            governor: Governor::new(config.braking, true),
            deframer: Deframer::default(),
            out: Buffer::default(),
            mid_line: false,
            pending: Pending::default(),
            link: Link::SettingUp(Setup::new(now)),
            odometry: CarOdometry::new(config.track_m),
            feedback: None,
            fault: None,
            heard: now,
            sent: now,
            wanted: false,
            silent: false,
            waiting: false,
            moved: now,
            forward: false,
        };
        adapter.begin(now);
        adapter
    }

    /// First words on a new link.
    fn begin(&mut self, now: Instant) {
        self.out.clear();
        // It fits: the buffer is empty.
        let _ = self.out.extend(&SPOIL);
        self.mid_line = false;
        self.stop_at_once(now);
    }

    /// Says zero, or the brake, without waiting for anything; its answer is not waited for either.
    fn stop_at_once(&mut self, now: Instant) {
        let line = Command::Drive(self.thrust(0, now)).encode();
        // A full buffer means that nobody writes it out.
        let _ = self.out.extend(line.as_slice());
    }

    fn report(&mut self, frame: Frame, fault: Fault) {
        self.fault = Some(DriveError::new(frame, fault));
    }

    /// Everything from the start: the order of answers is lost, or the board is another one.
    fn restart(&mut self, now: Instant) {
        let _ = self.governor.interrupt(now);
        self.link = Link::SettingUp(Setup::new(now));
        self.pending = Pending::default();
        self.forget_lines();
        // The set-up waits first, and what was said last must not stay in force meanwhile.
        self.stop_at_once(now);
        self.odometry.restart();
        (self.wanted, self.silent, self.waiting) = (false, false, false);
        self.heard = now;
    }

    /// Drops the lines that wait, but not the rest of one that has been begun: cut short, it
    /// could be a valid line with another number.
    fn forget_lines(&mut self) {
        let waiting = self.out;
        self.out.clear();
        let mut rest = waiting.as_slice().split_inclusive(|byte| *byte == b'\n');
        if let (true, Some(rest)) = (self.mid_line, rest.next()) {
            // It fits: it was there before.
            let _ = self.out.extend(rest);
        }
    }

    fn say(&mut self, command: Command, now: Instant) {
        let line = command.encode();
        // A full buffer means that nobody writes it out: the answer will be missed in time.
        if self.pending.push(command, now) && self.out.extend(line.as_slice()) {
            self.sent = now;
        }
    }

    /// Puts the set point on the wire: thrust only after the session has been confirmed.
    fn put(&mut self, setpoint: Setpoint, now: Instant) {
        let (level, steering) = self.levels(setpoint, now);
        self.say(Command::Steer(steering), now);
        if level.thrust() == 0 {
            self.waiting = false;
            self.say(Command::Drive(level), now);
        } else {
            self.waiting = true;
        }
        self.say(Command::GetSession, now);
    }

    fn levels(&self, setpoint: Setpoint, now: Instant) -> (DriveLevel, SteeringLevel) {
        let steering = curve::STEER.level(wheel_angle(setpoint.turn, self.config.wheelbase_m));
        (self.thrust(setpoint.linear, now), steering)
    }

    fn thrust(&self, linear_umps: i32, now: Instant) -> DriveLevel {
        let mmps = i16::try_from(linear_umps / 1000).unwrap_or(if linear_umps > 0 {
            i16::MAX
        } else {
            i16::MIN
        });
        let mmps = mmps.clamp(
            self.config.reverse_max_mmps.saturating_neg(),
            self.config.speed_max_mmps,
        );
        // The wheel sensor tells no direction: one that turns is taken to turn as it was last told.
        // So it comes to rest before it is told the other one.
        let turns = self.odometry.speed().abs() > 0.0;
        let mmps = if turns && mmps != 0 && (mmps > 0) != self.forward {
            0
        } else {
            mmps
        };
        let level = curve::SPEED.level(mmps);
        let recently = now.since(self.moved).is_some_and(|gap| gap < BRAKE_AFTER);
        if mmps == 0 && self.forward && recently {
            return DriveLevel::FULL_BRAKE;
        }
        let excess = self.odometry.speed() - f64::from(mmps) * 1e-3 - BRAKE_MARGIN;
        if mmps > 0 && self.forward && excess > 0.0 {
            return brake(excess);
        }
        level
    }

    fn message(&mut self, message: &Message, now: Instant) {
        match message.kind {
            Kind::Data => self.data(message.text(), now),
            Kind::Display => {
                if let Some(code) = reply::error_code(message.text()) {
                    self.report(Frame::Display, Fault::Refused(code));
                }
            }
            Kind::Answer => self.answer(message.text(), now),
        }
    }

    fn answer(&mut self, text: &str, now: Instant) {
        let Some(command) = self.pending.pop() else {
            if matches!(self.link, Link::SettingUp(setup) if setup.is_settling()) {
                return;
            }
            self.report(Frame::Stream, Fault::Unexpected);
            return self.restart(now);
        };
        if let Link::SettingUp(setup) = &mut self.link {
            match setup.answer(command, text, &self.config) {
                Ok(true) => self.opened(now),
                Ok(false) => {}
                Err(fault) => {
                    self.restart(now);
                    self.report(Frame::Answer(command), fault);
                }
            }
            return;
        }
        if let Err(fault) = answers::check(command, text, self.config.session) {
            self.restart(now);
            return self.report(Frame::Answer(command), fault);
        }
        // Only the newest question counts: the board may have restarted since an older one.
        let newest = command == Command::GetSession && !self.pending.contains(command);
        if newest && core::mem::take(&mut self.waiting) {
            let (level, _) = self.levels(self.governor.wire(), now);
            if level.thrust() != 0 {
                self.forward = level.thrust() > 0;
                self.moved = now;
            }
            self.say(Command::Drive(level), now);
        }
    }

    fn opened(&mut self, now: Instant) {
        self.link = Link::Open;
        self.heard = now;
        self.odometry.restart();
    }

    fn data(&mut self, text: &str, now: Instant) {
        let (number, payload) = match daq::split(text) {
            Ok(split) => split,
            Err(_) => return self.report(Frame::Stream, Fault::Unreadable),
        };
        let Some(group) = odometry::group(number) else {
            return; // a group that somebody else has defined
        };
        match group.decode(payload) {
            Err(_) => self.report(Frame::Group(number), Fault::Damaged),
            Ok(values) => {
                self.heard = now;
                self.silent = false;
                let direction = if self.forward { 1.0 } else { -1.0 };
                let may_calibrate = !self.wanted;
                let news = self
                    .odometry
                    .take(number, &values, direction, may_calibrate, now);
                if self.odometry.speed().abs() > 0.0 {
                    self.moved = now;
                }
                if let Some(feedback) = news {
                    self.feedback = Some(feedback);
                }
            }
        }
    }

    fn half_dead_man(&self) -> Duration {
        Duration::from_ms(u64::from(self.config.dead_man_ms) / 2)
    }

    fn watch(&mut self, now: Instant) {
        if let Some(command) = self.pending.overdue(now, Duration::from_ms(ANSWER_MS)) {
            self.restart(now);
            return self.report(Frame::Answer(command), Fault::NoAnswer);
        }
        let quiet = now.since(self.heard).unwrap_or_default();
        if quiet > self.config.feedback_max && !self.silent {
            self.silent = true;
            self.report(Frame::Stream, Fault::Silent);
            let _ = self.governor.withhold(now);
        }
        let unsent = now.since(self.sent).unwrap_or_default();
        let half = self.half_dead_man();
        if !self.governor.wire().is_rest() && (quiet > half || unsent > half) {
            if unsent > half {
                self.report(Frame::Stream, Fault::Gap);
            }
            let zero = self.governor.interrupt(now);
            self.put(zero, now);
        }
    }

    fn farewell(&mut self, since: Instant, now: Instant) {
        if now.since(self.sent).is_some_and(|gap| gap < FAREWELL_EVERY) {
            return;
        }
        let ramp = self.governor.withhold(now);
        self.put(ramp, now);
        let waited = now.since(since).unwrap_or_default();
        if !ramp.is_rest() {
            self.link = Link::Closing(now);
        } else if self.odometry.speed().abs() < 1e-6 || waited > FAREWELL {
            self.say(Command::Drive(DriveLevel::NEUTRAL), now);
            self.link = Link::Closed;
        }
    }
}

/// A brake as hard as the excess speed asks for: all of it from 0.2 m/s on.
#[allow(clippy::cast_possible_truncation)] // clamped to 100..=500 before
fn brake(excess_mps: f64) -> DriveLevel {
    let level = (excess_mps * 2500.0).clamp(100.0, 500.0) as i16;
    DriveLevel::forward(level.saturating_neg()).unwrap_or(DriveLevel::FULL_BRAKE)
}

/// Wheel angle of a curvature, 0.1 mrad; saturates at ±π/2.
///
/// - `curvature`: 10⁻⁶ /m, left positive
#[must_use]
#[allow(clippy::cast_possible_truncation)] // an arc tangent stays below 1.58 rad
pub fn wheel_angle(curvature: i32, wheelbase_m: f64) -> i16 {
    let angle = libm::atan(f64::from(curvature) * 1e-6 * wheelbase_m);
    libm::round(angle * 1e4) as i16
}
