//! Fifty thousand steps of the whole kernel, planner included, in composed worlds: no claim is violated.

#![allow(clippy::unwrap_used, clippy::panic)] // Tests may fail loudly.

use haltline_attack::compose::{compose, dimension};
use haltline_attack::genes::Dice;
use haltline_attack::setting::Setting;
use haltline_attack::trial::{self, Trial, Verdict};
use haltline_robots::Robot;
use rayon::prelude::*;
use std::collections::BTreeMap;
use toml::{Table, Value};

/// Control steps.
const STEPS: u64 = if cfg!(debug_assertions) {
    2_000
} else {
    50_000
};
/// Scenarios run at a time.
const BATCH: u64 = 32;

/// A composed scenario in which the kernel itself drives to a goal behind the bodies.
fn navigated(setting: &Setting, number: u64) -> String {
    let mut dice = Dice::new(number.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let structure = dice.seed();
    let genes: Vec<f64> = (0..dimension(setting, structure))
        .map(|_| dice.unit())
        .collect();
    let mut table: Table = compose(setting, structure, &genes, None)
        .text
        .parse()
        .unwrap();
    let mut proposer = Table::new();
    proposer.insert("kind".into(), "navigate".into());
    table.insert("proposer".into(), proposer.into());
    let mut goal = Table::new();
    let place = vec![
        Value::from(3.0 + 2.0 * dice.unit()),
        Value::from(3.0 * dice.unit() - 1.5),
    ];
    goal.insert("position_m".into(), place.into());
    goal.insert("radius_m".into(), 0.2.into());
    table.insert("goal".into(), goal.into());
    // Nobody sends commands, so nothing goes wrong with them.
    let of_command = |fault: &Value| {
        let kind = fault.get("kind").and_then(Value::as_str).unwrap_or("");
        kind.starts_with("command")
    };
    if let Some(Value::Array(faults)) = table.get_mut("fault") {
        faults.retain(|fault| !of_command(fault));
    }
    toml::to_string(&table).unwrap()
}

#[test]
fn fifty_thousand_navigated_steps_violate_nothing() {
    let robot = Robot::embedded("seekur_jr").unwrap();
    let setting = Setting::new(robot, BTreeMap::new(), BTreeMap::new(), false).unwrap();
    let (mut steps, mut moving, mut runs, mut excused) = (0, 0, 0, 0);
    while steps < STEPS {
        let batch: Vec<(String, Trial)> = (runs..runs + BATCH)
            .into_par_iter()
            .map(|number| {
                let text = navigated(&setting, number);
                let trial = trial::run(&setting, &text);
                (text, trial)
            })
            .collect();
        runs += BATCH;
        for (text, trial) in batch {
            if let Verdict::Violated { .. } = trial.verdict {
                panic!("{:?}\n{text}", trial.verdict);
            }
            excused += u64::from(matches!(trial.verdict, Verdict::Excused { .. }));
            steps += trial.ticks;
            moving += trial.moving;
        }
    }
    let part = 100.0 * moving as f64 / steps as f64;
    println!(
        "{runs} runs, {steps} steps of the whole kernel, {part:.0} % accepted in motion, {excused} runs with a contact \
         of which the claim does not speak, no claim violated"
    );
    assert!(part >= 15.0, "only {part} % of the steps moved");
}
