//! What a scenario file demands of its runs, and the axes of its sweep.

use serde::Deserialize;

use super::names;
use super::value::{NonNegative, Number, Positive};

/// Whether the guarded robot may touch while it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactExpectation {
    /// It must not.
    #[default]
    Never,
    /// It may, because an assumption is broken that nothing can detect in time.
    May,
    /// It must: the scenario shows what the broken assumption costs.
    Must,
}

/// What must come of the guarded run.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expect {
    /// Whether the goal is reached.
    pub reached: Option<bool>,
    /// Contact while moving.
    #[serde(default)]
    pub contact: ContactExpectation,
    /// At rest at the end, and before something.
    pub stopped_before: Option<StoppedBefore>,
    /// Whether it ends at rest because the guard or the stop logic holds it.
    pub blocked: Option<bool>,
    /// Reasons that must occur, as the kernel names them.
    #[serde(default, deserialize_with = "names::reasons")]
    pub reasons: Vec<String>,
    /// A stop decision must follow the first fault within this time.
    pub stop_within_s: Option<Positive>,
    /// Least path length: the robot did try.
    pub travelled_min_m: Option<NonNegative>,
    /// Least angle turned in all.
    pub turned_min_rad: Option<NonNegative>,
    /// Most angle turned in all: it did not circle.
    pub turned_max_deg: Option<NonNegative>,
    /// Longest path: it did not wander.
    pub travelled_max_m: Option<Positive>,
    /// `navigate`: whether the kernel itself says at the end that it has arrived.
    pub arrived: Option<bool>,
    /// `navigate`: why the kernel says at the end that it cannot go on, in its own words.
    #[serde(default, deserialize_with = "names::blocked_reason")]
    pub blocked_reason: Option<String>,
    /// `navigate`: most candidates of the planner that the guard may refuse over the run.
    pub refused_max: Option<u64>,
    /// Assumptions that the result must name as broken; any other broken one fails the scenario.
    #[serde(default, deserialize_with = "names::assumptions")]
    pub assumptions_broken: Vec<String>,
}

/// Where the robot must have stopped; give at least one.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoppedBefore {
    /// At least this far from every body at the end.
    pub clearance_m: Option<NonNegative>,
    /// Rotation centre never beyond this x.
    pub x_m: Option<Number>,
    /// Rotation centre never beyond this y.
    pub y_m: Option<Number>,
}

/// The run without the guard.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Naked {
    /// Whether it must touch.
    #[serde(default = "yes")]
    pub must_touch: bool,
    /// Why not, if not.
    pub reason: Option<String>,
    /// `navigate`: where the reckless driver that takes the kernel's place heads for.
    pub path: Option<NakedPath>,
    /// `navigate`: its speed; default the robot's highest.
    pub speed_mps: Option<Positive>,
}

const fn yes() -> bool {
    true
}

/// Where the naked twin of a `navigate` scenario heads for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NakedPath {
    /// Straight from one via point to the next.
    #[default]
    Via,
    /// Straight for the goal.
    Goal,
}

/// One axis of a sweep: either `values`, or `path` with `from`, `to` and `count`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepAxis {
    /// Word for the variant's name.
    pub name: String,
    /// Dotted path into the file, such as `circle.0.motion.delay_s`.
    pub path: Option<String>,
    /// First value.
    pub from: Option<Number>,
    /// Last value.
    pub to: Option<Number>,
    /// How many values, ends included.
    pub count: Option<usize>,
    /// Named sets of paths and values.
    #[serde(default)]
    pub values: Vec<SweepValue>,
}

/// One point of a named axis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepValue {
    /// Word for the variant's name.
    pub label: String,
    /// Dotted paths and their values.
    pub set: toml::Table,
}
