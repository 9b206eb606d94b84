//! The reserve as the kernel itself computes it: one call of its `certify` in empty surroundings.

use haltline::checked::KernelConfig;
use haltline::convert::{self, Round};
use haltline::guard::hull::{Hull, Vertex};
use haltline::guard::memory::{Memory, Staleness};
use haltline::guard::{Budget, Scene, Verdict, certify};
use haltline::input::Twist;
use haltline::odometry::{LocalPose, Odometer};
use haltline::time::Instant;
use haltline::units::Length;

use super::tubes::{
    BEAM_GAP, MOVING, ODOMETRY, Reserve, SENSOR, Term, Tubes, beam_angle_rad, range_to_m,
};
use crate::{BEAMS, Robot, SCANNERS};

/// The kernel's own tubes.
#[derive(Clone, Copy, Debug, Default)]
pub struct KernelTubes;

/// A motion that goes on unchanged, and where bodies are that it must not touch.
struct Steady {
    twist: Twist,
    speed_mps: f64,
    rate_radps: f64,
}

impl Tubes for KernelTubes {
    fn straight(&self, robot: &Robot, speed_mps: f64) -> Option<Reserve> {
        let steady = Steady {
            twist: Twist {
                linear: convert::speed(speed_mps, Round::Nearest)?,
                ..Twist::default()
            },
            speed_mps,
            rate_radps: 0.0,
        };
        let config = KernelConfig::new(robot.config, BEAMS).ok()?;
        let verdict = reserve(&config, &steady)?;
        let tolerance = robot.values.tolerances.speed_mps;
        let hold_s = seconds(config.reaction_us(config.config().timing.odometry_age_max));
        let path_m = metres(verdict.stopping_path);
        if path_m <= 0.0 {
            // Within the speed tolerance the guard plans a turn on the spot instead.
            return None;
        }
        let reaction_m = ((speed_mps + tolerance) * hold_s).min(path_m);
        let ahead = robot.values.footprint.front_m + path_m;
        let points = point_terms(robot, &config, &steady, ahead);
        Some(Reserve {
            reaction_m,
            braking_m: path_m - reaction_m,
            time_s: seconds(verdict.stopping_time.as_us()),
            inflation: terms(&verdict.budget, &points),
        })
    }

    fn on_the_spot(&self, robot: &Robot, rate_radps: f64) -> Option<Reserve> {
        if robot.values.kinematics != crate::Kinematics::Differential {
            return None;
        }
        let steady = Steady {
            twist: Twist {
                angular: convert::angular_speed(rate_radps, Round::Nearest)?,
                ..Twist::default()
            },
            speed_mps: 0.0,
            rate_radps,
        };
        let config = KernelConfig::new(robot.config, BEAMS).ok()?;
        let verdict = reserve(&config, &steady)?;
        let points = point_terms(robot, &config, &steady, robot.values.footprint.radius_m());
        Some(Reserve {
            time_s: seconds(verdict.stopping_time.as_us()),
            inflation: terms(&verdict.budget, &points),
            ..Reserve::default()
        })
    }
}

fn metres(length: Length) -> f64 {
    f64::from(length.as_um()) / 1e6
}

fn seconds(us: u64) -> f64 {
    us as f64 / 1e6
}

/// The verdict on a steady motion where nothing is known; `None` if there is no tube for it.
fn reserve(config: &KernelConfig<SCANNERS>, steady: &Steady) -> Option<Verdict> {
    // Nothing is known here, so one scanner, one beam and one point are room enough.
    let memory = Memory::<1, 1, 1>::default();
    let scene = Scene {
        memory: &memory,
        model: config.memory(),
        pose: LocalPose::default(),
        stamp: Instant::default(),
        odometer: Odometer::default(),
        excuse: None,
    };
    let mut hull = Hull::default();
    hull.push(Vertex {
        twist: steady.twist,
        ..Vertex::default()
    });
    let hold_us = config.reaction_us(config.config().timing.odometry_age_max);
    let verdict = certify(config.tube(), &hull, hold_us, &scene);
    (verdict.samples > 0).then_some(verdict)
}

/// Terms of a point `ahead_m` before the rotation centre in the oldest usable scan.
struct PointTerms {
    beam_gap_m: f64,
    odometry_m: f64,
    moved_m: f64,
    rounding_m: f64,
}

/// A point's own inflation is kept in whole millimetres, each of its parts rounded up.
const POINT_ROUNDING_M: f64 = 0.002;

fn point_terms(
    robot: &Robot,
    config: &KernelConfig<SCANNERS>,
    steady: &Steady,
    ahead_m: f64,
) -> PointTerms {
    let age_s = robot.values.timing.scan_age_max_s;
    let micro = |value: f64| (value * 1e6).ceil() as u64;
    let then = Odometer::default();
    let now = Odometer {
        travelled_um: micro(steady.speed_mps * age_s),
        turned_urad: micro(steady.rate_radps.abs() * age_s),
    };
    let Staleness {
        drift_um,
        turn_urad,
        moved_um,
    } = config.memory().staleness(
        Instant::default(),
        then,
        Instant::from_us(micro(age_s)),
        now,
    );
    PointTerms {
        beam_gap_m: beam_angle_rad(robot) * range_to_m(robot, ahead_m),
        odometry_m: seconds(drift_um) + seconds(turn_urad) * ahead_m,
        moved_m: seconds(moved_um),
        rounding_m: POINT_ROUNDING_M,
    }
}

fn terms(budget: &Budget, point: &PointTerms) -> Vec<Term> {
    let rows = [
        (SENSOR, metres(budget.sensor)),
        (BEAM_GAP, point.beam_gap_m),
        (ODOMETRY, point.odometry_m),
        (MOVING, metres(budget.moving) + point.moved_m),
        ("tracking", metres(budget.tracking)),
        ("sampling", metres(budget.sampling)),
        ("spread", metres(budget.spread)),
        ("rounding", metres(budget.rounding) + point.rounding_m),
    ];
    rows.map(|(name, value_m)| Term { name, value_m }).to_vec()
}
