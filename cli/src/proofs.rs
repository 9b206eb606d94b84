//! The proof ledger, as it stood against the kernel that was compiled into this command.
//!
//! Ledger and sources are compared when the command is built, so that an installed binary speaks
//! of its own kernel and of no other. `certify --prove` runs every check again instead.

use crate::provenance::{self, KERNEL_SOURCES, PROOF_STANDINGS};
use haltline_verification::prove::command::{Standing, checkout, run_again};
use haltline_verification::prove::ledger::{Entry, Means, Verdict};
use serde::Serialize;
use std::time::Duration;

/// After so long a check that is run again has no answer.
const CAP: Duration = Duration::from_secs(240);

/// How a check stands against the compiled kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// It holds, of these sources.
    Holds,
    /// What the ledger says is about other sources.
    Stale,
    /// It had no answer.
    Unknown,
    /// It does not hold.
    Fails,
    /// The ledger does not know it.
    Missing,
}

impl Finding {
    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Stale => "stale",
            Self::Unknown => "no answer",
            Self::Fails => "fails",
            Self::Missing => "missing in the ledger",
        }
    }
}

/// One check of the ledger.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Proof {
    /// Unique name.
    pub id: String,
    /// How it stands.
    pub finding: Finding,
    /// How it was shown: `proved`, `enumerated`, `all sequences visited`, `lemma`.
    pub means: String,
    /// What it says.
    pub claim: String,
    /// Requirements it is evidence for.
    pub requirements: Vec<String>,
    /// File and line of harness, enumeration or lemma.
    pub place: String,
    /// Bounds and solver, or the domain.
    pub bounds: String,
    /// Kernel sources it speaks about; none for a lemma.
    pub sources: Vec<String>,
    /// What its false twin did.
    pub twin: String,
    /// Tools, with versions.
    pub tools: Vec<String>,
    /// Hash of sources, harness and bounds.
    pub hash: String,
}

impl Proof {
    fn of(entry: Entry, finding: Finding) -> Self {
        Self {
            id: entry.id,
            finding,
            means: entry.means.to_string(),
            claim: entry.claim,
            requirements: entry.requirements,
            place: entry.place,
            bounds: entry.bounds,
            sources: entry.sources,
            twin: entry.twin,
            tools: entry.tools,
            hash: entry.hash,
        }
    }

    fn missing(id: String) -> Self {
        let none = String::new;
        Self {
            id,
            finding: Finding::Missing,
            means: none(),
            claim: none(),
            requirements: Vec::new(),
            place: none(),
            bounds: none(),
            sources: Vec::new(),
            twin: none(),
            tools: Vec::new(),
            hash: none(),
        }
    }

    /// Whether it is evidence for a requirement of the family.
    #[must_use]
    pub fn is_for(&self, family: &str) -> bool {
        self.requirements
            .iter()
            .any(|id| id.split('-').next() == Some(family))
    }

    /// What it shows, in one line, as strongly as its means allow.
    #[must_use]
    pub fn line(&self) -> String {
        let lemma = if self.means == Means::Lemma.to_string() {
            " (mathematics, not code)"
        } else {
            ""
        };
        let means = if self.finding == Finding::Holds {
            format!("{}{lemma}", self.means)
        } else {
            format!("proof {}", self.finding.words())
        };
        format!("{means}: {} at {} ({})", self.id, self.place, self.bounds)
    }
}

/// All checks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Proofs {
    /// `ledger`, or `run again`.
    pub origin: &'static str,
    /// Why nothing can be said, if so.
    pub trouble: Option<String>,
    /// The checks, sorted by name.
    pub checks: Vec<Proof>,
}

impl Proofs {
    /// What the ledger said of the compiled kernel.
    #[must_use]
    pub fn of_ledger() -> Self {
        let stood: Result<Vec<Standing>, String> = serde_json::from_str(PROOF_STANDINGS)
            .unwrap_or_else(|error| Err(format!("the embedded ledger: {error}")));
        match stood {
            Ok(standings) => Self::known(standings.into_iter().map(judged).collect()),
            Err(trouble) => Self::troubled("ledger", trouble),
        }
    }

    fn known(checks: Vec<Proof>) -> Self {
        Self {
            origin: "ledger",
            trouble: checks.is_empty().then(|| "the ledger is empty".to_owned()),
            checks,
        }
    }

    fn troubled(origin: &'static str, trouble: String) -> Self {
        Self {
            origin,
            trouble: Some(trouble),
            checks: Vec::new(),
        }
    }

    /// Runs every check again, in the checkout this command was built from.
    #[must_use]
    pub fn run_again() -> Self {
        let origin = "run again";
        if let Some(trouble) = changed() {
            return Self::troubled(origin, trouble);
        }
        match run_again(&checkout(), "", CAP) {
            Ok(entries) => Self {
                origin,
                ..Self::known(entries.into_iter().map(verdict).collect())
            },
            Err(error) => Self::troubled(origin, error.to_string()),
        }
    }

    /// Those that hold and are evidence for a requirement of the family.
    #[must_use]
    pub fn holding_for(&self, family: &str) -> Vec<&Proof> {
        self.checks
            .iter()
            .filter(|proof| proof.finding == Finding::Holds && proof.is_for(family))
            .collect()
    }
}

/// Why the checkout is not what was compiled, if so.
fn changed() -> Option<String> {
    let root = checkout();
    KERNEL_SOURCES.iter().find_map(|(file, hash)| {
        match std::fs::read(root.join(file)) {
            Ok(bytes) if provenance::sha256(&bytes) == *hash => None,
            Ok(_) => Some(format!("{file} has changed since this command was built: build it again")),
            Err(_) => Some(format!(
                "{file} is not there: proofs are run again only in the checkout that this command was built from"
            )),
        }
    })
}

fn judged(standing: Standing) -> Proof {
    match standing {
        Standing::Fresh(entry) => Proof::of(entry, Finding::Holds),
        Standing::Stale(entry) => Proof::of(entry, Finding::Stale),
        Standing::Open(entry) => verdict(entry),
        Standing::Missing(id) => Proof::missing(id),
    }
}

fn verdict(entry: Entry) -> Proof {
    let finding = match entry.verdict {
        Verdict::Holds => Finding::Holds,
        Verdict::Fails => Finding::Fails,
        Verdict::Unknown => Finding::Unknown,
    };
    Proof::of(entry, finding)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(verdict: Verdict) -> Entry {
        Entry {
            id: "stop::a".into(),
            means: Means::ModelChecked,
            claim: "A latch holds.".into(),
            requirements: vec!["LATCH-03".into()],
            place: "p.rs:1".into(),
            bounds: "no loops".into(),
            sources: Vec::new(),
            hash: "h".into(),
            tools: Vec::new(),
            verdict,
            twin: "twin panics".into(),
            reached: 1,
            seconds: 9,
        }
    }

    #[test]
    fn only_what_holds_of_these_sources_is_called_proved() {
        let fresh = judged(Standing::Fresh(entry(Verdict::Holds)));
        assert!(fresh.line().starts_with("proved: stop::a at p.rs:1"));
        for other in [
            Standing::Stale(entry(Verdict::Holds)),
            Standing::Open(entry(Verdict::Unknown)),
            Standing::Open(entry(Verdict::Fails)),
            Standing::Missing("stop::a".into()),
        ] {
            let proof = judged(other);
            assert_ne!(proof.finding, Finding::Holds);
            assert!(!proof.line().contains("proved"), "{}", proof.line());
        }
    }

    #[test]
    fn the_embedded_ledger_is_read() {
        let proofs = Proofs::of_ledger();
        assert_eq!(proofs.trouble, None);
        assert!(proofs.checks.len() > 60);
        assert!(changed().is_none(), "{:?}", changed());
    }
}
