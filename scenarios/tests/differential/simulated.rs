//! Whole drives: a naive controller and the kernel in the same scenario.

use haltline::decision::{Action, Decision, Reason, StopStatus};
use haltline::input::{Beam, Inputs, Motion, Reading, Twist};
use haltline::time::{Duration, Instant};
use haltline::units::Speed;
use haltline_robots::Robot;
use haltline_scenarios::batch::{Case, equip, run_case, run_one};
use haltline_scenarios::controller::Controller;
use haltline_scenarios::engine::{Run, run};
use haltline_scenarios::file::load_file;
use haltline_scenarios::result::Outcome;
use std::path::Path;

pub fn case(name: &str) -> Case {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = root.join("files").join(format!("{name}.toml"));
    let scenario = load_file(&file).unwrap().remove(0);
    let robot = Robot::embedded(&scenario.robot).unwrap();
    equip(scenario, &robot).unwrap()
}

/// Whether a moving robot touched something.
pub fn touches(run: &Run) -> bool {
    run.result.moving_contacts() > 0
}

/// The free distance straight ahead to the speed that goes with it, m/s.
type Law = fn(f64) -> f64;

/// A filter that keeps a law between distance and speed, on what beams return: nothing else is looked at.
struct Naive {
    law: Law,
    ahead_m: f64,
    last: Twist,
    waits: bool,
}

impl Naive {
    fn boxed(law: Law) -> Option<Box<dyn Controller>> {
        Some(Box::new(Self {
            law,
            ahead_m: f64::INFINITY,
            last: Twist::default(),
            waits: true,
        }))
    }
}

impl Controller for Naive {
    fn step(&mut self, inputs: &Inputs<'_>, now: Instant) -> Decision {
        for scan in inputs.scans {
            let Reading::Value(scan) = scan else { continue };
            // Seekur Jr: 541 beams over 270 degrees at 0.527 m, 0.073 m behind the front edge.
            let returns = scan.beams.iter().enumerate().filter_map(|(beam, seen)| {
                let Beam::Hit(range) = seen else { return None };
                let (y, x) = (0.5 * beam as f64 - 135.0).to_radians().sin_cos();
                let range = f64::from(*range) * 1e-3;
                (x > 0.0 && (y * range).abs() < 0.45).then_some(x * range - 0.073)
            });
            self.ahead_m = returns.fold(f64::INFINITY, f64::min);
        }
        self.waits &= inputs.reset.is_none();
        if let Reading::Value(command) = inputs.command
            && let Motion::Twist(twist) = command.motion
        {
            self.last = twist;
        }
        let most = (self.law)(self.ahead_m.max(0.0)).clamp(0.0, 5.0);
        let most = Speed::from_um_per_s((most * 1e6) as i32);
        let linear = if self.waits {
            Speed::ZERO
        } else {
            self.last.linear.min(most)
        };
        let action = if self.waits {
            Action::EmergencyStop
        } else {
            Action::Pass
        };
        Decision {
            action,
            setpoint: Motion::Twist(Twist {
                linear,
                ..self.last
            }),
            reason: Reason::None,
            status: if self.waits {
                StopStatus::Latched
            } else {
                StopStatus::Running
            },
            expires: now.plus(Duration::from_ms(100)),
            verdict: None,
            factor_permille: 1000,
        }
    }
}

/// The naive law touches, the kernel passes the same scenario.
fn differ(name: &str, law: Law) {
    let case = case(name);
    let naive = run(&case.scenario, &case.robot, Naive::boxed(law));
    assert!(touches(&naive), "{name}: the naive law would do");
    let ours = run_case(&case).unwrap();
    let judgement = &ours.result.judgement;
    assert_eq!(
        judgement.outcome,
        Outcome::Pass,
        "{name}: {:?}",
        judgement.sentences
    );
    assert!(
        !ours.result.guarded.contacts.iter().any(|c| c.robot_moving),
        "{name}"
    );
}

/// Stops half a metre before what it sees.
fn polygon(ahead_m: f64) -> f64 {
    if ahead_m < 0.5 { 0.0 } else { 5.0 }
}

/// Approach mode: never less than 1.2 s from a contact at the commanded speed.
fn approach(ahead_m: f64) -> f64 {
    ahead_m / 1.2
}

/// A barrier function `v^2 <= 2 b d` over continuous time, kept at each tick, without latency.
fn barrier(ahead_m: f64) -> f64 {
    (2.0 * 0.5 * ahead_m).sqrt()
}

#[test]
fn the_naive_controllers_are_no_straw_men() {
    // At 0.3 m/s each of them stops in time where nothing is wrong.
    for law in [polygon as Law, approach] {
        let mut case = case("corridor_ahead");
        case.scenario.proposer.get_mut().speed_mps = toml::Value::Float(0.3).try_into().ok();
        let naive = run(&case.scenario, &case.robot, Naive::boxed(law));
        assert!(!touches(&naive) && naive.result.travelled_m > 1.0);
    }
}

/// collision_monitor drops beams that are no numbers as if nothing were there, and uses what is left.
#[test]
fn blind_scans_do_not_clear_the_way() {
    differ("input_ranges_nan", polygon);
    differ("input_ranges_infinite", polygon);
    differ("input_ranges_zero", polygon);
}

/// A fixed polygon and a fixed time have no braking model.
#[test]
fn a_fixed_zone_is_too_short_at_speed() {
    differ("slow_then_fast", polygon);
    differ("slow_then_fast", approach);
}

/// Control-barrier filters, discretised and without the drive's latency, leave the safe set.
#[test]
fn a_discretised_barrier_overshoots() {
    differ("slow_then_fast", barrier);
}

/// RPP takes what is off the map, and what is unknown, for free.
#[test]
fn unknown_space_is_not_entered() {
    for name in ["blind_turn", "reverse_unwatched"] {
        let run = run_case(&case(name)).unwrap();
        let judgement = &run.result.judgement;
        assert_eq!(
            judgement.outcome,
            Outcome::Pass,
            "{name}: {:?}",
            judgement.sentences
        );
    }
}

/// DWB, #570, clips corners; so does the naked twin of this scenario.
#[test]
fn corners_are_not_clipped() {
    let case = case("corridor_corner");
    assert!(touches(&run_one(&case, false).unwrap()));
    assert!(!touches(&run_one(&case, true).unwrap()));
}

/// rust_robotics' DWA: if every candidate collides their costs saturate, and a colliding command wins.
#[test]
fn where_every_way_collides_the_planner_stands() {
    let case = case("navigate_dead_end");
    assert!(touches(&run_one(&case, false).unwrap()));
    let run = run_one(&case, true).unwrap();
    assert!(!touches(&run) && run.result.at_rest);
}
