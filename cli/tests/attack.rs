//! `attack`: exit codes, counterexamples that replay to the bit, shards that join.

#![allow(clippy::expect_used)]

mod common;

use common::{expect_exit, folder, haltline, stderr, stdout};
use sha2::{Digest, Sha256};
use std::path::Path;

const ROBOT: &str = "robots/seekur_jr.toml";

fn record(out: &Path) -> serde_json::Value {
    let text = std::fs::read_to_string(out.join("attack.json")).expect("attack.json");
    serde_json::from_str(&text).expect("json")
}

#[test]
fn a_lie_is_found_and_its_counterexample_replays_to_the_bit() {
    let out = folder("attack_lie");
    let to = out.display().to_string();
    let lie = "obstacles.speed_mps=0.0";
    let args = [
        "attack", ROBOT, "--told", lie, "--budget", "1200", "--out", &to,
    ];
    let output = haltline(&args);
    expect_exit(&output, 1);
    assert!(stdout(&output).contains("claim violated"));
    let record = record(&out);
    let find = &record["violations"][0];
    assert_eq!(find["what"], "CLAIM");
    let file = out.join(find["file"].as_str().expect("a file"));
    let text = std::fs::read_to_string(&file).expect("the scenario");
    assert!(text.starts_with("# CLAIM violated") && text.contains("told the truth"));
    assert!(text.lines().count() <= 70, "{text}");
    // What the file's own second line says.
    let run = out.join("run");
    let args = [
        "run",
        &file.display().to_string(),
        "--out",
        &run.display().to_string(),
    ];
    expect_exit(&haltline(&args), 1);
    let trace = std::fs::read(run.join("trace.jsonl")).expect("trace");
    let hash: String = Sha256::digest(trace)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    assert_eq!(find["trace_sha256"], hash.as_str());
}

#[test]
fn the_truth_stands_and_shards_join_once() {
    let shards = ["attack_shard_1", "attack_shard_2"].map(folder);
    for (out, shard) in shards.iter().zip(["1/2", "2/2"]) {
        let to = out.display().to_string();
        let args = [
            "attack",
            ROBOT,
            "--strategy",
            "random",
            "--budget",
            "1",
            "--shard",
            shard,
            "--out",
            &to,
        ];
        let output = haltline(&args);
        expect_exit(&output, 0);
        assert!(stdout(&output).contains("searched, no claim violated"));
    }
    let [one, two] = shards.map(|out| out.display().to_string());
    let whole = folder("attack_whole");
    let to = whole.display().to_string();
    expect_exit(&haltline(&["attack", "merge", &one, &two, "--out", &to]), 0);
    let runs = |out: &str| record(Path::new(out))["runs"].as_u64().expect("runs");
    assert_eq!(runs(&to), runs(&one) + runs(&two));
    assert!(record(&whole)["margins"]["ZONE"].is_number());
    let again = haltline(&["attack", "merge", &one, &one, "--out", &to]);
    expect_exit(&again, 2);
    assert!(
        stderr(&again).contains("are in already"),
        "{}",
        stderr(&again)
    );
}

#[test]
fn what_cannot_be_attacked_is_said() {
    for (args, word) in [
        (vec!["attack"], "ROBOT"),
        (vec!["attack", ROBOT, "--budget", "soon"], "budget"),
        (vec!["attack", ROBOT, "--shard", "3/2"], "shard"),
        (
            vec!["attack", ROBOT, "--set", "limits.speed=1.0"],
            "limits.speed",
        ),
        (vec!["attack", "no_such_robot.toml"], "no_such_robot"),
    ] {
        let output = haltline(&args);
        expect_exit(&output, 2);
        assert!(stderr(&output).contains(word), "{}", stderr(&output));
    }
    let help = haltline(&["attack", "--help"]);
    expect_exit(&help, 0);
    for word in ["--told", "--break", "merge", "Exit code", "counterexample"] {
        assert!(stdout(&help).contains(word), "{word}");
    }
}
