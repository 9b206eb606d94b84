//! The attacker finds a kernel that is told less than the truth, one term at a time, and nothing where it is told the
//! truth.
//!
//! | the kernel does not know of | how | test |
//! |---|---|---|
//! | moving obstacles | told | `..._nothing_moves` |
//! | latency | told | `..._reacts_at_once` |
//! | sensor error | told | `..._scanner_is_exact` |
//! | tracking | told | `..._never_skids` |
//! | memory drift | told | `..._never_drifts` |
//!
//! Commands in flight and the gap between beams are no settings: the faults of `verification/` take them out of a copy of
//! the kernel, and `commands_are_long_in_flight` and `beams_are_far_apart` must fail there.

#![allow(clippy::unwrap_used, clippy::panic)] // Tests may fail loudly.

use haltline_attack::campaign::{Budget, Orders, Shrunk, campaign};
use haltline_attack::search::Strategy;
use haltline_attack::setting::Setting;
use haltline_attack::trial::{self, Verdict};
use haltline_robots::Robot;
use std::collections::BTreeMap;
use std::time::Instant;

type Pairs<'a> = &'a [(&'a str, f64)];

fn values(pairs: Pairs<'_>) -> BTreeMap<String, toml::Value> {
    let whole = |key: &str| key.ends_with("beams");
    let entries = pairs.iter().map(|(key, value)| {
        let value = match whole(key) {
            true => toml::Value::from(*value as i64),
            false => toml::Value::from(*value),
        };
        ((*key).to_owned(), value)
    });
    entries.collect()
}

fn setting(robot: &str, set: Pairs<'_>, told: Pairs<'_>) -> Setting {
    let robot = Robot::embedded(robot).unwrap();
    Setting::new(robot, values(set), values(told), false).unwrap()
}

const fn orders(seed: u64, runs: u64) -> Orders {
    Orders {
        strategy: Strategy::Search,
        seed,
        shard: [0, 1],
        budget: Budget::Runs(runs),
        keep_going: false,
    }
}

/// The first find, and how many runs were made.
fn attacked(setting: &Setting, orders: &Orders) -> (Option<Shrunk>, u64) {
    let (mut first, mut runs) = (None, 0);
    campaign(setting, orders, |progress| {
        runs += progress.done.runs;
        if first.is_none() {
            first.clone_from(&progress.find);
        }
    });
    (first, runs)
}

/// A lie must be found, small enough to read, and by no fault of the kernel.
fn found(name: &str, set: Pairs<'_>, told: Pairs<'_>) {
    let setting = setting("seekur_jr", set, told);
    let started = Instant::now();
    let (find, runs) = attacked(
        &setting,
        &orders(1, if cfg!(debug_assertions) { 240 } else { 4_800 }),
    );
    let Some(find) = find else {
        // Without optimisation there is no time to look long enough.
        if cfg!(debug_assertions) {
            return;
        }
        panic!("{name} was not found in {runs} runs");
    };
    let lines = find.text.lines().filter(|line| !line.is_empty()).count();
    println!(
        "{name}: found within {runs} runs and {:.0} s, shrunk in {} more to {lines} lines: {:?}",
        started.elapsed().as_secs_f64(),
        find.runs,
        find.trial.verdict
    );
    assert!(
        matches!(find.trial.verdict, Verdict::Violated { told: true, .. }),
        "not by what it was told alone:\n{}",
        find.text
    );
    assert!(lines <= 60, "{lines} lines");
    // The text is the scenario: it is run again to the bit.
    assert_eq!(trial::run(&setting, &find.text).trace, find.trial.trace);
}

#[test]
fn a_kernel_that_thinks_that_nothing_moves() {
    found("obstacle speed", &[], &[("obstacles.speed_mps", 0.0)]);
}

#[test]
#[ignore = "minutes; ci.sh attack runs it"]
fn a_kernel_that_thinks_that_its_drive_reacts_at_once() {
    found("latency", &[], &[("timing.actuation_latency_s", 0.0)]);
}

#[test]
#[ignore = "minutes; ci.sh attack runs it"]
fn a_kernel_that_thinks_that_its_scanner_is_exact() {
    let exact = [
        ("scanner.0.error_systematic_m", 0.0),
        ("scanner.0.error_sigma_m", 0.0),
    ];
    found("sensor error", &[], &exact);
}

#[test]
#[ignore = "minutes; ci.sh attack runs it"]
fn a_kernel_that_thinks_that_it_never_skids() {
    // Skids of 50 mm before an exact scanner: errors of 66 mm would cover for the shipped 20 mm.
    let exact = [
        ("scanner.0.error_systematic_m", 0.0),
        ("scanner.0.error_sigma_m", 0.0),
        ("zone.front_m", 0.01),
        ("zone.side_m", 0.01),
        ("tolerances.tracking_m", 0.05),
    ];
    found("tracking", &exact, &[("tolerances.tracking_m", 0.0)]);
}

#[test]
#[ignore = "minutes; ci.sh attack runs it"]
fn a_kernel_that_thinks_that_its_odometry_never_drifts() {
    // Wheels without a gyro, and a scanner that looks ahead only, so that what is passed is known from memory alone; one
    // that errs by 66 mm would cover for what they drift in a few metres.
    let poor = [
        ("scanner.0.field_of_view_deg", 120.0),
        ("scanner.0.beams", 241.0),
        ("zone.front_m", 0.01),
        ("zone.side_m", 0.01),
        ("scanner.0.error_systematic_m", 0.0),
        ("scanner.0.error_sigma_m", 0.0),
        ("tolerances.tracking_m", 0.0),
        ("tolerances.odometry_m_per_m", 0.05),
        ("tolerances.odometry_rad_per_rad", 0.05),
    ];
    let told = [
        ("tolerances.odometry_m_per_m", 0.0),
        ("tolerances.odometry_rad_per_rad", 0.0),
    ];
    found("memory drift", &poor, &told);
}

/// What is attacked where nothing is wrong.
fn clean(name: &str, robot: &str, set: Pairs<'_>, runs: u64) {
    let runs = if cfg!(debug_assertions) { 120 } else { runs };
    let (find, made) = attacked(&setting(robot, set, &[]), &orders(1, runs));
    if let Some(find) = find {
        panic!("{name}: {:?}\n{}", find.trial.verdict, find.text);
    }
    println!("{name}: searched, nothing found in {made} runs");
}

#[test]
#[ignore = "minutes; ci.sh attack runs it"]
fn the_shipped_robots_are_clean() {
    for robot in ["seekur_jr", "jackal", "pses_car"] {
        clean(robot, robot, &[], 240);
    }
}

/// A drive that reacts 0.6 s late and brakes as hard as a car: what is on its way to it differs from what it does by as
/// much as a whole turn. A kernel that forgets what it has sent is found out here (`faults` of `verification/`).
#[test]
#[ignore = "minutes; ci.sh attack runs it"]
fn commands_are_long_in_flight() {
    let set = [
        ("scanner.0.error_systematic_m", 0.0),
        ("scanner.0.error_sigma_m", 0.0),
        ("tolerances.tracking_m", 0.0),
        ("tolerances.follow_speed_mps", 1.2),
        ("tolerances.follow_angular_speed_radps", 1.3),
        ("limits.acceleration_mps2", 4.0),
        ("limits.braking_mps2", 4.0),
        ("limits.angular_acceleration_radps2", 10.0),
        ("limits.angular_braking_radps2", 10.0),
        ("timing.actuation_latency_s", 0.6),
        ("timing.tracking_window_s", 1.6),
        ("zone.front_m", 0.01),
        ("zone.side_m", 0.01),
    ];
    clean("slow drive", "seekur_jr", &set, 1200);
}

/// Beams 10 degrees apart, five times a second, in a world of wide bodies: a kernel that takes returns for the whole of
/// what it sees is found out here (`faults` of `verification/`).
#[test]
#[ignore = "minutes; ci.sh attack runs it"]
fn beams_are_far_apart() {
    let set = [
        ("scanner.0.error_systematic_m", 0.0),
        ("scanner.0.error_sigma_m", 0.0),
        ("scanner.0.beams", 28.0),
        ("scanner.0.rate_hz", 5.0),
        ("scanner.0.invalid_gap_max_deg", 40.0),
        ("timing.scan_age_max_s", 0.3),
        ("memory.body_width_min_m", 0.6),
        ("tolerances.tracking_m", 0.0),
        ("tolerances.odometry_m_per_m", 0.0),
        ("tolerances.odometry_rad_per_rad", 0.0),
        ("zone.front_m", 0.01),
        ("zone.side_m", 0.01),
    ];
    clean("few beams", "seekur_jr", &set, 2400);
}
