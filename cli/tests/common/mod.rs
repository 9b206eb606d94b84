//! Runs the built command in a folder of its own.
#![allow(dead_code)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Root of the checkout.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A fresh folder for one test.
pub fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).expect("folder");
    path
}

/// Runs `haltline` in the root of the checkout.
pub fn haltline(args: &[&str]) -> Output {
    haltline_in(&root(), args)
}

/// Runs `haltline` in a folder.
pub fn haltline_in(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_haltline"))
        .args(args)
        .current_dir(folder)
        .output()
        .expect("starts")
}

/// Exit code, with everything the command said if it is another.
pub fn expect_exit(output: &Output, code: i32) {
    assert_eq!(
        output.status.code(),
        Some(code),
        "stdout:\n{}\nstderr:\n{}",
        stdout(output),
        stderr(output)
    );
}

/// Standard output as text.
pub fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Standard error as text.
pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A short scenario for the Seekur Jr: a wall ahead.
pub const WALL_AHEAD: &str = r#"
title = "A wall ahead"
requirements = ["GUARD-01"]
robot = "seekur_jr"
obstacle_speed_mps = 0.0
seed = 1
timeout_s = 8.0

[[wall]]
name = "ahead"
from_m = [3.0, -2.0]
to_m = [3.0, 2.0]

[[wall]]
name = "left"
from_m = [-3.0, 2.0]
to_m = [3.0, 2.0]

[[wall]]
name = "right"
from_m = [-3.0, -2.0]
to_m = [3.0, -2.0]

[goal]
position_m = [6.0, 0.0]
radius_m = 0.3

[proposer]
kind = "reckless"
speed_mps = 0.8

[expect]
reached = false
blocked = true
"#;

/// Writes a file and gives its path as text.
pub fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    path.display().to_string()
}

/// Runs `haltline replay` on a log of this text; the command's output and the folder it wrote to.
pub fn replay(format: &str, name: &str, file: &str, log: &str) -> (Output, PathBuf) {
    let out = folder(name);
    let file = write(&out, file, log);
    let folder = out.display().to_string();
    let args = ["replay", "--format", format, &file, "--out", &folder];
    (haltline(&args), out)
}

/// What a replay wrote down as events.
pub fn events(out: &Path) -> Vec<serde_json::Value> {
    let text = std::fs::read_to_string(out.join("replay.json")).expect("replay.json");
    serde_json::from_str(&text).expect("a list")
}

/// How far along x the first known point lies for which a replay braked, m.
pub fn first_point_m(out: &Path) -> f64 {
    let events = events(out);
    let mut braked = events
        .iter()
        .filter(|event| event["refusal"] == "known_point");
    let first = braked.next().expect("it brakes for a point");
    first["point_m"][0].as_f64().expect("a point")
}

/// Range of the beam at `angle` (radians, left positive) in a room 6 m wide whose end is `ahead_m` away.
///
/// A millimetre of ripple over beams and rows: no real sweep repeats the one before.
pub fn room_range_m(ahead_m: f64, angle: f64, (beam, row): (u32, u32)) -> f64 {
    let ahead = ahead_m / angle.cos().max(1e-9);
    let side = 3.0 / angle.sin().abs().max(1e-9);
    ahead.min(side).min(81.9) + f64::from((beam + row) % 3) * 0.001
}
