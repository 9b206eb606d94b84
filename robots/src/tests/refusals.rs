//! One test for each rule: a good file with one change must be refused, at that line.

use crate::{EMBEDDED, Robot, RobotError};

fn good() -> &'static str {
    EMBEDDED[0].1
}

/// The good file with every occurrence of `from` in one line replaced.
fn changed(from: &str, to: &str) -> String {
    assert_eq!(good().matches(from).count(), 1, "`{from}` must be unique");
    good().replace(from, to)
}

fn refusal(text: &str) -> RobotError {
    Robot::parse(text, "bad.toml").expect_err("the file must be refused")
}

/// Refuses the change, at the line that holds `marker`, with words on cause and cure.
fn refused(from: &str, to: &str, marker: &str, problem: &str, advice: &str) {
    let text = changed(from, to);
    let error = refusal(&text);
    let line = text.lines().position(|line| line.contains(marker));
    assert_eq!(Some(error.line), line.map(|index| index + 1), "{error}");
    assert!(error.problem.contains(problem), "{error}");
    assert!(error.advice.contains(advice), "{error}");
    assert!(
        error
            .to_string()
            .starts_with(&format!("bad.toml:{}:", error.line))
    );
}

#[test]
fn missing_key_shows_an_example_line() {
    let from = "rear_m = 0.60                     # Loh 2018, ch. 4\n";
    refused(
        from,
        "",
        "[footprint]",
        "`[footprint]` lacks the key `rear_m`",
        "add a line like `rear_m = 0.60`",
    );
}

#[test]
fn misspelt_key_is_named() {
    refused(
        "side_m = ",
        "sides_m = ",
        "sides_m",
        "unknown key `sides_m`",
        "write `side_m`",
    );
}

#[test]
fn wrong_unit_in_a_key_is_named() {
    let to = "period_ms = 40.0";
    refused(
        "period_s = 0.040",
        to,
        to,
        "unknown key `period_ms`",
        "write `period_s`: the unit",
    );
}
