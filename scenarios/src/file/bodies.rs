//! Bodies of a scenario file: walls, boxes, circles, and how they move.

use serde::Deserialize;
use toml::Spanned;

use super::value::{NonNegative, Number, Pair, Positive, exactly, perhaps, points};

/// How a body looks to a laser.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Material {
    /// Returns every beam.
    #[default]
    Solid,
    /// Glass or black cloth: returns none.
    Invisible,
}

/// A line without thickness.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Name for reports.
    pub name: Option<String>,
    /// One end.
    #[serde(deserialize_with = "exactly")]
    pub from_m: Pair,
    /// The other end.
    #[serde(deserialize_with = "exactly")]
    pub to_m: Pair,
    /// How it looks to a laser.
    #[serde(default)]
    pub material: Material,
    /// How it moves.
    pub motion: Option<Spanned<Motion>>,
}

/// A rectangle.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoxBody {
    /// Name for reports.
    pub name: Option<String>,
    /// Centre.
    #[serde(deserialize_with = "exactly")]
    pub center_m: Pair,
    /// Full extents along its own x and y.
    #[serde(deserialize_with = "exactly")]
    pub size_m: [Positive; 2],
    /// Heading of its own x.
    #[serde(default)]
    pub heading_deg: Number,
    /// How it looks to a laser.
    #[serde(default)]
    pub material: Material,
    /// How it moves.
    pub motion: Option<Spanned<Motion>>,
}

/// A disc.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    /// Name for reports.
    pub name: Option<String>,
    /// Centre.
    #[serde(deserialize_with = "exactly")]
    pub center_m: Pair,
    /// Radius.
    pub radius_m: Positive,
    /// How it looks to a laser.
    #[serde(default)]
    pub material: Material,
    /// How it moves.
    pub motion: Option<Spanned<Motion>>,
}

/// Motion of a body: one of `velocity_mps`, `turn_radps` with `pivot_m`, or `way_points`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// Start time; default 0.
    pub from_s: Option<NonNegative>,
    /// Instead: start when the robot's rotation centre first has this x ...
    pub when_robot_passes_x_m: Option<Number>,
    /// ... and this much later.
    pub delay_s: Option<NonNegative>,
    /// How long; default for ever.
    pub for_s: Option<Positive>,
    /// Constant velocity.
    #[serde(default, deserialize_with = "perhaps")]
    pub velocity_mps: Option<Pair>,
    /// Constant turn rate about `pivot_m`.
    pub turn_radps: Option<Number>,
    /// Pivot in the world.
    #[serde(default, deserialize_with = "perhaps")]
    pub pivot_m: Option<Pair>,
    /// `[t_s, x_m, y_m]` of the body's centre; times count from the start of the motion.
    #[serde(default, deserialize_with = "points")]
    pub way_points: Option<Vec<[Number; 3]>>,
}
