//! Messages in a stream: lines to the board, `[STX] kind text ETX [newline]` from it.

use crate::cursor::Buffer;

/// Most bytes of a message from the board that are kept.
pub const MESSAGE_MAX: usize = 512;
/// Most bytes of a line to the board, its newline included.
pub const LINE_MAX: usize = 1000;

const STX: u8 = 2;
const ETX: u8 = 3;

/// What is wrong with bytes that should be a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineError {
    /// Longer than [`MESSAGE_MAX`] or [`LINE_MAX`]; read over to its end.
    TooLong,
    /// A message began before the one before ended.
    CutShort,
    /// It does not begin with one of the characters that say what it is.
    UnknownKind(u8),
    /// It contains bytes that are not printable ASCII.
    NotText,
}

/// What the first character of a message says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `:` answers a command.
    Answer,
    /// `'` is for people, or an error nobody asked for.
    Display,
    /// `#` carries data.
    Data,
}

/// One message of the board, without its frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message {
    /// What it is.
    pub kind: Kind,
    text: Buffer<MESSAGE_MAX>,
}

impl Message {
    /// The text after the kind.
    #[must_use]
    pub fn text(&self) -> &str {
        core::str::from_utf8(self.text.as_slice()).unwrap_or_default()
    }
}

/// Finds the board's messages in a stream.
///
/// The STX is optional: firmware before 0.12.0 does not send one. Newlines between messages are
/// skipped.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deframer {
    text: Buffer<MESSAGE_MAX>,
    too_long: bool,
}

impl Deframer {
    /// Takes one byte.
    ///
    /// # Bound
    /// O(length) once for each message, O(1) otherwise; no state grows.
    pub fn push(&mut self, byte: u8) -> Option<Result<Message, LineError>> {
        match byte {
            STX => {
                let cut = !self.text.is_empty() || self.too_long;
                self.restart();
                cut.then_some(Err(LineError::CutShort))
            }
            ETX => {
                let message = self.finish();
                self.restart();
                message
            }
            b'\r' | b'\n' if self.text.is_empty() => None,
            byte => {
                self.too_long |= !self.text.push(byte);
                None
            }
        }
    }

    fn restart(&mut self) {
        self.text.clear();
        self.too_long = false;
    }

    fn finish(&self) -> Option<Result<Message, LineError>> {
        if self.too_long {
            return Some(Err(LineError::TooLong));
        }
        let (first, rest) = self.text.as_slice().split_first()?;
        let kind = match first {
            b':' => Kind::Answer,
            b'\'' => Kind::Display,
            b'#' => Kind::Data,
            other => return Some(Err(LineError::UnknownKind(*other))),
        };
        let printable = |byte: &u8| matches!(byte, b' '..=b'~' | b'\r' | b'\n' | b'\t');
        if !rest.iter().all(printable) {
            return Some(Err(LineError::NotText));
        }
        let mut text = Buffer::default();
        // It comes from a buffer of the same size.
        let _ = text.extend(rest);
        Some(Ok(Message { kind, text }))
    }
}

/// Finds the host's lines in a stream, for whoever plays the board.
#[derive(Clone, Copy, Debug, Default)]
pub struct LineReader {
    line: Buffer<LINE_MAX>,
    too_long: bool,
}

impl LineReader {
    /// Takes one byte; a whole line comes back without its newline.
    pub fn push(&mut self, byte: u8) -> Option<Result<Buffer<LINE_MAX>, LineError>> {
        if byte != b'\n' {
            self.too_long |= !self.line.push(byte);
            return None;
        }
        let (line, too_long) = (self.line, self.too_long);
        *self = Self::default();
        Some(if too_long {
            Err(LineError::TooLong)
        } else {
            Ok(line)
        })
    }
}
