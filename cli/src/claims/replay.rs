//! The command that shows a run again.

use haltline_scenarios::result::CaseResult;

/// How to show a case again.
#[derive(Clone, Debug)]
pub struct Replay {
    /// Folder of the scenario files as the user may type it.
    pub folder: String,
    /// Robot file, if it must be named.
    pub robot: Option<String>,
    /// Control period, seconds.
    pub period_s: f64,
}

impl Replay {
    /// The command that runs a case alone.
    #[must_use]
    pub fn command(&self, case: &CaseResult) -> String {
        let file = format!("{}/{}.toml", self.folder, case.group);
        let mut command = format!("haltline run {file}");
        if let Some(variant) = case.name.strip_prefix(&format!("{}/", case.group)) {
            command.push_str(&format!(" --variant '{variant}'"));
        }
        if let Some(robot) = &self.robot {
            command.push_str(&format!(" --robot {robot}"));
        }
        command
    }

    /// The command that runs the first variant of a sweep.
    #[must_use]
    pub fn first_of(&self, group: &str) -> String {
        format!("haltline run {}/{group}.toml", self.folder)
    }

    /// Number of the tick at a time of the run, if the control period is known.
    #[must_use]
    pub fn tick(&self, t_s: f64) -> Option<u64> {
        (self.period_s > 0.0).then(|| (t_s / self.period_s).round().max(0.0) as u64)
    }
}
