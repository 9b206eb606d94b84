//! `run`, `explain`, `new`, help and usage.

// A test that cannot get its files or start the command fails here, which is what `expect` is for.
#![allow(clippy::expect_used)]

mod common;

use common::{WALL_AHEAD, expect_exit, folder, haltline, haltline_in, stderr, stdout, write};

#[test]
fn run_prints_one_json_object_with_the_promised_keys() {
    let out = folder("run_json");
    let file = write(&out, "wall_ahead.toml", WALL_AHEAD);
    let output = haltline(&["run", &file, "--json", "--out", &out.display().to_string()]);
    expect_exit(&output, 0);
    let text = stdout(&output);
    assert_eq!(text.lines().count(), 1);
    let summary: serde_json::Value = serde_json::from_str(&text).expect("json");
    assert_eq!(summary["contacts"], 0);
    assert_eq!(summary["reached"], false);
    assert!(summary["time_s"].as_f64().expect("time_s") > 1.0);
    assert!(summary["min_clearance_m"].as_f64().expect("clearance") > 0.0);
    assert!(summary["stops"].as_u64().expect("stops") > 0);
    assert!(summary["naked_contacts"].as_u64().expect("twin") > 0);
}

#[test]
fn the_trace_confirms_what_the_summary_says() {
    let out = folder("run_trace");
    let file = write(&out, "wall_ahead.toml", WALL_AHEAD);
    let folder = out.display().to_string();
    expect_exit(&haltline(&["run", &file, "--out", &folder]), 0);
    let trace = std::fs::read_to_string(out.join("trace.jsonl")).expect("trace");
    let farthest = trace
        .lines()
        .map(|line| serde_json::from_str::<serde_json::Value>(line).expect("a line of JSON"))
        .map(|step| step["x_m"].as_f64().expect("x_m"))
        .fold(f64::MIN, f64::max);
    // The front edge of the robot is 0.6 m before its centre, the wall at 3 m.
    assert!(
        farthest > 0.5 && farthest + 0.6 < 3.0,
        "came to x = {farthest} m"
    );
    let picture = std::fs::read(out.join("run.png")).expect("picture");
    assert!(picture.starts_with(b"\x89PNG"));
    assert!(out.join("run.svg").is_file() && out.join("trace_naked.jsonl").is_file());
}

#[test]
fn the_same_run_gives_the_same_files() {
    let outs = [folder("run_same_a"), folder("run_same_b")];
    let file = write(&outs[0], "wall_ahead.toml", WALL_AHEAD);
    for out in &outs {
        expect_exit(
            &haltline(&["run", &file, "--out", &out.display().to_string()]),
            0,
        );
    }
    for name in ["trace.jsonl", "trace_naked.jsonl", "run.svg", "run.png"] {
        let [a, b] = outs
            .each_ref()
            .map(|out| std::fs::read(out.join(name)).expect(name));
        assert!(a == b, "{name} differs");
    }
}

#[test]
fn without_the_guard_the_robot_touches() {
    let out = folder("run_naked");
    let file = write(&out, "wall_ahead.toml", WALL_AHEAD);
    let folder = out.display().to_string();
    let output = haltline(&["run", &file, "--naked", "--json", "--out", &folder]);
    expect_exit(&output, 0);
    let summary: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("json");
    assert_eq!(summary["guarded"], false);
    assert!(summary["contacts"].as_u64().expect("contacts") > 0);
}

#[test]
fn a_run_that_does_not_come_true_exits_with_1() {
    let out = folder("run_fails");
    let wrong = WALL_AHEAD.replace("reached = false", "reached = true");
    let file = write(&out, "wrong.toml", &wrong.replace("blocked = true", ""));
    let output = haltline(&["run", &file, "--out", &out.display().to_string()]);
    expect_exit(&output, 1);
    assert!(stdout(&output).contains("FAILED"));
}

#[test]
fn a_bad_scenario_is_named_with_its_line() {
    let out = folder("run_bad");
    let file = write(&out, "bad.toml", &WALL_AHEAD.replacen("seed", "sead", 1));
    let output = haltline(&["run", &file]);
    expect_exit(&output, 2);
    assert!(
        stderr(&output).contains("bad.toml:6:"),
        "{}",
        stderr(&output)
    );
    expect_exit(&haltline(&["run", "no/such/scenario.toml"]), 2);
}

#[test]
fn an_unknown_variant_lists_the_known_ones() {
    let output = haltline(&[
        "run",
        "scenarios/files/crossing.toml",
        "--variant",
        "nonsense",
    ]);
    expect_exit(&output, 2);
    assert!(stderr(&output).contains("it has "), "{}", stderr(&output));
}

#[test]
fn explain_prints_text_assumptions_and_evidence() {
    let output = haltline(&["explain", "guard-01"]);
    expect_exit(&output, 0);
    let text = stdout(&output);
    for part in [
        "GUARD-01", "MUST", "Assumes", "A-SENSOR", "Evidence", "proved: ",
    ] {
        assert!(text.contains(part), "lacks `{part}`:\n{text}");
    }
    expect_exit(&haltline(&["explain", "A-BRAKE"]), 0);
    expect_exit(&haltline(&["explain"]), 0);
    let unknown = haltline(&["explain", "GUARD-1"]);
    expect_exit(&unknown, 2);
    assert!(
        stderr(&unknown).contains("did you mean"),
        "{}",
        stderr(&unknown)
    );
}

#[test]
fn new_robot_writes_a_file_that_parses_and_overwrites_nothing() {
    let out = folder("new_robot");
    expect_exit(&haltline_in(&out, &["new", "robot", "mine.toml"]), 0);
    let text = std::fs::read_to_string(out.join("mine.toml")).expect("template");
    assert!(text.contains("[footprint]"));
    let again = haltline_in(&out, &["new", "robot", "mine.toml"]);
    expect_exit(&again, 2);
    assert!(
        stderr(&again).contains("not overwritten"),
        "{}",
        stderr(&again)
    );
    assert_eq!(
        std::fs::read_to_string(out.join("mine.toml")).expect("still there"),
        text
    );
    // The template is a robot file, but no scenario is for it.
    expect_exit(&haltline_in(&out, &["certify", "mine.toml"]), 3);
}

#[test]
fn help_teaches() {
    let output = haltline(&["--help"]);
    expect_exit(&output, 0);
    let text = stdout(&output);
    for part in [
        "Examples:",
        "haltline new robot",
        "Exit codes:",
        "not checkable",
    ] {
        assert!(text.contains(part), "lacks `{part}`");
    }
    for command in ["certify", "run", "replay", "explain", "barn", "import barn"] {
        let words: Vec<&str> = command.split(' ').chain(["--help"]).collect();
        let text = stdout(&haltline(&words));
        assert!(
            text.contains("Example"),
            "{command} --help lacks an example"
        );
    }
    expect_exit(&haltline(&["certfy"]), 2);
}

#[test]
fn an_output_folder_that_cannot_be_written_is_bad_input() {
    let out = folder("run_unwritable");
    let file = write(&out, "wall_ahead.toml", WALL_AHEAD);
    // A file stands where the folder should be.
    let output = haltline(&["run", &file, "--out", &file]);
    expect_exit(&output, 2);
    assert!(stderr(&output).contains("--out"), "{}", stderr(&output));
    assert!(stdout(&output).is_empty(), "nothing was run");
}

#[test]
fn json_has_at_most_six_decimals() {
    let out = folder("run_decimals");
    let file = write(&out, "wall_ahead.toml", WALL_AHEAD);
    let output = haltline(&["run", &file, "--json", "--out", &out.display().to_string()]);
    let text = stdout(&output);
    let numbers = text.split(|c: char| !c.is_ascii_digit() && c != '.');
    let decimals = numbers
        .filter_map(|word| word.split_once('.'))
        .map(|(_, d)| d.len());
    let longest = decimals.max().expect("there are floats");
    assert!((2..=6).contains(&longest), "{longest} decimals in {text}");
}
