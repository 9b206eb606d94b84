//! The command `prove`: what to run, and what the ledger says afterwards.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::check::{Check, checks, proof_crate};
use super::ledger::{Entry, Ledger, Verdict};
use super::runner::run_all;
use super::tools::ProveError;

/// Which engine runs the harnesses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// `cargo kani`, where it is installed.
    Kani,
    /// Our own: wasm, C, cbmc; with lemmas and enumerations.
    Cbmc,
    /// Both.
    All,
}

/// What the command line asks for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Only checks whose name contains this.
    pub filter: String,
    /// Which engine.
    pub engine: Engine,
    /// Only compare the ledger with the sources.
    pub check: bool,
    /// Only run what the ledger does not hold for the present sources.
    pub stale: bool,
    /// Run, and leave the ledger as it is; where the tools cannot be had, compare it only.
    pub again: bool,
    /// After so much processor time a run is unknown.
    pub cap: Duration,
}

/// The ledger of a checkout.
#[must_use]
pub fn ledger_file(root: &Path) -> PathBuf {
    root.join("verification/ledger.json")
}

/// The checkout this program was built from.
#[must_use]
pub fn checkout() -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.parent().unwrap_or(own).to_path_buf()
}

/// The entries that hold, of the present sources: what a certificate may cite.
///
/// # Errors
/// If sources or ledger cannot be read, or if one check is stale, missing, open or fails: a
/// certificate cites the whole ledger or nothing.
pub fn verified_fresh(root: &Path) -> Result<Vec<Entry>, ProveError> {
    standings(root)?
        .into_iter()
        .map(|standing| match standing {
            Standing::Fresh(entry) => Ok(entry),
            Standing::Stale(entry) => Err(format!("{} is stale", entry.id)),
            Standing::Open(entry) => Err(format!("{} does not hold: {}", entry.id, entry.twin)),
            Standing::Missing(id) => Err(format!("{id} is missing")),
        })
        .collect::<Result<_, _>>()
        .map_err(|words| ProveError::Words(format!("proof ledger: {words}")))
}

/// A check against what the ledger holds of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// The ledger says it holds, of the present sources.
    Fresh(Entry),
    /// The ledger speaks about other sources.
    Stale(Entry),
    /// The ledger says that it does not hold or is unknown.
    Open(Entry),
    /// The ledger does not know it.
    Missing(String),
}

/// Compares every check with the ledger; entries for which no check exists are an error.
///
/// # Errors
/// If sources or ledger cannot be read.
pub fn standings(root: &Path) -> Result<Vec<Standing>, ProveError> {
    let ledger = Ledger::read(&ledger_file(root))?;
    let all = checks(root)?;
    let known = |id: &str| all.iter().any(|check| check.entry.id == id);
    if let Some(orphan) = ledger.entries.iter().find(|entry| !known(&entry.id)) {
        let words = format!("ledger: nothing in the sources is called '{}'", orphan.id);
        return Err(ProveError::Words(words));
    }
    Ok(all
        .iter()
        .map(|check| match ledger.entry(&check.entry.id) {
            None => Standing::Missing(check.entry.id.clone()),
            Some(entry) if entry.hash != check.entry.hash => Standing::Stale(entry.clone()),
            Some(entry) if entry.verdict != Verdict::Holds => Standing::Open(entry.clone()),
            // A harness may have moved since; what it says has not changed.
            Some(entry) => Standing::Fresh(Entry {
                place: check.entry.place.clone(),
                ..entry.clone()
            }),
        })
        .collect())
}

/// Runs the command; exit code 0 if everything asked for holds, 1 if not, 3 if it cannot be run.
#[must_use]
pub fn command(options: &Options) -> ExitCode {
    let root = checkout();
    let outcome = if options.check {
        compare(&root)
    } else if options.again {
        again(&root, options)
    } else {
        prove(&root, options)
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(3)
        }
    }
}

fn compare(root: &Path) -> Result<bool, ProveError> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    let mut good = true;
    for standing in standings(root)? {
        match standing {
            Standing::Fresh(entry) => *counts.entry(entry.means.to_string()).or_default() += 1,
            Standing::Stale(entry) => {
                good = false;
                println!("STALE    {}", entry.id);
            }
            Standing::Open(entry) => {
                good = false;
                println!("{:8?} {}: {}", entry.verdict, entry.id, entry.twin);
            }
            Standing::Missing(id) => {
                good = false;
                println!("MISSING  {id}");
            }
        }
    }
    let words: Vec<String> = counts
        .iter()
        .map(|(means, n)| format!("{n} {means}"))
        .collect();
    println!("ledger, compared with the sources: {}", words.join(", "));
    if !good {
        println!(
            "to bring it up to date: cargo run --release -p haltline-verification -- prove --stale"
        );
    }
    Ok(good)
}

/// Runs everything without writing the ledger, or says that it could not and compares the ledger.
fn again(root: &Path, options: &Options) -> Result<bool, ProveError> {
    let started = Instant::now();
    match run_again(root, &options.filter, options.cap) {
        Ok(entries) => {
            let held = entries.iter().filter(|e| e.verdict == Verdict::Holds);
            let (held, all) = (held.count(), entries.len());
            println!(
                "RUN AGAIN: {held} of {all} checks hold, in {} s",
                started.elapsed().as_secs()
            );
            // What a certificate cites is the ledger, so that must speak of the same.
            Ok(compare(root)? && held == all && all > 0)
        }
        Err(error) => {
            println!("NOT RUN AGAIN: {error}");
            println!("the ledger is compared with the sources instead");
            compare(root)
        }
    }
}

/// Runs the checks whose names contain `filter` again and leaves the ledger alone.
///
/// # Errors
/// If the tools cannot be had or the harnesses do not build.
pub fn run_again(root: &Path, filter: &str, cap: Duration) -> Result<Vec<Entry>, ProveError> {
    let wanted: Vec<Check> = checks(root)?
        .into_iter()
        .filter(|check| check.entry.id.contains(filter))
        .collect();
    let mut entries = Vec::new();
    run_all(root, &wanted, &root.join("target/prove"), cap, |entry| {
        entries.push(entry);
        Ok(())
    })?;
    entries.sort_by(|a, b| a.id.cmp(&b.id));
    Ok(entries)
}

fn prove(root: &Path, options: &Options) -> Result<bool, ProveError> {
    let mut good = true;
    if options.engine != Engine::Cbmc {
        good &= by_kani(root, &options.filter)?;
    }
    if options.engine == Engine::Kani {
        return Ok(good);
    }
    let started = Instant::now();
    let path = ledger_file(root);
    let mut ledger = Ledger::read(&path)?;
    let all = checks(root)?;
    let holds = |check: &Check, ledger: &Ledger| {
        ledger
            .entry(&check.entry.id)
            .is_some_and(|entry| entry.hash == check.entry.hash && entry.verdict == Verdict::Holds)
    };
    let wanted: Vec<Check> = all
        .iter()
        .filter(|check| check.entry.id.contains(&options.filter))
        .filter(|check| !(options.stale && holds(check, &ledger)))
        .cloned()
        .collect();
    let folder = root.join("target/prove");
    ledger
        .entries
        .retain(|entry| all.iter().any(|check| check.entry.id == entry.id));
    run_all(root, &wanted, &folder, options.cap, |entry| {
        good &= entry.verdict == Verdict::Holds;
        ledger.put(entry);
        ledger.write(&path)
    })?;
    ledger.write(&path)?;
    let held = ledger
        .entries
        .iter()
        .filter(|e| e.verdict == Verdict::Holds)
        .count();
    println!(
        "{} checks run in {} s; the ledger has {held} of {} that hold",
        wanted.len(),
        started.elapsed().as_secs(),
        all.len()
    );
    Ok(good)
}

/// The same harnesses by the real Kani.
fn by_kani(root: &Path, filter: &str) -> Result<bool, ProveError> {
    let mut command = Command::new("cargo");
    command
        .args(["kani", "--manifest-path"])
        .arg(proof_crate(root).join("Cargo.toml"));
    if !filter.is_empty() {
        command.args(["--harness", filter]);
    }
    let status = command
        .status()
        .map_err(|error| ProveError::Start("cargo kani".into(), error))?;
    if status.code() == Some(101) {
        let words = "cargo kani is not installed; '--engine cbmc' needs nothing but Debian";
        return Err(ProveError::Words(words.into()));
    }
    Ok(status.success())
}
