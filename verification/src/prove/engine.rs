//! Runs cbmc on one harness and reads its verdict.

use std::fs::{self, File};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::harness::Harness;
use super::tools::{ProveError, Tools, run};
use super::translate::Translated;
use super::wasm::Data;

/// Limits of one run of the model checker.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// After so much processor time of one process the answer is unknown.
    pub time: Duration,
    /// Address space, MiB.
    pub memory_mib: u64,
}

/// What one run has shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Every property holds, loops bounds included.
    Holds,
    /// A property is violated: what, and where in the Rust sources if it is a panic.
    Violated(String, Option<(String, u32)>),
    /// Covers that cannot be reached; empty if all can.
    Unreached(Vec<u32>),
    /// No answer: out of time or memory, or the tool failed.
    Unknown(String),
}

/// The meanings of the same C file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Panics are failures.
    Prove,
    /// The same, with any value for a 128-bit product: what holds here holds, what fails may hold.
    Coarse,
    /// Covers are asked for.
    Cover,
}

/// The compiled program, once for each mode.
#[derive(Clone, Debug)]
pub struct Program {
    prove: PathBuf,
    coarse: PathBuf,
    cover: PathBuf,
    data: Data,
}

/// Loops of the prelude that copy or fill memory; their lengths are constants.
const COPY_LOOPS: u32 = 2100;

impl Program {
    /// Compiles the translated harnesses, with an entry point for each.
    ///
    /// # Errors
    /// If the compiler fails.
    pub fn compile(
        tools: &Tools,
        translated: &Translated,
        harnesses: &[Harness],
    ) -> Result<Self, ProveError> {
        let mut text = fs::read_to_string(&translated.file)
            .map_err(|error| ProveError::file(&translated.file, error))?;
        let covers: Vec<String> = harnesses
            .iter()
            .flat_map(|harness| &harness.covers)
            .map(|id| format!("C({id}u)"))
            .collect();
        text.insert_str(0, &format!("#define COVERS {}\n", covers.join(" ")));
        for harness in harnesses {
            let name = &harness.name;
            text.push_str(&format!("void check_{name}(void) {{ w2c_{name}(0); }}\n"));
        }
        let source = translated.file.with_file_name("entries.c");
        fs::write(&source, text).map_err(|error| ProveError::file(&source, error))?;
        let compiled = |name: &str, defined: &str| -> Result<PathBuf, ProveError> {
            let out = source.with_file_name(format!("{name}.goto"));
            run(tools
                .command("goto-cc")
                .arg(defined)
                .args(["-c", "-o"])
                .arg(&out)
                .arg(&source))?;
            Ok(out)
        };
        Ok(Self {
            prove: compiled("prove", "-DMODE_PROVE")?,
            coarse: compiled("coarse", "-DCOARSE")?,
            cover: compiled("cover", "-DMODE_COVER")?,
            data: translated.data.clone(),
        })
    }

    /// Runs one harness in one mode; output is kept in `folder`.
    ///
    /// # Errors
    /// If a program cannot be started or a file not be written.
    pub fn check(
        &self,
        tools: &Tools,
        harness: &Harness,
        mode: Mode,
        limits: Limits,
        folder: &Path,
    ) -> Result<Outcome, ProveError> {
        let binary = match mode {
            Mode::Prove => &self.prove,
            Mode::Coarse => &self.coarse,
            Mode::Cover => &self.cover,
        };
        let unwind = harness.unwind.unwrap_or(1);
        let copies: Vec<String> = (0..5)
            .map(|loop_number| format!("copy_memory.{loop_number}:{COPY_LOOPS}"))
            .chain((0..2).map(|number| format!("fill_memory.{number}:{COPY_LOOPS}")))
            .chain(["split_put.0:5".to_owned()])
            .collect();
        let mut command = tools.command("cbmc");
        command
            .arg(binary)
            .args(["--function", &format!("check_{}", harness.name)])
            .args(["--no-standard-checks", "--bounds-check", "--slice-formula"])
            .args(["--unwind", &unwind.to_string()])
            .args(["--unwindset", &copies.join(",")])
            .args(["--max-field-sensitivity-array-size", "2048"]);
        match mode {
            Mode::Prove | Mode::Coarse => {
                command.args(["--unwinding-assertions", "--stop-on-fail", "--trace"])
            }
            Mode::Cover => command.arg("--no-unwinding-assertions"),
        };
        if harness.solver != "minisat" {
            let script = tools.solver_script(&harness.solver)?;
            command.arg("--external-sat-solver").arg(script);
        }
        let log = folder.join(format!("{}.{mode:?}.txt", harness.name));
        match limited(&command, limits, &log)? {
            Some(text) => Ok(self.verdict(harness, mode, &text)),
            None => Ok(Outcome::Unknown(format!(
                "no answer within {} s of processor time and {} MiB",
                limits.time.as_secs(),
                limits.memory_mib
            ))),
        }
    }

    fn verdict(&self, harness: &Harness, mode: Mode, text: &str) -> Outcome {
        let done = text.contains("VERIFICATION SUCCESSFUL");
        let failed = text.contains("VERIFICATION FAILED");
        if !done && !failed {
            let last = text.lines().rev().find(|line| !line.trim().is_empty());
            return Outcome::Unknown(last.unwrap_or("no output").trim().to_owned());
        }
        if mode == Mode::Cover {
            let is_open = |id: &u32| !text.contains(&format!("cover {id}u: FAILURE"));
            return Outcome::Unreached(harness.covers.iter().copied().filter(is_open).collect());
        }
        if done {
            return Outcome::Holds;
        }
        let violated = text
            .split("Violated property:")
            .nth(1)
            .map(|block| {
                block
                    .trim_start()
                    .lines()
                    .skip(1)
                    .take(1)
                    .collect::<String>()
            })
            .unwrap_or_default();
        let value = |name: &str| -> Option<u32> {
            let start = format!("{name}=");
            text.lines()
                .rev()
                .find_map(|line| line.trim().strip_prefix(&start))
                .and_then(|rest| rest.split(|c: char| !c.is_ascii_digit()).next())
                .and_then(|digits| digits.parse().ok())
        };
        let place = || {
            let (file, length) = (value("panic_file")?, value("panic_length")?);
            let file = self.data.text(file, length)?;
            // The proof crate's own files are named from its root.
            let crate_root = if file.starts_with("src/") {
                "verification/proofs/"
            } else {
                ""
            };
            Some((format!("{crate_root}{file}"), value("panic_line")?))
        };
        let violated = violated.trim().to_owned();
        let place = if violated == "panic" { place() } else { None };
        Outcome::Violated(violated, place)
    }
}

/// A busy machine may take this many times longer than the processor time of a run.
const PATIENCE: u32 = 10;

/// Runs a command under limits; `None` if it ran out of time.
///
/// Time is that of the processor, so that what else the machine does decides no verdict.
fn limited(command: &Command, limits: Limits, log: &Path) -> Result<Option<String>, ProveError> {
    let file = File::create(log).map_err(|error| ProveError::file(log, error))?;
    let errors = file
        .try_clone()
        .map_err(|error| ProveError::file(log, error))?;
    let mut child = Command::new("sh")
        .arg("-c")
        .arg(format!(
            "ulimit -v {}; ulimit -t {}; exec nice -n 10 \"$0\" \"$@\"",
            limits.memory_mib * 1024,
            limits.time.as_secs()
        ))
        .arg(command.get_program())
        .args(command.get_args())
        .stdin(Stdio::null())
        .stdout(file)
        .stderr(errors)
        .process_group(0)
        .spawn()
        .map_err(|error| ProveError::Start("cbmc".into(), error))?;
    let started = Instant::now();
    loop {
        let ended = child
            .try_wait()
            .map_err(|error| ProveError::Start("cbmc".into(), error))?;
        match ended {
            // Ended by a signal: the limit.
            Some(status) if status.code().is_none() => return Ok(None),
            Some(_) => break,
            None => {}
        }
        if started.elapsed() > limits.time * PATIENCE {
            // The solver may be a child of its own: the whole group ends.
            let _ = Command::new("kill")
                .args(["-KILL", "--", &format!("-{}", child.id())])
                .status();
            let _ = child.wait();
            return Ok(None);
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    fs::read_to_string(log)
        .map(Some)
        .map_err(|error| ProveError::file(log, error))
}
