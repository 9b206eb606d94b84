//! `haltline replay` on a made-up drive, and on the recorded one where it is at hand.

// A test that cannot get its files or start the command fails here, which is what `expect` is for.
#![allow(clippy::expect_used)]

mod common;

use common::{
    events, expect_exit, first_point_m, folder, haltline, room_range_m, root, stderr, stdout, write,
};
use std::fmt::Write as _;
use std::path::PathBuf;

const HEADER: &str = "# beams 361 aperture_rad 3.141593 right_to_left 1 max_range_m 80.00 sensor_x_m 0.780 \
                      sensor_y_m 0.000 sensor_yaw_rad 0.0000 sigma_m 0.010\n# t_s,dx_m,dy_m,dtheta_rad,range_m...\n";

/// Ten rows at rest, then straight towards a wall, in a room 6 m wide.
fn drive_at_wall(wall_m: f64, speed_mps: f64) -> String {
    let mut text = HEADER.to_owned();
    let mut x_m = 0.0;
    for row in 0..40 {
        let step_m = if row < 10 { 0.0 } else { speed_mps * 0.25 };
        x_m += step_m;
        let _ = write!(text, "{:.3},{step_m:.5},0.0,0.0", f64::from(row) * 0.25);
        for beam in 0..361 {
            let angle = (f64::from(beam) * 0.5 - 90.0).to_radians();
            let range = room_range_m(wall_m - x_m - 0.78, angle, (beam, row));
            let _ = write!(text, ",{range:.3}");
        }
        text.push('\n');
    }
    text
}

fn replay(name: &str, log: &str) -> (std::process::Output, PathBuf) {
    common::replay("sena", name, "drive.csv", log)
}

#[test]
fn driving_at_a_wall_is_braked_and_the_wall_is_named() {
    let (output, out) = replay("replay_wall", &drive_at_wall(9.0, 1.0));
    expect_exit(&output, 0);
    let x_m = first_point_m(&out);
    assert!(
        (x_m - 9.0).abs() < 0.1,
        "the deciding point is at x = {x_m} m"
    );
    for name in ["replay.png", "replay.svg"] {
        assert!(out.join(name).is_file(), "{name} is missing");
    }
}

#[test]
fn driving_where_nothing_is_in_the_way_passes() {
    let (output, out) = replay("replay_free", &drive_at_wall(40.0, 0.5));
    expect_exit(&output, 0);
    let braked = events(&out)
        .into_iter()
        .filter(|event| event["refusal"] == "known_point" || event["reason"] == "critical_zone")
        .count();
    assert_eq!(braked, 0, "{}", stdout(&output));
}

#[test]
fn a_bad_line_is_an_error_with_its_number() {
    let log = drive_at_wall(9.0, 1.0).replacen("\n0.250,", "\n0.250,oops,", 1);
    let (output, _) = replay("replay_bad", &log);
    expect_exit(&output, 2);
    assert!(
        stderr(&output).contains("drive.csv:4: "),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_missing_log_is_said_clearly() {
    let output = haltline(&["replay", "--format", "sena", "no/such/log.csv.gz"]);
    expect_exit(&output, 2);
    assert!(
        stderr(&output).contains("no such file"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_robot_that_does_not_fit_the_log_is_refused() {
    let out = folder("replay_misfit");
    let file = write(&out, "drive.csv", &drive_at_wall(9.0, 1.0));
    let args = [
        "replay",
        "--format",
        "sena",
        &file,
        "--robot",
        "robots/seekur_jr.toml",
    ];
    let output = haltline(&args);
    expect_exit(&output, 2);
    assert!(
        stderr(&output).contains("does not fit the log"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn the_recorded_drive_is_read_to_its_end() {
    let data = std::env::var_os("HALTLINE_DATA")
        .map_or_else(|| root().join("../shared/data"), PathBuf::from);
    let log = data.join("sena/sena.csv.gz");
    if !log.is_file() {
        eprintln!("skipped: {} is not there", log.display());
        return;
    }
    let out = folder("replay_recorded");
    let (log, folder) = (log.display().to_string(), out.display().to_string());
    let output = haltline(&["replay", "--format", "sena", &log, "--out", &folder]);
    expect_exit(&output, 0);
    let said = stdout(&output);
    assert!(said.contains("224 sweeps over 58.8 s and 76."), "{said}");
    assert!(said.contains("time per tick"), "{said}");
}
