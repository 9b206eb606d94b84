//! `haltline replay --format carmen` on a made-up log with a known wall.

// A test that cannot get its files or start the command fails here, which is what `expect` is for.
#![allow(clippy::expect_used)]

mod common;

use common::{expect_exit, first_point_m, room_range_m, stderr, stdout};
use std::fmt::Write as _;

/// Straight towards a wall in a room 6 m wide; the laser is 0.4 m before the odometry centre.
fn drive_at_wall(wall_m: f64, speed_mps: f64, beams: u32) -> String {
    let mut text = String::from("# CARMEN log\nPARAM robot_width 0.5\n");
    let mut x_m = 0.0;
    for row in 0..50 {
        x_m += if row < 10 { 0.0 } else { speed_mps * 0.2 };
        let _ = write!(text, "FLASER {beams}");
        for beam in 0..beams {
            let step = if beams.is_multiple_of(2) {
                180.0 / f64::from(beams)
            } else {
                180.0 / f64::from(beams - 1)
            };
            let angle = (f64::from(beam) * step - 90.0).to_radians();
            let range = room_range_m(wall_m - x_m - 0.4, angle, (beam, row));
            let _ = write!(text, " {range:.3}");
        }
        let time = f64::from(row) * 0.2;
        let _ = writeln!(
            text,
            " {:.4} 0 0 {x_m:.4} 0 0 {time:.3} robot {time:.3}",
            x_m + 0.4
        );
        let _ = writeln!(
            text,
            "ODOM {x_m:.4} 0 0 {speed_mps} 0 0 {time:.3} robot {time:.3}"
        );
    }
    text
}

fn replay(name: &str, log: &str) -> (std::process::Output, std::path::PathBuf) {
    common::replay("carmen", name, "drive.log", log)
}

#[test]
fn the_guard_brakes_for_the_wall_and_the_map_is_drawn() {
    for beams in [180, 181, 361] {
        let (output, out) = replay(
            &format!("carmen_wall_{beams}"),
            &drive_at_wall(9.0, 1.0, beams),
        );
        expect_exit(&output, 0);
        let x_m = first_point_m(&out);
        assert!(
            (x_m - 9.0).abs() < 0.1,
            "{beams} beams: the deciding point is at x = {x_m} m"
        );
        let map = std::fs::read(out.join("map.png")).expect("map.png");
        let size = |at: usize| u32::from_be_bytes([map[at], map[at + 1], map[at + 2], map[at + 3]]);
        // The room is 6 m wide: 60 cells, and a few for the walls and rounding.
        assert!(
            (58..=66).contains(&size(20)),
            "{beams} beams: {} rows",
            size(20)
        );
        assert!(size(16) > 80, "{} columns", size(16));
    }
}

#[test]
fn bad_lines_are_errors_with_their_number() {
    let log = drive_at_wall(10.0, 1.0, 181).replacen("FLASER 181 ", "FLASER 181 x ", 1);
    let (output, _) = replay("carmen_bad", &log);
    expect_exit(&output, 2);
    assert!(
        stderr(&output).contains("drive.log:3: `x` is not a number"),
        "{}",
        stderr(&output)
    );
    let (output, _) = replay("carmen_empty", "PARAM a b\n");
    expect_exit(&output, 2);
    assert!(
        stderr(&output).contains("0 FLASER lines"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn sweeps_out_of_order_are_dropped_and_said() {
    let log = drive_at_wall(20.0, 0.5, 181).replacen(" 0.400 robot 0.400", " 0.100 robot 0.400", 1);
    let (output, _) = replay("carmen_order", &log);
    expect_exit(&output, 0);
    assert!(
        stdout(&output).contains("1 sweep not newer"),
        "{}",
        stdout(&output)
    );
}
