//! Everything that can be proved, whatever the means, as one list of checks.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::harness::{Harness, harnesses};
use super::ledger::{Entry, Means, Verdict};
use super::sources::{hash, kernel_files};
use super::tools::ProveError;
use super::{lemma, native};

/// How a check is run.
#[derive(Clone, Debug)]
pub enum Job {
    /// A harness and its false twin, by model checking.
    Harness(Box<Harness>, Box<Harness>),
    /// A function that runs all cases, and its twin.
    Native(fn(bool) -> Result<u64, String>),
    /// A file for SMT solvers, and its twin.
    Lemma(PathBuf, PathBuf),
}

/// One thing to be shown.
#[derive(Clone, Debug)]
pub struct Check {
    /// What the ledger will say if it holds; verdict, twin and times are filled in by the run.
    pub entry: Entry,
    /// How it is run.
    pub job: Job,
}

/// The proof crate.
#[must_use]
pub fn proof_crate(root: &Path) -> PathBuf {
    root.join("verification/proofs")
}

/// All checks of a checkout, sorted by name, with the hashes of the present sources.
///
/// # Errors
/// If a source cannot be read or a harness is not well formed.
pub fn checks(root: &Path) -> Result<Vec<Check>, ProveError> {
    let mut found = model_checked(root)?;
    found.extend(native::checks(root)?);
    found.extend(lemma::checks(root)?);
    found.sort_by(|a, b| a.entry.id.cmp(&b.entry.id));
    Ok(found)
}

fn model_checked(root: &Path) -> Result<Vec<Check>, ProveError> {
    let folder = proof_crate(root);
    let all = harnesses(&folder)?;
    // What every harness rests on besides the kernel.
    let common = [
        "verification/proofs/Cargo.toml",
        "verification/proofs/shim/src/lib.rs",
        "verification/proofs/macros/src/lib.rs",
        "verification/src/prove/prelude.c",
    ];
    let mut found = Vec::new();
    for proof in all.iter().filter(|harness| !harness.twin) {
        let twin_name = format!("{}_twin", proof.name);
        let Some(twin) = all.iter().find(|other| other.name == twin_name) else {
            continue;
        };
        let twin = Harness {
            solver: proof.solver.clone(),
            unwind: proof.unwind,
            ..twin.clone()
        };
        let file = folder.join(&proof.file);
        let mut own: Vec<PathBuf> = common.iter().map(|name| root.join(name)).collect();
        own.push(file.clone());
        let bounds = match proof.unwind {
            None => format!("no loops; {}", proof.solver),
            Some(loops) => format!("loops up to {} rounds; {}", loops - 1, proof.solver),
        };
        let module = proof
            .file
            .trim_start_matches("src/")
            .trim_end_matches(".rs");
        found.push(Check {
            entry: blank(
                root,
                Blank {
                    id: format!("{}::{}", module.replace('/', "::"), proof.name),
                    means: Means::ModelChecked,
                    claim: proof.what.clone(),
                    requirements: proof.requirements.clone(),
                    place: format!("verification/proofs/{}:{}", proof.file, proof.line),
                    bounds,
                    own,
                    kernel: kernel_files(root, &file)?,
                },
            )?,
            job: Job::Harness(Box::new(proof.clone()), Box::new(twin)),
        });
    }
    Ok(found)
}

/// What is known of an entry before it is run.
pub(super) struct Blank {
    pub(super) id: String,
    pub(super) means: Means,
    pub(super) claim: String,
    pub(super) requirements: Vec<String>,
    pub(super) place: String,
    pub(super) bounds: String,
    pub(super) own: Vec<PathBuf>,
    pub(super) kernel: BTreeSet<PathBuf>,
}

/// An entry without a verdict.
pub(super) fn blank(root: &Path, of: Blank) -> Result<Entry, ProveError> {
    let name = |path: &PathBuf| {
        let inner = path.strip_prefix(root).unwrap_or(path);
        inner.to_string_lossy().replace('\\', "/")
    };
    Ok(Entry {
        hash: hash(root, &of.own, &of.kernel, &of.bounds)?,
        sources: of.kernel.iter().map(name).collect(),
        id: of.id,
        means: of.means,
        claim: of.claim,
        requirements: of.requirements,
        place: of.place,
        bounds: of.bounds,
        tools: Vec::new(),
        verdict: Verdict::Unknown,
        twin: "not run".into(),
        reached: 0,
        seconds: 0,
    })
}
