//! Reading worlds, thinning their paths, scoring.

use super::*;
use crate::file::parse;

/// Two rows of cylinders with a way between them that bends once.
fn bend() -> String {
    let mut text = String::from("kind,x_m,y_m\n");
    for step in 0..30 {
        let y = 5.0 + 0.15 * f64::from(step);
        let shift = if step < 15 {
            0.0
        } else {
            0.15 * f64::from(step - 15)
        };
        for side in [-0.6, 0.6] {
            text += &format!("cylinder,{:.4},{y:.4}\n", -2.0 + side + shift);
        }
    }
    for step in 0..30 {
        let shift = if step < 15 {
            0.0
        } else {
            0.15 * f64::from(step - 15)
        };
        text += &format!(
            "path,{:.4},{:.4}\n",
            -2.0 + shift,
            5.0 + 0.15 * f64::from(step)
        );
    }
    text
}

fn world(text: &str) -> World {
    World::parse(text, "world_007.csv", "world_007").expect("a good world")
}

fn error(text: &str) -> String {
    World::parse(text, "w.csv", "w")
        .expect_err("must be refused")
        .to_string()
}

#[test]
fn bad_lines_are_named_with_the_cure() {
    let first = error("cylinder,1,2\n");
    assert!(
        first.starts_with("w.csv:1:1:") && first.contains("`kind,x_m,y_m`"),
        "{first}"
    );
    assert!(error("").starts_with("w.csv:1:1:"));
    for (row, place, words) in [
        ("cylinder,1", "3:1", "write kind, x and y"),
        ("cylinder,1,2,3", "3:1", "4 values"),
        ("cylinder,1,two", "3:12", "`two` is no place"),
        ("path,nan,2", "3:6", "`nan` is no place"),
        ("path,1,1e9", "3:8", "no place"),
        ("pillar,1,2", "3:1", "write cylinder or path"),
    ] {
        let message = error(&format!("kind,x_m,y_m\ncylinder,0,0\n{row}\n"));
        assert!(message.starts_with(&format!("w.csv:{place}:")), "{message}");
        assert!(message.contains(words), "{message}");
    }
    assert!(error("kind,x_m,y_m\ncylinder,0,0\n").contains("one path row"));
}

#[test]
fn path_in_another_frame_is_refused() {
    let mut text = bend();
    text += "path,-1.4000,5.0000\n";
    let message = error(&text);
    assert!(message.starts_with("w.csv:92:1:"), "{message}");
    assert!(message.contains("not in the same frame"), "{message}");
}

#[test]
fn thinned_path_keeps_the_bend_and_its_clearance() {
    let world = world(&bend());
    let via = world.via_m();
    assert!(via.len() < world.path_m.len() / 2, "{via:?}");
    let [x, y, _] = START;
    let way: Vec<_> = [[x, y]].into_iter().chain(via).chain([GOAL_M]).collect();
    let own = |points: &[[f64; 2]]| {
        points
            .windows(2)
            .map(|pair| path::clearance_m(&world, pair[0], pair[1]))
            .fold(f64::INFINITY, f64::min)
    };
    let published: Vec<_> = [[x, y]]
        .into_iter()
        .chain(world.path_m.clone())
        .chain([GOAL_M])
        .collect();
    assert!(
        own(&way) >= own(&published).min(0.5) - 0.011,
        "{} {}",
        own(&way),
        own(&published)
    );
}

#[test]
fn score_follows_the_benchmark() {
    let world = world(&bend());
    // 2 m to the path, 14 steps of 0.15 m, 15 diagonal ones, and the way to the goal.
    let last = [-2.0 + 14.0 * 0.15, 5.0 + 29.0 * 0.15];
    let rest = libm::hypot(GOAL_M[0] - last[0], GOAL_M[1] - last[1]);
    let length = 2.0 + 15.0 * 0.15 + 14.0 * 0.15 * 2.0_f64.sqrt() + rest;
    assert!((world.optimal_time_s() - length / 2.0).abs() < 1e-9);
    let optimal = world.optimal_time_s();
    assert!(world.score(false, 10.0).abs() < 1e-12);
    assert!((world.score(true, optimal) - 0.25).abs() < 1e-12);
    assert!((world.score(true, 6.0 * optimal) - 1.0 / 6.0).abs() < 1e-12);
    assert!((world.score(true, 99.0 * optimal) - 0.125).abs() < 1e-12);
}

#[test]
fn scenario_is_good_and_says_what_it_changes() {
    let world = world(&bend());
    let text = world.scenario_text(&Options {
        sensor_bound_m: 0.04,
    });
    let scenario = parse(&text, "w.toml", "w")
        .expect("a good scenario")
        .remove(0);
    assert_eq!(scenario.circle.len(), 60);
    assert_eq!(scenario.seed, 7);
    assert_eq!(scenario.via_m(), world.via_m());
    let robot = haltline_robots::Robot::embedded("jackal").expect("shipped");
    let case = crate::batch::equip(scenario, &robot).expect("robot and world fit");
    assert!((case.robot.values.scanners[0].error_m() - 0.04).abs() < 1e-12);
    assert!((case.robot.values.scanners[0].no_return_clear_m - 30.0).abs() < 1e-12);
    // The tracking error is that of the Jackal's file.
    assert_eq!(case.changes.len(), 4);
}
