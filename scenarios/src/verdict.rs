//! Pass or fail, in sentences.

mod course;
mod navigation;

use crate::file::{ContactExpectation, Expect, Scenario};
use crate::result::{CaseResult, Contact, GroupResult, Judgement, Outcome, RunResult};

/// Collects sentences; failures come first.
#[derive(Debug, Default)]
struct Sentences {
    failures: Vec<String>,
    facts: Vec<String>,
}

impl Sentences {
    fn demand(&mut self, holds: bool, failure: impl FnOnce() -> String) {
        if !holds {
            self.failures.push(failure());
        }
    }

    fn judgement(mut self) -> Judgement {
        let outcome = if self.failures.is_empty() {
            Outcome::Pass
        } else {
            Outcome::Fail
        };
        self.failures.append(&mut self.facts);
        Judgement {
            outcome,
            sentences: self.failures,
        }
    }
}

/// Judges the guarded run and its naked twin against the scenario's expectations.
///
/// `naked` is none where the scenario says that it is not a contact scenario.
#[must_use]
pub fn judge(scenario: &Scenario, guarded: &RunResult, naked: Option<&RunResult>) -> Judgement {
    let mut sentences = Sentences::default();
    monitors(&mut sentences, guarded);
    contacts(&mut sentences, &scenario.expect, guarded);
    assumptions(&mut sentences, &scenario.expect, guarded);
    course::judge(&mut sentences, &scenario.expect, guarded);
    stops(&mut sentences, scenario, guarded);
    navigation::judge(&mut sentences, &scenario.expect, guarded);
    if let Some(naked) = naked {
        twin(&mut sentences, scenario, naked);
    }
    sentences.judgement()
}

fn monitors(sentences: &mut Sentences, run: &RunResult) {
    for monitor in &run.monitors {
        let first = monitor.violations.first();
        sentences.demand(monitor.violation_count == 0, || {
            let (t_s, what) = first.map_or((0.0, ""), |v| (v.t_s, v.what.as_str()));
            format!(
                "{} violated {} times, first at {t_s:.2} s: {what}.",
                monitor.id, monitor.violation_count
            )
        });
        sentences.demand(monitor.checked > 0, || {
            format!("{} judged no tick, so it shows nothing.", monitor.id)
        });
    }
}

fn contacts(sentences: &mut Sentences, expect: &Expect, run: &RunResult) {
    let moving = run.moving_contacts();
    let first: Option<&Contact> = run.contacts.iter().find(|c| c.robot_moving);
    let what = first.map_or_else(String::new, |contact| {
        let excuses: Vec<_> = run
            .assumptions_broken
            .iter()
            .map(|b| b.id.as_str())
            .collect();
        let because = if excuses.is_empty() {
            "with all assumptions kept".to_owned()
        } else {
            format!("with {} broken", excuses.join(", "))
        };
        format!(
            "The moving robot touched {} at {:.2} s at {:.2} m/s, {because}.",
            contact.body, contact.t_s, contact.v_mps
        )
    });
    match expect.contact {
        ContactExpectation::Never => sentences.demand(moving == 0, || what),
        ContactExpectation::Must if moving == 0 => sentences
            .failures
            .push("The broken assumption should have led to a contact and did not.".to_owned()),
        ContactExpectation::May | ContactExpectation::Must => {
            if moving > 0 {
                sentences.facts.push(what);
            }
        }
    }
    let resting = run.contacts.len() - moving;
    if resting > 0 {
        let text = format!("{resting} bodies ran into the resting robot; the claim allows that.");
        sentences.facts.push(text);
    }
}

fn assumptions(sentences: &mut Sentences, expect: &Expect, run: &RunResult) {
    let mut named: Vec<&str> = run
        .assumptions_broken
        .iter()
        .map(|b| b.id.as_str())
        .collect();
    named.dedup();
    for id in &named {
        sentences.demand(expect.assumptions_broken.iter().any(|e| e == id), || {
            let all = run.assumptions_broken.iter();
            let what: Vec<_> = all
                .filter(|b| b.id == *id)
                .map(|b| b.what.as_str())
                .collect();
            format!(
                "{id} is broken ({}), which the file does not expect.",
                what.join("; ")
            )
        });
    }
    for id in &expect.assumptions_broken {
        sentences.demand(named.contains(&id.as_str()), || {
            format!("{id} should be broken, but the simulator kept it.")
        });
    }
}

fn stops(sentences: &mut Sentences, scenario: &Scenario, run: &RunResult) {
    let expect = &scenario.expect;
    if let Some(blocked) = expect.blocked {
        let refused = stopping_after(run, run.time_s - STAND_S).is_some();
        let held = stands(run) && !run.reached && refused;
        sentences.demand(held == blocked, || {
            let last = run.decisions.last();
            let (decision, reason) =
                last.map_or(("-", "-"), |d| (d.decision.as_str(), d.reason.as_str()));
            format!("Blocked at the end: {held} ({decision}, {reason}), expected: {blocked}.")
        });
    }
    for reason in &expect.reasons {
        sentences.demand(run.decisions.iter().any(|d| d.reason == *reason), || {
            let mut seen: Vec<_> = run.decisions.iter().map(|d| d.reason.as_str()).collect();
            seen.sort_unstable();
            seen.dedup();
            format!(
                "Reason {reason} never occurred; there were {}.",
                seen.join(", ")
            )
        });
    }
    let first = scenario
        .fault
        .iter()
        .map(|f| f.get_ref().from_s.get())
        .reduce(f64::min);
    if let (Some(within), Some(first)) = (expect.stop_within_s, first) {
        let stopped = stopping_after(run, first);
        sentences.demand(
            stopped.is_some_and(|t| t <= first + within.get() + 1e-9),
            || {
                let when =
                    stopped.map_or("never".to_owned(), |t| format!("{:.2} s later", t - first));
                format!(
                    "The stop after the fault came {when}, expected within {} s.",
                    within.get()
                )
            },
        );
    }
}

/// How long a robot must have stood to count as standing at the end.
const STAND_S: f64 = 2.0;

/// Whether the robot stood, or crept by less than 50 mm and 0.05 rad, at the end.
///
/// A guard that refuses may still let a tick of motion through when noise favours it, so the
/// instantaneous speed of the last step says little.
fn stands(run: &RunResult) -> bool {
    let Some(last) = run.samples.last().map(|sample| sample.pose) else {
        return true;
    };
    let recent = run.samples.iter().filter(|s| s.t_s >= run.time_s - STAND_S);
    recent.map(|sample| sample.pose).all(|pose| {
        let turn = crate::math::wrap(pose.theta_rad - last.theta_rad);
        libm::hypot(pose.x_m - last.x_m, pose.y_m - last.y_m) < 0.05 && turn.abs() < 0.05
    })
}

/// First moment from `t_s` on at which a stop or brake decision is in force.
fn stopping_after(run: &RunResult, t_s: f64) -> Option<f64> {
    let brakes = |decision: &str| decision != "Pass" && decision != "Slow" && decision != "naked";
    let before = run.decisions.iter().rev().find(|d| d.t_s <= t_s);
    if before.is_some_and(|d| brakes(&d.decision)) {
        return Some(t_s);
    }
    let later = run
        .decisions
        .iter()
        .find(|d| d.t_s > t_s && brakes(&d.decision));
    later.map(|d| d.t_s)
}

fn twin(sentences: &mut Sentences, scenario: &Scenario, naked: &RunResult) {
    let touched = naked.moving_contacts() > 0;
    // A sweep counts its naked twins as a whole.
    let counted = scenario.sweep_naked_touch_min.is_some();
    sentences.demand(touched || counted, || {
        "The naked twin touched nothing, so the scenario shows nothing.".to_owned()
    });
    if let Some(contact) = naked.contacts.iter().find(|c| c.robot_moving) {
        let text = format!(
            "Without the guard the robot touches {} at {:.2} s at {:.2} m/s.",
            contact.body, contact.t_s, contact.v_mps
        );
        sentences.facts.push(text);
    }
}

/// Judges a sweep as a whole; `required` naked twins must touch, no guarded run may.
#[must_use]
pub fn judge_group(group: &str, cases: &[&CaseResult], required: Option<usize>) -> GroupResult {
    let touched = |run: &RunResult| run.moving_contacts() > 0;
    let naked_touched = cases
        .iter()
        .filter(|case| case.naked.as_ref().is_some_and(touched))
        .count();
    let guarded_touched = cases.iter().filter(|case| touched(&case.guarded)).count();
    let required = required.unwrap_or(cases.len());
    let mut sentences = Sentences::default();
    sentences.demand(naked_touched >= required, || {
        format!(
            "{naked_touched} of {} naked runs touched, {required} must.",
            cases.len()
        )
    });
    sentences.demand(guarded_touched == 0, || {
        format!("{guarded_touched} guarded runs touched while moving.")
    });
    sentences.facts.push(format!(
        "{naked_touched} of {} naked runs touched and {guarded_touched} guarded ones.",
        cases.len()
    ));
    GroupResult {
        group: group.to_owned(),
        variants: cases.len(),
        naked_touched,
        naked_required: required,
        guarded_touched,
        judgement: sentences.judgement(),
    }
}

#[cfg(test)]
mod tests;
