//! The adapter's side towards its caller.

use haltline::decision::Decision;
use haltline::input::Motion;
use haltline::time::{Duration, Instant};

use super::{Adapter, KEEP_ALIVE, Link, curve, wheel_angle};
use crate::drive::{Drive, DriveError, Fault, Feedback, Frame, State};
use crate::governor::Setpoint;
use crate::uc::ANSWER_MS;
use crate::uc::line::{Deframer, LineError};

impl Drive for Adapter {
    fn receive(&mut self, bytes: &[u8], now: Instant) {
        for byte in bytes {
            match self.deframer.push(*byte) {
                None => {}
                Some(Ok(message)) => self.message(&message, now),
                Some(Err(LineError::TooLong)) => self.report(Frame::Stream, Fault::TooLong),
                Some(Err(_)) => self.report(Frame::Stream, Fault::Damaged),
            }
        }
    }

    fn send(&mut self, decision: &Decision, now: Instant) -> Result<(), DriveError> {
        let refuse = |fault| Err(DriveError::new(Frame::Decision, fault));
        if !matches!(self.link, Link::Open) {
            return refuse(Fault::NotReady);
        }
        self.watch(now);
        if !matches!(self.link, Link::Open) {
            return refuse(Fault::NotReady);
        }
        let reach = match decision.setpoint {
            Motion::Twist(_) => Err(Fault::WrongMotion),
            Motion::Arc { curvature, .. } => {
                let angle = wheel_angle(curvature.as_urad_per_m(), self.config.wheelbase_m);
                let reaches = curve::STEER.reaches(angle);
                reaches.then_some(()).ok_or(Fault::OutOfReach)
            }
        };
        if let Err(fault) = reach {
            let ramp = self.governor.withhold(now);
            self.put(ramp, now);
            return refuse(fault);
        }
        let release = self.wanted && !self.silent && self.pending.is_empty();
        let sent = self.governor.decide(decision, now, release);
        self.put(sent, now);
        if now > decision.expires {
            return refuse(Fault::Expired);
        }
        if self.governor.is_holding() && !Setpoint::new(decision.setpoint).is_rest() {
            return refuse(Fault::NotReady);
        }
        Ok(())
    }

    fn tick(&mut self, now: Instant) {
        match self.link {
            Link::SettingUp(mut setup) => {
                if let Some(command) = self.pending.overdue(now, Duration::from_ms(ANSWER_MS * 3)) {
                    self.restart(now);
                    return self.report(Frame::Answer(command), Fault::NoAnswer);
                }
                let stop = self.thrust(0, now);
                if self.pending.is_empty()
                    && let Some(command) = setup.next(now, &self.config, stop)
                {
                    self.link = Link::SettingUp(setup);
                    self.say(command, now);
                }
            }
            Link::Open => {
                self.watch(now);
                if !matches!(self.link, Link::Open) {
                    return;
                }
                if let Some(ramp) = self.governor.tick(now) {
                    self.put(ramp, now);
                } else if now.since(self.sent).is_some_and(|gap| gap > KEEP_ALIVE) {
                    self.put(self.governor.wire(), now);
                }
            }
            Link::Closing(since) => self.farewell(since, now),
            Link::Closed => {}
        }
    }

    fn outgoing(&mut self, out: &mut [u8], _now: Instant) -> usize {
        let count = self.out.drain_into(out);
        if let Some(last) = out.get(..count).and_then(<[u8]>::last) {
            self.mid_line = *last != b'\n';
        }
        count
    }

    fn feedback(&mut self) -> Option<Feedback> {
        self.feedback.take()
    }

    fn state(&self) -> State {
        match self.link {
            Link::SettingUp(_) => State::Connecting,
            Link::Open if !self.wanted => State::Disabled,
            Link::Open if self.governor.is_holding() => State::Holding,
            Link::Open => State::Driving,
            Link::Closing(_) => State::Closing,
            Link::Closed if self.out.is_empty() => State::Closed,
            Link::Closed => State::Closing,
        }
    }

    fn fault(&mut self) -> Option<DriveError> {
        self.fault.take()
    }

    fn enable(&mut self, _now: Instant) {
        // The gyro's zero must be known: a turn that is not there would bend the odometry.
        if matches!(self.link, Link::Open) && self.odometry.is_calibrated() {
            self.wanted = true;
        }
    }

    fn reconnected(&mut self, now: Instant) {
        self.deframer = Deframer::default();
        self.restart(now);
        // A new link: what was begun on the old one is spoiled, not finished.
        self.begin(now);
    }

    fn shut_down(&mut self, now: Instant) {
        self.link = match self.link {
            Link::Open => Link::Closing(now),
            Link::SettingUp(_) => {
                self.forget_lines();
                Link::Closed
            }
            closing => closing,
        };
    }
}
