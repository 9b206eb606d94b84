//! What may be claimed because of the proof ledger.

use super::{Claim, Counterexample, Evidence, EvidenceKind, Status};
use crate::proofs::{Finding, Proof, Proofs};
use crate::report::words;
use haltline_verification::prove::composition;
use std::collections::BTreeMap;

/// The two claims that rest on nothing but proofs.
#[must_use]
pub fn from_proofs(proofs: &Proofs) -> Vec<Claim> {
    let all: Vec<&Proof> = proofs.checks.iter().collect();
    let is_piece = |proof: &&&Proof| composition::is_piece(&composition::GUARD, &proof.id);
    let pieces: Vec<&Proof> = all.iter().filter(is_piece).copied().collect();
    let ids: Vec<&str> = pieces.iter().map(|proof| proof.id.as_str()).collect();
    let lacking = composition::unknown_pieces(&composition::GUARD, &ids);
    let mut guard = judged(
        "GUARD",
        "No accepted tube contains a known point.",
        &pieces,
        proofs,
        format!(
            "proved by composition: harnesses, lemmas, written argument (verification/README.md); {} ({}); \
             unknown space is tested, not proved",
            words::count(pieces.len(), "piece"),
            by_means(&pieces)
        ),
    );
    if guard.status == Status::Holds && !lacking.is_empty() {
        guard.status = Status::NotCheckable;
        guard.evidence = Evidence::none(format!("pieces without a check: {}", lacking.join(", ")));
    }
    vec![
        judged(
            "PROOFS",
            "Every check of the proof ledger holds, of the kernel in this command.",
            &all,
            proofs,
            format!("{} ({})", by_means(&all), origin(proofs)),
        ),
        guard,
    ]
}

fn origin(proofs: &Proofs) -> &'static str {
    match proofs.origin {
        "ledger" => "from the ledger, which speaks of these sources; nothing was run again",
        _ => "all run again for this certificate",
    }
}

/// For instance `34 proved, 18 lemma`.
fn by_means(proofs: &[&Proof]) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for proof in proofs {
        *counts.entry(&proof.means).or_default() += 1;
    }
    let each: Vec<String> = counts
        .iter()
        .map(|(&means, n)| match means {
            "lemma" => format!("{} of mathematics, not code", words::count(*n, "lemma")),
            means => format!("{n} {means}"),
        })
        .collect();
    each.join(", ")
}

fn judged(id: &str, statement: &str, of: &[&Proof], proofs: &Proofs, words: String) -> Claim {
    let with = |finding| of.iter().filter(move |proof| proof.finding == finding);
    let open: Vec<String> = of
        .iter()
        .filter(|proof| !matches!(proof.finding, Finding::Holds | Finding::Fails))
        .map(|proof| format!("{} is {}", proof.id, proof.finding.words()))
        .collect();
    let status = if with(Finding::Fails).next().is_some() {
        Status::Failed
    } else if proofs.trouble.is_some() || of.is_empty() || !open.is_empty() {
        Status::NotCheckable
    } else {
        Status::Holds
    };
    let evidence = match (status, &proofs.trouble) {
        (Status::Holds, _) => Evidence {
            kind: EvidenceKind::Proofs,
            proofs: of.iter().map(|proof| proof.id.clone()).collect(),
            ..Evidence::none(words)
        },
        (_, Some(trouble)) => Evidence::none(trouble.clone()),
        (Status::Failed, None) => Evidence::none("a check fails"),
        (_, None) => Evidence::none(format!(
            "{}: run `cargo run --release -p haltline-verification -- prove --stale` and build again",
            first_few(&open)
        )),
    };
    Claim {
        id: id.to_owned(),
        statement: statement.to_owned(),
        status,
        evidence,
        counterexamples: with(Finding::Fails).map(|p| counterexample(p)).collect(),
        cases: Vec::new(),
    }
}

fn first_few(open: &[String]) -> String {
    const SHOWN: usize = 3;
    let more = open.len().saturating_sub(SHOWN);
    let mut words = open[..open.len().min(SHOWN)].join(", ");
    if more > 0 {
        words.push_str(&format!(" and {more} more"));
    }
    words
}

fn counterexample(proof: &Proof) -> Counterexample {
    Counterexample {
        case: proof.id.clone(),
        t_s: None,
        tick: None,
        what: format!("{} {}", proof.claim, proof.twin),
        replay: format!(
            "cargo run --release -p haltline-verification -- prove {}",
            proof.id
        ),
    }
}

/// Names the proofs behind each family of requirements in the claims about it.
pub fn attach(claims: &mut [Claim], proofs: &Proofs) {
    for claim in claims {
        let found = proofs.holding_for(&claim.id);
        if found.is_empty() || !claim.evidence.proofs.is_empty() {
            continue;
        }
        claim.evidence.words.push_str(&format!(
            "; of its requirements {} in the ledger: {}",
            if found.len() == 1 {
                "1 check holds".to_owned()
            } else {
                format!("{} checks hold", found.len())
            },
            by_means(&found)
        ));
        claim.evidence.proofs = found.into_iter().map(|proof| proof.id.clone()).collect();
    }
}
