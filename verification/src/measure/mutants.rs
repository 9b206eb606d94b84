//! Small changes to the safety core, one at a time, and whether a test fails: every n-th of them, by `cargo mutants`.

use super::{Mutants, TESTS, core_files, core_sha256, keep, still, tool};
use crate::prove::tools::ProveError;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Longest time for the tests of one change, s: several times what they need.
const TIMEOUT_S: &str = "600";

/// Tries shard `shard[0]` (from 1) of `shard[1]`: every `shard[1]`-th of all changes. Keeps and returns what became of them.
///
/// The tool's own sharding, because its filters by name let through every change that leaves a field out.
///
/// # Errors
/// A tool cannot be had, the tests fail without any change, or its results are not there.
pub fn measure(root: &Path, shard: [u64; 2]) -> Result<Mutants, ProveError> {
    let version = tool("mutants")?;
    let source_sha256 = core_sha256(root)?;
    let all = listed(root, None)?;
    let chosen = listed(root, Some(shard))?;
    println!("{chosen} of {all} changes; first the tests without any");
    unchanged(root)?;
    let out = root.join("target/mutants");
    let mut command = cargo_mutants(root, Some(shard))?;
    command.args([
        "--profile",
        "release",
        "--jobs",
        "1",
        // The tool would ask for tests of the kernel's own package only.
        "--baseline",
        "skip",
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
        shard,
        tried: [chosen, all],
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

fn cargo_mutants(root: &Path, shard: Option<[u64; 2]>) -> Result<Command, ProveError> {
    let mut command = Command::new("cargo");
    command
        .current_dir(root)
        .args(["mutants", "--package", "haltline"]);
    for file in core_files(root)? {
        command.arg("--file").arg(file);
    }
    if let Some([number, count]) = shard {
        // The tool counts from 0.
        let shard = format!("{}/{count}", number.saturating_sub(1));
        command.args(["--sharding", "round-robin", "--shard", &shard]);
    }
    Ok(command)
}

/// The tests that judge every change hold without one.
fn unchanged(root: &Path) -> Result<(), ProveError> {
    let mut command = Command::new("cargo");
    command
        .current_dir(root)
        .args(["test", "--release", "--quiet"]);
    command
        .args(["--package", "haltline", "--package", "haltline-spec"])
        .args(TESTS);
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(ProveError::Words(
            "tests fail without any change; nothing was measured".to_owned(),
        )),
        Err(error) => Err(ProveError::Words(format!("cargo test: {error}"))),
    }
}

/// How many changes the tool makes, of all or of a shard.
fn listed(root: &Path, shard: Option<[u64; 2]>) -> Result<u64, ProveError> {
    let said = cargo_mutants(root, shard)?.arg("--list").output();
    let said = said.map_err(|error| ProveError::Words(format!("cargo mutants: {error}")))?;
    if !said.status.success() {
        let why = String::from_utf8_lossy(&said.stderr).into_owned();
        return Err(ProveError::Words(format!("cargo mutants --list: {why}")));
    }
    Ok(String::from_utf8_lossy(&said.stdout).lines().count() as u64)
}
