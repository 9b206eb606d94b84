//! Seeded hostile runs for a certificate: a few at the edge of the assumptions, a few that break one each.

use crate::compose::{Plan, compose, dimension};
use crate::genes::Dice;
use crate::setting::Setting;
use crate::trial::{self, Verdict};
use haltline_robots::Robot;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// Runs that keep every assumption.
pub const KEPT: u64 = 160;
/// Runs that break one assumption each.
pub const BROKEN: u64 = 160;
/// Seed of all of them.
pub const SEED: u64 = 20_261_129;

/// What hostile runs showed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Hostile {
    /// Seed of the first; they follow each other.
    pub seed: u64,
    /// Runs that kept every assumption.
    pub kept: u64,
    /// Ticks judged in them.
    pub ticks: u64,
    /// Of these, ticks with an accepted motion.
    pub moving: u64,
    /// Of these runs, contacts of which the claim does not speak.
    pub excused: u64,
    /// The same by kind: the id of an assumption, or what the claim leaves out.
    pub excuses: BTreeMap<String, u64>,
    /// Compositions that could not be run.
    pub refused: u64,
    /// By assumption, and fault if it is one of the catalogue: runs that broke it.
    pub broken: BTreeMap<String, Broken>,
    /// Claims violated while every assumption was kept.
    #[serde(skip)]
    pub violations: Vec<Violation>,
}

/// Runs that broke one assumption.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Broken {
    /// How many.
    pub runs: u64,
    /// In how many of them the moving robot touched something.
    pub contacts: u64,
}

/// A claim violated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Which run.
    pub number: u64,
    /// The monitor that objects, and its words.
    pub what: String,
    /// The scenario.
    pub text: String,
}

/// Makes the hostile runs; the same on every machine.
///
/// # Errors
/// Whatever [`Setting::new`] refuses.
pub fn hostile(robot: &Robot) -> Result<Hostile, String> {
    let none = BTreeMap::new;
    let kept = Setting::new(robot.clone(), none(), none(), false)?;
    let broken = Setting::new(robot.clone(), none(), none(), true)?;
    let done: Vec<(Plan, trial::Trial)> = (0..KEPT + BROKEN)
        .into_par_iter()
        .map(|number| {
            let setting = if number < KEPT { &kept } else { &broken };
            let plan = drawn(setting, number);
            let trial = trial::run(setting, &plan.text);
            (plan, trial)
        })
        .collect();
    let mut all = Hostile {
        seed: SEED,
        ..Hostile::default()
    };
    for (number, (plan, trial)) in (0..).zip(done) {
        all.count(number, plan, &trial);
    }
    Ok(all)
}

fn drawn(setting: &Setting, number: u64) -> Plan {
    let mut dice = Dice::new(SEED + number);
    let structure = dice.seed();
    let genes: Vec<f64> = (0..dimension(setting, structure))
        .map(|_| dice.unit())
        .collect();
    compose(setting, structure, &genes, None)
}

impl Hostile {
    fn count(&mut self, number: u64, plan: Plan, trial: &trial::Trial) {
        if let Verdict::Refused(_) = trial.verdict {
            self.refused += 1;
            return;
        }
        if let Some(broken) = plan.broken {
            let known = self.broken.entry(broken.name).or_default();
            known.runs += 1;
            known.contacts += u64::from(matches!(trial.verdict, Verdict::Broken { .. }));
            return;
        }
        self.kept += 1;
        self.ticks += trial.ticks;
        self.moving += trial.moving;
        if let Verdict::Excused { why, .. } = &trial.verdict {
            self.excused += 1;
            *self.excuses.entry(why.clone()).or_default() += 1;
        }
        if let Verdict::Violated {
            invariant, what, ..
        } = &trial.verdict
        {
            self.violations.push(Violation {
                number,
                what: format!("{invariant}: {what}"),
                text: plan.text,
            });
        }
    }

    /// Runs that broke an assumption, and those of them that ended in a contact.
    #[must_use]
    pub fn broken_runs(&self) -> [u64; 2] {
        self.broken
            .values()
            .fold([0, 0], |[runs, contacts], broken| {
                [runs + broken.runs, contacts + broken.contacts]
            })
    }
}
