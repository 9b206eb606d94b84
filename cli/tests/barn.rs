//! `import barn` and `barn` on a made-up world; the published ones are driven in the scenarios' tests.

// A test that cannot get its files or start the command fails here, which is what `expect` is for.
#![allow(clippy::expect_used)]

mod common;

use common::{expect_exit, folder, haltline, stderr, stdout, write};

/// Two rows of cylinders, 2 m apart, and a path straight between them.
fn lane() -> String {
    let mut text = String::from("kind,x_m,y_m\n");
    for step in 0..60 {
        let y_m = 1.0 + 0.15 * f64::from(step);
        text += &format!("cylinder,-3.0000,{y_m:.4}\ncylinder,-1.0000,{y_m:.4}\n");
    }
    for step in 0..30 {
        text += &format!("path,-2.0250,{:.4}\n", 5.0 + 0.15 * f64::from(step));
    }
    text
}

#[test]
fn an_imported_world_is_a_scenario_that_runs() {
    let out = folder("barn_import");
    let world = write(&out, "world_001.csv", &lane());
    let target = out.join("lane.toml").display().to_string();
    let output = haltline(&["import", "barn", &world, "-o", &target]);
    expect_exit(&output, 0);
    assert!(
        stdout(&output).contains("120 cylinders"),
        "{}",
        stdout(&output)
    );
    let runs = out.join("run").display().to_string();
    let output = haltline(&["run", &target, "--json", "--out", &runs]);
    expect_exit(&output, 0);
    let summary: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("json");
    assert_eq!(summary["reached"], true);
    assert_eq!(summary["contacts"], 0);
    assert_eq!(summary["robot_values"][0]["key"], "scanner.0.error_sigma_m");
    assert!(summary["navigation"]["refused"].is_u64());
}

#[test]
fn an_import_overwrites_nothing_and_leaves_nothing_behind() {
    let out = folder("barn_import_twice");
    let world = write(&out, "world_001.csv", &lane());
    let target = write(&out, "mine.toml", "precious\n");
    let again = haltline(&["import", "barn", &world, "-o", &target]);
    expect_exit(&again, 2);
    assert!(stderr(&again).contains("--force"), "{}", stderr(&again));
    assert_eq!(
        std::fs::read_to_string(&target).expect("there"),
        "precious\n"
    );
    expect_exit(
        &haltline(&["import", "barn", &world, "-o", &target, "--force"]),
        0,
    );
    let nowhere = out.join("no/such/folder.toml").display().to_string();
    expect_exit(&haltline(&["import", "barn", &world, "-o", &nowhere]), 2);
    let mut left: Vec<_> = std::fs::read_dir(&out)
        .expect("folder")
        .filter_map(Result::ok)
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    left.sort();
    assert_eq!(left, ["mine.toml", "world_001.csv"]);
}

#[test]
fn a_bad_world_is_named_with_its_line() {
    let out = folder("barn_bad");
    let world = write(
        &out,
        "bad.csv",
        &lane().replacen("cylinder,-3.0000,1.0000", "cylinder,-3.0000", 1),
    );
    let target = out.join("bad.toml").display().to_string();
    let output = haltline(&["import", "barn", &world, "-o", &target]);
    expect_exit(&output, 2);
    assert!(
        stderr(&output).contains("bad.csv:2:1: 2 values"),
        "{}",
        stderr(&output)
    );
    expect_exit(
        &haltline(&["import", "barn", "no_such.csv", "-o", &target]),
        2,
    );
    let world = write(&out, "good.csv", &lane());
    let output = haltline(&[
        "import",
        "barn",
        &world,
        "-o",
        &target,
        "--sensor-bound",
        "-1",
    ]);
    expect_exit(&output, 2);
    assert!(!out.join("bad.toml").exists());
    expect_exit(&haltline(&["barn", &out.display().to_string()]), 2);
}

#[test]
fn all_worlds_of_a_folder_make_a_table() {
    let worlds = folder("barn_worlds");
    write(&worlds, "world_001.csv", &lane());
    let out = folder("barn_table");
    let (from, to) = (worlds.display().to_string(), out.display().to_string());
    let output = haltline(&["barn", &from, "--out", &to, "--jobs", "1"]);
    expect_exit(&output, 0);
    let said = stdout(&output);
    assert!(said.contains("world_001    reached"), "{said}");
    assert!(
        said.contains("1 of 1 reached (sensor bound 5 mm), 0 contacts"),
        "{said}"
    );
    let table = std::fs::read_to_string(out.join("barn.csv")).expect("table");
    assert_eq!(table.lines().count(), 2);
    assert!(
        table
            .lines()
            .nth(1)
            .is_some_and(|row| row.starts_with("world_001,true,0,0,")),
        "{table}"
    );
    let json = std::fs::read_to_string(out.join("barn.json")).expect("json");
    let json: serde_json::Value = serde_json::from_str(&json).expect("json");
    assert_eq!(json["rows"][0]["success"], true);
    assert!(out.join("world_001.svg").is_file());
    let empty = folder("barn_empty").display().to_string();
    let output = haltline(&["barn", &empty]);
    expect_exit(&output, 2);
    assert!(
        stderr(&output).contains("holds no world"),
        "{}",
        stderr(&output)
    );
}
