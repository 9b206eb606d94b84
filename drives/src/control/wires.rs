//! Bytes between the loop, the robot and its scanner; nothing here waits but for the clock.

use std::io;
use std::time::Duration as Wall;

use haltline::time::{Duration, Instant};

use super::Control;
use crate::drive::{Fault, State};

/// How often the wire is served between two ticks.
const SERVE: Wall = Wall::from_millis(1);
/// How often a lost link is tried again.
const RETRY: Duration = Duration::from_ms(500);
/// Slower than this, m/s and rad/s, counts as rest.
const RESTS: f64 = 1e-2;
/// Longest farewell.
const FAREWELL: Duration = Duration::from_ms(8000);

impl Control {
    pub(super) fn serve_until(&mut self, due: Instant) {
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
    pub(super) fn serve(&mut self, now: Instant) {
        // A scanner that is gone sends no scans any more: the kernel stops by itself.
        self.eye.exchange(now, &mut self.scans);
        self.look_again(now);
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
        if let Some(error) = self.drive.fault() {
            // Whoever pressed the button may release it; the motors wait for the operator all the same.
            let off = [Fault::StopButton, Fault::MotorsOff];
            self.resetting &= !off.contains(&error.fault);
            self.fault = Some(error);
        }
        if let Some(feedback) = self.drive.feedback() {
            self.feedback = feedback;
            self.fresh = true;
        }
    }

    /// Connecting may take a moment in which nobody serves the robot, so it waits for it to rest.
    fn look_again(&mut self, now: Instant) {
        let rests = self.feedback.twist.iter().all(|rate| rate.abs() < RESTS);
        let Some(opener) = self.eye_opener.as_mut().filter(|_| rests) else {
            return;
        };
        if !self.eye.is_open() && now >= self.eye_retry {
            if let Ok(link) = opener() {
                self.eye.reopen(link);
            }
            self.eye_retry = self.clock.now().plus(RETRY);
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
    pub(super) fn farewell(&mut self) -> bool {
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
}
