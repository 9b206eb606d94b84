//! Where things stand in a scenario file, for complaints that only show when robot and file meet.

use std::collections::BTreeMap;

use super::error::position;
use super::{Scenario, ScenarioError};

/// Line and column, from 1, of the parts of a file that may be complained about later.
///
/// Paths look like `wall.0`, `box.1`, `circle.2`, `step.0`, `proposer`, `robot_values.KEY`, `told.KEY`. In the
/// variants of a sweep they are the places in the file as it was written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Places {
    file: String,
    found: BTreeMap<String, (usize, usize)>,
}

impl Places {
    /// Notes the places of a scenario that was read from `text`.
    pub(super) fn new(scenario: &Scenario, file: &str, text: &str) -> Self {
        let mut places = Self {
            file: file.to_owned(),
            found: BTreeMap::new(),
        };
        let mut note = |path: String, span: core::ops::Range<usize>| {
            places.found.insert(path, position(text, span.start));
        };
        let numbered = |list: &str, spans: Vec<core::ops::Range<usize>>| {
            let list = list.to_owned();
            spans
                .into_iter()
                .enumerate()
                .map(move |(index, span)| (format!("{list}.{index}"), span))
                .collect::<Vec<_>>()
        };
        let proposer = scenario.proposer.get_ref();
        let lists = [
            numbered("wall", scenario.wall.iter().map(|s| s.span()).collect()),
            numbered("box", scenario.boxes.iter().map(|s| s.span()).collect()),
            numbered("circle", scenario.circle.iter().map(|s| s.span()).collect()),
            numbered("step", proposer.step.iter().map(|s| s.span()).collect()),
        ];
        for (path, span) in lists.into_iter().flatten() {
            note(path, span);
        }
        note("proposer".to_owned(), scenario.proposer.span());
        for key in scenario.told.keys() {
            note(format!("told.{}", key.get_ref()), key.span());
        }
        for key in scenario.robot_values.keys() {
            note(format!("robot_values.{}", key.get_ref()), key.span());
        }
        places
    }

    /// A complaint about the part at `path`; about the whole file if that part is unknown.
    #[must_use]
    pub fn complain(&self, path: &str, message: String) -> ScenarioError {
        let (line, column) = self.found.get(path).copied().unwrap_or((0, 0));
        ScenarioError {
            file: self.file.clone(),
            line,
            column,
            message,
        }
    }
}
