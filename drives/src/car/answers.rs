//! Which answer belongs to which command: the board answers each once and in order.

use haltline::time::{Duration, Instant};

use crate::drive::Fault;
use crate::uc::command::Command;
use crate::uc::reply::{self, Mode};

/// Most commands that may be unanswered.
const MAX: usize = 16;

/// Commands that wait for their answers, oldest first.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pending {
    queue: [Option<(Command, Instant)>; MAX],
}

impl Pending {
    /// Remembers a command; `false` if too many wait already.
    pub(super) fn push(&mut self, command: Command, now: Instant) -> bool {
        match self.queue.iter_mut().find(|slot| slot.is_none()) {
            Some(slot) => {
                *slot = Some((command, now));
                true
            }
            None => false,
        }
    }

    /// The command that the next answer belongs to.
    pub(super) fn pop(&mut self) -> Option<Command> {
        let oldest = self.queue[0].take();
        self.queue.rotate_left(1);
        oldest.map(|(command, _)| command)
    }

    /// Whether this command waits, too.
    pub(super) fn contains(&self, wanted: Command) -> bool {
        let waiting = self.queue.iter().flatten();
        waiting.into_iter().any(|(command, _)| *command == wanted)
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.queue[0].is_none()
    }

    /// The oldest command if it has waited longer than `most`.
    pub(super) fn overdue(&self, now: Instant, most: Duration) -> Option<Command> {
        let (command, since) = self.queue[0]?;
        now.since(since)
            .is_none_or(|gap| gap > most)
            .then_some(command)
    }
}

/// Whether `text` is the answer to `command`.
pub(super) fn check(command: Command, text: &str, session: u32) -> Result<(), Fault> {
    if let Some(code) = reply::error_code(text) {
        return Err(Fault::Refused(code));
    }
    let fits = match command {
        Command::Drive(level) => {
            let (letter, value) = level.words();
            let mode = if letter == 'F' {
                Mode::Forward
            } else {
                Mode::Reverse
            };
            let state = reply::drive_state(text);
            state.and_then(|state| state.drive) == Some((mode, i32::from(value)))
        }
        Command::Steer(level) => reply::number(text) == Some(i32::from(level.level())),
        Command::GetSession => {
            return match reply::session(text) {
                Some(found) if found == session => Ok(()),
                Some(_) => Err(Fault::Reboot),
                None => Err(Fault::Unexpected),
            };
        }
        Command::SetDeadMan(ms) => {
            let state = reply::drive_state(text);
            state.and_then(|state| state.dead_man_ms) == Some(u32::from(ms))
        }
        // The sheet does not say how the board answers this; reading it back decides.
        Command::SetSession(_) | Command::GetVersion => true,
        Command::GetDeadMan => reply::drive_state(text).is_some(),
        Command::StreamStart => text.eq_ignore_ascii_case("started"),
        Command::StreamStop => text.eq_ignore_ascii_case("stopped"),
        Command::DefineWheel(_) | Command::DefineGyro(_) => text.eq_ignore_ascii_case("ok"),
    };
    fits.then_some(()).ok_or(Fault::Unexpected)
}
