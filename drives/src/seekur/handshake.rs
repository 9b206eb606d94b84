//! Listening, SYNC0, SYNC1, SYNC2, OPEN, CONFIG: until the first SIP arrives.
//!
//! SYNC0 is PULSE to a server that is still open, and any packet may revive the set point that an
//! earlier client left behind. A server in its handshake, on the other hand, takes whatever is no
//! SYNC for a mistake. So nothing is said until an open server would have been heard: that one is
//! stopped and closed first.

use haltline::time::{Duration, Instant};

use super::outbox::Outbox;
use crate::arcos::command::number;
use crate::arcos::server::{Identity, kind};
use crate::arcos::{Command, Packet, sip};
use crate::drive::Fault;

/// An open server sends a SIP every 255 ms at the latest (the cycle is a byte of milliseconds).
const LISTEN: Duration = Duration::from_ms(300);
/// How long an echo may take.
const ECHO: Duration = Duration::from_ms(1000);
/// Without an echo for this long the server may be open and only not to be heard: it is stopped.
const SUSPECT: Duration = Duration::from_ms(250);
/// How often the configuration is asked for.
const CONFIG_EVERY: Duration = Duration::from_ms(200);
/// How long the configuration is waited for.
const CONFIG_WAIT: Duration = Duration::from_ms(1000);
/// Quiet time before the count starts again, so that what was on its way has arrived.
const SETTLE: Duration = Duration::from_ms(150);
/// Silent tries before OPEN is sent to dislodge a server that waits for something else, and before the
/// caller hears of it.
const DISLODGE_AFTER: u8 = 3;
/// Silent tries after which it is sent and said again.
const START_OVER_AFTER: u8 = 10;

/// Where the handshake stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Handshake {
    phase: Phase,
    /// Silent tries in a row.
    tries: u8,
}

#[derive(Clone, Copy, Debug)]
enum Phase {
    /// Nothing is sent before this time; a SIP means that the server is open.
    Listen(Instant),
    /// Nothing is sent before this time, whatever arrives.
    Settle(Instant),
    /// SYNC n was sent.
    Sync {
        step: u8,
        asked: Instant,
        stopped: bool,
    },
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
            phase: Phase::Listen(now.plus(LISTEN)),
            tries: 0,
        }
    }

    fn sync(&mut self, step: u8, now: Instant, outbox: &mut Outbox) {
        outbox.admin(Command::bare(step));
        self.phase = Phase::Sync {
            step,
            asked: now,
            stopped: false,
        };
    }

    /// The server is open: it stands before it is closed.
    fn close(&mut self, now: Instant, outbox: &mut Outbox) {
        outbox.clear();
        outbox.stop();
        outbox.admin(Command::int(number::CLOSE, 1));
        self.settle(now);
    }

    const fn settle(&mut self, now: Instant) {
        self.phase = Phase::Settle(now.plus(SETTLE));
    }

    /// Takes a packet of the robot.
    pub(super) fn message(
        &mut self,
        packet: &Packet,
        now: Instant,
        outbox: &mut Outbox,
    ) -> Result<Step, Fault> {
        // By its type alone: what a SIP holds does not matter here.
        let is_sip = matches!(packet.id(), sip::STOPPED | sip::MOVING);
        match (self.phase, packet.id()) {
            (Phase::Listen(_) | Phase::Sync { .. }, _) if is_sip => self.close(now, outbox),
            // What was on its way before.
            (Phase::Listen(_) | Phase::Settle(_), _) => {}
            // Whoever answers at once may be answered once more for each thing that was said.
            (Phase::Sync { .. } | Phase::Opening { .. }, kind::RESTART_SYNC) => self.settle(now),
            (Phase::Sync { step, .. }, echo) if step == echo => {
                self.tries = 0;
                self.echoed(step, packet, now, outbox)?;
            }
            (Phase::Sync { step, .. }, echo @ 1..=2) if echo > step => {
                self.settle(now);
                return Err(Fault::Unexpected);
            }
            // An earlier echo once more, or something that is none.
            (Phase::Sync { .. }, _) => {}
            (Phase::Opening { since, asked, .. }, _) if is_sip => {
                self.phase = Phase::Opening {
                    since,
                    asked,
                    sip: true,
                };
                if now.since(since).is_some_and(|waited| waited > CONFIG_WAIT) {
                    return Ok(Step::Open);
                }
            }
            (Phase::Opening { .. }, kind::CONFIG) => return Ok(Step::Open),
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
            self.settle(now);
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
        match &mut self.phase {
            Phase::Listen(until) | Phase::Settle(until) if now < *until => None,
            Phase::Listen(_) | Phase::Settle(_) => {
                self.sync(0, now, outbox);
                None
            }
            Phase::Sync { asked, stopped, .. } if waited(*asked) < ECHO => {
                if waited(*asked) >= SUSPECT && !core::mem::replace(stopped, true) {
                    outbox.stop();
                }
                None
            }
            Phase::Sync { .. } => self.silent(now, outbox),
            Phase::Opening { since, sip, .. } if !*sip && waited(*since) > ECHO.plus(ECHO) => {
                self.close(now, outbox);
                Some(Fault::NoAnswer)
            }
            Phase::Opening { since, asked, .. } => {
                if waited(*asked) >= CONFIG_EVERY && waited(*since) < CONFIG_WAIT {
                    outbox.admin(Command::int(number::CONFIG, 1));
                    *asked = now;
                }
                None
            }
        }
    }

    fn silent(&mut self, now: Instant, outbox: &mut Outbox) -> Option<Fault> {
        self.tries = self.tries.saturating_add(1);
        if self.tries == DISLODGE_AFTER {
            outbox.admin(Command::int(number::OPEN, 1));
            outbox.admin(Command::int(number::CLOSE, 1));
            self.settle(now);
            return Some(Fault::NoAnswer);
        }
        self.sync(0, now, outbox);
        if self.tries > START_OVER_AFTER {
            self.tries = 0;
        }
        None
    }
}
