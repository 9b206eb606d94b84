//! Every requirement the code names exists, and every quotation is verbatim.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

use haltline_spec::requirements::{requirement, requirements};
use std::path::{Path, PathBuf};

/// Crates whose sources are read; those that do not exist yet are skipped.
const CRATES: [&str; 9] = [
    "kernel",
    "spec",
    "scenarios",
    "robots",
    "cli",
    "verification",
    "drives",
    "maps",
    "pilots",
];

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for entry in entries {
        let path = entry.unwrap().path();
        if path.is_dir() && path.file_name().is_some_and(|name| name != "target") {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

fn sources() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    for name in CRATES {
        rust_files(&root.join(name), &mut files);
    }
    files.sort();
    files
        .into_iter()
        .map(|path| {
            let text = std::fs::read_to_string(&path).unwrap();
            (path, text)
        })
        .collect()
}

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
    for (path, text) in sources() {
        // Number 99 is kept free for tests that need an id that does not exist.
        for id in ids(&text).into_iter().filter(|id| !id.ends_with("-99")) {
            named += 1;
            assert!(requirement(&id).is_some(), "{}: no {id}", path.display());
        }
    }
    println!("{named} mentions");
    assert!(named > 50);
}

#[test]
fn every_quotation_is_verbatim() {
    let mut quoted = 0;
    for (path, text) in sources() {
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        for (index, line) in lines.iter().enumerate() {
            let Some((file, anchor)) = line
                .strip_prefix("//= spec/")
                .and_then(|target| target.split_once('#'))
            else {
                continue;
            };
            let place = format!("{}:{}", path.display(), index + 1);
            let found = requirement(anchor).unwrap_or_else(|| panic!("{place}: no {anchor}"));
            assert_eq!(found.file, format!("spec/{file}"), "{place}");
            let quote: Vec<&str> = lines[index + 1..]
                .iter()
                .skip_while(|next| next.starts_with("//= type="))
                .map_while(|next| next.strip_prefix("//# "))
                .collect();
            quoted += 1;
            assert!(!quote.is_empty(), "{place}: nothing quoted");
            assert!(
                found.must.contains(&quote.join(" ")),
                "{place}: {anchor} does not say this"
            );
        }
    }
    println!("{quoted} quotations");
    assert!(quoted > 20);
}
