//! The requirement gate: every requirement has a place in shipped code, a test or a proof of that code,
//! and a proof where `spec/README.md` demands one.
//!
//! What is missing must stand in a list below with its reason; what gains its evidence must leave it.

#![allow(clippy::unwrap_used, clippy::panic)] // Tests may fail loudly.

mod sources;

use haltline_spec::requirements::requirements;
use serde_json::Value;
use sources::{Citation, Kind, citations, root, tests_from, texts};
use std::collections::{BTreeMap, BTreeSet};

/// Requirements without a line of code that implements them, and why.
const NO_CODE: [(&str, &str); 0] = [];

/// Requirements without a test or a proof of the code, and why.
const NO_TEST: [(&str, &str); 2] = [
    (
        "TIME-01",
        "no test shows it for every input: all loops run over arrays of constant size, which is read in \
         the code; the worst ticks known are counted by `haltline-verification timing`",
    ),
    (
        "TIME-04",
        "two nested loops over slices, which is read in the code; a test would have to measure time; the \
         worst clouds known are counted by `haltline-verification timing`",
    ),
];

/// What there is to show for the requirements.
#[derive(Clone, Default)]
struct Evidence {
    /// Cited in shipped code.
    code: BTreeSet<String>,
    /// Cited above a test.
    test: BTreeSet<String>,
    /// In the ledger: by means that run the code.
    proved: BTreeSet<String>,
    /// In the ledger: by lemma, which is about the mathematics.
    lemma: BTreeSet<String>,
}

/// The crates that are shipped; the others judge them.
fn is_shipped(name: &str) -> bool {
    ["kernel/src/", "robots/src/", "drives/src/", "cli/src/"]
        .iter()
        .any(|folder| name.starts_with(folder))
}

impl Evidence {
    fn add(&mut self, citation: &Citation, is_test: bool, name: &str) {
        let id = citation.id.clone();
        match citation.kind {
            Kind::Implementation => {
                assert!(!is_test, "{:?}: code cited in a test", citation.place);
                if is_shipped(name) {
                    self.code.insert(id);
                }
            }
            Kind::Test => {
                let place = &citation.place;
                assert!(is_test, "{place:?}: a test cited outside tests");
                assert_eq!(citation.below, "#[test]", "{place:?}: not above a test");
                self.test.insert(id);
            }
            // The runner reads these and enters them into the ledger.
            Kind::Proof => assert_eq!(citation.below, "#[kani::proof]", "{:?}", citation.place),
            Kind::Other => panic!("{:?}: no such type", citation.place),
        }
    }

    fn gathered() -> Self {
        let mut all = Self::default();
        for (name, text) in texts() {
            let tests = tests_from(&name, &text);
            for citation in citations(&name, &text) {
                all.add(&citation, citation.place.1 >= tests, &name);
            }
        }
        let ledger = std::fs::read_to_string(root().join("verification/ledger.json")).unwrap();
        let ledger: Value = serde_json::from_str(&ledger).unwrap();
        for entry in ledger["entries"].as_array().unwrap() {
            assert_eq!(entry["verdict"], "holds", "{}", entry["id"]);
            let by_lemma = ["lemma", "intervals"].contains(&entry["means"].as_str().unwrap());
            for id in entry["requirements"].as_array().unwrap() {
                let id = id.as_str().unwrap().to_owned();
                if by_lemma {
                    all.lemma.insert(id);
                } else {
                    all.proved.insert(id);
                }
            }
        }
        all
    }

    /// What is missing, by requirement.
    fn missing(&self, ids: &[&str], table: &BTreeMap<String, String>) -> Missing {
        let (mut code, mut test, mut proof) = (Vec::new(), Vec::new(), Vec::new());
        for id in ids.iter().map(|id| (*id).to_owned()) {
            if !self.code.contains(&id) {
                code.push(id.clone());
            }
            if !self.test.contains(&id) && !self.proved.contains(&id) {
                test.push(id.clone());
            }
            let wanted = table.get(&id).map_or("", String::as_str);
            let by_code = wanted.contains("code") && !self.proved.contains(&id);
            let by_lemma = wanted.contains("lemma") && !self.lemma.contains(&id);
            if by_code || by_lemma {
                proof.push(id);
            }
        }
        Missing { code, test, proof }
    }
}

#[derive(Debug, Default, PartialEq)]
struct Missing {
    code: Vec<String>,
    test: Vec<String>,
    proof: Vec<String>,
}

/// Which proofs `spec/README.md` demands: by requirement `code`, `lemma` or both.
fn demanded(readme: &str) -> BTreeMap<String, String> {
    let section = readme.split("## What must be proved").nth(1).unwrap();
    let section = section.split("\n## ").next().unwrap();
    let mut table = BTreeMap::new();
    for row in section.lines().filter(|line| line.starts_with("| ")) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [family, numbers, means, ..] = cells[..] else {
            panic!("{row}");
        };
        if family.chars().all(|c| c.is_ascii_uppercase()) {
            for number in numbers.split(' ') {
                let again = table.insert(format!("{family}-{number}"), means.to_owned());
                let more = again.map(|before| format!("{before} {means}"));
                if let Some(both) = more {
                    table.insert(format!("{family}-{number}"), both);
                }
            }
        }
    }
    table
}

fn listed(list: &[(&str, &str)]) -> Vec<String> {
    assert!(list.iter().all(|(_, reason)| reason.len() > 20));
    list.iter().map(|(id, _)| (*id).to_owned()).collect()
}

fn table() -> BTreeMap<String, String> {
    demanded(&std::fs::read_to_string(root().join("spec/README.md")).unwrap())
}

#[test]
fn every_requirement_has_code_and_test_and_proof_where_demanded() {
    let evidence = Evidence::gathered();
    let all = requirements();
    let ids: Vec<&str> = all.iter().map(|requirement| requirement.id).collect();
    let table = table();
    for id in table.keys() {
        assert!(ids.contains(&id.as_str()), "the table demands {id}");
    }
    println!(
        "{} requirements: {} cited in code, {} above tests, {} in the ledger by code, {} by lemma, {} demanded",
        ids.len(),
        evidence.code.len(),
        evidence.test.len(),
        evidence.proved.len(),
        evidence.lemma.len(),
        table.len()
    );
    let expected = Missing {
        code: listed(&NO_CODE),
        test: listed(&NO_TEST),
        proof: Vec::new(),
    };
    assert_eq!(
        evidence.missing(&ids, &table),
        expected,
        "left: found; right: listed with a reason"
    );
}

/// The gate itself can fail: a requirement that loses its place, its test or its proof is named.
#[test]
fn false_twins() {
    let table = table();
    let demanded_by_code = |id: &str| table.get(id).is_some_and(|means| means.contains("code"));
    assert!(demanded_by_code("GUARD-01") && !demanded_by_code("ZONE-02"));
    let ids = ["GUARD-01", "ZONE-02"];
    let whole = Evidence::gathered();
    assert_eq!(whole.missing(&ids, &table), Missing::default());
    let without = |change: fn(&mut Evidence)| {
        let mut less = whole.clone();
        change(&mut less);
        less.missing(&ids, &table)
    };
    let one = |id: &str| vec![id.to_owned()];
    let no_code = without(|evidence| {
        evidence.code.remove("ZONE-02");
    });
    assert_eq!(no_code.code, one("ZONE-02"));
    let no_test = without(|evidence| {
        evidence.test.remove("ZONE-02");
    });
    assert_eq!(no_test.test, one("ZONE-02"));
    let no_proof = without(|evidence| {
        evidence.proved.remove("GUARD-01");
    });
    assert_eq!(no_proof.proof, one("GUARD-01"));
    let no_lemma = without(|evidence| {
        evidence.lemma.remove("GUARD-01");
    });
    assert_eq!(no_lemma.proof, one("GUARD-01"));
}

#[test]
fn a_citation_counts_only_for_what_it_stands_above() {
    let text = [
        "//= spec/zone.md#zone-02",
        "//= type=test",
        "//# Quote",
        "//# of two lines.",
        "#[test]",
        "fn a() {}",
        "//= spec/zone.md#zone-01",
        "//# Code.",
        "let b = 1;",
    ]
    .join("\n");
    let found = citations("x/tests/y.rs", &text);
    assert_eq!(found.len(), 2);
    assert_eq!(
        (found[0].kind, found[0].below.as_str()),
        (Kind::Test, "#[test]")
    );
    assert_eq!(found[0].quote, "Quote of two lines.");
    assert_eq!(found[1].kind, Kind::Implementation);
    assert_eq!(
        (found[1].id.as_str(), found[1].below.as_str()),
        ("ZONE-01", "let b = 1;")
    );
    assert_eq!(tests_from("kernel/src/a.rs", "fn a() {}\nmod tests {\n"), 2);
}
