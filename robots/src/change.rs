//! Other values for some keys of a robot file: checked like the file itself, and never unnoticed.
//!
//! Refuses to add or remove keys: what the file does not state cannot be changed.

use serde::Serialize;

use crate::error::Source;
use crate::{Robot, parse};

/// Another value for one key of a robot file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Change {
    /// Dotted path such as `limits.braking_mps2` or `scanner.0.error_sigma_m`.
    pub key: String,
    /// The value as TOML, such as `0.005`.
    pub value: String,
    /// What the file says; filled in by [`Robot::with_changes`].
    pub before: String,
}

impl Change {
    /// A change whose former value is not known yet.
    #[must_use]
    pub fn new(key: &str, value: &str) -> Self {
        Self {
            key: key.to_owned(),
            value: value.to_owned(),
            before: String::new(),
        }
    }

    /// Whether the value is another one than that of the file, and not only written otherwise.
    #[must_use]
    pub fn differs(&self) -> bool {
        let number = |text: &str| text.parse::<f64>().ok();
        match (number(&self.value), number(&self.before)) {
            (Some(value), Some(before)) => value.total_cmp(&before).is_ne(),
            _ => self.value != self.before,
        }
    }

    /// The path as the reader of robot files writes it: `scanner[0].error_sigma_m`.
    fn path(&self) -> String {
        let mut path = String::new();
        for part in self.key.split('.') {
            if part.parse::<usize>().is_ok() {
                path.push_str(&format!("[{part}]"));
            } else {
                if !path.is_empty() {
                    path.push('.');
                }
                path.push_str(part);
            }
        }
        path
    }
}

/// A change that the robot cannot take.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChangeError {
    /// Which of the changes is to blame; `None` if only all of them together.
    pub index: Option<usize>,
    /// What is wrong and what to write.
    pub message: String,
}

impl Robot {
    /// The same robot with some values of its file replaced, and the former values filled in.
    ///
    /// The changed text is read like a file, so every bound and rule holds for it too.
    ///
    /// # Errors
    /// A key that the file does not have, or values that the rules of robot files refuse.
    pub fn with_changes(&self, changes: &mut [Change]) -> Result<Self, ChangeError> {
        let source = Source {
            file: &self.file,
            text: &self.text,
        };
        let (_, _, places) = parse::values(source).map_err(|error| ChangeError {
            index: None,
            message: error.to_string(),
        })?;
        let mut edits = Vec::new();
        for (index, change) in changes.iter_mut().enumerate() {
            let span = places.of(&change.path());
            let before = self.text.get(span.clone()).unwrap_or_default();
            if span.is_empty() || before.contains('\n') || before.starts_with('[') {
                return Err(ChangeError {
                    index: Some(index),
                    message: format!(
                        "{} has no key `{}`; write the dotted path of a value it has, such as \
                         \"tolerances.tracking_m\" or \"scanner.0.error_sigma_m\"",
                        self.file, change.key
                    ),
                });
            }
            change.before = before.to_owned();
            edits.push((span, index));
        }
        edits.sort_by_key(|(span, _)| core::cmp::Reverse(span.start));
        let mut text = self.text.clone();
        let mut lines = Vec::new();
        for (span, index) in edits {
            let line = self
                .text
                .get(..span.start)
                .unwrap_or("")
                .matches('\n')
                .count()
                + 1;
            lines.push((line, index));
            if let Some(change) = changes.get(index) {
                text.replace_range(span, &change.value);
            }
        }
        Self::parse(&text, &self.file).map_err(|error| {
            let blamed = lines.iter().find(|(line, _)| *line == error.line);
            ChangeError {
                index: blamed.map(|(_, index)| *index),
                message: match blamed {
                    Some(_) => format!("{}; {}", error.problem, error.advice),
                    None => format!("with these values {error}"),
                },
            }
        })
    }
}
