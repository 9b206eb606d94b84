//! What is wrong with a map file, where, and what to write instead.

use core::fmt;

/// A map that cannot be read or written.
///
/// Prints as `file:line: what is wrong; what to write`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MapError {
    /// File as the user named it.
    pub file: String,
    /// Line, counted from 1; 0 if no line is to blame.
    pub line: usize,
    /// What is wrong.
    pub problem: String,
    /// What to write instead.
    pub advice: String,
}

impl MapError {
    pub(crate) fn new(
        file: &str,
        line: usize,
        problem: impl Into<String>,
        advice: impl Into<String>,
    ) -> Self {
        Self {
            file: file.to_owned(),
            line,
            problem: problem.into(),
            advice: advice.into(),
        }
    }
}

impl fmt::Display for MapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if self.line > 0 {
            write!(f, ":{}", self.line)?;
        }
        write!(f, ": {}; {}", self.problem, self.advice)
    }
}

impl std::error::Error for MapError {}

/// Text from a file, fit to be shown: short and without control characters.
pub(crate) fn shown(text: &str) -> String {
    const LENGTH: usize = 40;
    let mut shown: String = text
        .chars()
        .take(LENGTH)
        .map(|c| if c.is_control() { '?' } else { c })
        .collect();
    if text.chars().nth(LENGTH).is_some() {
        shown.push_str("...");
    }
    shown
}
