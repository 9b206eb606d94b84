//! Small changes to the safety core, one at a time, and whether a test fails: a seeded sample, by `cargo mutants`.

use super::{Mutants, TESTS, core_files, core_sha256, keep, still, tool};
use crate::prove::sources::sha256;
use crate::prove::tools::ProveError;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Longest time for the tests of one change, s: several times what they need.
const TIMEOUT_S: &str = "900";

/// Tries `sample` of all changes; keeps and returns what became of them.
///
/// # Errors
/// A tool cannot be had, the tests fail without any change, or its results are not there.
pub fn measure(root: &Path, sample: usize, seed: u64) -> Result<Mutants, ProveError> {
    let version = tool("mutants")?;
    let source_sha256 = core_sha256(root)?;
    let all = known(root)?;
    let chosen = drawn(&all, sample, seed);
    println!("{} of {} changes", chosen.len(), all.len());
    let out = root.join("target/mutants");
    let mut command = cargo_mutants(root)?;
    command.args([
        "--profile",
        "release",
        "--jobs",
        "1",
        "--timeout",
        TIMEOUT_S,
    ]);
    command.args([
        "--test-package",
        "haltline",
        "--test-package",
        "haltline-spec",
        "--output",
    ]);
    command.arg(&out);
    for name in &chosen {
        command.arg("--re").arg(format!("^{}$", escaped(name)));
    }
    // It ends with an error where a change was missed; what counts is in its lists.
    let status = command.arg("--").args(TESTS).status();
    status.map_err(|error| ProveError::Words(format!("cargo mutants: {error}")))?;
    let list = |name: &str| -> Result<Vec<String>, ProveError> {
        let path = out.join("mutants.out").join(name);
        let text = fs::read_to_string(&path).map_err(|error| ProveError::file(&path, error))?;
        Ok(text.lines().map(str::to_owned).collect())
    };
    let count = |name: &str| list(name).map(|lines| lines.len() as u64);
    still(root, &source_sha256)?;
    let mutants = Mutants {
        source_sha256,
        tool: version,
        seed,
        tried: [chosen.len() as u64, all.len() as u64],
        caught: count("caught.txt")?,
        timed_out: count("timeout.txt")?,
        unviable: count("unviable.txt")?,
        missed: list("missed.txt")?,
    };
    let judged =
        mutants.caught + mutants.timed_out + mutants.unviable + mutants.missed.len() as u64;
    if judged != mutants.tried[0] {
        return Err(ProveError::Words(format!(
            "cargo mutants judged {judged} of {}",
            mutants.tried[0]
        )));
    }
    keep(root, |measured| measured.mutants = Some(mutants.clone()))?;
    Ok(mutants)
}

fn cargo_mutants(root: &Path) -> Result<Command, ProveError> {
    let mut command = Command::new("cargo");
    command
        .current_dir(root)
        .args(["mutants", "--package", "haltline"]);
    for file in core_files(root)? {
        command.arg("--file").arg(file);
    }
    Ok(command)
}

/// Names of all changes that the tool can make.
fn known(root: &Path) -> Result<Vec<String>, ProveError> {
    let said = cargo_mutants(root)?.arg("--list").output();
    let said = said.map_err(|error| ProveError::Words(format!("cargo mutants: {error}")))?;
    if !said.status.success() {
        let why = String::from_utf8_lossy(&said.stderr).into_owned();
        return Err(ProveError::Words(format!("cargo mutants --list: {why}")));
    }
    Ok(String::from_utf8_lossy(&said.stdout)
        .lines()
        .map(str::to_owned)
        .collect())
}

/// Those whose hashes with the seed are the least: the same whatever the order of the list.
fn drawn(all: &[String], sample: usize, seed: u64) -> Vec<String> {
    let mut order: Vec<(String, &String)> = all
        .iter()
        .map(|name| (sha256(format!("{seed} {name}").as_bytes()), name))
        .collect();
    order.sort();
    order
        .into_iter()
        .take(sample)
        .map(|(_, name)| name.clone())
        .collect()
}

/// A text as a regular expression that matches it alone.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        if r"\.+*?()|[]{}^$".contains(c) {
            out.push('\\');
        }
        out.push(c);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_depend_on_the_seed_and_not_on_the_order() {
        let all: Vec<String> = (0..100).map(|n| format!("change {n}")).collect();
        let mut reversed = all.clone();
        reversed.reverse();
        assert_eq!(drawn(&all, 7, 1), drawn(&reversed, 7, 1));
        assert_ne!(drawn(&all, 7, 1), drawn(&all, 7, 2));
        assert_eq!(drawn(&all, 7, 1).len(), 7);
    }

    #[test]
    fn names_are_taken_literally() {
        assert_eq!(
            escaped("a.rs:1: replace * with + in f(x)"),
            r"a\.rs:1: replace \* with \+ in f\(x\)"
        );
    }
}
