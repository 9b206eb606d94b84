//! What a board answers.

use super::command::integer;

/// Which way the drive was told to turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Forward, or braking below zero.
    Forward,
    /// Reverse.
    Reverse,
    /// Pulse offset in µs.
    Direct,
    /// Disconnected from its battery.
    Off,
}

/// An answer about the drive: `F 300`, `OFF`, `OFF ~DMS=1000`, `~DMS=200`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveState {
    /// Mode and value, if the answer has them.
    pub drive: Option<(Mode, i32)>,
    /// Dead-man time, ms, if the answer has it.
    pub dead_man_ms: Option<u32>,
}

/// The code of an error message: `ERR(266)` or `ERR(266):text`; `None` if it is none.
///
/// An `ERR` that cannot be read is error 1, unknown: it must not pass for an answer.
#[must_use]
pub fn error_code(text: &str) -> Option<u16> {
    let rest = text.trim().strip_prefix("ERR")?;
    let code = rest
        .strip_prefix('(')
        .and_then(|rest| rest.split_once(')'))
        .and_then(|(code, _)| code.trim().parse().ok());
    Some(code.unwrap_or(super::error::UNKNOWN))
}

/// Reads an answer about the drive; `None` if it is anything else.
#[must_use]
pub fn drive_state(text: &str) -> Option<DriveState> {
    let mut state = DriveState {
        drive: None,
        dead_man_ms: None,
    };
    let mut words = text.split_ascii_whitespace();
    while let Some(word) = words.next() {
        let upper = |name: &str| word.eq_ignore_ascii_case(name);
        if let Some(value) = strip_option(word, "DMS") {
            let fresh = state.dead_man_ms.replace(value.parse().ok()?).is_none();
            fresh.then_some(())?;
            continue;
        }
        let (mode, value) = match () {
            () if upper("OFF") => (Mode::Off, 0),
            () if upper("F") => (Mode::Forward, integer(words.next()?)?),
            () if upper("B") => (Mode::Reverse, integer(words.next()?)?),
            () if upper("D") => (Mode::Direct, integer(words.next()?)?),
            () => return None,
        };
        state.drive.replace((mode, value)).is_none().then_some(())?;
    }
    (state.drive.is_some() || state.dead_man_ms.is_some()).then_some(state)
}

fn strip_option<'a>(word: &'a str, name: &str) -> Option<&'a str> {
    let (key, value) = word.strip_prefix('~')?.split_once('=')?;
    key.eq_ignore_ascii_case(name).then_some(value)
}

/// A number alone: the answer to `!STEER`.
#[must_use]
pub fn number(text: &str) -> Option<i32> {
    integer(text.trim())
}

/// A session number: the answer to `?SID` and `!SID`.
#[must_use]
pub fn session(text: &str) -> Option<u32> {
    let digits = text.trim();
    let plain = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    plain.then(|| digits.parse().ok())?
}
