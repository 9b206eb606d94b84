//! What is attacked.

use haltline_robots::{Change, Robot};
use std::collections::BTreeMap;
use std::path::Path;

/// The robot and how far the attacker may go.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The robot as its file says.
    pub robot: Robot,
    /// Name by which scenarios call it: the stem of its file.
    pub name: String,
    /// Other values for the robot, by dotted key.
    pub values: BTreeMap<String, toml::Value>,
    /// What the kernel is told instead of the truth, by dotted key.
    pub told: BTreeMap<String, toml::Value>,
    /// Whether each scenario breaks an assumption.
    pub breaking: bool,
    /// The robot with its other values: the truth.
    pub truth: Robot,
}

impl Setting {
    /// A setting.
    ///
    /// # Errors
    /// A key that the robot file does not have, or values that its rules refuse, in words.
    pub fn new(
        robot: Robot,
        values: BTreeMap<String, toml::Value>,
        told: BTreeMap<String, toml::Value>,
        breaking: bool,
    ) -> Result<Self, String> {
        let with = |robot: &Robot, values: &BTreeMap<String, toml::Value>| {
            let mut changes: Vec<Change> = values
                .iter()
                .map(|(key, value)| Change::new(key, &value.to_string()))
                .collect();
            if changes.is_empty() {
                return Ok(robot.clone());
            }
            robot.with_changes(&mut changes).map_err(|error| {
                let key = error.index.and_then(|index| changes.get(index));
                key.map_or_else(
                    || error.message.clone(),
                    |change| format!("{}: {}", change.key, error.message),
                )
            })
        };
        let truth = with(&robot, &values)?;
        // What is told must be a possible robot, too; scenarios say more exactly what is wrong.
        let mut all = values.clone();
        all.extend(told.clone());
        with(&robot, &all)?;
        let stem = Path::new(&robot.file).file_stem();
        let name = stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Ok(Self {
            robot,
            name,
            values,
            told,
            breaking,
            truth,
        })
    }
}
