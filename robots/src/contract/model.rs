//! The tubes of `spec/model.md` over the reals: what the kernel's integers are held against.

use super::tubes::{
    BEAM_GAP, MOVING, ODOMETRY, Reserve, SENSOR, Term, Tubes, beam_angle_rad, hold_s, range_to_m,
};
use crate::{Kinematics, Robot, Scanner};

/// Range error bound of the worst scanner, metres.
fn sensor_m(robot: &Robot) -> f64 {
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
        let age = v.timing.scan_age_max_s;
        let drift = v.tolerances.odometry_m_per_m * speed_mps * age
            + v.tolerances.odometry_rad_per_rad * rate_radps * age * range_m;
        vec![
            Term {
                name: SENSOR,
                value_m: sensor_m(robot),
            },
            Term {
                name: BEAM_GAP,
                value_m: beam_angle_rad(robot) * range_m,
            },
            Term {
                name: ODOMETRY,
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
        let range = range_to_m(robot, v.footprint.front_m + path);
        let mut inflation = Self::point_terms(robot, range, speed_mps, 0.0);
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
