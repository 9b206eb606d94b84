//! One scanner as its table states it, and where its beams go.

use serde::Serialize;

/// One scanner.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scanner {
    /// Name in reports.
    pub name: String,
    /// Position in the body frame, forward, metres.
    pub x_m: f64,
    /// Position in the body frame, left, metres.
    pub y_m: f64,
    /// Direction of the middle of the field of view, radians.
    pub yaw_rad: f64,
    /// Angle from the first beam to the last, radians.
    pub field_of_view_rad: f64,
    /// Beams run clockwise seen from above.
    pub upside_down: bool,
    /// Number of beams.
    pub beams: u16,
    /// Time from the first beam to the last, seconds.
    pub scan_time_s: f64,
    /// Scans each second.
    pub rate_hz: f64,
    /// How "no return" and its like are written.
    pub encoding: Encoding,
    /// Shortest measured range, metres.
    pub range_min_m: f64,
    /// Longest measured range, metres.
    pub range_max_m: f64,
    /// Systematic range error, metres.
    pub error_systematic_m: f64,
    /// Standard deviation of the range, metres.
    pub error_sigma_m: f64,
    /// Up to here a beam without return counts as free, metres.
    pub no_return_clear_m: f64,
    /// Largest part of invalid beams, 0 to 1.
    pub invalid_fraction_max: f64,
    /// Largest angle of neighbouring invalid beams, radians.
    pub invalid_gap_max_rad: f64,
    /// Robot parts in view.
    pub masks: Vec<Mask>,
}

impl Scanner {
    /// Error bound of a range: systematic error and three standard deviations, metres.
    #[must_use]
    pub fn error_m(&self) -> f64 {
        self.error_systematic_m + 3.0 * self.error_sigma_m
    }

    /// Magnitude of the angle between neighbouring beams, radians.
    #[must_use]
    pub fn beam_angle_rad(&self) -> f64 {
        self.field_of_view_rad / f64::from(self.beams.saturating_sub(1).max(1))
    }

    /// Direction of the first beam in the body frame, radians (not wrapped).
    #[must_use]
    pub fn first_beam_rad(&self) -> f64 {
        let half = self.field_of_view_rad / 2.0;
        self.yaw_rad + if self.upside_down { half } else { -half }
    }

    /// Signed angle from one beam to the next in the body frame, radians.
    #[must_use]
    pub fn increment_rad(&self) -> f64 {
        let step = self.beam_angle_rad();
        if self.upside_down { -step } else { step }
    }

    /// Whether a body-frame point (metres) lies within field of view and range.
    #[must_use]
    pub fn sees(&self, x_m: f64, y_m: f64) -> bool {
        let (dx, dy) = (x_m - self.x_m, y_m - self.y_m);
        let range = dx.hypot(dy);
        let off_axis = wrap(dy.atan2(dx) - self.yaw_rad).abs();
        off_axis <= self.field_of_view_rad / 2.0
            && range >= self.range_min_m
            && range <= self.range_max_m
    }
}

/// How "no return" is written; as [`haltline::convert::BeamEncoding`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Encoding {
    /// +∞ none, −∞ too near, NaN invalid.
    Rep117,
    /// Zero is no return.
    ZeroIsNone,
    /// Zero is a lost measurement.
    ZeroIsInvalid,
}

impl From<Encoding> for haltline::convert::BeamEncoding {
    fn from(encoding: Encoding) -> Self {
        match encoding {
            Encoding::Rep117 => Self::Rep117,
            Encoding::ZeroIsNone => Self::ZeroIsNone,
            Encoding::ZeroIsInvalid => Self::ZeroIsInvalid,
        }
    }
}

/// Self-mask rectangle in the body frame, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs)] // schema.rs documents each key
pub struct Mask {
    pub x_min_m: f64,
    pub x_max_m: f64,
    pub y_min_m: f64,
    pub y_max_m: f64,
}

/// Wraps an angle to (−π, π].
pub(crate) fn wrap(angle_rad: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let wrapped = angle_rad.rem_euclid(TAU);
    if wrapped > PI { wrapped - TAU } else { wrapped }
}
