//! What a host says, and how a board reads it.

use core::fmt::Write as _;

use super::{FORWARD, REVERSE, STEERING};
use crate::cursor::Buffer;

/// One line to the board.
pub type Line = Buffer<96>;

/// A drive value that the board accepts; there is no way to make another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveLevel(Drive);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Drive {
    Forward(i16),
    Reverse(i16),
}

impl DriveLevel {
    /// Neutral: the car coasts.
    pub const NEUTRAL: Self = Self(Drive::Forward(0));
    /// The hardest brake there is, from forward motion only.
    pub const FULL_BRAKE: Self = Self(Drive::Forward(-500));

    /// Forward mode: above zero drives, below zero **brakes** and never reverses.
    #[must_use]
    pub fn forward(level: i16) -> Option<Self> {
        FORWARD
            .contains(&level)
            .then_some(Self(Drive::Forward(level)))
    }

    /// Reverse mode, as a magnitude.
    #[must_use]
    pub fn reverse(level: i16) -> Option<Self> {
        REVERSE
            .contains(&level)
            .then_some(Self(Drive::Reverse(level)))
    }

    /// Signed level: positive drives forward, negative backwards, zero neither. A brake is zero.
    #[must_use]
    pub const fn thrust(self) -> i16 {
        match self.0 {
            Drive::Forward(level) if level > 0 => level,
            Drive::Forward(_) => 0,
            Drive::Reverse(level) => level.saturating_neg(),
        }
    }

    /// How hard it brakes, 0 to 500.
    #[must_use]
    pub const fn brake(self) -> i16 {
        match self.0 {
            Drive::Forward(level) if level < 0 => level.saturating_neg(),
            _ => 0,
        }
    }

    /// The board's letter and number.
    #[must_use]
    pub const fn words(self) -> (char, i16) {
        match self.0 {
            Drive::Forward(level) => ('F', level),
            Drive::Reverse(level) => ('B', level),
        }
    }
}

/// A steering value that the board accepts; positive steers **right**.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SteeringLevel(i16);

impl SteeringLevel {
    /// Neutral pulse.
    pub const ZERO: Self = Self(0);

    /// As [`SteeringLevel::new`], for constants.
    #[must_use]
    pub const fn checked(level: i16) -> Option<Self> {
        if level >= *STEERING.start() && level <= *STEERING.end() {
            Some(Self(level))
        } else {
            None
        }
    }

    /// `None` outside ±1000.
    #[must_use]
    pub fn new(level: i16) -> Option<Self> {
        STEERING.contains(&level).then_some(Self(level))
    }

    /// The level.
    #[must_use]
    pub const fn level(self) -> i16 {
        self.0
    }
}

/// What an adapter asks of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// `!DRV`: thrust or brake, the number twice so that the board can compare.
    Drive(DriveLevel),
    /// `!STEER`, the number twice.
    Steer(SteeringLevel),
    /// `!DRV ~DMS`: dead-man time, ms; 0 would switch it off.
    SetDeadMan(u16),
    /// `?DRV ~DMS`.
    GetDeadMan,
    /// `?SID`: session number, 0 after a reset.
    GetSession,
    /// `!SID`.
    SetSession(u32),
    /// `?VER`.
    GetVersion,
    /// `!DAQ STOP`.
    StreamStop,
    /// `!DAQ START`.
    StreamStart,
    /// `!DAQ GRP`: wheel pulses, hexadecimal with CRC.
    DefineWheel(u8),
    /// `!DAQ GRP`: turn rate every 10 ms, averaged, hexadecimal with CRC.
    DefineGyro(u8),
}

impl Command {
    /// The command with its newline.
    ///
    /// Two spaces stand between a number and its check: if one were lost or spoiled, a single space
    /// would leave one number, wrong and unchecked.
    #[must_use]
    pub fn encode(self) -> Line {
        let mut line = Line::default();
        let written = match self {
            Self::Drive(level) => {
                let (mode, value) = level.words();
                writeln!(line, "!DRV {mode} {value}  {value}")
            }
            Self::Steer(SteeringLevel(level)) => writeln!(line, "!STEER {level}  {level}"),
            Self::SetDeadMan(ms) => writeln!(line, "!DRV ~DMS={ms}"),
            Self::GetDeadMan => writeln!(line, "?DRV ~DMS"),
            Self::GetSession => writeln!(line, "?SID"),
            Self::SetSession(id) => writeln!(line, "!SID {id}"),
            Self::GetVersion => writeln!(line, "?VER"),
            Self::StreamStop => writeln!(line, "!DAQ STOP"),
            Self::StreamStart => writeln!(line, "!DAQ START"),
            Self::DefineWheel(n) => {
                writeln!(line, "!DAQ GRP {n} HALL_CNT HALL_DT ~ANY ~ENC=HEX ~CRC")
            }
            Self::DefineGyro(n) => writeln!(line, "!DAQ GRP {n} GZ ~TS=10 ~AVG ~ENC=HEX ~CRC"),
        };
        // Every line is far shorter than the buffer.
        debug_assert!(written.is_ok());
        line
    }
}

/// Most words, and most options, of a line that are kept.
const WORDS_MAX: usize = 22;

/// A line as the board reads it: `!` or `?`, words, and options that may stand anywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request<'a> {
    /// `true` for `!`.
    pub set: bool,
    words: [Option<&'a str>; WORDS_MAX],
    options: [Option<(&'a str, Option<&'a str>)>; WORDS_MAX],
}

impl<'a> Request<'a> {
    /// Takes a line apart.
    ///
    /// # Errors
    /// The board's error code.
    pub fn parse(line: &'a [u8]) -> Result<Self, u16> {
        let text = core::str::from_utf8(line).map_err(|_| super::error::PARSE)?;
        let set = match text.chars().next() {
            Some('!') => true,
            Some('?') => false,
            _ => return Err(super::error::WRONG_START),
        };
        let mut request = Self {
            set,
            words: [None; WORDS_MAX],
            options: [None; WORDS_MAX],
        };
        let (mut words, mut options) = (0_usize, 0_usize);
        for word in text.get(1..).unwrap_or_default().split_ascii_whitespace() {
            if words.saturating_add(options) > WORDS_MAX {
                return Err(super::error::WRONG_USAGE);
            }
            if let Some(option) = word.strip_prefix('~') {
                let pair = option.split_once('=');
                let slot = request.options.get_mut(options);
                *slot.ok_or(super::error::WRONG_USAGE)? =
                    Some(pair.map_or((option, None), |(name, value)| (name, Some(value))));
                options = options.saturating_add(1);
            } else {
                let slot = request.words.get_mut(words);
                *slot.ok_or(super::error::WRONG_USAGE)? = Some(word);
                words = words.saturating_add(1);
            }
        }
        Ok(request)
    }

    /// Word number `index`, the command itself being 0.
    #[must_use]
    pub fn word(&self, index: usize) -> Option<&'a str> {
        self.words.get(index).copied().flatten()
    }

    /// Whether word `index` is `text`, whatever its case.
    #[must_use]
    pub fn is(&self, index: usize, text: &str) -> bool {
        self.word(index)
            .is_some_and(|word| word.eq_ignore_ascii_case(text))
    }

    /// Words from `index` on.
    pub fn words_from(&self, index: usize) -> impl Iterator<Item = &'a str> {
        self.words.iter().skip(index).copied().flatten()
    }

    /// An option: `None` if it is not there, `Some(None)` if it has no value.
    #[must_use]
    #[allow(clippy::option_option)] // three states, exactly these
    pub fn option(&self, name: &str) -> Option<Option<&'a str>> {
        self.options
            .iter()
            .flatten()
            .find(|(known, _)| known.eq_ignore_ascii_case(name))
            .map(|(_, value)| *value)
    }

    /// The number in word `index`, which may be given twice as a check.
    ///
    /// # Errors
    /// The board's error code: no integer, or two that differ.
    pub fn checked_number(&self, index: usize) -> Result<i32, u16> {
        let number = |at: usize| -> Result<Option<i32>, u16> {
            self.word(at)
                .map(|word| integer(word).ok_or(super::error::PARSE))
                .transpose()
        };
        let first = number(index)?.ok_or(super::error::WRONG_USAGE)?;
        match number(index.saturating_add(1))? {
            Some(second) if second != first => Err(super::error::CORRUPTED),
            _ => Ok(first),
        }
    }
}

/// An integer as the board understands it: an optional minus and digits, no plus, no point.
#[must_use]
pub fn integer(word: &str) -> Option<i32> {
    let digits = word.strip_prefix('-').unwrap_or(word);
    let plain = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    plain.then(|| word.parse().ok())?
}
