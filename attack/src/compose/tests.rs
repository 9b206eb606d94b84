//! Composed scenarios can be run, and keep the assumptions they are to keep.

use super::*;
use crate::trial::{self, Verdict};
use haltline_robots::Robot;
use std::collections::BTreeMap;

fn setting(robot: &str, breaking: bool) -> Setting {
    let robot = Robot::embedded(robot).expect("a shipped robot");
    Setting::new(robot, BTreeMap::new(), BTreeMap::new(), breaking).expect("the truth")
}

fn plan(setting: &Setting, number: u64) -> Plan {
    let mut dice = Dice::new(number);
    let structure = dice.seed();
    let genes: Vec<f64> = (0..dimension(setting, structure))
        .map(|_| dice.unit())
        .collect();
    compose(setting, structure, &genes, None)
}

/// How a short run of a plan ends: what matters is known before its first step.
fn started(setting: &Setting, plan: &Plan) -> (Verdict, Vec<String>) {
    let text = plan.text.replace("timeout_s = 8.0", "timeout_s = 0.1");
    let verdict = trial::run(setting, &text).verdict;
    (verdict, trial::broken(setting, &text))
}

#[test]
fn most_scenarios_run_and_none_breaks_what_it_is_to_keep() {
    for robot in ["seekur_jr", "jackal", "pses_car"] {
        let setting = setting(robot, false);
        let mut refused = 0;
        for number in 0..120 {
            let plan = plan(&setting, number);
            let (verdict, broken) = started(&setting, &plan);
            refused += usize::from(matches!(verdict, Verdict::Refused(_)));
            assert_eq!(broken, [""; 0], "{robot} {number}\n{}", plan.text);
            assert_eq!(plan.broken, None);
        }
        assert!(refused <= 24, "{robot}: {refused} of 120 could not be run");
    }
}

#[test]
fn a_scenario_that_is_to_break_an_assumption_breaks_that_one_only() {
    let setting = setting("seekur_jr", true);
    let mut seen = std::collections::BTreeSet::new();
    for number in 0..400 {
        let plan = plan(&setting, number);
        let meant = plan.broken.clone().expect("it breaks something");
        let (verdict, broken) = started(&setting, &plan);
        if matches!(verdict, Verdict::Refused(_)) {
            continue;
        }
        // A fault may fall on nothing: no return is cleared, no command is sent.
        assert!(
            broken.iter().all(|id| *id == meant.id),
            "{meant:?}: {broken:?}\n{}",
            plan.text
        );
        if !broken.is_empty() {
            seen.insert(meant.name);
        }
    }
    assert!(seen.len() >= 15, "{seen:?}");
}

#[test]
fn the_same_seed_composes_the_same_text() {
    let setting = setting("seekur_jr", false);
    assert_eq!(plan(&setting, 7).text, plan(&setting, 7).text);
    assert_ne!(plan(&setting, 7).text, plan(&setting, 8).text);
}
