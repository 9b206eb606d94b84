//! SYNC0, SYNC1, SYNC2, OPEN, CONFIG: until the first SIP arrives.

use haltline::time::{Duration, Instant};

use super::outbox::Outbox;
use crate::arcos::command::number;
use crate::arcos::server::{Identity, Message};
use crate::arcos::{Command, Packet};
use crate::drive::Fault;

/// How long an echo may take.
const ECHO: Duration = Duration::from_ms(1000);
/// How often the configuration is asked for.
const CONFIG_EVERY: Duration = Duration::from_ms(200);
/// How long the configuration is waited for.
const CONFIG_WAIT: Duration = Duration::from_ms(1000);
/// Quiet time after CLOSE, so that what was on its way has arrived.
const SETTLE: Duration = Duration::from_ms(150);
/// Silent tries before OPEN is sent to dislodge a server that waits for something else.
const DISLODGE_AFTER: u8 = 3;
/// Silent tries after which the caller hears of it.
const REPORT_AFTER: u8 = 10;

/// Where the handshake stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Handshake {
    phase: Phase,
    /// Silent tries in a row.
    tries: u8,
}

#[derive(Clone, Copy, Debug)]
enum Phase {
    /// Nothing is sent before this time.
    Settle(Instant),
    /// SYNC n was sent.
    Sync(u8, Instant),
    /// OPEN was sent; the first SIP and the configuration are awaited.
    Opening {
        since: Instant,
        asked: Instant,
        sip: bool,
    },
}

/// What a message did to the handshake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// It goes on.
    Going,
    /// It is through.
    Open,
}

impl Handshake {
    pub(super) const fn new(now: Instant) -> Self {
        Self {
            phase: Phase::Settle(now),
            tries: 0,
        }
    }

    fn sync(&mut self, step: u8, now: Instant, outbox: &mut Outbox) {
        outbox.admin(Command::bare(step));
        self.phase = Phase::Sync(step, now);
    }

    fn close(&mut self, now: Instant, outbox: &mut Outbox) {
        outbox.clear();
        outbox.admin(Command::int(number::CLOSE, 1));
        self.phase = Phase::Settle(now.plus(SETTLE));
    }

    /// Takes a packet of the robot.
    pub(super) fn message(
        &mut self,
        message: &Message,
        packet: &Packet,
        now: Instant,
        outbox: &mut Outbox,
    ) -> Result<Step, Fault> {
        match (self.phase, message) {
            // What was on its way when we closed.
            (Phase::Settle(_), _) => {}
            (Phase::Sync(..), Message::Sip(_)) => self.close(now, outbox),
            (Phase::Sync(..), Message::RestartSync) => self.sync(0, now, outbox),
            (Phase::Sync(step, _), Message::Sync(echo)) if step == *echo => {
                self.tries = 0;
                self.echoed(step, packet, now, outbox)?;
            }
            (Phase::Sync(..), Message::Sync(_)) => {
                self.sync(0, now, outbox);
                return Err(Fault::Unexpected);
            }
            (Phase::Sync(..), _) => {}
            (Phase::Opening { since, asked, .. }, Message::Sip(_)) => {
                self.phase = Phase::Opening {
                    since,
                    asked,
                    sip: true,
                };
                if now.since(since).is_some_and(|waited| waited > CONFIG_WAIT) {
                    return Ok(Step::Open);
                }
            }
            (Phase::Opening { .. }, Message::Config(_)) => return Ok(Step::Open),
            (Phase::Opening { .. }, Message::RestartSync) => self.sync(0, now, outbox),
            (Phase::Opening { .. }, _) => {}
        }
        Ok(Step::Going)
    }

    fn echoed(
        &mut self,
        step: u8,
        packet: &Packet,
        now: Instant,
        outbox: &mut Outbox,
    ) -> Result<(), Fault> {
        if step < 2 {
            self.sync(step.saturating_add(1), now, outbox);
            return Ok(());
        }
        if Identity::decode(packet).is_none() {
            self.sync(0, now, outbox);
            return Err(Fault::Unreadable);
        }
        outbox.admin(Command::int(number::OPEN, 1));
        outbox.admin(Command::int(number::CONFIG, 1));
        self.phase = Phase::Opening {
            since: now,
            asked: now,
            sip: false,
        };
        Ok(())
    }

    /// Lets time pass; a fault once nobody has answered for long.
    pub(super) fn tick(&mut self, now: Instant, outbox: &mut Outbox) -> Option<Fault> {
        let waited = |since: Instant| now.since(since).unwrap_or_default();
        match self.phase {
            Phase::Settle(until) if now < until => None,
            Phase::Settle(_) => {
                self.sync(0, now, outbox);
                None
            }
            Phase::Sync(_, asked) if waited(asked) < ECHO => None,
            Phase::Sync(..) => Some(self.silent(now, outbox)?),
            Phase::Opening { since, sip, .. } if !sip && waited(since) > ECHO.plus(ECHO) => {
                self.close(now, outbox);
                Some(Fault::NoAnswer)
            }
            Phase::Opening { since, asked, sip } => {
                if waited(asked) >= CONFIG_EVERY && waited(since) < CONFIG_WAIT {
                    outbox.admin(Command::int(number::CONFIG, 1));
                    self.phase = Phase::Opening {
                        since,
                        asked: now,
                        sip,
                    };
                }
                None
            }
        }
    }

    fn silent(&mut self, now: Instant, outbox: &mut Outbox) -> Option<Fault> {
        self.tries = self.tries.saturating_add(1);
        if self.tries == DISLODGE_AFTER {
            outbox.admin(Command::int(number::OPEN, 1));
            self.close_later(now, outbox);
        } else {
            self.sync(0, now, outbox);
        }
        if self.tries > REPORT_AFTER {
            self.tries = 0;
            return Some(Fault::NoAnswer);
        }
        None
    }

    fn close_later(&mut self, now: Instant, outbox: &mut Outbox) {
        outbox.admin(Command::int(number::CLOSE, 1));
        self.phase = Phase::Settle(now.plus(SETTLE));
    }
}
