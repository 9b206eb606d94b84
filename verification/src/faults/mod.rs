//! Seeded faults: each is put into a copy of the checkout, where a named check must fail.
//!
//! The chosen ones are in `list`; mutants drawn from elsewhere are read from
//! `verification/mutants.txt`, if that file exists. A fault that does not build is no fault and is
//! reported.

mod list;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::prove::tools::{ProveError, run};

/// One fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// File below `kernel/src`.
    pub file: &'static str,
    /// Text that occurs exactly once in what comes before the tests.
    pub from: &'static str,
    /// What stands there instead.
    pub to: &'static str,
    /// Part of the name of the proof that must catch it.
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
        // Faults live as long as the program; there are few.
        let text: &'static str = Box::leak(text.into_boxed_str());
        for block in text.split("\n\n").filter(|block| block.contains("file: ")) {
            all.push(drawn(block).ok_or_else(|| {
                ProveError::Words(format!("{}: not a fault:\n{block}", path.display()))
            })?);
        }
    }
    Ok(all)
}

/// A drawn fault: lines `file:`, `from:`, `to:`, `check:`; it lives as long as the program.
fn drawn(block: &'static str) -> Option<Fault> {
    let field = |name: &str| {
        block.lines().find_map(|line| {
            line.strip_prefix(name)
                .map(|rest| rest.trim_start_matches(' '))
        })
    };
    Some(Fault {
        file: field("file:")?,
        from: field("from:")?,
        to: field("to:")?,
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
) -> Result<Vec<(Fault, Fate)>, ProveError> {
    let copy = copied(root)?;
    let faults = all(root)?;
    let mut fates = Vec::new();
    for (index, fault) in faults.iter().enumerate() {
        if index % of != number - 1 {
            continue;
        }
        let fate = tried(&copy, fault)?;
        println!(
            "{fate:?}: {} `{}` -> `{}` by {}",
            fault.file,
            fault.from.trim(),
            fault.to.trim(),
            fault.check
        );
        fates.push((*fault, fate));
    }
    Ok(fates)
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

/// Puts the fault in, runs its check, takes it out again.
fn tried(copy: &Path, fault: &Fault) -> Result<Fate, ProveError> {
    let path = copy.join("kernel/src").join(fault.file);
    let whole = fs::read_to_string(&path).map_err(|error| ProveError::file(&path, error))?;
    let production = whole
        .split("#[cfg(test)]\nmod tests {")
        .next()
        .unwrap_or(&whole);
    if production.matches(fault.from).count() != 1 {
        return Ok(Fate::Invalid("its text does not occur exactly once".into()));
    }
    let write = |text: &str| fs::write(&path, text).map_err(|error| ProveError::file(&path, error));
    write(&whole.replacen(fault.from, fault.to, 1))?;
    let fate = checked(copy, fault.check);
    write(&whole)?;
    fate
}

fn checked(copy: &Path, check: &str) -> Result<Fate, ProveError> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command
        .args(["run", "--release", "--quiet", "-p", "haltline-verification"])
        .args(["--", "prove", check, "--cap", "120"])
        .current_dir(copy)
        .env("CARGO_TARGET_DIR", copy.join("target"));
    let output = command
        .output()
        .map_err(|error| ProveError::Start("cargo".into(), error))?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    // Unknown is no answer, and a kernel that does not build is no fault.
    let last = |text: &str| text.lines().last().unwrap_or_default().to_owned();
    Ok(match output.status.code() {
        Some(1) if said.contains("] FAILS") => Fate::Killed,
        Some(0) if said.contains(" 0 checks run") || said.starts_with("0 checks") => {
            Fate::Invalid("no such check".into())
        }
        Some(0) => Fate::Survived,
        _ => Fate::Invalid(last(&String::from_utf8_lossy(&output.stderr))),
    })
}
