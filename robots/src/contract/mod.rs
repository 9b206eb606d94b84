//! The contract: whether a robot's limits are consistent with what it sees and how it stops.
//!
//! Plain arithmetic on the robot file and on the tubes that the kernel itself
//! would reserve ([`Tubes`]); nothing here is simulated, and nothing here makes
//! a motion safe that the guard would refuse. All distances are worst cases over
//! everything the file allows: oldest odometry, latest tick, least braking.

mod blind;
mod checks;
mod kernel_tubes;
mod model;
mod tables;
mod timing;
mod tubes;

use serde::Serialize;

use crate::Robot;

pub use kernel_tubes::KernelTubes;
pub use model::ModelTubes;
pub use tubes::{Reserve, Term, Tubes};

/// Obstacle speeds of the tables, m/s: static, crossing (Loh 2018, 6.2.2), half of it, and a
/// person's walk (ISO 13855).
pub const OBSTACLE_SPEEDS_MPS: [f64; 4] = [0.0, 0.5, 1.0, 1.6];

/// What a check found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// The values fit together.
    Holds,
    /// They do not; the sentence says what to change.
    Fails,
    /// The contract does not cover this, and the sentence says so.
    NotCovered,
}

/// One check of the contract.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Stable id, for example `C-STOP`.
    pub id: &'static str,
    /// What is checked.
    pub title: &'static str,
    /// What came out.
    pub finding: Finding,
    /// The computed value.
    pub value: f64,
    /// What it is compared with.
    pub bound: f64,
    /// Unit of both.
    pub unit: &'static str,
    /// The result in words, with the figures and, if it fails, what to change.
    pub sentence: String,
}

impl Check {
    /// Whether the check holds.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.finding == Finding::Holds
    }
}

/// Top speed for one obstacle speed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpeedRow {
    /// Largest speed of anything that moves, m/s.
    pub obstacle_speed_mps: f64,
    /// Fastest straight drive for which the robot sees everything it needs, m/s; 0 if none.
    pub top_speed_mps: f64,
    /// Whether the file's own limit decides, not what the robot sees.
    pub limited_by_file: bool,
    /// From the front edge: path and inflation, term by term, at that speed.
    pub terms: Vec<Term>,
    /// Sum of the terms, metres.
    pub reach_m: f64,
    /// How far ahead of the front edge bodies are known, metres.
    pub known_m: f64,
    /// How far ahead of the front edge the kernel's memory can hold space as free, metres.
    pub space_m: f64,
    /// Name of the largest term, or what else decides.
    pub decides: &'static str,
    /// The row in words.
    pub sentence: String,
}

/// Smallest passable straight gap for one obstacle speed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GapRow {
    /// Largest speed of anything that moves, m/s.
    pub obstacle_speed_mps: f64,
    /// Narrowest straight gap that the guard lets through at some speed, metres; `None` if none.
    pub gap_m: Option<f64>,
    /// The speed at which it does, m/s.
    pub at_speed_mps: f64,
    /// Narrowest gap at the top speed of [`SpeedRow`], metres; `None` if there is no top speed.
    pub gap_at_top_speed_m: Option<f64>,
    /// Width of the footprint, metres.
    pub width_m: f64,
    /// Inflation of each side in the narrowest gap, term by term.
    pub terms: Vec<Term>,
    /// Name of the largest term.
    pub decides: &'static str,
    /// The row in words.
    pub sentence: String,
}

/// The whole contract of a robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contract {
    /// Name of the robot.
    pub robot: String,
    /// All checks in a fixed order.
    pub checks: Vec<Check>,
    /// Top speed for each of [`OBSTACLE_SPEEDS_MPS`].
    pub speed_table: Vec<SpeedRow>,
    /// Smallest gap for each of [`OBSTACLE_SPEEDS_MPS`].
    pub gap_table: Vec<GapRow>,
    /// Values of the file whose comment says that they are assumed.
    pub assumed: Vec<crate::Sourced>,
}

impl Contract {
    /// The contract of `robot` with the kernel's own tubes.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        Self::with_tubes(robot, &KernelTubes)
    }

    /// The contract of `robot` when the guard reserves what `tubes` says.
    #[must_use]
    pub fn with_tubes(robot: &Robot, tubes: &dyn Tubes) -> Self {
        let speed_table: Vec<SpeedRow> = OBSTACLE_SPEEDS_MPS
            .iter()
            .map(|speed| tables::speed_row(robot, tubes, *speed))
            .collect();
        let gap_table = speed_table
            .iter()
            .map(|row| tables::gap_row(robot, tubes, row))
            .collect();
        Self {
            robot: robot.name.clone(),
            checks: checks::all(robot, tubes),
            speed_table,
            gap_table,
            assumed: robot.sources().into_iter().filter(|s| s.assumed).collect(),
        }
    }

    /// Whether no check fails.
    #[must_use]
    pub fn holds(&self) -> bool {
        !self
            .checks
            .iter()
            .any(|check| check.finding == Finding::Fails)
    }
}

fn holds_if(condition: bool) -> Finding {
    if condition {
        Finding::Holds
    } else {
        Finding::Fails
    }
}
