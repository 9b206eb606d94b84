//! One search: a structure, and genes that come nearer and nearer to a violation.

use crate::compose::{Plan, compose, dimension};
use crate::genes::Dice;
use crate::setting::Setting;
use crate::trial::{self, Trial};
use cmaes::{CMAESOptions, DVector};
use std::collections::BTreeMap;

/// How genes are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strategy {
    /// Each run a structure and genes of its own, at random.
    Random,
    /// Structures at random, genes by CMA-ES with robustness as its objective.
    Search,
}

/// What a search comes nearer to: mostly a contact.
const OBJECTIVES: [&str; 8] = [
    "CLAIM", "CLAIM", "CLAIM", "ZONE", "CLAIM", "CLAIM", "FRESH", "CLAIM",
];

/// Runs of one search.
pub const RUNS: usize = 120;
/// Of these, runs at random that look for a structure and a place to begin.
const SCOUTS: usize = 40;

/// What a search found.
#[derive(Clone, Debug, Default)]
pub struct Searched {
    /// Runs made, scenarios that could not be run included.
    pub runs: u64,
    /// Of these, scenarios that could not be run.
    pub refused: u64,
    /// Of these, contacts of which the claim does not speak.
    pub excused: u64,
    /// The same by kind.
    pub excuses: BTreeMap<String, u64>,
    /// Ticks judged.
    pub ticks: u64,
    /// Ticks with an accepted motion.
    pub moving: u64,
    /// Least signed distances to a violation of the invariants other than CLAIM that have one.
    pub margins: BTreeMap<String, f64>,
    /// Naked twins run, and how many of them touched something in motion.
    pub naked: [u64; 2],
    /// Least robustness of a run that could be run, and its scenario.
    pub worst: Option<(f64, String)>,
    /// The first find: its plan, where it came from, its trial.
    pub found: Option<Found>,
}

/// A scenario that shows something.
#[derive(Clone, Debug)]
pub struct Found {
    /// The scenario.
    pub plan: Plan,
    /// Its structure and genes, to compose it again.
    pub structure: u64,
    /// Genes.
    pub genes: Vec<f64>,
    /// Its run.
    pub trial: Trial,
}

/// Makes search `number` of a campaign with `seed`: the same on every machine, whatever else runs.
#[must_use]
pub fn search(setting: &Setting, strategy: Strategy, seed: u64, number: u64) -> Searched {
    let mut dice = Dice::new(seed ^ number.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let mut state = State {
        setting,
        objective: OBJECTIVES
            .get((number % OBJECTIVES.len() as u64) as usize)
            .unwrap_or(&"CLAIM"),
        done: Searched::default(),
    };
    let scouts = match strategy {
        Strategy::Random => RUNS,
        Strategy::Search => SCOUTS,
    };
    let mut best: Option<(f64, u64, Vec<f64>)> = None;
    for _ in 0..scouts {
        let structure = dice.seed();
        let genes: Vec<f64> = (0..dimension(setting, structure))
            .map(|_| dice.unit())
            .collect();
        let robustness = state.try_one(structure, &genes);
        if best.as_ref().is_none_or(|(least, ..)| robustness < *least) {
            best = Some((robustness, structure, genes));
        }
        if state.done.found.is_some() {
            return state.done;
        }
    }
    let Some((_, structure, genes)) = best.filter(|_| strategy == Strategy::Search) else {
        return state.done;
    };
    let objective = |genes: &DVector<f64>| state.try_one(structure, genes.as_slice());
    let optimiser = CMAESOptions::new(genes, 0.15)
        .seed(dice.seed())
        .max_function_evals(RUNS - SCOUTS)
        .fun_target(-1e-9)
        .build(objective);
    if let Ok(mut optimiser) = optimiser {
        optimiser.run();
    }
    state.done
}

struct State<'a> {
    setting: &'a Setting,
    objective: &'static str,
    done: Searched,
}

impl State<'_> {
    fn try_one(&mut self, structure: u64, genes: &[f64]) -> f64 {
        if let Some(found) = &self.done.found {
            // The generation in which it was found is not worth finishing.
            return found.trial.towards(self.objective);
        }
        let plan = compose(self.setting, structure, genes, None);
        let mut trial = trial::run(self.setting, &plan.text);
        trial.expect(plan.broken.as_ref().map(|broken| broken.id.as_str()));
        let robustness = trial.towards(self.objective);
        self.count(&plan, &trial);
        if trial.verdict.found() {
            self.done.found = Some(Found {
                plan,
                structure,
                genes: genes.to_vec(),
                trial,
            });
        }
        robustness
    }

    fn count(&mut self, plan: &Plan, trial: &Trial) {
        let done = &mut self.done;
        done.runs += 1;
        done.ticks += trial.ticks;
        done.moving += trial.moving;
        match &trial.verdict {
            trial::Verdict::Refused(_) => {
                done.refused += 1;
                return;
            }
            trial::Verdict::Excused { why, .. } => {
                done.excused += 1;
                *done.excuses.entry(why.clone()).or_default() += 1;
            }
            _ => {}
        }
        for (invariant, margin) in &trial.margins {
            let least = done.margins.entry(invariant.clone()).or_insert(*margin);
            *least = least.min(*margin);
        }
        if done
            .worst
            .as_ref()
            .is_none_or(|(least, _)| trial.robustness < *least)
        {
            done.worst = Some((trial.robustness, plan.text.clone()));
        }
        // A tenth is run without the guard, to say how often it had something to do.
        if done.runs.is_multiple_of(10)
            && let Some(touched) = trial::naked_touches(self.setting, &plan.text)
        {
            let [runs, touches] = done.naked;
            done.naked = [runs + 1, touches + u64::from(touched)];
        }
    }
}
