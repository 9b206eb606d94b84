//! What nobody claims yet, said as plainly as what is claimed.

use super::{Claim, Evidence, Status};
use crate::provenance;

/// Stands for the tests that name requirements of the family.
const PROPERTY: &str = "";

/// Id, statement, and what there is instead of evidence.
const PARTS: [(&str, &str, &str); 2] = [
    (
        "MEMORY",
        "A hit is never lost but by the rule; unknown is never free.",
        PROPERTY,
    ),
    (
        "TIME",
        "The work of a tick stays below a declared bound.",
        "wall times of this machine are in timing.json; they bound nothing",
    ),
];

/// Parts of the certificate that nobody claims yet, with what there is instead.
#[must_use]
pub fn not_claimed() -> Vec<Claim> {
    PARTS
        .into_iter()
        .map(|(id, statement, instead)| Claim {
            id: id.to_owned(),
            statement: statement.to_owned(),
            status: Status::NotClaimed,
            evidence: Evidence::none(if instead == PROPERTY {
                property_tests(id)
            } else {
                instead.to_owned()
            }),
            counterexamples: Vec::new(),
            cases: Vec::new(),
        })
        .collect()
}

/// Tests are evidence for whoever runs them; this command does not.
fn property_tests(family: &str) -> String {
    let files = provenance::tests_of_family(family);
    if files.is_empty() {
        return "no monitor here, and no test cites its requirements".to_owned();
    }
    format!(
        "no monitor here; `cargo test --workspace` runs property tests that name its requirements ({})",
        files.join(", ")
    )
}
