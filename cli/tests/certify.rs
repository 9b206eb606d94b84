//! `haltline certify`: exit codes, files, and the same bytes twice.

// A test that cannot get its files or start the command fails here, which is what `expect` is for.
#![allow(clippy::expect_used)]

mod common;

use common::{WALL_AHEAD, expect_exit, folder, haltline, root, stderr, stdout, write};
use haltline_verification::prove::command::verified_fresh;
use std::path::Path;

/// The smallest set of shipped scenarios that exercises every monitor, and a wall.
const SMALL: [&str; 3] = ["emergency_stop", "input_ranges_nan", "overtaking"];

fn small_folder(name: &str) -> std::path::PathBuf {
    let scenarios = folder(name);
    for stem in SMALL {
        let from = root().join(format!("scenarios/files/{stem}.toml"));
        std::fs::copy(from, scenarios.join(format!("{stem}.toml"))).expect("copied");
    }
    write(&scenarios, "wall_ahead.toml", WALL_AHEAD);
    scenarios
}

fn certify(scenarios: &Path, out: &Path) -> std::process::Output {
    haltline(&[
        "certify",
        "robots/seekur_jr.toml",
        "--scenarios",
        &scenarios.display().to_string(),
        "--out",
        &out.display().to_string(),
    ])
}

#[test]
fn two_runs_give_the_same_bytes_but_for_the_times() {
    let scenarios = small_folder("certify_small");
    let outs = [folder("certify_a"), folder("certify_b")];
    let proved = verified_fresh(&root()).is_ok();
    for out in &outs {
        let output = certify(&scenarios, out);
        // Without a fresh proof ledger, the same runs end as "not checkable".
        expect_exit(&output, if proved { 0 } else { 3 });
        let said = stdout(&output);
        assert_eq!(
            said.contains("Every claim that is made holds."),
            proved,
            "{said}"
        );
    }
    for name in [
        "report.html",
        "certificate.json",
        "junit.xml",
        "claims.sarif",
    ] {
        let [a, b] = outs
            .each_ref()
            .map(|out| std::fs::read(out.join(name)).expect(name));
        assert!(!a.is_empty() && a == b, "{name} differs between two runs");
    }
    let json = std::fs::read_to_string(outs[0].join("certificate.json")).expect("json");
    let certificate: serde_json::Value = serde_json::from_str(&json).expect("valid");
    assert_eq!(certificate["schema"], "haltline-certificate/1");
    assert_eq!(
        certificate["verdict"]["exit_code"],
        if proved { 0 } else { 3 }
    );
    let claims = certificate["claims"].as_array().expect("claims");
    for id in ["PROOFS", "GUARD"] {
        let claim = claims
            .iter()
            .find(|claim| claim["id"] == id)
            .expect("claimed");
        assert_eq!(claim["status"] == "holds", proved, "{claim}");
    }
    assert_eq!(certificate["cases"].as_array().map(Vec::len), Some(4));
    assert_eq!(
        certificate["scenario_files"].as_array().map(Vec::len),
        Some(4)
    );
    // Only a check of the ledger may call itself proved.
    let checks = certificate["proofs"]["checks"].as_array().expect("checks");
    let means = checks.iter().filter(|check| check["means"] == "proved");
    assert_eq!(json.matches("\"proved\"").count(), means.count());
    let timing = std::fs::read_to_string(outs[0].join("timing.json")).expect("timing");
    assert!(timing.contains("scenarios_s"));
}

#[test]
fn every_key_of_the_certificate_is_documented() {
    let out = folder("certify_keys");
    let scenarios = folder("certify_keys_scenarios");
    write(&scenarios, "wall_ahead.toml", WALL_AHEAD);
    let _ = certify(&scenarios, &out);
    let json = std::fs::read_to_string(out.join("certificate.json")).expect("json");
    let certificate: serde_json::Value = serde_json::from_str(&json).expect("valid");
    let documented = std::fs::read_to_string(root().join("cli/CERTIFICATE.md")).expect("schema");
    let claim = &certificate["claims"][0];
    let case = &certificate["cases"][0];
    for object in [
        &certificate,
        claim,
        case,
        &case["guarded"],
        &certificate["verdict"],
        &claim["evidence"],
        &certificate["proofs"],
        &certificate["proofs"]["checks"][0],
    ] {
        for key in object.as_object().expect("object").keys() {
            assert!(documented.contains(key), "CERTIFICATE.md lacks `{key}`");
        }
    }
}

#[test]
fn what_no_run_exercised_is_not_checkable() {
    let scenarios = folder("certify_one_scenarios");
    write(&scenarios, "wall_ahead.toml", WALL_AHEAD);
    let output = certify(&scenarios, &folder("certify_one"));
    expect_exit(&output, 3);
    assert!(
        stdout(&output).contains("not checkable"),
        "{}",
        stdout(&output)
    );
}

#[test]
fn a_scenario_that_does_not_come_true_fails_and_names_its_replay() {
    let scenarios = folder("certify_fails_scenarios");
    let wrong = WALL_AHEAD.replace("reached = false", "reached = true");
    write(
        &scenarios,
        "wall_ahead.toml",
        &wrong.replace("blocked = true", ""),
    );
    let out = folder("certify_fails");
    let output = certify(&scenarios, &out);
    expect_exit(&output, 1);
    let said = stdout(&output);
    assert!(said.contains("SCENARIOS does not hold"), "{said}");
    let command = said
        .lines()
        .find_map(|line| line.trim().strip_prefix("replay: haltline "))
        .expect("a command to replay");
    let args: Vec<&str> = command.split(' ').collect();
    let run_out = folder("certify_fails_replay").display().to_string();
    let replayed = haltline(&[args.as_slice(), &["--out", &run_out]].concat());
    expect_exit(&replayed, 1);
    let sarif = std::fs::read_to_string(out.join("claims.sarif")).expect("sarif");
    let sarif: serde_json::Value = serde_json::from_str(&sarif).expect("valid");
    let results = sarif["runs"][0]["results"].as_array().expect("results");
    let about = |id| results.iter().any(|result| result["ruleId"] == id);
    assert!(about("SCENARIOS") && !about("LATCH"), "{sarif}");
    assert!(results.iter().all(|result| {
        let text = result["message"]["text"].as_str().unwrap_or_default();
        let place = &result["locations"][0]["physicalLocation"];
        text.contains("Replay: ") && place["artifactLocation"]["uri"] == "robots/seekur_jr.toml"
    }));
    let junit = std::fs::read_to_string(out.join("junit.xml")).expect("junit");
    assert!(junit.contains("<failure"), "{junit}");
}

#[test]
fn no_scenario_for_the_robot_is_not_checkable() {
    let robots = folder("certify_unknown_robot");
    let text = std::fs::read_to_string(root().join("robots/seekur_jr.toml")).expect("robot");
    let robot = write(&robots, "somebody_else.toml", &text);
    let out = robots.join("out").display().to_string();
    let output = haltline(&["certify", &robot, "--out", &out]);
    expect_exit(&output, 3);
    assert!(
        stderr(&output).contains("robot = \"somebody_else\""),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_bad_robot_file_is_named_with_its_line() {
    let robots = folder("certify_bad_robot");
    let text = std::fs::read_to_string(root().join("robots/seekur_jr.toml")).expect("robot");
    let robot = write(
        &robots,
        "bad.toml",
        &text.replacen("period_s", "perjod_s", 1),
    );
    let output = haltline(&["certify", &robot]);
    expect_exit(&output, 2);
    assert!(stderr(&output).contains("bad.toml:"), "{}", stderr(&output));
    expect_exit(&haltline(&["certify", "no/such/robot.toml"]), 2);
    expect_exit(
        &haltline(&[
            "certify",
            "robots/seekur_jr.toml",
            "--scenarios",
            "no/such/folder",
        ]),
        2,
    );
}
