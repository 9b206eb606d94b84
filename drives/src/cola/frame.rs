//! Telegrams in a stream.

/// Most bytes of a telegram: 1100 ranges of at most five characters and a header.
const TELEGRAM_MAX: usize = 8192;

const STX: u8 = 2;
const ETX: u8 = 3;

/// What is wrong with bytes that should be a telegram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TelegramError {
    /// Longer than any telegram; read over to its end.
    TooLong,
    /// A telegram began before the one before ended.
    CutShort,
    /// Bytes that are not ASCII.
    NotText,
}

/// Finds telegrams in a stream; about 8 KB.
#[derive(Clone, Debug)]
pub struct Deframer {
    text: [u8; TELEGRAM_MAX],
    len: usize,
    inside: bool,
    too_long: bool,
}

impl Default for Deframer {
    fn default() -> Self {
        Self {
            text: [0; TELEGRAM_MAX],
            len: 0,
            inside: false,
            too_long: false,
        }
    }
}

impl Deframer {
    /// Takes one byte; a telegram comes back without its frame. Bytes between telegrams are skipped.
    pub fn push(&mut self, byte: u8) -> Option<Result<&str, TelegramError>> {
        match byte {
            STX => {
                let cut = self.inside;
                (self.inside, self.len, self.too_long) = (true, 0, false);
                cut.then_some(Err(TelegramError::CutShort))
            }
            ETX if self.inside => {
                self.inside = false;
                if self.too_long {
                    return Some(Err(TelegramError::TooLong));
                }
                let text = self.text.get(..self.len).unwrap_or_default();
                Some(match core::str::from_utf8(text) {
                    Ok(text) if text.is_ascii() => Ok(text),
                    _ => Err(TelegramError::NotText),
                })
            }
            byte if self.inside => {
                match self.text.get_mut(self.len) {
                    Some(slot) => {
                        *slot = byte;
                        self.len = self.len.saturating_add(1);
                    }
                    None => self.too_long = true,
                }
                None
            }
            _ => None,
        }
    }
}

/// Writes a telegram with its frame through `put`.
pub fn frame_into(text: &str, mut put: impl FnMut(&[u8])) {
    put(&[STX]);
    put(text.as_bytes());
    put(&[ETX]);
}
