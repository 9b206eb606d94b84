//! Every expectation can fail.

use super::*;
use crate::engine::run;
use crate::navigation::{NavigationRecord, ProgressRecord};
use crate::result::{BrokenAssumption, MonitorReport, Violation};
use crate::testing::{ROOM, robot, scenario};

/// A naked run of the room, used as raw material.
fn driven(text: &str) -> RunResult {
    run(&scenario(text), &robot(), None).result
}

/// A guarded run that nobody can object to: the robot never left.
fn parked() -> RunResult {
    let still = ROOM.replace("linear_mps = 0.5", "linear_mps = 0.0");
    let mut result = driven(&still);
    for decision in &mut result.decisions {
        decision.decision = "Brake".to_owned();
        decision.reason = "GuardBlocked".to_owned();
    }
    result.monitors = vec![MonitorReport {
        margin: None,
        id: "CLAIM".to_owned(),
        checked: 100,
        engaged: 10,
        violation_count: 0,
        violations: Vec::new(),
    }];
    result
}

fn expecting(expect: &str) -> Scenario {
    scenario(&ROOM.replace("blocked = true", expect))
}

/// Whether the guarded run passes with this `[expect]` table.
fn passes(expect: &str, run: &RunResult) -> bool {
    judge(&expecting(expect), run, None).outcome == Outcome::Pass
}

#[test]
fn course_expectations_hold_and_fail() {
    let parked = parked();
    assert!(passes("blocked = true", &parked));
    assert!(!passes("blocked = false", &parked));
    assert!(passes("reached = false", &parked));
    assert!(!passes("reached = false\ntravelled_min_m = 1.0", &parked));
    assert!(!passes("reached = false\nturned_min_rad = 1.0", &parked));
    assert!(passes("reasons = [\"GuardBlocked\"]", &parked));
    assert!(!passes("reasons = [\"ScanStale\"]", &parked));
    assert!(passes("stopped_before = { clearance_m = 1.0 }", &parked));
    assert!(!passes("stopped_before = { clearance_m = 2.5 }", &parked));
    let mut nothing_near = parked.clone();
    for sample in &mut nothing_near.samples {
        sample.clearance_m = None;
    }
    assert!(!passes(
        "stopped_before = { clearance_m = 1.0 }",
        &nothing_near
    ));
    assert!(passes("stopped_before = { x_m = 0.1 }", &parked));
    assert!(!passes("stopped_before = { x_m = -0.1 }", &parked));
    assert!(!passes("stopped_before = { y_m = -0.1 }", &parked));
}

#[test]
fn robot_that_still_moves_has_not_stopped() {
    let mut rolling = driven(&ROOM.replace("timeout_s = 10.0", "timeout_s = 4.0"));
    rolling.monitors = parked().monitors;
    assert!(!passes("stopped_before = { clearance_m = 0.0 }", &rolling));
    assert!(!passes("blocked = true", &rolling));
}

#[test]
fn contact_while_moving_fails_unless_it_was_asked_for() {
    let mut touched = driven(ROOM);
    touched.monitors = parked().monitors;
    assert!(!passes("reached = false", &touched));
    assert!(passes("reached = false\ncontact = \"may\"", &touched));
    assert!(passes("reached = false\ncontact = \"must\"", &touched));
    assert!(!passes("reached = false\ncontact = \"must\"", &parked()));
}

#[test]
fn violation_fails_and_is_quoted() {
    let mut bad = parked();
    bad.monitors[0].violation_count = 3;
    bad.monitors[0].violations.push(Violation {
        t_s: 1.5,
        what: "it moved".to_owned(),
    });
    let judgement = judge(&expecting("blocked = true"), &bad, None);
    assert_eq!(judgement.outcome, Outcome::Fail);
    let first = &judgement.sentences[0];
    assert!(
        first.contains("CLAIM") && first.contains("it moved"),
        "{first}"
    );
    let mut vacuous = parked();
    vacuous.monitors[0].checked = 0;
    assert!(!passes("blocked = true", &vacuous));
}

#[test]
fn broken_assumptions_must_be_the_expected_ones() {
    let mut broken = parked();
    broken.assumptions_broken.push(BrokenAssumption {
        id: "A-BRAKE".to_owned(),
        what: "weak".to_owned(),
    });
    assert!(!passes("blocked = true", &broken));
    assert!(passes(
        "blocked = true\nassumptions_broken = [\"A-BRAKE\"]",
        &broken
    ));
    assert!(!passes(
        "blocked = true\nassumptions_broken = [\"A-BRAKE\"]",
        &parked()
    ));
}

#[test]
fn stop_must_follow_the_fault_in_time() {
    let fault = "\n[[fault]]\nkind = \"scan_missing\"\nfrom_s = 3.0\n";
    let text = ROOM.replace("blocked = true", "stop_within_s = 0.2");
    let scenario = scenario(&format!("{text}{fault}"));
    let mut run = parked();
    run.decisions[0].decision = "Pass".to_owned();
    assert_eq!(
        judge(&scenario, &run, None).outcome,
        Outcome::Fail,
        "it never stops"
    );
    let mut stop = run.decisions[0].clone();
    stop.decision = "ProtectiveStop".to_owned();
    stop.t_s = 3.16;
    run.decisions.push(stop);
    assert_eq!(judge(&scenario, &run, None).outcome, Outcome::Pass);
    run.decisions[1].t_s = 3.24;
    assert_eq!(
        judge(&scenario, &run, None).outcome,
        Outcome::Fail,
        "too late"
    );
}

#[test]
fn naked_twin_that_touches_nothing_shows_nothing() {
    let scenario = expecting("blocked = true");
    let judged = |naked: &RunResult| judge(&scenario, &parked(), Some(naked));
    assert_eq!(judged(&driven(ROOM)).outcome, Outcome::Pass);
    let harmless = judged(&parked());
    assert_eq!(harmless.outcome, Outcome::Fail);
    assert!(harmless.sentences[0].contains("shows nothing"));
}

#[test]
fn turning_and_wandering_can_be_too_much() {
    let mut run = parked();
    run.turned_rad = 1.0;
    run.travelled_m = 4.0;
    assert!(passes("turned_max_deg = 58.0", &run));
    assert!(!passes("turned_max_deg = 57.0", &run));
    assert!(passes("travelled_max_m = 4.1", &run));
    assert!(!passes("travelled_max_m = 3.9", &run));
}

/// A room in which the kernel drives itself, with this `[expect]` table.
fn navigating(expect: &str) -> Scenario {
    let (before, _) = ROOM.split_once("[proposer]").expect("there is one");
    scenario(&format!(
        "{before}[goal]\nposition_m = [2.0, 0.0]\nradius_m = 0.3\n[proposer]\nkind = \"navigate\"\n\
         [expect]\n{expect}\n"
    ))
}

/// Sentences of a parked run whose navigator ended like this.
fn complaint(expect: &str, end: ProgressRecord, refused: u64) -> Option<String> {
    let mut run = parked();
    run.navigation = Some(NavigationRecord {
        end,
        refused,
        refused_ticks: refused.min(2),
        ..NavigationRecord::new(0)
    });
    let judgement = judge(&navigating(expect), &run, None);
    (judgement.outcome == Outcome::Fail).then(|| judgement.sentences.join(" "))
}

fn ended(kind: &str, reason: Option<&str>) -> ProgressRecord {
    ProgressRecord {
        kind: kind.to_owned(),
        reason: reason.map(str::to_owned),
        since_s: Some(3.5),
        ..ProgressRecord::default()
    }
}

#[test]
fn what_the_navigator_says_is_judged() {
    let arrived = || ended("arrived", None);
    let blocked = || ended("blocked", Some("GoalOccupied"));
    assert_eq!(complaint("arrived = true", arrived(), 0), None);
    assert_eq!(complaint("arrived = false", blocked(), 0), None);
    let text = complaint("arrived = true", blocked(), 0).expect("it has not arrived");
    assert!(
        text.contains("blocked by GoalOccupied since 3.50 s"),
        "{text}"
    );
    assert!(complaint("arrived = false", arrived(), 0).is_some());
    let expect = "blocked_reason = \"GoalOccupied\"";
    assert_eq!(complaint(expect, blocked(), 0), None);
    assert!(complaint(expect, arrived(), 0).is_some());
    assert!(complaint(expect, ended("blocked", Some("NoWay")), 0).is_some());
}

#[test]
fn refusals_are_judged() {
    let arrived = || ended("arrived", None);
    assert_eq!(complaint("refused_max = 3", arrived(), 3), None);
    let text = complaint("refused_max = 3", arrived(), 4).expect("too many");
    assert!(
        text.contains("refused 4 candidates") && text.contains("at most 3"),
        "{text}"
    );
}
