//! Zero, dead-man time and its read-back, session, data groups: before anything may move.

use haltline::time::{Duration, Instant};

use super::{Config, GYRO_GROUP, WHEEL_GROUP, answers};
use crate::drive::Fault;
use crate::uc::command::{Command, DriveLevel};
use crate::uc::reply;

/// Quiet time at the start, so that answers to somebody else's commands have arrived.
const SETTLE: Duration = Duration::from_ms(120);

/// Where the set-up stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setup {
    since: Instant,
    /// Next step; counts up.
    step: u8,
}

impl Setup {
    pub(super) const fn new(now: Instant) -> Self {
        Self {
            since: now,
            step: 0,
        }
    }

    /// Nothing has been asked yet, so answers are none of ours.
    pub(super) const fn is_settling(self) -> bool {
        self.step == 0
    }

    /// The next command, once the one before is answered.
    ///
    /// - `stop`: zero, or the brake of a car that still rolls
    pub(super) fn next(
        &mut self,
        now: Instant,
        config: &Config,
        stop: DriveLevel,
    ) -> Option<Command> {
        if now.since(self.since).is_none_or(|waited| waited < SETTLE) {
            return None;
        }
        let command = match self.step {
            0 => Command::Drive(stop),
            1 => Command::SetDeadMan(config.dead_man_ms),
            2 => Command::GetDeadMan,
            3 => Command::SetSession(config.session),
            4 => Command::GetSession,
            5 => Command::StreamStop,
            6 => Command::DefineWheel(WHEEL_GROUP),
            7 => Command::DefineGyro(GYRO_GROUP),
            8 => Command::StreamStart,
            _ => return None,
        };
        self.step = self.step.saturating_add(1);
        Some(command)
    }

    /// Takes an answer; `true` when it was the last.
    pub(super) fn answer(
        &self,
        command: Command,
        text: &str,
        config: &Config,
    ) -> Result<bool, Fault> {
        if command == Command::StreamStop {
            // A board whose stream does not run may refuse to stop it.
            return Ok(false);
        }
        answers::check(command, text, config.session)?;
        if command == Command::GetDeadMan {
            let found = reply::drive_state(text).and_then(|state| state.dead_man_ms);
            let found_ms = found.map_or(u16::MAX, |ms| u16::try_from(ms).unwrap_or(u16::MAX));
            if found_ms != config.dead_man_ms || found_ms == 0 {
                return Err(Fault::DeadMan {
                    wanted_ms: config.dead_man_ms,
                    found_ms,
                });
            }
        }
        Ok(command == Command::StreamStart)
    }
}
