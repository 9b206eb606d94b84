//! The kernel drives the published BARN worlds: no contact anywhere, and most goals are reached.

#![allow(clippy::expect_used, clippy::panic)] // helpers outside of #[test] functions

use std::path::{Path, PathBuf};

use haltline_robots::Robot;
use haltline_scenarios::barn::{Options, World};
use haltline_scenarios::batch::{equip, run_guarded};
use haltline_scenarios::file::parse;
use haltline_scenarios::result::{CaseResult, Outcome};
use rayon::prelude::*;

/// Worlds at hand; none, with one line that says so, where the data or the time are missing.
fn worlds() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let data = std::env::var_os("HALTLINE_DATA")
        .map_or_else(|| root.join("../shared/data"), PathBuf::from);
    let folder = data.join("barn");
    if cfg!(debug_assertions) {
        eprintln!("skipped: 30 drives take minutes without optimisation; run with --release");
        return Vec::new();
    }
    let Ok(listing) = std::fs::read_dir(&folder) else {
        eprintln!("skipped: {} is not there", folder.display());
        return Vec::new();
    };
    let paths = listing.filter_map(Result::ok).map(|entry| entry.path());
    paths
        .filter(|path| path.extension().is_some_and(|end| end == "csv"))
        .collect()
}

fn drive(file: &Path) -> CaseResult {
    let world = World::read(file).expect("a published world");
    let text = world.scenario_text(&Options::default());
    let scenario = parse(&text, "made", &world.name)
        .expect("a good scenario")
        .remove(0);
    let robot = Robot::embedded("jackal").expect("the robot is shipped");
    let case = equip(scenario, &robot).expect("robot and world fit");
    run_guarded(&case)
        .expect("the kernel takes the robot")
        .result
}

#[test]
fn no_contact_in_any_world_and_most_goals_reached() {
    let files = worlds();
    if files.is_empty() {
        return;
    }
    assert_eq!(files.len(), 30, "the data hold 30 worlds");
    let results: Vec<CaseResult> = files.par_iter().map(|file| drive(file)).collect();
    let mut refused = 0;
    for result in &results {
        let run = &result.guarded;
        refused += run
            .navigation
            .as_ref()
            .map_or(0, |navigation| navigation.refused);
        assert!(
            run.contacts.is_empty(),
            "{} touched: {:?}",
            result.name,
            run.contacts
        );
        assert_eq!(
            run.violation_count(),
            0,
            "{}: {:?}",
            result.name,
            run.monitors
        );
        assert_eq!(run.assumptions_broken, [], "{}", result.name);
        if !run.reached {
            // Whoever does not get there says why.
            let end = run.navigation.as_ref().map(|navigation| &navigation.end);
            assert!(
                end.is_some_and(|end| end.reason.is_some()),
                "{}: {end:?}",
                result.name
            );
        }
    }
    let passed = |result: &&CaseResult| result.judgement.outcome == Outcome::Pass;
    let reached = results.iter().filter(passed).count();
    println!("{reached} of 30 worlds reached, {refused} candidates refused by the guard");
    assert!(reached >= 25, "only {reached} of 30 worlds reached");
}
