//! Robot files: what a robot is, in SI units with its sources, and as the kernel's integers.
//!
//! [`Robot::load`] parses a TOML file against the [`schema`], refuses impossible
//! combinations and converts outward, so that rounding only ever enlarges the
//! kernel's margins. This crate refuses to guess: every key is required, every
//! unknown key is an error, and every error says where it is and what to write.

mod change;
pub mod contract;
mod error;
mod kernel_config;
mod parse;
mod reader;
mod robot;
mod rules;
mod scanner;
pub mod schema;
mod sources;
mod suggest;
mod template;

use std::path::Path;

use haltline::checked::KernelConfig;

pub use change::{Change, ChangeError};
pub use error::RobotError;
use error::Source;
pub use robot::{
    Footprint, HostDeath, Kinematics, Limits, Memory, Ramps, Robot, Silence, Steering, Timing,
    Tolerances, Values, Zone,
};
pub use scanner::{Encoding, Mask, Scanner};

pub use sources::Sourced;
pub use template::{key_list, template};

/// Most scanners of one robot.
pub const SCANNERS: usize = 4;

/// Most beams of one scanner.
pub const BEAMS: usize = 1100;

/// Points that the kernel remembers.
pub const MEMORY: usize = 1024;

/// The kernel's configuration of a robot from a file.
pub type RobotConfig = haltline::config::Config<SCANNERS>;

/// The robot files that come with the project: name and text.
pub const EMBEDDED: &[(&str, &str)] = &[
    ("seekur_jr", include_str!("../seekur_jr.toml")),
    ("pses_car", include_str!("../pses_car.toml")),
    ("jackal", include_str!("../jackal.toml")),
    ("sena", include_str!("../sena.toml")),
];

impl Robot {
    /// Reads and checks a robot file.
    ///
    /// # Errors
    /// The file cannot be read, or [`Robot::parse`] refuses it.
    pub fn load(path: &Path) -> Result<Self, RobotError> {
        let file = path.display().to_string();
        match std::fs::read_to_string(path) {
            Ok(text) => Self::parse(&text, &file),
            Err(error) => Err(RobotError {
                file,
                line: 0,
                column: 0,
                problem: format!("cannot read the robot file ({error})"),
                advice: "name an existing UTF-8 text file, or make one with `haltline new robot`"
                    .to_owned(),
            }),
        }
    }

    /// Checks the text of a robot file; `file_name` is used in messages.
    ///
    /// # Errors
    /// Unknown or missing keys, wrong types, values out of bounds, and
    /// combinations that no robot can have.
    pub fn parse(text: &str, file_name: &str) -> Result<Self, RobotError> {
        let source = Source {
            file: file_name,
            text,
        };
        let (name, values, places) = parse::values(source)?;
        rules::check(source, &values, &places)?;
        let config = kernel_config::config(&values).map_err(|misfit| {
            source.error(
                &places.of(&misfit.0),
                format!("`{}` does not fit the kernel's integers", misfit.0),
                "write a value nearer to that of a real robot",
            )
        })?;
        if let Err(error) = KernelConfig::new(config, BEAMS) {
            let (path, problem, advice) = rules::of_kernel(error);
            return Err(source.error(&places.of(&path), problem, advice));
        }
        Ok(Self {
            name,
            file: file_name.to_owned(),
            text: text.to_owned(),
            values,
            config,
        })
    }

    /// One of the robots that come with the project, such as `"seekur_jr"`.
    ///
    /// # Errors
    /// There is no robot of that name; the message lists those there are.
    pub fn embedded(name: &str) -> Result<Self, RobotError> {
        let Some((_, text)) = EMBEDDED.iter().find(|(known, _)| *known == name) else {
            let known: Vec<_> = EMBEDDED.iter().map(|(known, _)| *known).collect();
            return Err(RobotError {
                file: name.to_owned(),
                line: 0,
                column: 0,
                problem: "no robot of this name comes with the project".to_owned(),
                advice: format!("write one of: {}", known.join(", ")),
            });
        };
        Self::parse(text, &format!("{name}.toml"))
    }

    /// The same robot where bodies move at most at `speed_mps`.
    ///
    /// Returns `None` if the speed is negative, not finite or too large.
    #[must_use]
    pub fn with_obstacle_speed(&self, speed_mps: f64) -> Option<Self> {
        let mut values = self.values.clone();
        values.obstacle_speed_mps = speed_mps;
        (speed_mps >= 0.0).then_some(())?;
        self.with_values(values)
    }

    /// The same robot with or without host death in the guard's tube.
    #[must_use]
    pub fn with_cover_host_death(&self, cover: bool) -> Option<Self> {
        let mut values = self.values.clone();
        values.host_death.cover_host_death = cover;
        self.with_values(values)
    }

    fn with_values(&self, values: Values) -> Option<Self> {
        let config = kernel_config::config(&values).ok()?;
        Some(Self {
            name: self.name.clone(),
            file: self.file.clone(),
            text: self.text.clone(),
            values,
            config,
        })
    }
}

#[cfg(test)]
mod tests;
