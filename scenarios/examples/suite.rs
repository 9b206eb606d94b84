//! Runs scenario files and prints one line for each case: `cargo run --release --example suite [WORD]`.
//!
//! With a word only the cases whose name contains it run, and their sentences, stops and broken
//! assumptions are printed as well.

use std::path::Path;
use std::process::ExitCode;

use haltline_robots::Robot;
use haltline_scenarios::batch::{Case, equip, run_suite};
use haltline_scenarios::file::load_dir;
use haltline_scenarios::result::{CaseResult, Outcome};

fn main() -> ExitCode {
    let word = std::env::args().nth(1).unwrap_or_default();
    match cases(&word) {
        Ok(cases) => report(&cases, !word.is_empty()),
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

fn cases(word: &str) -> Result<Vec<Case>, String> {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("files");
    let scenarios = load_dir(&dir).map_err(|error| error.to_string())?;
    scenarios
        .into_iter()
        .filter(|scenario| scenario.name.contains(word))
        .map(|scenario| {
            let robot = Robot::embedded(&scenario.robot).map_err(|error| error.to_string())?;
            equip(scenario, &robot).map_err(|error| error.to_string())
        })
        .collect()
}

fn report(cases: &[Case], details: bool) -> ExitCode {
    let begun = std::time::Instant::now();
    let suite = run_suite(cases, &|_| {});
    for case in &suite.cases {
        line(case);
        if details || case.judgement.outcome == Outcome::Fail {
            explain(case, details);
        }
    }
    for group in &suite.groups {
        println!("{}: {}", group.group, group.judgement.sentences.join(" "));
    }
    println!(
        "{} cases, {} failed, {:.1} s",
        suite.cases.len(),
        suite.failed,
        begun.elapsed().as_secs_f64()
    );
    if suite.failed == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

fn line(case: &CaseResult) {
    let run = &case.guarded;
    let last = run.decisions.last();
    println!(
        "{:4} {:44} t {:5.1} way {:5.2} reached {:5} contacts {} clear {:6.3} last {}/{}",
        if case.judgement.outcome == Outcome::Pass {
            "pass"
        } else {
            "FAIL"
        },
        case.name,
        run.time_s,
        run.travelled_m,
        run.reached,
        run.moving_contacts(),
        run.min_clearance_m.unwrap_or(f64::NAN),
        last.map_or("-", |d| &d.decision),
        last.map_or("-", |d| &d.reason),
    );
}

fn explain(case: &CaseResult, details: bool) {
    for sentence in &case.judgement.sentences {
        println!("       {sentence}");
    }
    if !details {
        return;
    }
    for change in &case.guarded.decisions {
        let pose = change.pose;
        println!(
            "       {:6.2} s  {} / {} at ({:.3}, {:.3}, {:.3}) point {:?}",
            change.t_s,
            change.decision,
            change.reason,
            pose.x_m,
            pose.y_m,
            pose.theta_rad,
            change.point_m
        );
    }
    for broken in &case.guarded.assumptions_broken {
        println!("       {}: {}", broken.id, broken.what);
    }
    for monitor in &case.guarded.monitors {
        println!(
            "       {}: {} judged, {} engaged, {} violated",
            monitor.id, monitor.checked, monitor.engaged, monitor.violation_count
        );
        for violation in monitor.violations.iter().take(5) {
            println!("           {:.2} s {}", violation.t_s, violation.what);
        }
    }
}
