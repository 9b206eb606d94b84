//! The requirement gate: which requirement has a place in the code, and which a test or a proof.
//!
//! A requirement without either must stand in the list below, with nothing said for it; a new one
//! cannot slip in, and one that gains its evidence must leave the list.

#![allow(clippy::unwrap_used, clippy::panic)] // Tests may fail loudly.

use haltline_spec::requirements::requirements;
use std::path::{Path, PathBuf};

/// Requirements that nothing in code, tests and proofs names yet.
const NOT_SHOWN: [&str; 25] = [
    "GUARD-04",
    "GUARD-09",
    "GUARD-10",
    "GUARD-16",
    "GUARD-20",
    "BRAKE-01",
    "BRAKE-07",
    "LIMIT-06",
    "LIMIT-07",
    "LIMIT-08",
    "ZONE-03",
    "LATCH-09",
    "INPUT-02",
    "INPUT-03",
    "INPUT-04",
    "INPUT-13",
    "INPUT-14",
    "MEMORY-01",
    "MEMORY-05",
    "MEMORY-07",
    "MEMORY-09",
    "MEMORY-11",
    "TIME-01",
    "TIME-03",
    "TIME-04",
];

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for entry in entries {
        let path = entry.unwrap().path();
        if path.is_dir() && path.file_name().is_some_and(|name| name != "target") {
            rust_files(&path, found);
        } else if path
            .extension()
            .is_some_and(|ending| ending == "rs" || ending == "smt2")
        {
            found.push(path);
        }
    }
}

/// What the files below `folders` say of the requirement `id`.
fn named(folders: &[&str], id: &str, only: impl Fn(&Path) -> bool) -> bool {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let anchor = format!("#{}", id.to_lowercase());
    let mut files = Vec::new();
    for folder in folders {
        rust_files(&root.join(folder), &mut files);
    }
    files.iter().filter(|path| only(path)).any(|path| {
        let text = std::fs::read_to_string(path).unwrap();
        text.contains(id) || text.lines().any(|line| line.ends_with(&anchor))
    })
}

fn is_gate(path: &Path) -> bool {
    path.ends_with("spec/tests/gate.rs")
}

#[test]
fn every_requirement_is_shown_or_listed() {
    let evidence = [
        "verification",
        "spec",
        "kernel",
        "scenarios",
        "robots",
        "drives",
    ];
    let mut open = Vec::new();
    let mut count = 0;
    for requirement in requirements() {
        count += 1;
        if !named(&evidence, requirement.id, |path| !is_gate(path)) {
            open.push(requirement.id);
        }
    }
    println!(
        "{} of {count} requirements are named by code, test or proof",
        count - open.len()
    );
    assert_eq!(
        open, NOT_SHOWN,
        "left: named by nothing; right: listed as such"
    );
}
