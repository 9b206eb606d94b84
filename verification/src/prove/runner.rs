//! Runs checks in parallel and turns what they did into ledger entries.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use super::check::{Check, Job, checks, proof_crate};
use super::engine::{Limits, Mode, Outcome, Program};
use super::harness::Harness;
use super::ledger::{Entry, Verdict};
use super::lemma;
use super::tools::{ProveError, Tools};
use super::translate::translate;

/// Address space of one model checker, MiB.
const MEMORY_MIB: u64 = 5000;

/// The tools and the compiled harnesses of one run.
struct Workshop<'a> {
    folder: &'a Path,
    cap: Duration,
    tools: Tools,
    versions: Vec<(String, String)>,
    program: Option<Program>,
}

/// Runs `wanted` and hands each entry to `keep` as soon as it is there.
///
/// # Errors
/// If the tools cannot be had or the harnesses do not build.
pub fn run_all(
    root: &Path,
    wanted: &[Check],
    folder: &Path,
    cap: Duration,
    keep: impl FnMut(Entry) -> Result<(), ProveError> + Send,
) -> Result<(), ProveError> {
    std::fs::create_dir_all(folder).map_err(|error| ProveError::file(folder, error))?;
    let shop = Workshop::open(root, wanted, folder, cap)?;
    let next = AtomicUsize::new(0);
    let kept = Mutex::new((0, keep, Ok(())));
    thread::scope(|scope| {
        for _ in 0..workers() {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(check) = wanted.get(index) else {
                        return;
                    };
                    let entry = shop.entry(check);
                    let Ok(mut kept) = kept.lock() else {
                        return;
                    };
                    kept.0 += 1;
                    report(&entry, kept.0, wanted.len());
                    let written = (kept.1)(entry);
                    if kept.2.is_ok() {
                        kept.2 = written;
                    }
                }
            });
        }
    });
    kept.into_inner()
        .map_err(|_| ProveError::Words("a worker has panicked".into()))?
        .2
}

/// As many as there are cores, and no more than memory allows.
fn workers() -> usize {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let free_mib = std::fs::read_to_string("/proc/meminfo")
        .ok()
        .and_then(|text| {
            let line = text
                .lines()
                .find(|line| line.starts_with("MemAvailable:"))?;
            line.split_whitespace().nth(1)?.parse::<u64>().ok()
        })
        .map_or(MEMORY_MIB, |kib| kib / 1024);
    let room = usize::try_from(free_mib / MEMORY_MIB).unwrap_or(1);
    cores.min(room).max(1)
}

fn report(entry: &Entry, number: usize, of: usize) {
    let word = match entry.verdict {
        Verdict::Holds => entry.means.to_string(),
        Verdict::Fails => "FAILS".into(),
        Verdict::Unknown => "UNKNOWN".into(),
    };
    println!(
        "[{number:3}/{of}] {word:18} {:5} s  {}",
        entry.seconds, entry.id
    );
    if entry.verdict != Verdict::Holds {
        println!("          {}", entry.twin);
    }
}

/// What became of harnesses that ought to fail.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refutation {
    /// One is violated: what, and where.
    Violated(String),
    /// All hold.
    None,
    /// No answer.
    Unknown(String),
}

/// Runs harnesses alone, without covers and twins, until one is violated.
///
/// # Errors
/// If the tools cannot be had or the harnesses do not build.
pub fn refute(
    root: &Path,
    wanted: &[Check],
    folder: &Path,
    cap: Duration,
) -> Result<Refutation, ProveError> {
    let shop = Workshop::open(root, wanted, folder, cap)?;
    let mut found = Refutation::None;
    for check in wanted {
        let Job::Harness(proof, _) = &check.job else {
            continue;
        };
        match shop.outcome(proof, Mode::Prove) {
            Outcome::Holds => {}
            Outcome::Violated(what, place) => {
                let place =
                    place.map_or_else(String::new, |(file, line)| format!(" at {file}:{line}"));
                return Ok(Refutation::Violated(format!(
                    "{}: {what}{place}",
                    proof.name
                )));
            }
            Outcome::Unknown(why) => found = Refutation::Unknown(why),
            Outcome::Unreached(_) => {}
        }
    }
    Ok(found)
}

impl<'a> Workshop<'a> {
    fn open(
        root: &Path,
        wanted: &[Check],
        folder: &'a Path,
        cap: Duration,
    ) -> Result<Self, ProveError> {
        let tools = Tools::ready(folder)?;
        let versions = tools.versions()?;
        let any = wanted
            .iter()
            .any(|check| matches!(check.job, Job::Harness(..)));
        let program = if any {
            println!("building the harnesses");
            let crate_folder = proof_crate(root);
            let translated = translate(&tools, &crate_folder.join("Cargo.toml"), folder)?;
            let all: Vec<Harness> = checks(root)?
                .into_iter()
                .filter_map(|check| match check.job {
                    Job::Harness(proof, twin) => Some([*proof, *twin]),
                    _ => None,
                })
                .flatten()
                .collect();
            Some(Program::compile(&tools, &translated, &all)?)
        } else {
            None
        };
        Ok(Self {
            folder,
            cap,
            tools,
            versions,
            program,
        })
    }

    fn entry(&self, check: &Check) -> Entry {
        let started = Instant::now();
        let (verdict, twin, reached, tools) = match &check.job {
            Job::Harness(proof, twin) => self.model_check(proof, twin),
            Job::Native(run) => native(*run),
            Job::Lemma(path, twin) => {
                let (verdict, words, count) = lemma::run(path, twin);
                (verdict, words, count, vec!["z3", "cvc5"])
            }
        };
        let used = |name: &String| name == "rustc" || tools.contains(&name.as_str());
        Entry {
            verdict,
            twin,
            reached,
            tools: self
                .versions
                .iter()
                .filter(|(name, _)| used(name))
                .map(|(name, version)| format!("{name} {version}"))
                .collect(),
            seconds: started.elapsed().as_secs(),
            ..check.entry.clone()
        }
    }

    fn outcome(&self, harness: &Harness, mode: Mode) -> Outcome {
        let limits = Limits {
            time: self.cap,
            memory_mib: MEMORY_MIB,
        };
        match &self.program {
            None => Outcome::Unknown("not compiled".into()),
            Some(program) => program
                .check(&self.tools, harness, mode, limits, self.folder)
                .unwrap_or_else(|error| Outcome::Unknown(error.to_string())),
        }
    }

    /// Twin first: a check that cannot fail is not worth its time.
    fn model_check(
        &self,
        proof: &Harness,
        twin: &Harness,
    ) -> (Verdict, String, u64, Vec<&'static str>) {
        let mut tools = vec!["wasm2c", "cbmc"];
        tools.extend(["kissat", "cadical"].iter().filter(|&&s| s == proof.solver));
        let (verdict, words, reached) = self.judged(proof, twin);
        (verdict, words, reached, tools)
    }

    fn judged(&self, proof: &Harness, twin: &Harness) -> (Verdict, String, u64) {
        let fell = match self.outcome(twin, Mode::Prove) {
            Outcome::Violated(_, Some((file, line))) => format!("twin panics at {file}:{line}"),
            Outcome::Unknown(why) => return (Verdict::Unknown, format!("twin: {why}"), 0),
            other => {
                return (
                    Verdict::Fails,
                    format!("the twin does not panic: {other:?}"),
                    0,
                );
            }
        };
        // Products are what costs time, and many proofs do not need them.
        let outcome = match self.outcome(proof, Mode::Coarse) {
            Outcome::Holds => Outcome::Holds,
            _ => self.outcome(proof, Mode::Prove),
        };
        match outcome {
            Outcome::Holds => {}
            Outcome::Violated(what, Some((file, line))) => {
                return (Verdict::Fails, format!("{what} at {file}:{line}"), 0);
            }
            Outcome::Unknown(why) => return (Verdict::Unknown, why, 0),
            other => return (Verdict::Fails, format!("{other:?}"), 0),
        }
        match self.outcome(proof, Mode::Cover) {
            Outcome::Unreached(open) if open.is_empty() => {
                (Verdict::Holds, fell, proof.covers.len() as u64)
            }
            Outcome::Unknown(why) => (Verdict::Unknown, format!("cover: {why}"), 0),
            other => (Verdict::Fails, format!("vacuous: {other:?}"), 0),
        }
    }
}

fn native(run: fn(bool) -> Result<u64, String>) -> (Verdict, String, u64, Vec<&'static str>) {
    let (verdict, words, reached) = match (run(true), run(false)) {
        (Ok(_), _) => (Verdict::Fails, "the twin does not fail".into(), 0),
        (_, Err(case)) => (Verdict::Fails, case, 0),
        (Err(case), Ok(cases)) => (Verdict::Holds, format!("twin fails: {case}"), cases),
    };
    (verdict, words, reached, Vec::new())
}
