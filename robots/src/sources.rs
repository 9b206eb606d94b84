//! Where the values of a robot file come from, as its comments say.

use serde::Serialize;

use crate::Robot;

/// A value of the file with the comment behind it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Sourced {
    /// Table and key, for example `limits.braking_mps2`.
    pub key: String,
    /// The value as written.
    pub value: String,
    /// The comment behind it.
    pub source: String,
    /// Whether the comment says that the value is assumed.
    pub assumed: bool,
}

impl Robot {
    /// Every value of the file with the comment behind it, in the order of the file.
    #[must_use]
    pub fn sources(&self) -> Vec<Sourced> {
        let mut table = String::new();
        let mut out = Vec::new();
        for line in self.text.lines() {
            let line = line.trim();
            if line.starts_with('[') {
                let header = line.split('#').next().unwrap_or(line).trim();
                table = header.trim_matches(['[', ']']).trim().to_owned();
            } else if let Some((key, rest)) =
                line.split_once('=').filter(|_| !line.starts_with('#'))
            {
                let (value, source) = split_comment(rest);
                out.push(Sourced {
                    key: format!("{table}.{}", key.trim()),
                    value: value.to_owned(),
                    source: source.to_owned(),
                    assumed: source.to_lowercase().contains("assumed"),
                });
            }
        }
        out
    }
}

/// Value and comment; a `#` inside quotes belongs to the value.
fn split_comment(rest: &str) -> (&str, &str) {
    let mut quoted = false;
    for (index, character) in rest.char_indices() {
        match character {
            '"' => quoted = !quoted,
            '#' if !quoted => {
                let (value, comment) = rest.split_at(index);
                return (value.trim(), comment.trim_start_matches('#').trim());
            }
            _ => {}
        }
    }
    (rest.trim(), "")
}
