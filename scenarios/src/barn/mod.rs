//! Worlds of the BARN benchmark: read from CSV, turned into scenarios, scored by its own rule.
//!
//! Task, robot and score: Perille et al. 2020, "Benchmarking Metric Ground Navigation", and the
//! navigation competitions built on it. Refuses a world whose reference path runs through its own
//! cylinders: then path and cylinders are not in the same frame.

mod csv;
mod path;
mod text;

#[cfg(test)]
mod tests;

use std::path::Path;

use crate::file::ScenarioError;

/// Radius of every cylinder, metres.
pub const CYLINDER_RADIUS_M: f64 = 0.075;
/// Where the robot starts: x, y in metres, heading in radians.
pub const START: [f64; 3] = [-2.0, 3.0, 1.57];
/// Where it has to go, metres.
pub const GOAL_M: [f64; 2] = [-2.0, 13.0];
/// It is there within this distance of the goal, metres.
pub const GOAL_RADIUS_M: f64 = 1.0;
/// After this the run has failed, seconds.
pub const TIMEOUT_S: f64 = 100.0;
/// Speed of the benchmark's ideal robot, m/s.
const IDEAL_SPEED_MPS: f64 = 2.0;

/// One world.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    /// Stem of its file.
    pub name: String,
    /// Centres of the cylinders, metres.
    pub cylinders_m: Vec<[f64; 2]>,
    /// The published reference path, metres.
    pub path_m: Vec<[f64; 2]>,
}

/// What may differ from one import to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Bound of the range error that the kernel is told, metres.
    pub sensor_bound_m: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            sensor_bound_m: 0.005,
        }
    }
}

/// Standard deviation of the simulated lidar's noise, metres.
pub const NOISE_SIGMA_M: f64 = 0.001;

/// Largest bound that an import takes: the robot file's key allows no more, metres.
pub const SENSOR_BOUND_MAX_M: f64 = 0.5;

impl World {
    /// Reads a world.
    ///
    /// # Errors
    /// The file cannot be read, a line does not fit, or the path runs through the cylinders.
    pub fn read(file: &Path) -> Result<Self, ScenarioError> {
        let shown = file.display().to_string();
        let text = std::fs::read_to_string(file).map_err(|error| {
            let message = format!("cannot be read ({error}); name a world of BARN as CSV");
            ScenarioError::whole(&shown, message)
        })?;
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        Self::parse(&text, &shown, &stem)
    }

    /// Reads the text of a world; `file` is used in messages.
    ///
    /// # Errors
    /// As [`World::read`].
    pub fn parse(text: &str, file: &str, stem: &str) -> Result<Self, ScenarioError> {
        csv::parse(text, file, stem)
    }

    /// The world as the text of a scenario file for the Jackal.
    #[must_use]
    pub fn scenario_text(&self, options: &Options) -> String {
        text::scenario(self, options)
    }

    /// Points to pass: the published path, thinned where straight lines keep as clear as it does.
    #[must_use]
    pub fn via_m(&self) -> Vec<[f64; 2]> {
        path::thinned(self)
    }

    /// The benchmark's optimal time: start, reference path and goal at its ideal speed, seconds.
    #[must_use]
    pub fn optimal_time_s(&self) -> f64 {
        let [x, y, _] = START;
        let way = core::iter::once([x, y])
            .chain(self.path_m.iter().copied())
            .chain([GOAL_M]);
        path::length_m(way) / IDEAL_SPEED_MPS
    }

    /// The benchmark's score of one run: at most 0.25, nothing without success.
    #[must_use]
    pub fn score(&self, success: bool, time_s: f64) -> f64 {
        let optimal_s = self.optimal_time_s();
        let counted_s = time_s.clamp(4.0 * optimal_s, 8.0 * optimal_s);
        if success { optimal_s / counted_s } else { 0.0 }
    }
}
