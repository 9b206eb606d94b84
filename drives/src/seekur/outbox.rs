//! What waits to be sent: the newest of each kind, stops first, one packet every 5 ms.

use haltline::time::{Duration, Instant};

use super::wire::Words;
use crate::arcos::command::number;
use crate::arcos::{COMMAND_SPACING_MS, Command};
use crate::cursor::Buffer;

/// Most administrative commands that wait.
const ADMIN_MAX: usize = 16;

/// Packets to be sent.
#[derive(Clone, Debug, Default)]
pub(super) struct Outbox {
    emergency: bool,
    stop: bool,
    /// The newest set point.
    words: Option<Words>,
    /// Second half of a set point whose first is on the wire: halves of two are never mixed.
    second: Option<(u8, i32)>,
    /// Number and argument, oldest first.
    admin: [Option<(u8, Option<i32>)>; ADMIN_MAX],
    partial: Buffer<258>,
    sent: Instant,
}

impl Outbox {
    /// Forgets what waits.
    pub(super) fn clear(&mut self) {
        *self = Self {
            // A packet that is half on the wire is finished, or it would spoil the next.
            partial: self.partial,
            sent: self.sent,
            ..Self::default()
        };
    }

    /// The rest of a packet must not reach a new link: it could complete an old set point there.
    pub(super) const fn forget_partial(&mut self) {
        self.partial.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        let set_points = self.words.is_none() && self.second.is_none();
        let stops = !self.emergency && !self.stop;
        set_points && stops && self.admin[0].is_none() && self.partial.is_empty()
    }

    /// When the last packet was begun.
    pub(super) const fn sent(&self) -> Instant {
        self.sent
    }

    pub(super) const fn emergency(&mut self) {
        self.emergency = true;
    }

    pub(super) const fn stop(&mut self) {
        self.stop = true;
    }

    /// Replaces the set point that waits.
    pub(super) const fn set(&mut self, words: Words) {
        self.words = Some(words);
    }

    /// Queues a command that moves nothing; a full queue loses it, as a line might.
    pub(super) fn admin(&mut self, command: Command<'_>) {
        let argument = match command.argument {
            crate::arcos::Argument::Int(value) => Some(value),
            _ => None,
        };
        if let Some(slot) = self.admin.iter_mut().find(|slot| slot.is_none()) {
            *slot = Some((command.number, argument));
        }
    }

    fn next(&mut self) -> Option<Command<'static>> {
        if core::mem::take(&mut self.emergency) {
            return Some(Command::bare(number::E_STOP));
        }
        if core::mem::take(&mut self.stop) {
            return Some(Command::bare(number::STOP));
        }
        if let Some((number, value)) = self.second.take() {
            return Some(Command::int(number, value));
        }
        match self.words.take() {
            Some(Words::VelRvel { mmps, degps }) => {
                self.second = Some((number::RVEL, degps));
                return Some(Command::int(number::VEL, mmps));
            }
            Some(Words::Vel2 { left, right }) => return Some(Command::vel2(left, right)),
            None => {}
        }
        let (number, argument) = self.admin[0].take()?;
        self.admin.rotate_left(1);
        Some(argument.map_or(Command::bare(number), |value| Command::int(number, value)))
    }

    /// Copies what may be sent at `now`.
    pub(super) fn drain(&mut self, out: &mut [u8], now: Instant) -> usize {
        let spacing = Duration::from_ms(COMMAND_SPACING_MS);
        let due = now.since(self.sent).is_none_or(|gap| gap >= spacing);
        if self.partial.is_empty()
            && due
            && let Some(packet) = self.next().and_then(|command| command.encode())
        {
            self.partial = packet.to_bytes();
            self.sent = now;
        }
        self.partial.drain_into(out)
    }
}
