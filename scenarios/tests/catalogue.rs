//! The catalogue of faults: whole, and true to the files it names.

#![allow(clippy::expect_used, clippy::panic)] // helpers outside of #[test] functions

use std::fs;
use std::path::{Path, PathBuf};

use haltline_robots::Robot;
use haltline_scenarios::batch::{equip, run_one};
use haltline_scenarios::catalogue::{CATALOGUE, Fault, How, table};
use haltline_scenarios::file::fault::{FaultKind, KINDS};
use haltline_scenarios::file::load_file;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[test]
fn every_kind_is_in_the_catalogue() {
    for kind in KINDS {
        let known = CATALOGUE.iter().any(|fault| fault.how == How::Kind(kind));
        assert!(known, "{kind:?} is missing");
    }
}

#[test]
fn the_page_is_the_catalogue() {
    let path = root().join("scenarios/FAULTS.md");
    if std::env::var_os("UPDATE_FAULTS").is_some() {
        fs::write(&path, table()).expect("it can be written");
    }
    let page = fs::read_to_string(&path).expect("the page is there");
    assert!(page == table(), "UPDATE_FAULTS=1 writes FAULTS.md again");
}

#[test]
fn every_fault_is_shown_where_the_catalogue_says() {
    for fault in CATALOGUE {
        match fault.shown.split_once("::") {
            Some((file, test)) => {
                let text = fs::read_to_string(root().join(file)).expect("the test's file is there");
                assert!(text.contains(&format!("fn {test}(")), "{}", fault.shown);
            }
            None => shown_by_file(fault),
        }
    }
}

/// A fault that changes nothing shows nothing.
#[test]
fn every_fault_has_an_effect_where_it_is_shown() {
    for fault in CATALOGUE {
        let How::Kind(kind) = fault.how else {
            continue;
        };
        // That a scan which comes twice changes nothing is what its scenario shows.
        if fault.shown.contains("::") || kind == FaultKind::ScanDuplicated {
            continue;
        }
        let [with, without] = [false, true].map(|sound| {
            let path = root().join(format!("scenarios/files/{}.toml", fault.shown));
            let mut scenario = load_file(&path).expect("it is good").remove(0);
            if sound {
                scenario.fault.retain(|entry| entry.get_ref().kind != kind);
            }
            let robot = Robot::embedded(&scenario.robot).expect("a shipped robot");
            let case = equip(scenario, &robot).expect("it fits");
            run_one(&case, true).expect("the kernel takes it").trace
        });
        assert!(
            with != without,
            "{} does nothing in {}",
            fault.what,
            fault.shown
        );
    }
}

/// The file asks for the fault, and the simulator names just the assumption that the catalogue names.
fn shown_by_file(fault: &Fault) {
    let path = root().join(format!("scenarios/files/{}.toml", fault.shown));
    let text = fs::read_to_string(&path).expect("the scenario is there");
    let asked = match fault.how {
        How::Kind(kind) => format!("kind = \"{}\"", kind.name()),
        How::Key(key) => key.to_owned(),
        How::Markers => panic!("{}: markers are in no scenario", fault.what),
    };
    assert!(text.contains(&asked), "{} lacks {asked}", fault.shown);
    let mut scenario = load_file(&path).expect("it is good").remove(0);
    // Breaks are known before the first step.
    scenario.timeout_s = toml::Value::Float(0.05).try_into().expect("a time limit");
    let robot = Robot::embedded(&scenario.robot).expect("a shipped robot");
    let case = equip(scenario, &robot).expect("it fits");
    let run = run_one(&case, true).expect("the kernel takes it");
    let mut broken = run.result.assumptions_broken;
    broken.dedup_by(|a, b| a.id == b.id);
    let broken: Vec<&str> = broken.iter().map(|one| one.id.as_str()).collect();
    let named: Vec<&str> = fault.breaks.into_iter().collect();
    assert_eq!(broken, named, "{} ({})", fault.what, fault.shown);
}
