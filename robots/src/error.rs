//! What is wrong with a robot file, where, and what to write instead.

use core::fmt;
use core::ops::Range;

/// A robot file that cannot be used.
///
/// Prints as `file:line:col: what is wrong; what to write`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotError {
    /// File as the user named it.
    pub file: String,
    /// Line, counted from 1; 0 if the file could not be read at all.
    pub line: usize,
    /// Column in characters, counted from 1; 0 if the file could not be read at all.
    pub column: usize,
    /// What is wrong.
    pub problem: String,
    /// What to write instead.
    pub advice: String,
}

impl fmt::Display for RobotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line == 0 {
            write!(f, "{}: {}; {}", self.file, self.problem, self.advice)
        } else {
            let (line, column) = (self.line, self.column);
            write!(
                f,
                "{}:{line}:{column}: {}; {}",
                self.file, self.problem, self.advice
            )
        }
    }
}

impl std::error::Error for RobotError {}

/// A text with a name, able to turn byte offsets into lines and columns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'t> {
    pub(crate) file: &'t str,
    pub(crate) text: &'t str,
}

impl Source<'_> {
    /// Error at the start of `span`.
    pub(crate) fn error(
        &self,
        span: &Range<usize>,
        problem: impl Into<String>,
        advice: impl Into<String>,
    ) -> RobotError {
        let before = self.text.get(..span.start).unwrap_or(self.text);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let column = before
            .get(line_start..)
            .map_or(0, |line| line.chars().count());
        RobotError {
            file: self.file.to_owned(),
            line: before.matches('\n').count() + 1,
            column: column + 1,
            problem: problem.into(),
            advice: advice.into(),
        }
    }
}
