//! Hostile runs: what they claim.

use super::{Claim, Counterexample, Evidence, EvidenceKind, Status};
use crate::report::words::count;
use haltline_attack::hostile::Hostile;

/// File in the output folder that holds the scenario of a violation.
#[must_use]
pub fn file(number: u64) -> String {
    format!("adversary_{number}.toml")
}

/// The claim about hostile runs; their scenarios are written to `out`.
#[must_use]
pub fn from_hostile(hostile: &Hostile, out: &str) -> Claim {
    let counterexamples: Vec<Counterexample> = hostile
        .violations
        .iter()
        .map(|one| Counterexample {
            case: format!("adversary {}", one.number),
            t_s: None,
            tick: None,
            what: one.what.clone(),
            replay: format!("haltline run {out}/{}", file(one.number)),
        })
        .collect();
    Claim {
        id: "ADVERSARY".to_owned(),
        statement: "Seeded hostile runs find no failure while the assumptions hold.".to_owned(),
        status: match (counterexamples.is_empty(), hostile.moving) {
            (false, _) => Status::Failed,
            (true, 0) => Status::NotCheckable,
            (true, _) => Status::Holds,
        },
        evidence: evidence(hostile),
        counterexamples,
        cases: Vec::new(),
    }
}

fn evidence(hostile: &Hostile) -> Evidence {
    if hostile.moving == 0 {
        return Evidence::none("no hostile run moved the robot");
    }
    let runs = usize::try_from(hostile.kept).unwrap_or(usize::MAX);
    let [broken, contacts] = hostile.broken_runs();
    Evidence {
        kind: EvidenceKind::Searched,
        words: format!(
            "searched ({}); of {broken} that break one assumption each, {contacts} end in a contact",
            count(runs, "hostile run")
        ),
        runs,
        ticks_checked: hostile.ticks,
        ticks_engaged: hostile.moving,
        proofs: Vec::new(),
    }
}
