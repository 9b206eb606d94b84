//! Errors name line, column and what to write; sweeps give the variants they promise.

use super::*;

const GOOD: &str = r#"title = "A wall ahead"
requirements = ["GUARD-01"]
robot = "seekur_jr"
obstacle_speed_mps = 0
seed = 1
timeout_s = 10.0

[[wall]]
from_m = [5.0, -2.0]
to_m = [5.0, 2.0]

[[circle]]
center_m = [3.0, 3.0]
radius_m = 0.2
motion = { velocity_mps = [0.0, -1.0], when_robot_passes_x_m = 1.0, delay_s = 1.0 }

[proposer]
kind = "script"

[[proposer.step]]
until_s = 5.0
linear_mps = 0.5

[expect]
blocked = true
"#;

fn error(text: &str) -> String {
    parse(text, "a.toml", "a")
        .expect_err("the file is wrong")
        .to_string()
}

#[test]
fn good_file_parses() {
    let scenarios = parse(GOOD, "a.toml", "a").expect("the file is good");
    assert_eq!(scenarios.len(), 1);
    assert_eq!(scenarios[0].name, "a");
    assert_eq!(scenarios[0].naked_excuse(), None);
}

#[test]
fn unknown_key_is_named_with_its_line_and_the_known_ones() {
    let text = GOOD.replace("seed = 1", "sead = 1");
    let message = error(&text);
    assert!(message.starts_with("a.toml:5:1:"), "{message}");
    assert!(
        message.contains("`sead`") && message.contains("`seed`"),
        "{message}"
    );
}

#[test]
fn impossible_number_is_refused_where_it_stands() {
    let message = error(&GOOD.replace("radius_m = 0.2", "radius_m = -0.2"));
    assert!(message.starts_with("a.toml:14:12:"), "{message}");
    assert!(message.contains("above zero"), "{message}");
    let message = error(&GOOD.replace("timeout_s = 10.0", "timeout_s = nan"));
    assert!(message.starts_with("a.toml:6:13:"), "{message}");
}

#[test]
fn wrong_type_and_broken_syntax_have_a_place() {
    let message = error(&GOOD.replace("seed = 1", "seed = \"one\""));
    assert!(message.starts_with("a.toml:5:8:"), "{message}");
    let message = error(&GOOD.replace("[expect]", "[expect"));
    assert!(message.starts_with("a.toml:24:"), "{message}");
}

#[test]
fn combinations_that_make_no_sense_are_refused() {
    let message = error(&GOOD.replace("kind = \"script\"", "kind = \"reckless\""));
    assert!(message.starts_with("a.toml:17:1:"), "{message}");
    assert!(message.contains("[goal]"), "{message}");
    let message = error(&GOOD.replace("blocked = true", ""));
    assert!(message.contains("asks for nothing"), "{message}");
    let message = error(&format!("{GOOD}\n[naked]\nmust_touch = false\n"));
    assert!(message.contains("needs a reason"), "{message}");
    let fault = "\n[[fault]]\nkind = \"scan_future\"\nfrom_s = 1.0\n";
    let message = error(&format!("{GOOD}{fault}"));
    assert!(message.contains("needs offset_s"), "{message}");
    assert!(message.starts_with("a.toml:27:1:"), "{message}");
    let message = error(&GOOD.replace("delay_s = 1.0", "from_s = 1.0"));
    assert!(message.starts_with("a.toml:15:10:"), "{message}");
}

#[test]
fn sweep_multiplies_its_axes() {
    let sweep = r#"
[[sweep]]
name = "side"
[[sweep.values]]
label = "left"
set = { "circle.0.center_m" = [3.0, 3.0] }
[[sweep.values]]
label = "right"
set = { "circle.0.center_m" = [3.0, -3.0], "circle.0.motion.velocity_mps.1" = 1.0 }

[[sweep]]
name = "timing"
path = "circle.0.motion.delay_s"
from = 0.5
to = 3.5
count = 20
"#;
    let scenarios = parse(&format!("{GOOD}{sweep}"), "a.toml", "a").expect("the file is good");
    assert_eq!(scenarios.len(), 40);
    assert_eq!(scenarios[0].name, "a/side_left-timing_00");
    assert_eq!(scenarios[39].name, "a/side_right-timing_19");
    let motion = scenarios[39].circle[0]
        .get_ref()
        .motion
        .clone()
        .expect("a motion")
        .into_inner();
    assert_eq!(motion.delay_s.map(NonNegative::get), Some(3.5));
    assert_eq!(motion.velocity_mps.map(value::floats), Some([0.0, 1.0]));
    assert_eq!(scenarios[39].group, "a");
}

#[test]
fn sweep_over_a_path_that_is_not_there_is_refused() {
    let sweep =
        "\n[[sweep]]\nname = \"x\"\npath = \"circle.7.radius_m\"\nfrom = 1\nto = 2\ncount = 2\n";
    let message = error(&format!("{GOOD}{sweep}"));
    assert!(message.contains("circle.7.radius_m"), "{message}");
    assert!(message.starts_with("a.toml:27:1:"), "{message}");
}

/// Refused at `place` with words on what is wrong or what to write.
#[track_caller]
fn refused(from: &str, to: &str, place: &str, words: &str) {
    assert_eq!(GOOD.matches(from).count(), 1, "`{from}` must be unique");
    let message = error(&GOOD.replace(from, to));
    assert!(
        message.starts_with(&format!("a.toml:{place}:")),
        "{message}"
    );
    assert!(message.contains(words), "{message}");
}

#[test]
fn arrays_of_wrong_length_are_refused() {
    let center = "center_m = [3.0, 3.0]";
    refused(center, "center_m = [1, 2, 3]", "13:12", "write exactly 2");
    refused(center, "center_m = [1]", "13:12", "write exactly 2");
    let velocity = "velocity_mps = [0.0, -1.0]";
    refused(velocity, "velocity_mps = [0.0]", "15:27", "write exactly 2");
    let points = "way_points = [[0.0, 1.0, 2.0, 3.0]]";
    refused(velocity, points, "15:25", "write exactly 3");
}

#[test]
fn windows_and_numbers_out_of_range_are_refused() {
    let with = |table: &str| error(&format!("{GOOD}\n{table}\n"));
    let message = with("[operator]\nemergency_stops_s = [[5.0, 3.0]]");
    assert!(message.starts_with("a.toml:28:"), "{message}");
    assert!(message.contains("until_s after from_s"), "{message}");
    let message = with("[operator]\nemergency_stops_s = [[3.0, 5.0, 7.0]]");
    assert!(message.contains("write exactly 2"), "{message}");
    let message = with("[sensor]\ndelay_s = 1e6");
    assert!(message.starts_with("a.toml:28:11:"), "{message}");
    assert!(message.contains("from 0 to 10"), "{message}");
    refused(
        "timeout_s = 10.0",
        "timeout_s = 1e9",
        "6:13",
        "at most 3600",
    );
    refused("radius_m = 0.2", "radius_m = 1e9", "14:12", "at most 1e6");
    refused(
        "to_m = [5.0, 2.0]",
        "to_m = [5.0, -2.0]",
        "8:1",
        "no length",
    );
}

#[test]
fn steps_that_contradict_or_never_run_are_refused() {
    let step = "linear_mps = 0.5";
    let both = "linear_mps = 0.5\nangular_radps = 0.1\ncurvature_per_m = 0.2";
    refused(step, both, "20:1", "write one of them");
    let late = "linear_mps = 0.5\n[[proposer.step]]\nuntil_s = 4.0";
    refused(step, late, "23:1", "never runs");
}

#[test]
fn names_that_nobody_knows_are_refused() {
    refused("GUARD-01", "GUARD-99", "2:16", "no requirement `GUARD-99`");
    let typo = "reasons = [\"GuardBloked\"]";
    refused("blocked = true", typo, "25:11", "GuardBlocked");
    let typo = "assumptions_broken = [\"A-FOO\"]";
    refused("blocked = true", typo, "25:22", "A-BRAKE");
}

const NAVIGATE: &str = r#"title = "To the end of the corridor"
requirements = ["GUARD-01"]
robot = "seekur_jr"
obstacle_speed_mps = 0
seed = 1
timeout_s = 10.0

[goal]
position_m = [5.0, 0.0]
radius_m = 0.3
at_rest = true

[proposer]
kind = "navigate"
via_m = [[1.0, 0.1], [2.0, -0.1]]
navigate = { goal_tolerance_m = 0.1, creep_mps = 0.02 }

[naked]
path = "goal"
speed_mps = 0.8

[expect]
arrived = true
refused_max = 0
"#;

#[test]
fn kernel_that_drives_itself_takes_via_points_and_tuning() {
    let scenario = parse(NAVIGATE, "a.toml", "a").expect("good").remove(0);
    assert!(scenario.navigates());
    assert_eq!(scenario.via_m(), [[1.0, 0.1], [2.0, -0.1]]);
    let tuning = scenario.proposer.get_ref().navigate.expect("a table");
    assert_eq!(tuning.creep_mps.map(NonNegative::get), Some(0.02));
    assert!(scenario.goal.is_some_and(|goal| goal.at_rest));
    assert_eq!(scenario.naked_excuse(), None);
}

#[test]
fn navigate_and_the_other_proposers_do_not_mix() {
    let refused = |from: &str, to: &str, place: &str, words: &str| {
        assert_eq!(NAVIGATE.matches(from).count(), 1, "`{from}` must be unique");
        let message = error(&NAVIGATE.replace(from, to));
        assert!(message.starts_with(&format!("a.toml{place}")), "{message}");
        assert!(message.contains(words), "{message}");
    };
    let kind = "kind = \"navigate\"";
    refused(
        kind,
        "kind = \"reckless\"\nspeed_mps = 1.0",
        ":13:1:",
        "write kind = \"navigate\"",
    );
    refused(
        kind,
        "kind = \"navigate\"\nspeed_mps = 1.0",
        ":13:1:",
        "chooses its speed itself",
    );
    refused(
        kind,
        "kind = \"navigate\"\nstep = [{ until_s = 1.0 }]",
        ":13:1:",
        "script",
    );
    refused(
        "[1.0, 0.1], ",
        "[1.0, 0.1, 0.2], ",
        ":15:",
        "write exactly 2",
    );
    refused("creep_mps = 0.02", "creep_mph = 0.02", ":16:", "creep_mph");
    let late = "\n[[fault]]\nkind = \"command_missing\"\nfrom_s = 1.0\n";
    let message = error(&format!("{NAVIGATE}{late}"));
    assert!(message.contains("nobody sends commands"), "{message}");
    let goal = NAVIGATE.find("[goal]").zip(NAVIGATE.find("[proposer]"));
    let (from, to) = goal.expect("both are there");
    let nowhere = format!("{}{}", &NAVIGATE[..from], &NAVIGATE[to..]);
    assert!(error(&nowhere).contains("write a [goal] table"));
    let message = error(&format!("{GOOD}arrived = true\n"));
    assert!(
        message.contains("answers of the kernel's planner"),
        "{message}"
    );
    let message = error(&format!("{GOOD}\n[naked]\npath = \"goal\"\n"));
    assert!(message.contains("twin of a navigate scenario"), "{message}");
}
