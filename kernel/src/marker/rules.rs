//! Parameters of the filter, checked once. Nothing here is tuned at run time.

use super::pose::Increment;
use crate::time::Duration;

/// How fast odometry goes wrong: variances that grow with the way, plus a constant per sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdometryNoise {
    /// Along the motion, m² per metre driven.
    pub along_m2_per_m: f64,
    /// Across the motion (side slip), m² per metre driven.
    pub across_m2_per_m: f64,
    /// Heading, rad² per metre driven.
    pub heading_rad2_per_m: f64,
    /// Heading, rad² per radian turned.
    pub heading_rad2_per_rad: f64,
    /// Position along and across, m² per sample.
    pub position_m2_per_sample: f64,
    /// Heading, rad² per sample.
    pub heading_rad2_per_sample: f64,
}

impl OdometryNoise {
    /// Variances along, across and in heading of one increment.
    pub(super) fn of(&self, increment: &Increment) -> [f64; 3] {
        let way_m = libm::hypot(increment.forward_m, increment.left_m);
        let turn_rad = increment.turn_rad.abs();
        [
            self.along_m2_per_m * way_m + self.position_m2_per_sample,
            self.across_m2_per_m * way_m + self.position_m2_per_sample,
            self.heading_rad2_per_m * way_m
                + self.heading_rad2_per_rad * turn_rad
                + self.heading_rad2_per_sample,
        ]
    }

    fn terms(&self) -> [f64; 6] {
        [
            self.along_m2_per_m,
            self.across_m2_per_m,
            self.heading_rad2_per_m,
            self.heading_rad2_per_rad,
            self.position_m2_per_sample,
            self.heading_rad2_per_sample,
        ]
    }
}

/// How the filter behaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterRules {
    /// Errors of the odometry.
    pub odometry: OdometryNoise,
    /// Largest NIS of a pose sighting (3 degrees of freedom).
    pub gate_pose: f64,
    /// Largest NIS of a position-only sighting (2 degrees of freedom).
    pub gate_position: f64,
    /// Whether markers that nobody knows enter the state.
    pub learn: bool,
    /// Largest time between a frame and the last odometry.
    pub frame_age: Duration,
    /// The filter is lost when all sightings of known markers were rejected for this long.
    pub lost_after: Duration,
    /// A marker in the state goes when this many of its sightings in a row were rejected while
    /// others were fused.
    pub contradictions: u8,
}

impl Default for FilterRules {
    /// Gates at 99.9 % of the chi-square distribution, lost after one second.
    fn default() -> Self {
        Self {
            odometry: OdometryNoise {
                along_m2_per_m: 2.5e-5,
                across_m2_per_m: 2.5e-5,
                heading_rad2_per_m: 9e-6,
                heading_rad2_per_rad: 1e-4,
                position_m2_per_sample: 0.0,
                heading_rad2_per_sample: 0.0,
            },
            gate_pose: 16.266,
            gate_position: 13.816,
            learn: true,
            frame_age: Duration::from_ms(100),
            lost_after: Duration::from_ms(1000),
            contradictions: 10,
        }
    }
}

/// Why a filter or a map entry was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[must_use]
pub enum FilterError {
    /// An odometry noise that is negative, not finite or beyond 1.
    OdometryNoise,
    /// A gate that is not positive or not finite.
    Gate,
    /// Not one contradiction allowed.
    Contradictions,
    /// A pose that is not finite or farther than [`super::POSITION_MAX_M`] from the origin.
    Pose,
    /// A variance that is not positive or beyond [`super::NOISE_MAX`].
    Variance,
    /// An id that does not exist.
    Id,
    /// The id is in the map already, or in the state.
    Duplicate,
    /// No room in the map.
    Full,
}

impl FilterRules {
    /// Whether a filter can run with these rules.
    ///
    /// # Errors
    /// The first rule that is broken.
    pub fn check(&self) -> Result<(), FilterError> {
        let terms = self.odometry.terms();
        if terms.iter().any(|term| !(0.0..=1.0).contains(term)) {
            return Err(FilterError::OdometryNoise);
        }
        let gates = [self.gate_pose, self.gate_position];
        if gates.iter().any(|gate| !(*gate > 0.0 && gate.is_finite())) {
            return Err(FilterError::Gate);
        }
        if self.contradictions == 0 {
            return Err(FilterError::Contradictions);
        }
        Ok(())
    }
}
