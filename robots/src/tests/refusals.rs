//! One test for each rule: a good file with one change must be refused, at that line.

use crate::{EMBEDDED, Robot, RobotError};

mod scanner;

/// A good file with one piece of text replaced.
struct Bad {
    text: String,
}

/// The Seekur Jr's file with `from`, which must occur once, replaced.
fn seekur(from: &str, to: &str) -> Bad {
    of(0, from, to)
}

fn of(robot: usize, from: &str, to: &str) -> Bad {
    let good = EMBEDDED[robot].1;
    assert_eq!(good.matches(from).count(), 1, "`{from}` must be unique");
    Bad {
        text: good.replace(from, to),
    }
}

impl Bad {
    fn and(self, from: &str, to: &str) -> Self {
        assert_eq!(
            self.text.matches(from).count(),
            1,
            "`{from}` must be unique"
        );
        Self {
            text: self.text.replace(from, to),
        }
    }

    /// Refused at the line that starts with `line`, with words on cause and cure.
    #[track_caller]
    fn refused(self, line: &str, problem: &str, advice: &str) -> RobotError {
        let error = Robot::parse(&self.text, "bad.toml").expect_err("must be refused");
        let at = self.text.lines().position(|text| text.starts_with(line));
        assert_eq!(Some(error.line), at.map(|index| index + 1), "{error}");
        assert!(error.problem.contains(problem), "{error}");
        assert!(error.advice.contains(advice), "{error}");
        let place = format!("bad.toml:{}:{}: ", error.line, error.column);
        assert!(error.to_string().starts_with(&place));
        error
    }
}

#[test]
fn missing_key_shows_table_and_example_line() {
    let line = "rear_m = 0.60                     # Loh 2018, ch. 4\n";
    seekur(line, "").refused(
        "[footprint]",
        "`[footprint]` lacks the key `rear_m`",
        "add a line like `rear_m = 0.60`",
    );
}

/// Not one key of the format may be left out silently.
#[test]
fn every_missing_key_is_reported_with_its_table() {
    for (name, text) in EMBEDDED {
        let mut table = "";
        for line in text.lines() {
            if line.starts_with('[') {
                table = line.split('#').next().unwrap_or(line).trim();
            }
            let Some((key, _)) = line.split_once(" = ").filter(|_| !line.starts_with('#')) else {
                continue;
            };
            let without: Vec<_> = text.lines().filter(|other| *other != line).collect();
            let error = Robot::parse(&without.join("\n"), name).expect_err(line);
            let expected = format!("`{table}` lacks the key `{key}`");
            assert_eq!(error.problem, expected, "{error}");
            assert!(error.advice.contains(&format!("`{key} = ")), "{error}");
        }
    }
}

#[test]
fn missing_table_shows_its_lines() {
    let text = EMBEDDED[0].1;
    let start = text.find("[zone]").unwrap();
    let end = text.find("[memory]").unwrap();
    let without = format!("{}{}", &text[..start], &text[end..]);
    let error = Robot::parse(&without, "bad.toml").unwrap_err();
    assert_eq!(error.problem, "table `[zone]` is missing");
    assert!(error.advice.contains("`front_m = 0.050`, `side_m = 0.020`"));
}

#[test]
fn misspelt_key_is_named() {
    let bad = seekur("side_m = ", "sids_m = ");
    let error = bad.refused(
        "sids_m",
        "unknown key `sids_m` in `[zone]`",
        "write `side_m`",
    );
    assert_eq!(error.column, 1);
}

#[test]
fn wrong_unit_in_a_key_is_named() {
    let bad = seekur("period_s = 0.040", "period_ms = 40.0");
    bad.refused(
        "period_ms",
        "unknown key `period_ms`",
        "write `period_s`: the unit",
    );
}

#[test]
fn unknown_table_is_named() {
    let bad = seekur("[zone]", "[zones]");
    bad.refused("[zones]", "unknown table `zones`", "write `zone`");
}

#[test]
fn key_outside_every_table_is_named() {
    let bad = seekur("[robot]", "nmae = 1\n[robot]");
    bad.refused(
        "nmae",
        "key `nmae` stands outside every table",
        "write one of: robot",
    );
}

#[test]
fn broken_toml_is_reported_in_our_words() {
    let bad = seekur("front_m = 0.050 ", "front_m 0.050 ");
    bad.refused("front_m 0.050", "this is not TOML", "write each value as");
}

#[test]
fn key_given_twice_is_reported() {
    let bad = seekur("[zone]\n", "[zone]\nside_m = 0.1\n");
    bad.refused(
        "side_m = 0.020",
        "this is not TOML: duplicate key",
        "write each value",
    );
}

#[test]
fn text_for_a_number_is_refused() {
    let bad = seekur("rate_hz = 50.0 ", "rate_hz = \"50\"");
    let error = bad.refused("rate_hz", "`rate_hz` cannot be \"50\"", "`rate_hz = 50.0`");
    assert_eq!(error.column, 11);
}

#[test]
fn negative_time_is_refused() {
    let bad = seekur("rest_s = 0.2 ", "rest_s = -0.2");
    bad.refused("rest_s", "`rest_s` cannot be -0.2", "a number from 0 to 10");
}

#[test]
fn not_finite_numbers_are_refused() {
    for (value, shown) in [("nan", "nan"), ("inf", "inf"), ("-inf", "-inf")] {
        let bad = seekur("x_m = 0.527", &format!("x_m = {value}"));
        bad.refused("x_m", &format!("`x_m` cannot be {shown}"), "for example");
    }
}

#[test]
fn zero_braking_is_refused() {
    // The same digits stand in the host's table; the first is that of the limits.
    let bad = seekur("braking_mps2 = 0.5 ", "braking_mps2 = 0.0 ");
    bad.refused(
        "braking_mps2 = 0.0",
        "`braking_mps2` cannot be 0.0",
        "a number above 0",
    );
}

#[test]
fn fraction_for_a_count_is_refused() {
    let bad = seekur("beams = 541", "beams = 540.5");
    bad.refused(
        "beams",
        "`beams` cannot be 540.5",
        "a whole number from 2 to 1100",
    );
}

#[test]
fn more_beams_than_the_kernel_holds_are_refused() {
    let bad = seekur("beams = 541", "beams = 1101");
    bad.refused(
        "beams",
        "`beams` cannot be 1101",
        "a whole number from 2 to 1100",
    );
}

#[test]
fn unknown_word_lists_the_known_ones() {
    let bad = seekur("encoding = \"zero_is_invalid\"", "encoding = \"zero\"");
    bad.refused(
        "encoding",
        "`encoding` cannot be \"zero\"",
        "\"rep117\" or \"zero_is_none\"",
    );
}

#[test]
fn number_for_a_flag_is_refused() {
    let bad = seekur("upside_down = false", "upside_down = 0");
    bad.refused("upside_down", "`upside_down` cannot be 0", "true or false");
}

#[test]
fn empty_name_is_refused() {
    let bad = seekur("name = \"Seekur Jr\"", "name = \" \"");
    bad.refused("name", "`name` cannot be", "a text in quotes");
}

#[test]
fn single_brackets_around_scanner_are_refused() {
    let bad = seekur("[[scanner]]", "[scanner]");
    bad.refused(
        "[scanner]",
        "`scanner` must be a list",
        "`[[scanner]]` with double brackets",
    );
}

#[test]
fn footprint_without_area_is_refused() {
    let bad = seekur("front_m = 0.60", "front_m = 0.00").and("rear_m = 0.60", "rear_m = 0.0");
    bad.refused("[footprint]", "the footprint has no length", "in metres");
}

#[test]
fn steering_without_ackermann_is_refused() {
    let bad = of(
        1,
        "kinematics = \"ackermann\"",
        "kinematics = \"differential\"",
    );
    bad.refused(
        "[steering]",
        "does not fit kinematics",
        "remove it or write",
    );
}

#[test]
fn ackermann_without_steering_is_refused() {
    let bad = seekur(
        "kinematics = \"differential\"",
        "kinematics = \"ackermann\"",
    );
    let error = Robot::parse(&bad.text, "bad.toml").unwrap_err();
    assert_eq!(error.problem, "table `[steering]` is missing");
}

#[test]
fn impossible_turning_radius_is_refused() {
    let bad = of(1, "turning_radius_m = 1.0", "turning_radius_m = 0.01");
    bad.refused("turning_radius_m", "wheel angle of 89 deg", "as measured");
}

#[test]
fn no_scanner_is_refused() {
    let text = EMBEDDED[0].1;
    let without = &text[..text.find("[[scanner]]").unwrap()];
    let error = Robot::parse(without, "bad.toml").unwrap_err();
    assert_eq!(error.problem, "the robot has no scanner");
    assert!(error.advice.contains("`[[scanner]]` with lines like"));
}

#[test]
fn too_many_scanners_are_refused() {
    let text = EMBEDDED[0].1;
    let scanner = &text[text.find("[[scanner]]").unwrap()..];
    let many = format!("{text}{scanner}{scanner}{scanner}{scanner}");
    let error = Robot::parse(&many, "bad.toml").unwrap_err();
    assert!(error.problem.starts_with("5 scanners"), "{error}");
    let last = many.lines().collect::<Vec<_>>();
    let last = last.iter().rposition(|line| *line == "[[scanner]]");
    assert_eq!(Some(error.line), last.map(|index| index + 1));
}

#[test]
fn unwatched_reverse_is_refused() {
    let bad = seekur("speed_reverse_mps = 0.0", "speed_reverse_mps = 0.3");
    bad.refused(
        "speed_reverse_mps",
        "no scanner sees the space behind",
        "speed_reverse_mps = 0.0",
    );
}

#[test]
fn reverse_is_allowed_with_a_rear_scanner_or_into_memory() {
    let reverse = seekur("speed_reverse_mps = 0.0", "speed_reverse_mps = 0.3");
    let scanner = &reverse.text[reverse.text.find("[[scanner]]").unwrap()..];
    let rear = scanner
        .replace("x_m = 0.527", "x_m = -0.60")
        .replace("yaw_deg = 0.0", "yaw_deg = 180.0");
    let watched = format!("{}{rear}", reverse.text);
    assert!(Robot::parse(&watched, "good.toml").is_ok());
    let memory = reverse.and("reverse_into_memory = false", "reverse_into_memory = true");
    assert!(Robot::parse(&memory.text, "good.toml").is_ok());
}

#[test]
fn resting_at_top_speed_is_refused() {
    let bad = seekur("speed_forward_mps = 1.2", "speed_forward_mps = 0.004");
    bad.refused(
        "rest_speed_mps",
        "resting at its top speed",
        "well below 0.004",
    );
    let bad = seekur(
        "angular_speed_radps = 1.3962",
        "angular_speed_radps = 0.004",
    );
    bad.refused(
        "rest_angular_speed_radps",
        "resting at its highest turn rate",
        "well below",
    );
}

#[test]
fn jitter_of_a_period_is_refused() {
    let bad = seekur("jitter_s = 0.002", "jitter_s = 0.040");
    bad.refused(
        "jitter_s",
        "as long as a whole control period",
        "less than period_s = 0.04",
    );
}

#[test]
fn period_beyond_scan_age_is_refused() {
    let bad = seekur("period_s = 0.040", "period_s = 0.070");
    bad.refused(
        "period_s",
        "every scan grows older than scan_age_max_s",
        "at most 0.06",
    );
}

#[test]
fn ages_below_a_period_are_refused() {
    let rows = [
        ("odometry_age_max_s = 0.120", "odometry_age_max_s = 0.01"),
        ("command_age_max_s = 0.200", "command_age_max_s = 0.01"),
        ("tracking_window_s = 0.4", "tracking_window_s = 0.01"),
    ];
    for (from, to) in rows {
        let bad = seekur(from, to);
        bad.refused(
            to,
            "shorter than one control period",
            "at least period_s = 0.04",
        );
    }
}

#[test]
fn vouching_for_less_than_the_robot_is_refused() {
    let bad = seekur("clear_at_start_m = 1.0", "clear_at_start_m = 0.5");
    bad.refused("clear_at_start_m", "farthest corner 0.732 m", "write 0.0");
}

#[test]
fn unreadable_file_is_reported_without_a_line() {
    let error = Robot::load(std::path::Path::new("no/such/robot.toml")).unwrap_err();
    let shown = error.to_string();
    assert!(
        shown.starts_with("no/such/robot.toml: cannot read the robot file"),
        "{shown}"
    );
    assert!(shown.contains("haltline new robot"));
}

/// Columns count characters, not bytes.
#[test]
fn columns_count_characters() {
    let bad = seekur("name = \"Seekur Jr\"", "name = \"Jürgen\", \"x\"");
    let error = bad.refused("name", "this is not TOML", "write each value");
    assert_eq!(error.column, 16);
}

/// Without a steering sensor the hull holds every set point of the steering's sweep:
/// (0.1 + 0.06 + 0.6) s / 0.02 s = 38 set points and 6 more are beyond the kernel's 40.
#[test]
fn a_longer_pipeline_than_the_kernel_holds_is_refused() {
    let bad = of(1, "sweep_s = 0.4", "sweep_s = 0.6");
    bad.refused(
        "period_s",
        "more commands are in flight",
        "raise period_s or lower",
    );
}

/// Both within their own bounds, together more than the kernel's window.
#[test]
fn a_scanner_beyond_the_window_is_refused() {
    let bad = seekur("x_m = 0.527", "x_m = 1.5").and("y_m = 0.0 ", "y_m = 1.0 ");
    bad.refused(
        "[[scanner]]",
        "the kernel refuses this scanner",
        "within 1.8 m",
    );
}
