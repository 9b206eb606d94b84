//! What the guard reserves around a steady motion, term by term.

use serde::Serialize;

use crate::{Kinematics, Robot, Scanner};

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
/// Name of the obstacle term.
pub const MOVING: &str = "moving bodies";

/// Where reserves come from: the kernel, or a stand-in for tests.
pub trait Tubes {
    /// Reserve of driving straight ahead at `speed_mps`; `None` if the guard refuses the motion
    /// whatever it sees.
    fn straight(&self, robot: &Robot, speed_mps: f64) -> Option<Reserve>;

    /// Reserve of turning on the spot at `rate_radps`; `None` as above.
    fn on_the_spot(&self, robot: &Robot, rate_radps: f64) -> Option<Reserve>;
}

/// Longest time for which a motion may last before braking begins, seconds (`T` of spec/model.md).
pub(crate) fn hold_s(robot: &Robot) -> f64 {
    let t = robot.values.timing;
    t.odometry_age_max_s + t.period_s + t.jitter_s + t.actuation_latency_s
}

/// Range error bound of the worst scanner, metres.
pub(crate) fn sensor_m(robot: &Robot) -> f64 {
    let errors = robot.values.scanners.iter().map(Scanner::error_m);
    errors.fold(0.0, f64::max)
}

/// The formulas of `spec/model.md` over the reals, for steady motions.
///
/// Shares no code with the kernel; the tests hold the kernel's integers against it.
#[derive(Clone, Copy, Debug, Default)]
pub struct ModelTubes;

impl ModelTubes {
    /// Terms that belong to the points, not to the motion: seen at `range_m`, at `speed_mps`.
    fn point_terms(robot: &Robot, range_m: f64, speed_mps: f64, rate_radps: f64) -> Vec<Term> {
        let v = &robot.values;
        let beam = v.scanners.iter().map(Scanner::beam_angle_rad);
        let age = v.timing.scan_age_max_s;
        let drift = v.tolerances.odometry_m_per_m * speed_mps * age
            + v.tolerances.odometry_rad_per_rad * rate_radps * age * range_m;
        vec![
            Term {
                name: "sensor",
                value_m: sensor_m(robot),
            },
            Term {
                name: "beam gap",
                value_m: beam.fold(0.0, f64::max) * range_m,
            },
            Term {
                name: "odometry",
                value_m: drift,
            },
        ]
    }
}

/// Largest number of steps between samples of a straight tube, as the kernel's.
const STEPS: f64 = 48.0;

impl Tubes for ModelTubes {
    fn straight(&self, robot: &Robot, speed_mps: f64) -> Option<Reserve> {
        let v = &robot.values;
        let (tol_v, tol_w) = (v.tolerances.speed_mps, v.tolerances.angular_speed_radps);
        let steered = match v.kinematics {
            Kinematics::Differential => None,
            Kinematics::Ackermann(steering) => Some(steering.curvature_tolerance_per_m()),
        };
        let hold = hold_s(robot);
        let top = speed_mps + tol_v;
        let turn_stop = match steered {
            None => tol_w / v.limits.angular_braking_radps2,
            Some(_) => 0.0,
        };
        let stop = (top / v.limits.braking_mps2).max(turn_stop);
        let (path, time) = (top * (hold + stop / 2.0), hold + stop);
        let rho = v.footprint.radius_m();
        let bend = steered.unwrap_or(0.0);
        let spread =
            bend * (path * path / 2.0 + rho * path) + (tol_w + bend * tol_v) * time * (path + rho);
        let ahead = v.footprint.front_m + path;
        let mut inflation = Self::point_terms(robot, ahead, speed_mps, 0.0);
        let age = v.timing.scan_age_max_s;
        inflation.extend([
            Term {
                name: MOVING,
                value_m: v.obstacle_speed_mps * (age + time),
            },
            Term {
                name: "tracking",
                value_m: v.tolerances.tracking_m,
            },
            Term {
                name: "sampling",
                value_m: path / STEPS / 2.0,
            },
            Term {
                name: "spread",
                value_m: spread,
            },
        ]);
        Some(Reserve {
            reaction_m: top * hold,
            braking_m: path - top * hold,
            time_s: time,
            inflation,
        })
    }

    fn on_the_spot(&self, robot: &Robot, rate_radps: f64) -> Option<Reserve> {
        let v = &robot.values;
        if v.kinematics != Kinematics::Differential {
            return None;
        }
        let (tol_v, tol_w) = (v.tolerances.speed_mps, v.tolerances.angular_speed_radps);
        let stop = ((rate_radps + tol_w) / v.limits.angular_braking_radps2)
            .max(tol_v / v.limits.braking_mps2);
        let time = hold_s(robot) + stop;
        let rho = v.footprint.radius_m();
        let mut inflation = Self::point_terms(robot, rho, 0.0, rate_radps);
        inflation.extend([
            Term {
                name: MOVING,
                value_m: v.obstacle_speed_mps * (v.timing.scan_age_max_s + time),
            },
            Term {
                name: "tracking",
                value_m: v.tolerances.tracking_m,
            },
            Term {
                name: "sampling",
                value_m: rho * SPOT_STEP_RAD / 2.0,
            },
            Term {
                name: "spread",
                value_m: tol_v * time,
            },
        ]);
        Some(Reserve {
            time_s: time,
            inflation,
            ..Reserve::default()
        })
    }
}

/// Angle between samples of a turn on the spot, as the kernel's 2 degrees.
const SPOT_STEP_RAD: f64 = 0.034_906;
