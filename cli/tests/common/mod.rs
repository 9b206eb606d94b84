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
