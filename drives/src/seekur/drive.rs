//! The adapter's side towards its caller.

use haltline::decision::Decision;
use haltline::input::Motion;
use haltline::time::Instant;

use super::{Adapter, Link};
use crate::arcos::command::number;
use crate::arcos::{Command, Deframer, FrameError};
use crate::drive::{Drive, DriveError, Fault, Feedback, Frame, State};
use crate::governor::Setpoint;

impl Drive for Adapter {
    fn receive(&mut self, bytes: &[u8], now: Instant) {
        for byte in bytes {
            match self.deframer.push(*byte, now) {
                None => {}
                Some(Ok(packet)) => self.packet(&packet, now),
                Some(Err(FrameError::Checksum(id))) => {
                    self.report(Frame::ArcosServer(id), Fault::Damaged);
                }
                Some(Err(FrameError::TooShort | FrameError::TimedOut)) => {
                    self.report(Frame::Stream, Fault::Damaged);
                }
            }
        }
    }

    fn send(&mut self, decision: &Decision, now: Instant) -> Result<(), DriveError> {
        if !matches!(self.link, Link::Open) {
            return Err(DriveError::new(Frame::Decision, Fault::NotReady));
        }
        self.watch(now);
        if !matches!(self.link, Link::Open) {
            return Err(DriveError::new(Frame::Decision, Fault::NotReady));
        }
        if let Motion::Arc { .. } = decision.setpoint {
            let ramp = self.governor.withhold(now);
            self.put(ramp);
            return Err(DriveError::new(Frame::Decision, Fault::WrongMotion));
        }
        //= spec/drive.md#drive-01
        //# An adapter MUST NOT send a set point other than zero before its handshake is complete and the operator has enabled the drive.
        let release = self.is_ready() && !self.touching && self.outbox.is_empty();
        let sent = self.governor.decide(decision, now, release);
        //= spec/drive.md#drive-04
        //# The set point of a decision MUST be on the wire within one control period.
        self.put(sent);
        if now > decision.expires {
            return Err(DriveError::new(Frame::Decision, Fault::Expired));
        }
        if self.governor.is_holding() && !Setpoint::new(decision.setpoint).is_rest() {
            return Err(DriveError::new(Frame::Decision, Fault::NotReady));
        }
        Ok(())
    }

    fn tick(&mut self, now: Instant) {
        match &mut self.link {
            Link::Shaking(handshake) => {
                if let Some(fault) = handshake.tick(now, &mut self.outbox) {
                    self.report(Frame::Stream, fault);
                }
                return;
            }
            Link::Open => {}
            Link::Closing { since, emergency } => {
                let (since, emergency) = (*since, *emergency);
                return self.farewell(since, emergency, now);
            }
            Link::Closed => return,
        }
        self.watch(now);
        if !matches!(self.link, Link::Open) {
            return;
        }
        if let Some(ramp) = self.governor.tick(now) {
            self.put(ramp);
        }
        self.ask_for_motors(now);
        self.keep_alive(now);
    }

    fn outgoing(&mut self, out: &mut [u8], now: Instant) -> usize {
        self.outbox.drain(out, now)
    }

    fn feedback(&mut self) -> Option<Feedback> {
        self.feedback.take()
    }

    fn state(&self) -> State {
        match self.link {
            Link::Shaking(_) => State::Connecting,
            Link::Closing { .. } => State::Closing,
            Link::Closed if self.outbox.is_empty() => State::Closed,
            Link::Closed => State::Closing,
            Link::Open if !self.motors || self.wanted.is_none() => State::Disabled,
            Link::Open if self.governor.is_holding() => State::Holding,
            Link::Open => State::Driving,
        }
    }

    fn fault(&mut self) -> Option<DriveError> {
        self.fault.take()
    }

    fn enable(&mut self, now: Instant) {
        if !matches!(self.link, Link::Open) || self.wanted.is_some() {
            return;
        }
        if let Err(error) = self.watchdog_fits() {
            self.fault = Some(error);
            return;
        }
        self.interrupt(now);
        self.outbox.admin(Command::int(number::ENABLE, 1));
        self.wanted = Some(now);
    }

    fn reconnected(&mut self, now: Instant) {
        self.deframer = Deframer::default();
        self.restart(now);
        self.outbox.forget_partial();
    }

    fn shut_down(&mut self, now: Instant) {
        self.link = match self.link {
            Link::Open => Link::Closing {
                since: now,
                emergency: false,
            },
            Link::Shaking(_) => {
                self.outbox.clear();
                self.outbox.stop();
                Link::Closed
            }
            closing => closing,
        };
    }
}
