//! What the guard reserves around a steady motion, term by term.

use serde::Serialize;

use crate::Robot;

/// One named length of a budget.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Term {
    /// Name in tables.
    pub name: &'static str,
    /// Its size, metres.
    pub value_m: f64,
}

/// What the guard reserves for a steady motion in the worst case that the robot file allows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reserve {
    /// Path before braking takes hold, metres.
    pub reaction_m: f64,
    /// Path while braking, metres.
    pub braking_m: f64,
    /// Latest time until rest, seconds.
    pub time_s: f64,
    /// Inflation of the last sample, the pose at rest.
    pub inflation: Vec<Term>,
}

impl Reserve {
    /// Sum of the inflation, metres.
    #[must_use]
    pub fn inflation_m(&self) -> f64 {
        self.inflation.iter().map(|term| term.value_m).sum()
    }

    /// Path and the part of the inflation that counts against unknown space, metres.
    #[must_use]
    pub fn into_space_m(&self) -> f64 {
        let own = self.inflation.iter();
        let own = own.filter(|term| !POINT_TERMS.contains(&term.name));
        self.reaction_m + self.braking_m + own.map(|term| term.value_m).sum::<f64>()
    }

    /// Path and inflation, term by term.
    #[must_use]
    pub fn reach(&self) -> Vec<Term> {
        let mut terms = vec![
            Term {
                name: REACTION,
                value_m: self.reaction_m,
            },
            Term {
                name: BRAKING,
                value_m: self.braking_m,
            },
        ];
        terms.extend(&self.inflation);
        terms
    }
}

/// Name of the path before braking takes hold.
pub const REACTION: &str = "reaction";
/// Name of the path while braking.
pub const BRAKING: &str = "braking";
/// Name of the scanner's error.
pub const SENSOR: &str = "sensor";
/// Name of what may hide between two beams.
pub const BEAM_GAP: &str = "beam gap";
/// Name of the odometry's error since the scan.
pub const ODOMETRY: &str = "odometry";
/// Name of the obstacle term.
pub const MOVING: &str = "moving bodies";

/// Terms that say how wrong or old a point may be; unknown space is not inflated by them.
const POINT_TERMS: [&str; 4] = [SENSOR, BEAM_GAP, ODOMETRY, MOVING];

/// Where reserves come from: the kernel, or a stand-in for tests.
pub trait Tubes {
    /// Reserve of driving straight ahead at `speed_mps`; `None` if the guard refuses the motion
    /// whatever it sees.
    fn straight(&self, robot: &Robot, speed_mps: f64) -> Option<Reserve>;

    /// Reserve of turning on the spot at `rate_radps`; `None` as above.
    fn on_the_spot(&self, robot: &Robot, rate_radps: f64) -> Option<Reserve>;
}

/// Range from the worst scanner to a place `ahead_m` before the rotation centre, metres.
pub(super) fn range_to_m(robot: &Robot, ahead_m: f64) -> f64 {
    let scanners = robot.values.scanners.iter();
    let ranges = scanners.map(|s| (ahead_m - s.x_m).hypot(s.y_m));
    ranges.fold(0.0, f64::max)
}

/// Largest angle between two beams of a scanner, radians.
pub(super) fn beam_angle_rad(robot: &Robot) -> f64 {
    let scanners = robot.values.scanners.iter();
    scanners
        .map(crate::Scanner::beam_angle_rad)
        .fold(0.0, f64::max)
}

/// Longest time for which a motion may last before braking begins, seconds (`T` of spec/model.md).
pub(crate) fn hold_s(robot: &Robot) -> f64 {
    let t = robot.values.timing;
    t.odometry_age_max_s + t.period_s + t.jitter_s + t.actuation_latency_s
}
