//! One scenario run, and how near it came to a violation.

use crate::setting::Setting;
use haltline_scenarios::assumption::START;
use haltline_scenarios::batch::{Case, equip, run_one};
use haltline_scenarios::file::parse;
use haltline_scenarios::monitor::{UNSEEN, is_outside};
use haltline_scenarios::result::{Contact, RunResult};
use std::collections::{BTreeMap, BTreeSet};

/// What a run showed.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Nothing.
    Clean,
    /// The scenario is none: a body on the robot, a key out of bounds.
    Refused(String),
    /// The robot touched something while it moved, and the claim does not speak of that: a body that no beam had
    /// ever returned came at it, or an assumption is broken that was to be kept.
    Excused {
        /// A few words, the same for all contacts of the kind: the id of an assumption, or what the claim leaves out.
        why: String,
        /// What happened.
        what: String,
    },
    /// The robot touched something while it moved, and this assumption was broken on purpose.
    Broken {
        /// Id of the assumption.
        id: String,
        /// What was assumed and what happened.
        what: String,
    },
    /// A monitor objects: a bug.
    Violated {
        /// Monitor: `CLAIM`, `LIMIT`, ...
        invariant: String,
        /// Its words.
        what: String,
        /// Whether it comes of what the kernel is told: told the truth, it does nothing wrong.
        told: bool,
    },
}

impl Verdict {
    /// Whether two verdicts are about the same thing.
    #[must_use]
    pub fn same(&self, other: &Self) -> bool {
        match (self, other) {
            (
                Self::Violated {
                    invariant: a,
                    told: c,
                    ..
                },
                Self::Violated {
                    invariant: b,
                    told: d,
                    ..
                },
            ) => a == b && c == d,
            (Self::Broken { id: a, .. }, Self::Broken { id: b, .. }) => a == b,
            _ => false,
        }
    }

    /// Whether it is what an attacker looks for.
    #[must_use]
    pub const fn found(&self) -> bool {
        matches!(self, Self::Broken { .. } | Self::Violated { .. })
    }
}

/// A run as the search sees it.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Signed distance to a contact: the least clearance while moving, in metres; once something is violated, minus
    /// the speed at the contact in m/s, or -1 where a monitor other than CLAIM objects.
    pub robustness: f64,
    /// Signed distances to a violation of the other invariants that have one, in the monitors' own units:
    /// [`haltline_scenarios::result::MonitorReport::margin`].
    pub margins: BTreeMap<String, f64>,
    /// What it showed.
    pub verdict: Verdict,
    /// Ids of the assumptions that the run broke, each once.
    pub broken: Vec<String>,
    /// Ticks judged.
    pub ticks: u64,
    /// Ticks with an accepted motion.
    pub moving: u64,
    /// `trace.jsonl` of the run.
    pub trace: String,
}

impl Trial {
    /// Whether it shows the same as `other` and breaks no assumption that the other keeps.
    #[must_use]
    pub fn shows(&self, other: &Self) -> bool {
        let keeps = |id: &String| other.broken.contains(id);
        self.verdict.same(&other.verdict) && self.broken.iter().all(keeps)
    }

    /// What another assumption explains than the one broken on purpose is no find.
    pub fn expect(&mut self, drawn: Option<&str>) {
        if let Verdict::Broken { id, what } = &self.verdict
            && drawn != Some(id)
        {
            let (why, what) = (id.clone(), what.clone());
            self.verdict = Verdict::Excused { why, what };
            self.robustness = NOTHING;
        }
    }

    /// The signed distance that a search for this invariant makes smaller; `CLAIM` is a contact.
    #[must_use]
    pub fn towards(&self, invariant: &str) -> f64 {
        let clean = matches!(self.verdict, Verdict::Clean | Verdict::Excused { .. });
        if clean && invariant != "CLAIM" {
            return self.margins.get(invariant).copied().unwrap_or(NOTHING);
        }
        self.robustness
    }
}

/// What a scenario counts that cannot be run or proves nothing.
const NOTHING: f64 = 10.0;

/// Parses and runs the text of a scenario.
#[must_use]
pub fn run(setting: &Setting, text: &str) -> Trial {
    let mut trial = as_written(setting, text);
    if let Verdict::Violated { told, .. } = &mut trial.verdict
        && !setting.told.is_empty()
    {
        *told = truthful(text).is_some_and(|text| {
            !matches!(as_written(setting, &text).verdict, Verdict::Violated { .. })
        });
    }
    trial
}

fn as_written(setting: &Setting, text: &str) -> Trial {
    match case(setting, text) {
        Ok(case) => match run_one(&case, true) {
            Some(run) => judged(&run.result, run.trace, setting.breaking),
            None => refused("the kernel refuses the robot".to_owned()),
        },
        Err(message) => refused(message),
    }
}

/// Ids of the assumptions that a scenario breaks; none if it cannot be run.
#[must_use]
pub fn broken(setting: &Setting, text: &str) -> Vec<String> {
    let Some(run) = case(setting, text)
        .ok()
        .and_then(|case| run_one(&case, true))
    else {
        return Vec::new();
    };
    broken_by(&run.result)
}

fn broken_by(run: &RunResult) -> Vec<String> {
    let broken = run.assumptions_broken.iter();
    let ids: BTreeSet<&String> = broken.map(|one| &one.id).collect();
    ids.into_iter().cloned().collect()
}

/// The same scenario, with a kernel that knows the truth.
fn truthful(text: &str) -> Option<String> {
    let mut table: toml::Table = text.parse().ok()?;
    table.remove("told")?;
    toml::to_string(&table).ok()
}

/// Whether the robot touches something in motion when nobody guards it; none if the scenario cannot be run.
#[must_use]
pub fn naked_touches(setting: &Setting, text: &str) -> Option<bool> {
    let run = run_one(&case(setting, text).ok()?, false)?;
    Some(run.result.moving_contacts() > 0)
}

fn case(setting: &Setting, text: &str) -> Result<Case, String> {
    let mut scenarios =
        parse(text, "composed.toml", "composed").map_err(|error| error.to_string())?;
    let scenario = scenarios.pop().ok_or("no scenario")?;
    equip(scenario, &setting.robot).map_err(|error| error.to_string())
}

fn refused(message: String) -> Trial {
    Trial {
        robustness: NOTHING,
        margins: BTreeMap::new(),
        verdict: Verdict::Refused(message),
        broken: Vec::new(),
        ticks: 0,
        moving: 0,
        trace: String::new(),
    }
}

fn judged(run: &RunResult, trace: String, breaking: bool) -> Trial {
    let verdict = verdict(run, breaking);
    let clearance_m = run.min_clearance_moving_m.unwrap_or(NOTHING);
    let speed = |contact: &Contact| contact.v_mps.abs().max(contact.omega_radps.abs() * 0.5);
    let contacts = run.contacts.iter().filter(|contact| contact.robot_moving);
    let fastest = contacts.map(speed).fold(0.0, f64::max);
    let robustness = match &verdict {
        Verdict::Violated { invariant, .. } if invariant != "CLAIM" => -1.0,
        Verdict::Violated { .. } | Verdict::Broken { .. } => -fastest.max(1e-3),
        Verdict::Excused { .. } | Verdict::Refused(_) => NOTHING,
        Verdict::Clean => clearance_m,
    };
    let claim = run.monitors.iter().find(|monitor| monitor.id == "CLAIM");
    let margins = run.monitors.iter();
    let margins = margins.filter_map(|one| Some((one.id.clone(), one.margin?)));
    Trial {
        robustness,
        margins: margins.collect(),
        verdict,
        broken: broken_by(run),
        ticks: claim.map_or(0, |monitor| monitor.checked),
        moving: claim.map_or(0, |monitor| monitor.engaged),
        trace,
    }
}

/// Contacts of which the claim does not speak are no find, although the monitor says them: it is stricter than the claim,
/// so that scenarios show them (CAVEATS.md).
fn verdict(run: &RunResult, breaking: bool) -> Verdict {
    let objection = run.monitors.iter().find_map(|monitor| {
        let mut violations = monitor.violations.iter();
        let first = violations.find(|one| !is_outside(&one.what))?;
        Some((
            monitor.id.clone(),
            format!("at {:.2} s {}", first.t_s, first.what),
        ))
    });
    if let Some((invariant, what)) = objection {
        return Verdict::Violated {
            invariant,
            what,
            told: false,
        };
    }
    let moving = run.contacts.iter().filter(|contact| contact.robot_moving);
    let mut explained: Vec<Verdict> = moving.map(|one| explained(run, one, breaking)).collect();
    let found = explained.iter().position(Verdict::found).unwrap_or(0);
    if explained.is_empty() {
        return Verdict::Clean;
    }
    explained.swap_remove(found)
}

/// A contact to which no monitor objects. It is laid to what was broken on purpose if nothing else explains it.
fn explained(run: &RunResult, contact: &Contact, breaking: bool) -> Verdict {
    if let Some(why) = &contact.outside {
        let (why, what) = (why.clone(), format!("{} {why}", contact.body));
        return Verdict::Excused { why, what };
    }
    let mut ids = contact.assumptions.iter();
    let Some(id) = contact.assumptions.first() else {
        // Nothing explains it and nobody objects: it began as one that a monitor had passed over.
        return Verdict::Excused {
            why: UNSEEN.to_owned(),
            what: format!("{} {UNSEEN}", contact.body),
        };
    };
    let words = run.assumptions_broken.iter().find(|one| one.id == *id);
    let (id, what) = (id.clone(), words.map_or(String::new(), |w| w.what.clone()));
    // Nobody breaks the operator's word on purpose.
    if breaking && id != START && ids.all(|other| *other == id) {
        return Verdict::Broken { id, what };
    }
    Verdict::Excused { why: id, what }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_breaks_another_assumption_shows_something_else() {
        let shown = |broken: &[&str]| Trial {
            verdict: Verdict::Violated {
                invariant: "CLAIM".to_owned(),
                what: String::new(),
                told: false,
            },
            broken: broken.iter().map(|id| (*id).to_owned()).collect(),
            ..refused(String::new())
        };
        assert!(shown(&[]).shows(&shown(&[])));
        assert!(shown(&[]).shows(&shown(&["A-START"])));
        assert!(!shown(&["A-OBSTACLE"]).shows(&shown(&[])));
        assert!(!shown(&["A-OBSTACLE"]).shows(&shown(&["A-START"])));
        assert!(!refused(String::new()).shows(&shown(&[])));
    }
}
