//! What may be claimed after a batch of runs: as strong as the evidence, and no stronger.
//!
//! A claim without data is *not checkable*, never passed; a part that nobody examined is
//! *not claimed yet*.

pub mod adversary;
pub mod drive;
mod proofs;
mod replay;
mod unclaimed;

pub use proofs::{attach, from_proofs};
pub use replay::Replay;
pub use unclaimed::not_claimed;

use crate::report::words;
use haltline_scenarios::result::{CaseResult, Judgement, MonitorReport, Outcome, SuiteResult};
use serde::Serialize;

/// Requirement families with a monitor that judges every tick of every guarded run.
pub const MONITORED: [&str; 8] = [
    "CLAIM", "BRAKE", "LIMIT", "ZONE", "FRESH", "SILENT", "LATCH", "INPUT",
];

/// How a claim stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The evidence is there and nothing spoke against it.
    Holds,
    /// Something spoke against it.
    Failed,
    /// The evidence needed is missing.
    NotCheckable,
    /// Nobody claims it.
    NotClaimed,
}

impl Status {
    /// The status in words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Failed => "FAILED",
            Self::NotCheckable => "not checkable",
            Self::NotClaimed => "not claimed yet",
        }
    }
}

/// What kind of evidence stands behind a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EvidenceKind {
    /// Simulated runs, judged by monitors or exact geometry.
    Tested,
    /// Arithmetic on the robot file.
    Computed,
    /// Machine-checked proofs, each with the strength that the ledger states.
    Proofs,
    /// Every case of a stated domain was run.
    Enumerated,
    /// Composed hostile runs, judged like simulated ones.
    Searched,
    /// None.
    None,
}

/// The evidence in numbers and words.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evidence {
    /// Its kind.
    pub kind: EvidenceKind,
    /// In words.
    pub words: String,
    /// Number of runs.
    pub runs: usize,
    /// Number of ticks judged.
    pub ticks_checked: u64,
    /// Number of ticks at which the requirement had something to say.
    pub ticks_engaged: u64,
    /// Names of the checks in the proof ledger that stand behind it.
    pub proofs: Vec<String>,
}

impl Evidence {
    /// No evidence, with the reason.
    #[must_use]
    pub fn none(words: impl Into<String>) -> Self {
        Self {
            kind: EvidenceKind::None,
            words: words.into(),
            runs: 0,
            ticks_checked: 0,
            ticks_engaged: 0,
            proofs: Vec::new(),
        }
    }

    /// Simulated runs without a count of ticks.
    fn tested(words: impl Into<String>, runs: usize) -> Self {
        Self {
            kind: EvidenceKind::Tested,
            runs,
            ..Self::none(words)
        }
    }

    /// Arithmetic on the robot file.
    #[must_use]
    pub fn computed(words: impl Into<String>) -> Self {
        Self {
            kind: EvidenceKind::Computed,
            ..Self::none(words)
        }
    }
}

/// Something that spoke against a claim.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Counterexample {
    /// Case or rule.
    pub case: String,
    /// Time within the run, if it happened at one.
    pub t_s: Option<f64>,
    /// Tick of the kernel at that time, if it happened at one.
    pub tick: Option<u64>,
    /// What was seen and what was wanted.
    pub what: String,
    /// Command that shows it again.
    pub replay: String,
}

/// One claim of the certificate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Claim {
    /// Requirement family or part of the certificate.
    pub id: String,
    /// What is claimed.
    pub statement: String,
    /// How it stands.
    pub status: Status,
    /// Why one may believe it.
    pub evidence: Evidence,
    /// What spoke against it; the first few of each case.
    pub counterexamples: Vec<Counterexample>,
    /// Cases that exercised it.
    pub cases: Vec<String>,
}

/// The first counterexample of each case, and how many more that case has.
#[must_use]
pub fn first_of_each_case(found: &[Counterexample]) -> Vec<(&Counterexample, usize)> {
    let mut first: Vec<(&Counterexample, usize)> = Vec::new();
    for one in found {
        match first.iter_mut().find(|(known, _)| known.case == one.case) {
            Some((_, more)) => *more += 1,
            None => first.push((one, 0)),
        }
    }
    first
}

fn statement(id: &str) -> &'static str {
    match id {
        "CLAIM" => {
            "While it moves, the robot touches no body that a valid beam or the memory showed at the \
             tick that accepted the manoeuvre, if that body has moved at most at the obstacle speed since."
        }
        "BRAKE" => {
            "Where no motion is accepted, the set points fall to zero along the arc, at least as fast as the sure \
             decelerations."
        }
        "LIMIT" => "Every accepted motion lies within the speed limits and the dynamic window.",
        "ZONE" => "A point in the critical zone starts a stop in the same tick.",
        "FRESH" => "No motion on a scan, odometry or command older than its limit.",
        "SILENT" => "Every decision carries an expiry, and silence stops the robot.",
        "INPUT" => {
            "A value that cannot be used stops or brakes the robot in the tick that receives it."
        }
        "LATCH" => "An emergency stop holds until reset at rest; release replays no old command.",
        _ => "",
    }
}

/// Claims from a batch of runs.
#[must_use]
pub fn from_suite(suite: &SuiteResult, replay: &Replay) -> Vec<Claim> {
    let mut claims: Vec<Claim> = MONITORED
        .iter()
        .map(|id| monitored(id, suite, replay))
        .collect();
    claims.push(scenarios(suite, replay));
    claims.push(twins(suite));
    claims
}

/// Whether a run is evidence for the claims about this robot.
///
/// One that breaks an assumption on purpose is none for what rests on it, and one that changes values
/// of the robot is about another robot; what either violates counts all the same.
fn is_evidence(case: &CaseResult) -> bool {
    case.guarded.assumptions_broken.is_empty() && case.robot_values.is_empty()
}

fn monitored(id: &str, suite: &SuiteResult, replay: &Replay) -> Claim {
    let reports: Vec<(&CaseResult, &MonitorReport)> = suite
        .cases
        .iter()
        .flat_map(|case| case.guarded.monitors.iter().map(move |m| (case, m)))
        .filter(|(_, report)| report.id == id)
        .collect();
    let kept = || reports.iter().filter(|(case, _)| is_evidence(case));
    let checked = kept().map(|(_, r)| r.checked).sum();
    let engaged: u64 = kept().map(|(_, r)| r.engaged).sum();
    let violations: u64 = reports.iter().map(|(_, r)| r.violation_count).sum();
    let counterexamples = violations_of(&reports, replay);
    let cases: Vec<String> = kept()
        .filter(|(_, report)| report.engaged > 0)
        .map(|(case, _)| case.name.clone())
        .collect();
    let status = match (violations, engaged) {
        (1.., _) => Status::Failed,
        (0, 0) => Status::NotCheckable,
        (0, _) => Status::Holds,
    };
    let evidence = if engaged == 0 && violations == 0 {
        Evidence::none("no run exercised it: add a scenario that does")
    } else {
        Evidence {
            kind: EvidenceKind::Tested,
            words: format!("tested ({})", words::count(cases.len(), "run")),
            runs: cases.len(),
            ticks_checked: checked,
            ticks_engaged: engaged,
            proofs: Vec::new(),
        }
    };
    Claim {
        id: id.to_owned(),
        statement: statement(id).to_owned(),
        status,
        evidence,
        counterexamples,
        cases,
    }
}

fn violations_of(
    reports: &[(&CaseResult, &MonitorReport)],
    replay: &Replay,
) -> Vec<Counterexample> {
    reports
        .iter()
        .flat_map(|(case, report)| report.violations.iter().map(move |v| (case, v)))
        .map(|(case, violation)| Counterexample {
            case: case.name.clone(),
            t_s: Some(violation.t_s),
            tick: replay.tick(violation.t_s),
            what: violation.what.clone(),
            replay: replay.command(case),
        })
        .collect()
}

/// Every run came out as its file expects.
fn scenarios(suite: &SuiteResult, replay: &Replay) -> Claim {
    let counterexamples = unexpected(suite, replay);
    let runs = suite.cases.len();
    let status = match (counterexamples.is_empty(), runs) {
        (false, _) => Status::Failed,
        (true, 0) => Status::NotCheckable,
        (true, _) => Status::Holds,
    };
    let evidence = if runs == 0 {
        Evidence::none("no scenario is for this robot")
    } else {
        Evidence::tested(format!("tested ({})", words::count(runs, "run")), runs)
    };
    Claim {
        id: "SCENARIOS".to_owned(),
        statement:
            "Every scenario came out as its file expects (goal reached, stopped before, blocked)."
                .to_owned(),
        status,
        evidence,
        counterexamples,
        cases: suite.cases.iter().map(|case| case.name.clone()).collect(),
    }
}

/// Runs and sweeps that did not come out as their files expect.
fn unexpected(suite: &SuiteResult, replay: &Replay) -> Vec<Counterexample> {
    let found = |case: &str, judgement: &Judgement, replay: String| Counterexample {
        case: case.to_owned(),
        t_s: None,
        tick: None,
        what: judgement.sentences.join(" "),
        replay,
    };
    let cases = suite
        .cases
        .iter()
        .filter(|case| case.judgement.outcome == Outcome::Fail)
        .map(|case| found(&case.name, &case.judgement, replay.command(case)));
    let sweeps = suite
        .groups
        .iter()
        .filter(|group| group.judgement.outcome == Outcome::Fail)
        .map(|group| {
            found(
                &group.group,
                &group.judgement,
                replay.first_of(&group.group),
            )
        });
    cases.chain(sweeps).collect()
}

/// The scenarios can hurt: without the guard, the robot touches.
///
/// Whether enough twins touched is part of each case's and each sweep's own verdict; this claim
/// only counts, and cannot be made without at least one twin that touched.
fn twins(suite: &SuiteResult) -> Claim {
    let twins: Vec<&CaseResult> = suite.cases.iter().filter(|c| c.naked.is_some()).collect();
    let touched: Vec<String> = twins
        .iter()
        .filter(|case| case.naked.as_ref().is_some_and(|n| !n.contacts.is_empty()))
        .map(|case| case.name.clone())
        .collect();
    let (status, evidence) = if touched.is_empty() {
        (
            Status::NotCheckable,
            Evidence::none("no naked twin touched anything: the scenarios show nothing"),
        )
    } else {
        let words = format!(
            "tested ({}, of which {} touched)",
            words::count(twins.len(), "naked run"),
            touched.len()
        );
        let evidence = Evidence::tested(words, twins.len());
        (Status::Holds, evidence)
    };
    Claim {
        id: "TWINS".to_owned(),
        statement: "The scenarios are dangerous: driven without the guard, the robot touches."
            .to_owned(),
        status,
        evidence,
        counterexamples: Vec::new(),
        cases: touched,
    }
}

#[cfg(test)]
mod tests;
