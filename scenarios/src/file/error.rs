//! What is wrong with a scenario file, where, and what to write instead.

use core::fmt;
use core::ops::Range;

/// A scenario file that cannot be run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScenarioError {
    /// File as it was named.
    pub file: String,
    /// Line, from 1; 0 if the error belongs to the file as a whole.
    pub line: usize,
    /// Column, from 1; 0 if the error belongs to the file as a whole.
    pub column: usize,
    /// What is wrong and what to write.
    pub message: String,
}

impl ScenarioError {
    /// An error at a byte range of `text`.
    #[must_use]
    pub fn at(file: &str, text: &str, span: Option<Range<usize>>, message: String) -> Self {
        let (line, column) = span.map_or((0, 0), |span| position(text, span.start));
        Self {
            file: file.to_owned(),
            line,
            column,
            message,
        }
    }

    /// An error of the file as a whole.
    #[must_use]
    pub fn whole(file: &str, message: String) -> Self {
        Self::at(file, "", None, message)
    }
}

/// Line and column, both from 1, of a byte offset.
pub(super) fn position(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before
        .rsplit('\n')
        .next()
        .map_or(1, |tail| tail.chars().count() + 1);
    (line, column)
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line == 0 {
            write!(f, "{}: {}", self.file, self.message)
        } else {
            write!(
                f,
                "{}:{}:{}: {}",
                self.file, self.line, self.column, self.message
            )
        }
    }
}

impl std::error::Error for ScenarioError {}
