//! The scenario file as people write it.
//!
//! Every table refuses keys it does not know; numbers carry their unit in the key and are checked
//! while they are read, so each error names file, line, column and what to write.

mod bodies;
mod check;
mod error;
mod expect;
pub mod fault;
mod load;
mod names;
mod navigate;
mod places;
pub mod value;

#[cfg(test)]
mod tests;

pub use bodies::{BoxBody, Circle, Material, Motion, Wall};
pub use error::ScenarioError;
pub use expect::{
    ContactExpectation, Expect, Naked, NakedPath, StoppedBefore, SweepAxis, SweepValue,
};
pub use load::{load_dir, load_file, parse};
pub use navigate::Navigate;
pub use places::Places;

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;
use value::{Delay, Fraction, NonNegative, Number, Pair, Positive, Timeout};

/// One scenario: a world, a robot in it, what goes wrong, and what must come of it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// File stem and variant; not in the file.
    #[serde(skip)]
    pub name: String,
    /// File stem; not in the file.
    #[serde(skip)]
    pub group: String,
    /// Where its parts stand in the file; not in the file.
    #[serde(skip)]
    pub places: Places,
    /// One sentence for people.
    pub title: String,
    /// Ids of the requirements it covers.
    #[serde(deserialize_with = "names::requirements")]
    pub requirements: Vec<String>,
    /// Robot file stem, such as `seekur_jr`.
    pub robot: String,
    /// Bound of obstacle speed given to the guard (assumption A-OBSTACLE).
    pub obstacle_speed_mps: NonNegative,
    /// Seed of all noise.
    pub seed: u64,
    /// When the run ends at the latest.
    pub timeout_s: Timeout,
    /// Overrides the robot file: whether the guard's tube covers a dying host.
    pub cover_host_death: Option<bool>,
    /// Other values for keys of the robot file, by their dotted paths.
    #[serde(default)]
    pub robot_values: BTreeMap<Spanned<String>, toml::Value>,
    /// What the kernel alone is told about the robot, instead of the truth; dotted keys of the robot file.
    #[serde(default)]
    pub told: BTreeMap<Spanned<String>, toml::Value>,
    /// Where the robot stands at time zero.
    #[serde(default)]
    pub start: Start,
    /// Lines without thickness.
    #[serde(default)]
    pub wall: Vec<Spanned<Wall>>,
    /// Rectangles.
    #[serde(default, rename = "box")]
    pub boxes: Vec<Spanned<BoxBody>>,
    /// Discs.
    #[serde(default)]
    pub circle: Vec<Spanned<Circle>>,
    /// Where the robot wants to go.
    pub goal: Option<Goal>,
    /// Who proposes the motion.
    pub proposer: Spanned<Proposer>,
    /// Laser scanners, where they differ from the robot file.
    #[serde(default)]
    pub sensor: Sensor,
    /// Odometry.
    #[serde(default)]
    pub odometry: OdometryModel,
    /// Drive.
    #[serde(default)]
    pub drive: Drive,
    /// Operator: resets and the emergency stop line.
    #[serde(default)]
    pub operator: Operator,
    /// What goes wrong, and when.
    #[serde(default)]
    pub fault: Vec<Spanned<fault::FaultEntry>>,
    /// What must come of it.
    pub expect: Expect,
    /// The run without the guard; default it must touch.
    pub naked: Option<Spanned<Naked>>,
    /// Axes of a parameter sweep; each combination is a variant.
    #[serde(default)]
    pub sweep: Vec<Spanned<SweepAxis>>,
    /// How many naked runs of a sweep must touch; default all.
    pub sweep_naked_touch_min: Option<usize>,
}

/// Pose and twist at time zero.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[allow(missing_docs)] // keys name themselves
pub struct Start {
    pub x_m: Number,
    pub y_m: Number,
    pub heading_deg: Number,
    pub linear_mps: Number,
    pub angular_radps: Number,
}

/// A disc the rotation centre must enter.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Goal {
    /// Centre.
    #[serde(deserialize_with = "value::exactly")]
    pub position_m: Pair,
    /// Radius.
    pub radius_m: Positive,
    /// Whether the run only ends once the robot rests inside; default it ends as soon as it is inside.
    #[serde(default)]
    pub at_rest: bool,
}

/// Who proposes the motion.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Proposer {
    /// What sort.
    pub kind: ProposerKind,
    /// `reckless`: speed towards the goal.
    pub speed_mps: Option<Positive>,
    /// `reckless`: turn rate for each radian of heading error; default 1.5.
    pub heading_gain_per_s: Option<Positive>,
    /// `script`: what to do, in order.
    #[serde(default)]
    pub step: Vec<Spanned<Step>>,
    /// `navigate`: points to pass on the way to the goal, in order.
    #[serde(default, deserialize_with = "value::points")]
    pub via_m: Option<Vec<Pair>>,
    /// `navigate`: the kernel's planner, where it differs from its default.
    pub navigate: Option<Navigate>,
}

/// Sort of proposer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProposerKind {
    /// Heads straight for the goal and avoids nothing.
    Reckless,
    /// Plays back fixed motions.
    Script,
    /// The kernel itself drives: it plans the way along the via points to the goal.
    Navigate,
}

/// One scripted motion.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// Ends this long after the robot was first allowed to move.
    pub until_s: Positive,
    /// Forward speed.
    #[serde(default)]
    pub linear_mps: Number,
    /// Turn rate (differential drive).
    pub angular_radps: Option<Number>,
    /// Path curvature; with a differential drive the turn rate is speed times curvature.
    pub curvature_per_m: Option<Number>,
}

/// Laser scanners, where they differ from the robot file.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Sensor {
    /// Standard deviation of the range; default the robot file's.
    pub noise_sigma_m: Option<NonNegative>,
    /// Systematic range error; default the robot file's, reading too long.
    pub bias_m: Option<Number>,
    /// `false`: all beams at the time of the first.
    pub skew: Option<bool>,
    /// Part of the beams that are lost at random.
    pub dropout_fraction: Fraction,
    /// Time from the last beam to the host; default 5 ms.
    pub delay_s: Option<Delay>,
    /// Shortest range; default the robot file's.
    pub range_min_m: Option<NonNegative>,
    /// Longest range; default the robot file's.
    pub range_max_m: Option<Positive>,
}

/// Odometry model.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OdometryModel {
    /// Samples each second; default one each control period.
    pub rate_hz: Option<Positive>,
    /// Time from measurement to host; default 0.
    pub delay_s: Delay,
    /// Position error for each metre, signed; default drawn within the robot's bound.
    pub error_m_per_m: Option<Number>,
    /// Heading error for each radian, signed; default drawn within the robot's bound.
    pub error_rad_per_rad: Option<Number>,
}

/// Drive model, where it differs from what the robot file assumes at the worst.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Drive {
    /// Time from decision to wheels, a whole number of 10 ms; default 60 ms or the robot's bound.
    pub latency_s: Option<Delay>,
    /// Time constant of the first-order lag; default 20 ms or what the robot's bound leaves.
    pub lag_s: Option<NonNegative>,
    /// True turn rate for each commanded and measured one (skid steer); default 1.
    pub slip: Option<Positive>,
    /// Deceleration the brakes give; default the robot's least.
    pub braking_mps2: Option<Positive>,
    /// Angular deceleration; default the robot's least.
    pub angular_braking_radps2: Option<Positive>,
    /// Whether v and omega ramp separately; default as the robot file.
    pub separate_ramps: Option<bool>,
    /// What the drive does when its watchdog expires; default as the robot file.
    pub silence: Option<Silence>,
    /// Its watchdog; default as the robot file.
    pub watchdog_s: Option<Positive>,
    /// Its deceleration then; default as the robot file.
    pub silent_braking_mps2: Option<Positive>,
    /// Whether the adapter stops at the decision's expiry while the kernel pauses; default true.
    pub honours_expiry: Option<bool>,
    /// A skid: the wheels turn as they should, the robot goes elsewhere.
    pub skid: Option<Skid>,
}

/// A skid while the robot moves: the pose is displaced in the robot's frame, the odometry pose tells it and the
/// measured twist does not.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Skid {
    /// First moment.
    pub from_s: NonNegative,
    /// How long the robot moves until it has slid all the way.
    pub for_s: Positive,
    /// How far ahead it ends, signed.
    pub ahead_m: Number,
    /// How far to the left it ends, signed.
    pub left_m: Number,
}

/// What a drive does when its watchdog expires.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Silence {
    /// Brakes with its silent deceleration.
    Brake,
    /// Runs out with its silent deceleration, each of v and omega by itself.
    Coast,
    /// Goes on for ever with the last set point.
    None,
}

/// What the operator does.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Operator {
    /// Times of resets; default one as soon as the robot can take it (0.2 s + its rest time).
    pub resets_s: Option<Vec<NonNegative>>,
    /// `[from_s, until_s]` during which the emergency stop line is pulled.
    #[serde(deserialize_with = "value::windows")]
    pub emergency_stops_s: Vec<[NonNegative; 2]>,
}

impl Scenario {
    /// Points that the kernel's navigator is asked to pass, in the world.
    #[must_use]
    pub fn via_m(&self) -> Vec<[f64; 2]> {
        let points = self.proposer.get_ref().via_m.iter().flatten();
        points.map(|point| value::floats(*point)).collect()
    }

    /// Whether the kernel itself drives.
    #[must_use]
    pub fn navigates(&self) -> bool {
        self.proposer.get_ref().kind == ProposerKind::Navigate
    }

    /// Why there is no naked twin; `None` if there is one and it must touch.
    #[must_use]
    pub fn naked_excuse(&self) -> Option<&str> {
        let naked = self.naked.as_ref()?.get_ref();
        (!naked.must_touch).then(|| naked.reason.as_deref().unwrap_or_default())
    }
}
