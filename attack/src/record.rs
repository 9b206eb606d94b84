//! What a campaign leaves for machines, and how shards are joined.

use crate::search::Searched;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// `attack.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// What was attacked and how: only equal campaigns can be joined.
    pub campaign: Campaign,
    /// Numbers of the searches, as `[first, step, count]` for each shard.
    pub shards: Vec<[u64; 3]>,
    /// Runs, scenarios that could not be run included.
    pub runs: u64,
    /// Scenarios that could not be run.
    pub refused: u64,
    /// Contacts of which the claim does not speak.
    pub excused: u64,
    /// The same by kind: the id of an assumption, or what the claim leaves out.
    #[serde(default)]
    pub excuses: BTreeMap<String, u64>,
    /// Ticks judged.
    pub ticks: u64,
    /// Ticks with an accepted motion.
    pub moving: u64,
    /// Twins run without the guard.
    pub naked_runs: u64,
    /// Of these, those that touched something in motion.
    pub naked_touched: u64,
    /// Least robustness; see [`crate::trial::Trial::robustness`].
    pub worst_robustness: Option<f64>,
    /// Least signed distances to a violation of the other invariants: metres for ZONE, seconds for FRESH and SILENT,
    /// m/s or rad/s for LIMIT. LATCH, INPUT and BRAKE say yes or no.
    pub margins: BTreeMap<String, f64>,
    /// Claims violated.
    pub violations: Vec<Find>,
    /// By broken assumption: the least break that led to a contact.
    pub broken: BTreeMap<String, Find>,
}

/// What makes two shards parts of one campaign.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Campaign {
    /// Name of the robot.
    pub robot: String,
    /// SHA-256 of its file.
    pub robot_sha256: String,
    /// Program and version.
    pub program: String,
    /// `random` or `search`.
    pub strategy: String,
    /// Seed of everything.
    pub seed: u64,
    /// Whether assumptions were broken on purpose.
    pub breaking: bool,
    /// Other values of the robot, as TOML.
    pub values: BTreeMap<String, String>,
    /// What the kernel was told instead of the truth, as TOML.
    pub told: BTreeMap<String, String>,
}

/// A scenario that shows something.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Find {
    /// Number of the search.
    pub search: u64,
    /// Monitor, or id of the assumption.
    pub what: String,
    /// In words.
    pub words: String,
    /// Robustness of the run.
    pub robustness: f64,
    /// Times what is assumed, where an assumption is broken that has a size.
    pub severity: Option<f64>,
    /// File beside `attack.json`.
    pub file: String,
    /// SHA-256 of the `trace.jsonl` that `haltline run` writes for it.
    pub trace_sha256: String,
}

impl Record {
    /// Takes in the counts of a search.
    pub fn add(&mut self, done: &Searched) {
        self.runs += done.runs;
        self.refused += done.refused;
        self.excused += done.excused;
        self.excuse(&done.excuses);
        self.ticks += done.ticks;
        self.moving += done.moving;
        self.naked_runs += done.naked[0];
        self.naked_touched += done.naked[1];
        self.worst_robustness = least(
            self.worst_robustness,
            done.worst.as_ref().map(|(worst, _)| *worst),
        );
        self.nearer(&done.margins);
    }

    fn excuse(&mut self, excuses: &BTreeMap<String, u64>) {
        for (why, count) in excuses {
            let known = self.excuses.entry(why.clone()).or_default();
            *known = known.saturating_add(*count);
        }
    }

    fn nearer(&mut self, margins: &BTreeMap<String, f64>) {
        for (invariant, margin) in margins {
            let least = self.margins.entry(invariant.clone()).or_insert(*margin);
            *least = least.min(*margin);
        }
    }

    /// Takes in a find: a violated claim, or an assumption broken on purpose, of which only the least break is kept. Says
    /// whether it was kept.
    pub fn find(&mut self, find: Find, breaks: bool) -> bool {
        if !breaks {
            self.violations.push(find);
            return true;
        }
        let known = self.broken.get(&find.what);
        let size = |find: &Find| find.severity.unwrap_or(1.0);
        let better = known.is_none_or(|known| size(&find) < size(known));
        if better {
            self.broken.insert(find.what.clone(), find);
        }
        better
    }

    /// Joins another shard of the same campaign.
    ///
    /// # Errors
    /// Another campaign, or a shard that is in already, in words.
    pub fn join(&mut self, other: Self) -> Result<(), String> {
        if self.campaign != other.campaign {
            return Err(
                "belongs to another campaign (robot, seed, strategy or version)".to_owned(),
            );
        }
        for shard in &other.shards {
            if self.shards.iter().any(|known| overlap(*known, *shard)) {
                return Err(format!("searches {shard:?} are in already"));
            }
        }
        self.shards.extend(other.shards);
        self.runs = self.runs.saturating_add(other.runs);
        self.refused = self.refused.saturating_add(other.refused);
        self.excused = self.excused.saturating_add(other.excused);
        self.excuse(&other.excuses);
        self.ticks = self.ticks.saturating_add(other.ticks);
        self.moving = self.moving.saturating_add(other.moving);
        self.naked_runs = self.naked_runs.saturating_add(other.naked_runs);
        self.naked_touched = self.naked_touched.saturating_add(other.naked_touched);
        self.worst_robustness = least(self.worst_robustness, other.worst_robustness);
        self.nearer(&other.margins);
        for find in other.violations {
            self.find(find, false);
        }
        for find in other.broken.into_values() {
            self.find(find, true);
        }
        self.violations.sort_by_key(|find| find.search);
        Ok(())
    }
}

fn least(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

/// Whether two shards `[first, step, count]` share a search.
///
/// In closed form: a file may claim any count, and looking at each number would take for ever.
fn overlap(one: [u64; 3], two: [u64; 3]) -> bool {
    let ([first, step, count], [other, other_step, others]) =
        (one.map(i128::from), two.map(i128::from));
    if count == 0 || others == 0 {
        return false;
    }
    let (step, other_step) = (step.max(1), other_step.max(1));
    let last =
        |first: i128, step: i128, count: i128| step.saturating_mul(count - 1).saturating_add(first);
    let begin = first.max(other);
    // Searches are numbered by 64 bits.
    let end = last(first, step, count)
        .min(last(other, other_step, others))
        .min(i128::from(u64::MAX));
    // Numbers of both shards: first + k step = other (mod other_step).
    let (common, inverse) = bezout(step, other_step);
    if begin > end || (other - first) % common != 0 {
        return false;
    }
    let period = other_step / common;
    let wide = |value: i128| value.rem_euclid(period).unsigned_abs();
    let k = wide((other - first) / common) * wide(inverse) % period.unsigned_abs();
    // The least shared number from `first` on; the others follow at this distance.
    let k = i128::try_from(k).unwrap_or(i128::MAX);
    let shared = step.saturating_mul(k).saturating_add(first);
    let every = step.saturating_mul(period);
    let missing = (begin - shared).max(0);
    let rounds = missing / every + i128::from(missing % every != 0);
    every.saturating_mul(rounds).saturating_add(shared) <= end
}

/// The greatest common divisor of two positive numbers, and `x` with `a x = gcd (mod b)`.
fn bezout(a: i128, b: i128) -> (i128, i128) {
    let (mut rest, mut next) = (a, b);
    let (mut x, mut next_x) = (1, 0);
    while next != 0 {
        let times = rest / next;
        (rest, next) = (next, rest - times * next);
        (x, next_x) = (next_x, x - times * next_x);
    }
    (rest, x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_a_search_exactly_if_a_number_is_in_both() {
        let all: Vec<[u64; 3]> = (0..6)
            .flat_map(|first| {
                (0..5).flat_map(move |step| (0..5).map(move |count| [first, step, count]))
            })
            .collect();
        let numbers =
            |[first, step, count]: [u64; 3]| (0..count).map(move |k| first + k * step.max(1));
        for one in &all {
            for two in &all {
                let shared = numbers(*one).any(|number| numbers(*two).any(|other| other == number));
                assert_eq!(overlap(*one, *two), shared, "{one:?} {two:?}");
            }
        }
    }

    #[test]
    fn any_numbers_are_answered_at_once() {
        let most = u64::MAX;
        assert!(overlap([0, 1, most], [most / 2, 1, most]));
        assert!(overlap([0, most, most], [0, most - 1, most]));
        assert!(!overlap([0, 2, most], [1, 2, most]));
        assert!(!overlap([most, most, most], [0, 1, most]));
        let record = Record {
            shards: vec![[0, 1, most]],
            runs: most,
            ..Record::default()
        };
        let mut sum = Record {
            runs: 1,
            ..Record::default()
        };
        assert_eq!(sum.join(record.clone()), Ok(()));
        assert_eq!(sum.runs, most, "counts saturate");
        assert!(sum.join(record).is_err());
    }
}
