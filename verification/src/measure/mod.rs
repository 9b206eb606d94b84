//! How well tests see the safety core: lines they run, and small changes they notice. Measured on demand, kept in
//! `verification/measured.json` with the hash of what was measured, so that a certificate can say whether it still is.
//!
//! Figures of this kind prove nothing: a line that ran may be wrong, and a change that nobody noticed may be harmless.

pub mod coverage;
pub mod mutants;

use crate::prove::sources;
use crate::prove::tools::ProveError;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where the figures are kept, from the root of the checkout.
pub const FILE: &str = "verification/measured.json";

/// The safety core, from `kernel/src`; tests inside it do not count.
const CORE: [&str; 18] = [
    "arith.rs",
    "checked.rs",
    "config.rs",
    "convert.rs",
    "decision.rs",
    "geometry",
    "guard",
    "input.rs",
    "kernel/ingest.rs",
    "kernel/mod.rs",
    "kernel/motion.rs",
    "odometry.rs",
    "pipeline.rs",
    "stop",
    "time.rs",
    "units.rs",
    "watch.rs",
    "window.rs",
];

/// Tests that both measurements run: those of the kernel, and those against the oracle but for the long campaign.
pub const TESTS: [&str; 19] = [
    "--lib",
    "--test",
    "configurations",
    "--test",
    "door",
    "--test",
    "edges",
    "--test",
    "guard",
    "--test",
    "memory",
    "--test",
    "shield",
    "--test",
    "stops",
    "--test",
    "unknown",
    "--test",
    "zone",
];

/// Everything that was measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// Lines that tests run.
    pub coverage: Option<Coverage>,
    /// Changes that tests notice.
    pub mutants: Option<Mutants>,
}

/// Lines and regions of the safety core that its tests run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coverage {
    /// [`core_sha256`] of what was measured.
    pub source_sha256: String,
    /// Tools with their versions.
    pub tool: String,
    /// Lines run and all lines.
    pub lines: [u64; 2],
    /// Regions run and all regions.
    pub regions: [u64; 2],
    /// Lines of each file.
    pub files: BTreeMap<String, [u64; 2]>,
}

/// A sample of small changes to the safety core, one at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mutants {
    /// [`core_sha256`] of what was measured.
    pub source_sha256: String,
    /// Tools with their versions.
    pub tool: String,
    /// Number of the shard, from 1, and how many there are.
    pub shard: [u64; 2],
    /// Changes tried, and all that the tool knows.
    pub tried: [u64; 2],
    /// A test failed.
    pub caught: u64,
    /// Tests ran into their time limit.
    pub timed_out: u64,
    /// Did not compile, which says nothing.
    pub unviable: u64,
    /// No test failed.
    pub missed: Vec<String>,
}

/// Figures, and whether they are of these sources.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    /// The figures.
    pub measured: Measured,
    /// Whether the safety core is the one whose coverage was measured.
    pub coverage_fresh: bool,
    /// Whether the safety core is the one whose changes were tried.
    pub mutants_fresh: bool,
}

/// How the figures kept below `root` stand against the sources there.
///
/// # Errors
/// A source or the file cannot be read, or the file is none of these figures.
pub fn standing(root: &Path) -> Result<Standing, ProveError> {
    Ok(Standing::of(read(root)?, &core_sha256(root)?))
}

impl Standing {
    fn of(measured: Measured, now: &str) -> Self {
        let fresh = |hash: Option<&String>| hash.is_some_and(|hash| hash == now);
        Self {
            coverage_fresh: fresh(measured.coverage.as_ref().map(|one| &one.source_sha256)),
            mutants_fresh: fresh(measured.mutants.as_ref().map(|one| &one.source_sha256)),
            measured,
        }
    }
}

/// Files of the safety core, from the root of the checkout, sorted.
///
/// # Errors
/// A folder cannot be read.
pub fn core_files(root: &Path) -> Result<Vec<String>, ProveError> {
    let mut files = Vec::new();
    for part in CORE {
        list(root, &format!("kernel/src/{part}"), &mut files)?;
    }
    files.sort();
    Ok(files)
}

fn list(root: &Path, at: &str, files: &mut Vec<String>) -> Result<(), ProveError> {
    let path = root.join(at);
    if !path.is_dir() {
        files.push(at.to_owned());
        return Ok(());
    }
    let entries = fs::read_dir(&path).map_err(|error| ProveError::file(&path, error))?;
    for entry in entries {
        let entry = entry.map_err(|error| ProveError::file(&path, error))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if name != "tests" && name != "tests.rs" {
            list(root, &format!("{at}/{name}"), files)?;
        }
    }
    Ok(())
}

/// One hash of the safety core; comments and tests do not count.
///
/// # Errors
/// A source cannot be read.
pub fn core_sha256(root: &Path) -> Result<String, ProveError> {
    let files: Vec<PathBuf> = core_files(root)?
        .iter()
        .map(|file| root.join(file))
        .collect();
    let mut text = String::new();
    for file in &files {
        text += &sources::sha256(sources::read(file)?.as_bytes());
        text.push('\n');
    }
    Ok(sources::sha256(text.as_bytes()))
}

/// Figures are of the sources they began with, or of none.
fn still(root: &Path, before: &str) -> Result<(), ProveError> {
    if core_sha256(root)? == before {
        return Ok(());
    }
    Err(ProveError::Words(
        "the safety core changed while it was measured; nothing is kept".to_owned(),
    ))
}

fn read(root: &Path) -> Result<Measured, ProveError> {
    let path = root.join(FILE);
    if !path.exists() {
        return Ok(Measured::default());
    }
    let text = fs::read_to_string(&path).map_err(|error| ProveError::file(&path, error))?;
    serde_json::from_str(&text).map_err(|error| ProveError::file(&path, error.into()))
}

/// Replaces some of the figures.
fn keep(root: &Path, change: impl FnOnce(&mut Measured)) -> Result<(), ProveError> {
    let path = root.join(FILE);
    let mut measured = read(root)?;
    change(&mut measured);
    let mut text = serde_json::to_string_pretty(&measured)
        .map_err(|error| ProveError::file(&path, error.into()))?;
    text.push('\n');
    fs::write(&path, text).map_err(|error| ProveError::file(&path, error))
}

/// The version that a cargo command says it has; installs it where there is none.
fn tool(name: &str) -> Result<String, ProveError> {
    let asked = || {
        let said = Command::new("cargo")
            .args([name, "--version"])
            .output()
            .ok()?;
        let text = String::from_utf8_lossy(&said.stdout).trim().to_owned();
        (said.status.success() && !text.is_empty()).then_some(text)
    };
    if let Some(version) = asked() {
        return Ok(version);
    }
    let package = format!("cargo-{name}");
    println!("installing {package}");
    run(Command::new("cargo").args(["install", "--locked", &package]))?;
    asked().ok_or_else(|| ProveError::Words(format!("cargo {name} does not run")))
}

/// Runs a command to its end.
fn run(command: &mut Command) -> Result<(), ProveError> {
    let shown = format!("{command:?}");
    let status = command
        .status()
        .map_err(|error| ProveError::Words(format!("{shown}: {error}")))?;
    if status.success() {
        Ok(())
    } else {
        Err(ProveError::Words(format!("{shown}: {status}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prove::command::checkout;

    #[test]
    fn the_core_is_what_the_guard_needs_and_nothing_that_plans() {
        let files = core_files(&checkout()).expect("readable");
        assert!(files.iter().any(|file| file == "kernel/src/guard/tube.rs"));
        assert!(files.iter().any(|file| file == "kernel/src/stop/mod.rs"));
        assert!(
            !files
                .iter()
                .any(|file| file.contains("tests") || file.contains("dwa"))
        );
        assert!(files.iter().all(|file| checkout().join(file).is_file()));
    }

    fn figures() -> Coverage {
        Coverage {
            source_sha256: "00".repeat(32),
            tool: String::new(),
            lines: [1, 2],
            regions: [1, 2],
            files: BTreeMap::new(),
        }
    }

    fn stands(coverage: &Coverage, now: &str) -> Standing {
        let measured = Measured {
            coverage: Some(coverage.clone()),
            mutants: None,
        };
        Standing::of(measured, now)
    }

    #[test]
    fn figures_of_other_sources_are_stale() {
        let root = checkout();
        let standing = standing(&root).expect("readable");
        let now = core_sha256(&root).expect("readable");
        let mut coverage = figures();
        assert!(!stands(&coverage, &now).coverage_fresh);
        coverage.source_sha256.clone_from(&now);
        assert!(stands(&coverage, &now).coverage_fresh);
        if let Some(kept) = &standing.measured.coverage {
            assert_eq!(standing.coverage_fresh, kept.source_sha256 == now);
            assert!(kept.lines[0] <= kept.lines[1] && kept.lines[1] > 1000);
        }
        let Some(mutants) = standing.measured.mutants else {
            return;
        };
        assert_eq!(standing.mutants_fresh, mutants.source_sha256 == now);
        let sum =
            mutants.caught + mutants.timed_out + mutants.unviable + mutants.missed.len() as u64;
        assert_eq!(sum, mutants.tried[0]);
    }
}
