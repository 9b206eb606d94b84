//! Seeded faults: each is put into a copy of the checkout, where a named check must fail.
//!
//! The chosen ones are in `list`; mutants drawn from elsewhere are read from
//! `verification/mutants.txt`, if that file exists. A fault that does not build is no fault and is
//! reported.

mod list;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use crate::prove::check::{Check, Job, checks};
use crate::prove::runner::{Refutation, refute};
use crate::prove::tools::{ProveError, run};

/// After so much processor time a proof has no answer, which is no kill.
const CAP: Duration = Duration::from_secs(120);
/// A build with its test that takes so long, also on a busy machine, hangs.
const HANGS: &str = "30m";

/// One fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// File below `kernel/src`.
    pub file: &'static str,
    /// Text that occurs exactly once in what comes before the tests.
    pub from: &'static str,
    /// What stands there instead.
    pub to: &'static str,
    /// Part of the name of the proof that must catch it, or `test` and arguments of `cargo test`.
    pub check: &'static str,
}

/// What became of a fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fate {
    /// The check failed, as it must.
    Killed,
    /// The check passed: the fault lives.
    Survived,
    /// It could not be tried: why.
    Invalid(String),
}

/// All faults: the chosen ones, then those drawn from the mutants' list.
///
/// # Errors
/// If the file of drawn faults is not well formed.
pub fn all(root: &Path) -> Result<Vec<Fault>, ProveError> {
    let mut all = list::CHOSEN.to_vec();
    let path = root.join("verification/mutants.txt");
    if path.exists() {
        let text = fs::read_to_string(&path).map_err(|error| ProveError::file(&path, error))?;
        let text: &'static str = Box::leak(text.into_boxed_str());
        for block in text.split("\n\n").filter(|block| block.contains("file: ")) {
            all.push(drawn(block).ok_or_else(|| {
                ProveError::Words(format!("{}: not a fault:\n{block}", path.display()))
            })?);
        }
    }
    Ok(all)
}

/// A drawn fault: lines `file:`, `from:`, `to:`, `check:`, with `\n` for the end of a line.
fn drawn(block: &'static str) -> Option<Fault> {
    let field = |name: &str| {
        block.lines().find_map(|line| {
            line.strip_prefix(name)
                .map(|rest| rest.trim_start_matches(' '))
        })
    };
    // Faults live as long as the program; there are few.
    let lines =
        |text: &str| -> &'static str { Box::leak(text.replace("\\n", "\n").into_boxed_str()) };
    Some(Fault {
        file: field("file:")?,
        from: lines(field("from:")?),
        to: lines(field("to:")?),
        check: field("check:")?,
    })
}

/// Tries every fault of a shard (`number` of `of`, from 1); the fates, in order.
///
/// # Errors
/// If the copy cannot be made.
pub fn try_shard(
    root: &Path,
    (number, of): (usize, usize),
    filter: &str,
) -> Result<Vec<(Fault, Fate)>, ProveError> {
    let copy = copied(root)?;
    let mut fates = Vec::new();
    for (index, fault) in all(root)?.iter().enumerate() {
        let named = [fault.file, fault.check]
            .iter()
            .any(|name| name.contains(filter));
        if index % of != number - 1 || !named {
            continue;
        }
        let started = Instant::now();
        let fate = tried(&copy, fault)?;
        println!(
            "{:3} {fate:?} in {} s: {} `{}` -> `{}` by {}",
            index + 1,
            started.elapsed().as_secs(),
            fault.file,
            one_line(fault.from),
            one_line(fault.to),
            fault.check
        );
        fates.push((*fault, fate));
    }
    Ok(fates)
}

/// For a line of the report.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A copy of all tracked files, with the tools of the original.
fn copied(root: &Path) -> Result<PathBuf, ProveError> {
    let copy = root.join("target/faults/tree");
    let listed = run(Command::new("git").args(["ls-files"]).current_dir(root))?;
    for name in String::from_utf8_lossy(&listed.stdout).lines() {
        let (from, to) = (root.join(name), copy.join(name));
        if let Some(folder) = to.parent() {
            fs::create_dir_all(folder).map_err(|error| ProveError::file(folder, error))?;
        }
        // Unchanged files keep their times, so that nothing is built twice.
        let same = fs::read(&to).ok() == fs::read(&from).ok();
        if !same && from.is_file() {
            fs::copy(&from, &to).map_err(|error| ProveError::file(&to, error))?;
        }
    }
    let tools = root.join("target/prove/trixie");
    let link = copy.join("target/prove/trixie");
    if tools.exists() && !link.exists() {
        let folder = copy.join("target/prove");
        fs::create_dir_all(&folder).map_err(|error| ProveError::file(&folder, error))?;
        std::os::unix::fs::symlink(&tools, &link)
            .map_err(|error| ProveError::file(&link, error))?;
    }
    Ok(copy)
}

/// What comes before the tests of a file.
fn production(whole: &str) -> &str {
    whole
        .split("#[cfg(test)]\nmod tests {")
        .next()
        .unwrap_or(whole)
}

/// Puts the fault in, runs its check, takes it out again.
fn tried(copy: &Path, fault: &Fault) -> Result<Fate, ProveError> {
    let path = copy.join("kernel/src").join(fault.file);
    let whole = fs::read_to_string(&path).map_err(|error| ProveError::file(&path, error))?;
    if production(&whole).matches(fault.from).count() != 1 {
        return Ok(Fate::Invalid("its text does not occur exactly once".into()));
    }
    let write = |text: &str| fs::write(&path, text).map_err(|error| ProveError::file(&path, error));
    write(&whole.replacen(fault.from, fault.to, 1))?;
    let fate = checked(copy, fault.check);
    write(&whole)?;
    fate
}

/// The check on the broken copy: a test, or proofs.
fn checked(copy: &Path, check: &str) -> Result<Fate, ProveError> {
    if let Some(arguments) = check.strip_prefix("test ") {
        return tested(copy, arguments);
    }
    let wanted: Vec<Check> = checks(copy)?
        .into_iter()
        .filter(|found| found.entry.id.contains(check))
        .collect();
    if wanted.is_empty() {
        return Ok(Fate::Invalid("no such check".into()));
    }
    // Enumerations are machine code of the kernel, so they need a program with the fault in it.
    if wanted
        .iter()
        .any(|found| !matches!(found.job, Job::Harness(..)))
    {
        return proved(copy, check);
    }
    // The fault may break the build, which is no kill.
    Ok(
        match refute(copy, &wanted, &copy.join("target/prove"), CAP) {
            Ok(Refutation::Violated(_)) => Fate::Killed,
            Ok(Refutation::None) => Fate::Survived,
            Ok(Refutation::Unknown(why)) => Fate::Invalid(why),
            Err(error) => Fate::Invalid(last_line(&error.to_string())),
        },
    )
}

fn cargo(copy: &Path) -> Command {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new("timeout");
    command
        .args(["--signal=KILL", HANGS])
        .arg(cargo)
        .current_dir(copy)
        .env("CARGO_TARGET_DIR", copy.join("target"));
    command
}

fn last_line(text: &str) -> String {
    text.lines().last().unwrap_or_default().to_owned()
}

/// `cargo test` with these arguments, in the broken copy.
fn tested(copy: &Path, arguments: &str) -> Result<Fate, ProveError> {
    let output = cargo(copy)
        .args(["test", "--quiet"])
        .args(arguments.split(' '))
        .output()
        .map_err(|error| ProveError::Start("cargo".into(), error))?;
    let said = String::from_utf8_lossy(&output.stdout);
    let ran = said
        .lines()
        .any(|line| line.starts_with("running ") && !line.starts_with("running 0 "));
    Ok(match output.status.code() {
        Some(0) if ran => Fate::Survived,
        Some(0) => Fate::Invalid("no such test".into()),
        Some(101) if said.contains("test result: FAILED") => Fate::Killed,
        _ => Fate::Invalid(last_line(&String::from_utf8_lossy(&output.stderr))),
    })
}

/// The proofs of that name, by a runner built from the broken copy.
fn proved(copy: &Path, check: &str) -> Result<Fate, ProveError> {
    let output = cargo(copy)
        .args(["run", "--release", "--quiet", "-p", "haltline-verification"])
        .args(["--", "prove", check, "--cap", &CAP.as_secs().to_string()])
        .output()
        .map_err(|error| ProveError::Start("cargo".into(), error))?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    // Unknown is no answer, and a kernel that does not build is no fault.
    Ok(match output.status.code() {
        Some(1) if said.contains("] FAILS") => Fate::Killed,
        Some(0) => Fate::Survived,
        _ => Fate::Invalid(last_line(&String::from_utf8_lossy(&output.stderr))),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_in_the_list_become_lines() {
        let block =
            "file: a.rs\nfrom: x {\\n    y\nto: x {\\n    z\ncheck: test -p haltline --lib a";
        let fault = drawn(block).unwrap();
        assert_eq!((fault.from, fault.to), ("x {\n    y", "x {\n    z"));
        assert_eq!(fault.check, "test -p haltline --lib a");
        assert_eq!(drawn("file: a.rs\nfrom: x"), None);
    }

    #[test]
    fn every_fault_has_its_place_and_every_proof_named_exists() {
        let root = crate::prove::command::checkout();
        let known = checks(&root).unwrap();
        let all = all(&root).unwrap();
        assert!(all.len() >= 40);
        for fault in all {
            let path = root.join("kernel/src").join(fault.file);
            let text = fs::read_to_string(&path).unwrap();
            assert_eq!(
                production(&text).matches(fault.from).count(),
                1,
                "{fault:?}"
            );
            assert_ne!(fault.from, fault.to);
            assert!(
                fault.check.starts_with("test ")
                    || known
                        .iter()
                        .any(|check| check.entry.id.contains(fault.check)),
                "{fault:?}"
            );
        }
    }
}
