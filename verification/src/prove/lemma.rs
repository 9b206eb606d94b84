//! Lemmas over the reals: each file must be unsatisfiable, its false twin satisfiable.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::check::{Blank, Check, Job, blank};
use super::ledger::{Means, Verdict};
use super::tools::ProveError;

/// Solvers that are asked, with their limits of processor time in seconds.
const SOLVERS: [(&str, u32); 2] = [("z3", 60), ("cvc5", 20)];

/// The lemmas in `spec/lemmas`.
pub(super) fn checks(root: &Path) -> Result<Vec<Check>, ProveError> {
    let folder = root.join("spec/lemmas");
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let mut files: Vec<PathBuf> = fs::read_dir(&folder)
        .map_err(|error| ProveError::file(&folder, error))?
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "smt2"))
        .collect();
    files.sort();
    let is_twin = |path: &PathBuf| path.to_string_lossy().ends_with(".false.smt2");
    files
        .iter()
        .filter(|path| !is_twin(path))
        .map(|path| check(root, path))
        .collect()
}

fn check(root: &Path, path: &Path) -> Result<Check, ProveError> {
    let twin = path.with_extension("false.smt2");
    let text = fs::read_to_string(path).map_err(|error| ProveError::file(path, error))?;
    if !twin.is_file() {
        let words = format!("{}: no false twin {}", path.display(), twin.display());
        return Err(ProveError::Words(words));
    }
    let field = |name: &str| -> Option<&str> {
        text.lines()
            .find_map(|line| line.strip_prefix(name).map(str::trim))
    };
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let claim = text.lines().next().unwrap_or_default();
    let requirements = field("; Requirements:").unwrap_or_default();
    let entry = blank(
        root,
        Blank {
            id: format!("lemma::{name}"),
            means: Means::Lemma,
            claim: claim.trim_start_matches("; ").to_owned(),
            requirements: requirements
                .split([',', ' '])
                .filter(|id| !id.is_empty())
                .map(str::to_owned)
                .collect(),
            place: format!("spec/lemmas/{name}.smt2:1"),
            bounds: "real numbers".into(),
            own: vec![path.to_path_buf(), twin.clone()],
            kernel: BTreeSet::new(),
        },
    )?;
    Ok(Check {
        entry,
        job: Job::Lemma(path.to_path_buf(), twin),
    })
}

/// What all solvers say about one file: `unsat`, `sat`, or anything else for no answer.
fn answers(path: &Path) -> Vec<(&'static str, String)> {
    SOLVERS
        .iter()
        .map(|(solver, seconds)| {
            let output = Command::new("sh")
                .args(["-c", &format!("ulimit -t {seconds}; exec {solver} \"$0\"")])
                .arg(path)
                .output();
            let word = output.map_or_else(
                |error| error.to_string(),
                |output| {
                    let text = String::from_utf8_lossy(&output.stdout).into_owned();
                    text.lines().next().unwrap_or("no answer").to_owned()
                },
            );
            (*solver, word)
        })
        .collect()
}

/// Verdict, words on lemma and twin, and the solvers that confirmed it.
pub(super) fn run(path: &Path, twin: &Path) -> (Verdict, String, u64) {
    let (ours, theirs) = (answers(path), answers(twin));
    let count = |answers: &[(&str, String)], wanted: &str| {
        answers.iter().filter(|(_, word)| word == wanted).count()
    };
    let words = |answers: &[(&str, String)]| {
        let each: Vec<String> = answers.iter().map(|(s, w)| format!("{s} {w}")).collect();
        each.join(", ")
    };
    let said = format!("lemma: {}; twin: {}", words(&ours), words(&theirs));
    let (proved, refuted) = (count(&ours, "unsat"), count(&ours, "sat"));
    let twin_falls = count(&theirs, "sat") > 0 && count(&theirs, "unsat") == 0;
    let verdict = if refuted > 0 || (proved > 0 && !twin_falls) {
        Verdict::Fails
    } else if proved > 0 {
        Verdict::Holds
    } else {
        Verdict::Unknown
    };
    (verdict, said, proved as u64)
}
