//! Complaints about robot and scenario together name file, line and cure.

use super::*;
use crate::file::parse;
use crate::testing::{ROOM, robot};

fn equipped(text: &str, robot: &Robot) -> Result<Case, String> {
    let scenario = parse(text, "test.toml", "test")
        .expect("the text is good")
        .remove(0);
    equip(scenario, robot).map_err(|error| error.to_string())
}

fn with(values: &str) -> String {
    format!("{ROOM}\n[robot_values]\n{values}\n")
}

/// Line of the last line of a text made by [`with`] for a single value.
fn line(text: &str) -> usize {
    text.lines().count()
}

#[test]
fn robot_values_change_the_robot_and_are_kept_for_the_report() {
    let text = with("\"scanner.0.error_sigma_m\" = 0.001\ntolerances.tracking_m = 0.005");
    let case = equipped(&text, &robot()).expect("good values");
    assert!((case.robot.values.scanners[0].error_sigma_m - 0.001).abs() < 1e-12);
    assert!((case.robot.values.tolerances.tracking_m - 0.005).abs() < 1e-12);
    let keys: Vec<_> = case
        .changes
        .iter()
        .map(|change| change.key.as_str())
        .collect();
    assert_eq!(keys, ["scanner.0.error_sigma_m", "tolerances.tracking_m"]);
    assert_eq!(case.changes[0].before, "0.012");
    assert!(equipped(ROOM, &robot()).expect("good").changes.is_empty());
}

#[test]
fn robot_values_obey_the_rules_of_robot_files() {
    for (value, words) in [
        (
            "\"tolerances.trakking_m\" = 0.005",
            "has no key `tolerances.trakking_m`",
        ),
        (
            "\"tolerances.tracking_m\" = -0.005",
            "`tracking_m` cannot be -0.005",
        ),
        (
            "tolerances.tracking_m = \"small\"",
            "`tracking_m` cannot be",
        ),
        ("\"timing.jitter_s\" = 0.05", "write less than period_s"),
        ("\"timing.period_s\" = 0.045", "multiple of 10000 us"),
        ("\"obstacles.speed_mps\" = 0.5", "write obstacle_speed_mps"),
    ] {
        let text = with(value);
        let message = equipped(&text, &robot()).expect_err(value);
        assert!(
            message.starts_with(&format!("test.toml:{}:1:", line(&text))),
            "{message}"
        );
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn robot_that_stands_on_a_body_is_refused_at_the_bodys_line() {
    let on_top = |x: f64| {
        let disc = format!("[[circle]]\nname = \"post\"\ncenter_m = [{x}, 0.0]\nradius_m = 0.1\n");
        equipped(&format!("{ROOM}\n{disc}"), &robot())
    };
    let message = on_top(0.0).expect_err("it stands in the robot");
    let at = format!("test.toml:{}:1:", ROOM.lines().count() + 2);
    assert!(
        message.starts_with(&at) && message.contains("post"),
        "{message}"
    );
    // The front edge is 0.6 m ahead.
    assert!(on_top(0.69).is_err() && on_top(0.72).is_ok());
    let wall = ROOM.replace("to_m = [-4.0, 3.0]", "to_m = [4.0, 2.99]");
    let message = equipped(&wall, &robot()).expect_err("the wall crosses the robot");
    let before = ROOM
        .split("[[wall]]")
        .take(4)
        .map(|part| part.matches('\n').count());
    let at = format!("test.toml:{}:1:", before.sum::<usize>() + 1);
    assert!(
        message.starts_with(&at) && message.contains("wall 3"),
        "{message}"
    );
}

#[test]
fn steered_robot_takes_no_turn_rate() {
    let car = Robot::embedded("pses_car").expect("the shipped robot is good");
    let turning = ROOM.replace("linear_mps = 0.5", "linear_mps = 0.5\nangular_radps = 0.1");
    let message = equipped(&turning, &car).expect_err("a car has no turn rate");
    let at = 1 + ROOM
        .split("[[proposer.step]]")
        .next()
        .map_or(0, |part| part.matches('\n').count());
    assert!(
        message.starts_with(&format!("test.toml:{at}:1:")),
        "{message}"
    );
    assert!(message.contains("curvature_per_m"), "{message}");
    let curving = turning.replace("angular_radps", "curvature_per_m");
    assert!(equipped(&curving, &car).is_ok());
    assert!(equipped(&turning, &robot()).is_ok());
}
