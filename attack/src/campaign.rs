//! Many searches on all cores, in an order that does not matter.

use crate::compose::compose;
use crate::search::{Found, Searched, Strategy, search};
use crate::setting::Setting;
use crate::shrink::shrink;
use crate::trial::{self, Trial, Verdict};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// So many runs, rounded up to whole searches.
    Runs(u64),
    /// No search begins later, seconds from the start; how many that are depends on the machine.
    Seconds(f64),
}

/// Which searches, and when to stop.
#[derive(Clone, Copy, Debug)]
pub struct Orders {
    /// How genes are chosen.
    pub strategy: Strategy,
    /// Seed of everything.
    pub seed: u64,
    /// This shard, from 0, and how many there are.
    pub shard: [u64; 2],
    /// How much this shard tries.
    pub budget: Budget,
    /// Whether to go on after a violated claim.
    pub keep_going: bool,
}

/// A finished search as told to whoever waits.
pub struct Progress<'a> {
    /// Number of the search.
    pub number: u64,
    /// Its counts.
    pub done: &'a Searched,
    /// Its find, shrunk.
    pub find: Option<Shrunk>,
}

/// A small scenario that shows the same as the one found.
#[derive(Clone, Debug)]
pub struct Shrunk {
    /// The scenario file.
    pub text: String,
    /// Times what is assumed, where an assumption is broken.
    pub severity: Option<f64>,
    /// The assumption broken on purpose, and by which fault.
    pub broken: Option<String>,
    /// Its run.
    pub trial: Trial,
    /// Runs it took to shrink.
    pub runs: usize,
}

impl Shrunk {
    /// The scenario file as written for people: what it shows, how to replay it, then the scenario.
    #[must_use]
    pub fn file(&self, replay: &str) -> String {
        let what = match &self.trial.verdict {
            Verdict::Violated {
                invariant,
                what,
                told,
            } => {
                let why = if *told {
                    "The kernel is told what [told] says; told the truth, it does nothing wrong."
                } else {
                    "This is a bug."
                };
                let broken = match &self.trial.broken[..] {
                    [] => "No assumption is broken".to_owned(),
                    ids => format!("Broken, but no excuse for this: {}", ids.join(", ")),
                };
                format!("{invariant} violated: {what}.\n# {broken}. {why}")
            }
            Verdict::Broken { id, what } => format!("{id} is broken: {what}."),
            other => format!("{other:?}"),
        };
        format!("# {what}\n# Replay: {replay}\n\n{}", self.text)
    }
}

/// Searches made at a time: between two of them the budget is looked at.
const BATCH: u64 = 8;

/// Runs a campaign; `told` hears of each search in the order of their numbers. Returns how many were made.
pub fn campaign(setting: &Setting, orders: &Orders, mut told: impl FnMut(&Progress<'_>)) -> u64 {
    let started = Instant::now();
    let [first, step] = orders.shard;
    let all = match orders.budget {
        Budget::Runs(runs) => runs.div_ceil(crate::search::RUNS as u64),
        Budget::Seconds(_) => u64::MAX,
    };
    let mut made = 0;
    // The first search that violated a claim: what comes after it is not begun, or forgotten.
    let first_found = AtomicU64::new(u64::MAX);
    while made < all {
        let count = BATCH.min(all - made);
        let done: Vec<_> = (made..made + count)
            .into_par_iter()
            .map(|k| {
                let wanted = k < first_found.load(Ordering::Relaxed);
                (wanted && in_time(orders.budget, started)).then(|| {
                    let number = first + k * step;
                    let done = search(setting, orders.strategy, orders.seed, number);
                    if !orders.keep_going && done.found.as_ref().is_some_and(is_violation) {
                        first_found.fetch_min(k, Ordering::Relaxed);
                    }
                    (number, done)
                })
            })
            .collect();
        let complete = done.iter().all(Option::is_some);
        // Shards are counted without holes: what comes after a search that was not begun is forgotten.
        for (number, done) in done.into_iter().map_while(|one| one) {
            let find = done.found.as_ref().map(|found| small(setting, found));
            told(&Progress {
                number,
                done: &done,
                find,
            });
            made += 1;
            if made > first_found.load(Ordering::Relaxed) {
                return made;
            }
        }
        if !complete {
            break;
        }
    }
    made
}

fn in_time(budget: Budget, started: Instant) -> bool {
    match budget {
        Budget::Runs(_) => true,
        Budget::Seconds(limit) => started.elapsed().as_secs_f64() < limit,
    }
}

const fn is_violation(found: &Found) -> bool {
    matches!(found.trial.verdict, Verdict::Violated { .. })
}

/// The find with as little broken as will do, and everything else that is not needed removed.
#[must_use]
pub fn small(setting: &Setting, found: &Found) -> Shrunk {
    let (mildest, severity) = milder(setting, found);
    let (text, runs) = shrink(setting, &mildest, &found.trial);
    Shrunk {
        trial: trial::run(setting, &text),
        text,
        severity: severity.filter(|_| matches!(found.trial.verdict, Verdict::Broken { .. })),
        broken: found.plan.broken.as_ref().map(|broken| broken.name.clone()),
        runs,
    }
}

/// Halves the way from "as assumed" to the break that was found, as long as it still leads to a contact.
fn milder(setting: &Setting, found: &Found) -> (String, Option<f64>) {
    let text = found.plan.text.clone();
    let Some(broken) = &found.plan.broken else {
        return (text, None);
    };
    let Some(severity) = broken.severity else {
        return (text, None);
    };
    let (mut kept, mut low, mut high) = (text, 1.0, severity);
    for _ in 0..8 {
        let middle = (low + high) / 2.0;
        let plan = compose(setting, found.structure, &found.genes, Some(middle));
        if trial::run(setting, &plan.text).shows(&found.trial) {
            (kept, high) = (plan.text, middle);
        } else {
            low = middle;
        }
    }
    (kept, Some(high))
}
