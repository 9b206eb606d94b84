//! Readers of recorded drives: the project's own CSV ([`sena`]), [`carmen`] logs and [`mrclam`] data sets.
//!
//! Each refuses a line that does not fit, with file and line; nothing is skipped in silence. Parsing is
//! apart from reading files, so that tests and fuzzers hand in any text.

pub mod carmen;
pub mod mrclam;
pub mod sena;

use std::fmt;
use std::path::Path;

/// A log that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogError {
    /// File, line where there is one, and what is wrong.
    pub message: String,
}

impl LogError {
    fn input(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
        }
    }

    fn line(file: &Path, line: usize, message: impl fmt::Display) -> Self {
        Self::input(format!("{}:{line}: {message}", file.display()))
    }

    fn read(file: &Path, error: &std::io::Error) -> Self {
        Self::input(format!("{}: cannot be read: {error}", file.display()))
    }
}

impl fmt::Display for LogError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.message)
    }
}

impl std::error::Error for LogError {}

/// A number that is one: `nan` and `inf` are none.
fn number(word: &str) -> Option<f64> {
    word.trim()
        .parse::<f64>()
        .ok()
        .filter(|value| value.is_finite())
}
