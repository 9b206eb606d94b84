//! Bounded time, measured: instructions of the kernel's ticks under callgrind, against declared bounds.
//!
//! Counts do not depend on the machine's load, so they may gate; wall-clock times
//! may not and are left to `cargo bench`.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A scene of `kernel/benches/instructions.rs` and the most instructions it may take.
#[derive(Clone, Copy, Debug)]
pub struct Bound {
    /// Name of the scene.
    pub scene: &'static str,
    /// What is counted.
    pub what: &'static str,
    /// Declared bound.
    pub instructions: u64,
}

/// The declared bounds: about a third above what was measured when they were set, so that a
/// change of compiler does not trip them and a change of complexity does.
///
/// The slowest stated target executes 10⁹ instructions a second at the Seekur Jr's control
/// period of 40 ms, of which the kernel may use a tenth: 4 000 000 for the worst tick.
pub const BOUNDS: [Bound; 5] = [
    Bound {
        scene: "certify-typical",
        what: "one motion against 541 beams and 1000 remembered points in a corridor",
        instructions: 200_000,
    },
    Bound {
        scene: "certify-crowded",
        what: "one sharp turn with every point inside the tube's bounding box",
        instructions: 600_000,
    },
    Bound {
        scene: "refresh",
        what: "bringing all points to the newest pose",
        instructions: 250_000,
    },
    Bound {
        scene: "tick-typical",
        what: "a full shield tick in a corridor",
        instructions: 1_500_000,
    },
    Bound {
        scene: "tick-crowded",
        what: "a full shield tick with rings of returns closing in and the store full",
        instructions: 4_000_000,
    },
];

/// Why nothing was measured.
#[derive(Debug)]
pub enum TimingError {
    /// A program could not be started.
    Start(String, io::Error),
    /// A program failed (its words).
    Failed(String, String),
    /// callgrind printed no count.
    NoCount(String),
}

impl fmt::Display for TimingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start(program, error) => write!(
                f,
                "cannot start {program}: {error}; './ci.sh setup' installs what is missing"
            ),
            Self::Failed(program, words) => write!(f, "{program} failed:\n{words}"),
            Self::NoCount(words) => write!(f, "callgrind printed no count:\n{words}"),
        }
    }
}

impl std::error::Error for TimingError {}

fn words_of(command: &mut Command) -> Result<(String, String), TimingError> {
    let program = command.get_program().to_string_lossy().into_owned();
    let output = command
        .output()
        .map_err(|error| TimingError::Start(program.clone(), error))?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    if output.status.success() {
        Ok((text(&output.stdout), text(&output.stderr)))
    } else {
        Err(TimingError::Failed(program, text(&output.stderr)))
    }
}

/// Builds the benchmark program and returns its path.
///
/// # Errors
/// If cargo cannot be run or the program does not compile.
pub fn build() -> Result<PathBuf, TimingError> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command
        .args(["bench", "-p", "haltline", "--bench", "instructions"])
        .args(["--no-run", "--message-format=json"])
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."));
    let (messages, words) = words_of(&mut command)?;
    messages
        .lines()
        .filter(|line| line.contains("\"instructions\""))
        .filter_map(|line| line.split("\"executable\":\"").nth(1))
        .filter_map(|rest| rest.split('"').next())
        .next_back()
        .map(PathBuf::from)
        .ok_or(TimingError::Failed("cargo bench".into(), words))
}

/// Instructions of one scene.
///
/// # Errors
/// If valgrind cannot be run or prints no count.
pub fn count(program: &Path, scene: &str) -> Result<u64, TimingError> {
    let mut command = Command::new("valgrind");
    command
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .args(["--collect-atstart=no", "--toggle-collect=*measured*"])
        .arg(program)
        .arg(scene);
    let (_, words) = words_of(&mut command)?;
    words
        .lines()
        .find_map(|line| line.split("Collected :").nth(1))
        .and_then(|count| count.trim().parse().ok())
        .filter(|&count: &u64| count > 0)
        .ok_or(TimingError::NoCount(words))
}
