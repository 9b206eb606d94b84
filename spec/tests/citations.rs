//! Every requirement the code names exists, and every quotation is verbatim.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

mod sources;

use haltline_spec::requirements::{requirement, requirements};
use sources::{citations, texts};

/// Ids of the form FAMILY-NN in a text.
fn ids(text: &str) -> Vec<String> {
    let families: Vec<&str> = requirements().iter().map(|r| r.family.prefix()).collect();
    text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'))
        .filter(|word| {
            word.split_once('-').is_some_and(|(family, number)| {
                families.contains(&family)
                    && number.len() == 2
                    && number.bytes().all(|byte| byte.is_ascii_digit())
            })
        })
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_requirement_named_in_code_exists() {
    let mut named = 0;
    for (path, text) in texts() {
        // Number 99 is kept free for tests that need an id that does not exist.
        for id in ids(&text).into_iter().filter(|id| !id.ends_with("-99")) {
            named += 1;
            assert!(requirement(&id).is_some(), "{path}: no {id}");
        }
    }
    println!("{named} mentions");
    assert!(named > 50);
}

#[test]
fn every_quotation_is_verbatim() {
    let mut quoted = 0;
    for (name, text) in texts() {
        for citation in citations(&name, &text) {
            let (place, id) = (&citation.place, &citation.id);
            let found = requirement(id).unwrap_or_else(|| panic!("{place:?}: no {id}"));
            assert_eq!(found.file, citation.of, "{place:?}");
            quoted += 1;
            assert!(!citation.quote.is_empty(), "{place:?}: nothing quoted");
            assert!(
                found.must.contains(&citation.quote),
                "{place:?}: {id} does not say this"
            );
        }
    }
    println!("{quoted} quotations");
    assert!(quoted > 200);
}
