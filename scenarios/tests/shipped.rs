//! The shipped files: all load, name real requirements, and a few are run from end to end.

#![allow(clippy::expect_used, clippy::panic)] // helpers outside of #[test] functions

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use haltline_robots::Robot;
use haltline_scenarios::batch::{Case, equip, run_case, run_one};
use haltline_scenarios::file::{Scenario, load_dir, load_file};
use haltline_scenarios::result::{Outcome, RunResult};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

fn shipped() -> Vec<Scenario> {
    load_dir(&root().join("files")).expect("all shipped files are good")
}

fn case(name: &str) -> Case {
    let file = root().join("files").join(format!("{name}.toml"));
    let scenario = load_file(&file).expect("the file is good").remove(0);
    let robot = Robot::embedded(&scenario.robot).expect("the robot is shipped");
    equip(scenario, &robot).expect("robot and scenario fit")
}

#[test]
fn every_file_fits_its_robot() {
    let scenarios = shipped();
    assert!(scenarios.len() >= 120, "only {} cases", scenarios.len());
    let mut names = BTreeSet::new();
    for scenario in scenarios {
        assert!(
            names.insert(scenario.name.clone()),
            "{} twice",
            scenario.name
        );
        let robot = Robot::embedded(&scenario.robot).expect("the robot is shipped");
        if let Err(error) = equip(scenario, &robot) {
            panic!("{error}");
        }
    }
}

#[test]
fn crossing_has_both_sides_at_twenty_timings() {
    let crossing = shipped().into_iter().filter(|s| s.group == "crossing");
    let (left, right): (Vec<_>, Vec<_>) = crossing.partition(|s| s.name.contains("side_left"));
    assert_eq!((left.len(), right.len()), (20, 20));
    for side in [left, right] {
        let delays: Vec<f64> = side
            .iter()
            .filter_map(|s| s.circle[0].get_ref().motion.as_ref()?.get_ref().delay_s)
            .map(|delay| delay.get())
            .collect();
        // Robot and object meet for 1.6667 s; the sweep is -1.5 s to +1.5 s around it.
        assert!((delays[0] - 0.1667).abs() < 1e-9 && (delays[19] - 3.1667).abs() < 1e-9);
        let step = (delays[1] - delays[0]) / (3.0 / 19.0);
        assert!((step - 1.0).abs() < 1e-9, "the timings are evenly spaced");
    }
}

#[test]
fn files_name_requirements_that_exist() {
    let mut known = BTreeSet::new();
    for entry in fs::read_dir(root().join("../spec")).expect("the specification is there") {
        let path = entry.expect("it can be listed").path();
        if path.extension().is_some_and(|end| end == "md") {
            let text = fs::read_to_string(path).expect("it can be read");
            let ids = text.lines().filter_map(|line| line.strip_prefix("## "));
            known.extend(ids.map(|id| id.trim().to_owned()));
        }
    }
    for scenario in shipped() {
        for id in &scenario.requirements {
            assert!(known.contains(id), "{}: no requirement {id}", scenario.name);
        }
        for id in &scenario.expect.assumptions_broken {
            assert!(known.contains(id), "{}: no assumption {id}", scenario.name);
        }
    }
}

/// The course of decisions and the end of a run, coarse enough to survive a change of noise.
fn summary(run: &RunResult) -> String {
    let mut text = format!(
        "guarded: {}\nreached: {}\nmoving contacts: {}\nstands at the end: {}\n",
        run.guarded,
        run.reached,
        run.moving_contacts(),
        run.at_rest
    );
    for contact in run.contacts.iter().take(1) {
        writeln!(text, "touches {} at {:.1} s", contact.body, contact.t_s).expect("a string");
    }
    let broken: Vec<_> = run
        .assumptions_broken
        .iter()
        .map(|b| b.id.as_str())
        .collect();
    writeln!(text, "broken: {}", broken.join(", ")).expect("a string");
    for change in run.decisions.iter().take(4) {
        let (decision, reason) = (&change.decision, &change.reason);
        writeln!(text, "{:.2} s {decision} / {reason}", change.t_s).expect("a string");
    }
    text
}

#[test]
fn naked_corridor_run_is_as_it_was() {
    let run = run_one(&case("corridor_ahead"), false).expect("it runs");
    insta::assert_snapshot!("naked_corridor_ahead", summary(&run.result));
    let lines: Vec<&str> = run.trace.lines().step_by(100).take(6).collect();
    insta::assert_snapshot!("naked_corridor_ahead_trace", lines.join("\n"));
}

/// The guarded run of a shipped case, which must be judged a pass.
fn passed(name: &str) -> RunResult {
    let run = run_case(&case(name)).expect("the kernel takes the robot");
    let judgement = &run.result.judgement;
    let sentences = &judgement.sentences;
    assert_eq!(judgement.outcome, Outcome::Pass, "{name}: {sentences:?}");
    run.result.guarded
}

#[test]
fn nan_ranges_stop_the_robot_as_they_did() {
    let run = passed("input_ranges_nan");
    insta::assert_snapshot!("input_ranges_nan", summary(&run));
}

#[test]
fn uncovered_host_death_is_named() {
    let run = passed("host_death_uncovered");
    insta::assert_snapshot!("host_death_uncovered", summary(&run));
}

/// What the navigator says at the end, coarse enough to survive a change of noise.
fn navigated(run: &RunResult) -> String {
    let navigation = run.navigation.as_ref().expect("the kernel drives itself");
    let end = &navigation.end;
    format!(
        "{}end: {}{}\nvia points: {}\n",
        summary(run),
        end.kind,
        end.reason
            .as_ref()
            .map_or_else(String::new, |reason| format!(" by {reason}")),
        navigation.via_points
    )
}

#[test]
fn kernel_drives_through_the_widest_passage_as_it_did() {
    let run = passed("navigate_passages");
    insta::assert_snapshot!("navigate_passages", navigated(&run));
}

#[test]
fn kernel_says_why_it_stops_before_a_passage_that_is_too_narrow() {
    let text = navigated(&passed("navigate_passages_closed"));
    // How often it tries again before it stands is a matter of tuning, so only the ends are kept.
    let lines: Vec<&str> = text.lines().filter(|line| !line.contains(" s ")).collect();
    insta::assert_snapshot!("navigate_passages_closed", lines.join("\n"));
}
