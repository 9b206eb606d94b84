//! Does a release image of the kernel link without a panic handler?
//!
//! The image's panic handler calls a symbol that exists nowhere. Each exported
//! function is linked alone with unused sections dropped: if the link succeeds,
//! the optimiser has proved every panic of that function unreachable; if it fails
//! for that symbol, a panic is reachable.

use std::ffi::OsStr;
use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The symbol that does not exist.
const TRAP: &str = "__panic_reached";

/// What linking one function alone has shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Linked {
    /// No panic is reachable.
    PanicFree,
    /// The link failed because of the panic handler.
    PanicReachable,
    /// The link failed for another reason (the linker's words).
    Failed(String),
}

/// Why the check could not be made.
#[derive(Debug)]
pub enum ImageError {
    /// A program could not be started or a file not be written.
    Io(String, io::Error),
    /// Building the image failed (the compiler's words).
    Build(String),
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(what, error) => write!(f, "{what}: {error}"),
            Self::Build(words) => write!(f, "the image does not build:\n{words}"),
        }
    }
}

impl std::error::Error for ImageError {}

fn run(command: &mut Command) -> Result<std::process::Output, ImageError> {
    command
        .output()
        .map_err(|error| ImageError::Io(format!("cannot start {command:?}"), error))
}

/// A built image.
#[derive(Clone, Debug)]
pub struct Image {
    archive: PathBuf,
    folder: PathBuf,
}

impl Image {
    /// Builds the image into `folder`; `planted` adds the function that can panic.
    ///
    /// # Errors
    /// If cargo cannot be run or the image does not compile.
    pub fn build(folder: &Path, planted: bool) -> Result<Self, ImageError> {
        let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("image/Cargo.toml");
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut command = Command::new(cargo);
        command
            .args(["build", "--release", "--quiet", "--manifest-path"])
            .arg(manifest)
            .arg("--target-dir")
            .arg(folder)
            // The outer build's flags and coverage settings must not reach the image.
            .env_remove("RUSTFLAGS")
            .env_remove("CARGO_ENCODED_RUSTFLAGS");
        if planted {
            command.args(["--features", "planted-panic"]);
        }
        let output = run(&mut command)?;
        if !output.status.success() {
            let words = String::from_utf8_lossy(&output.stderr).into_owned();
            return Err(ImageError::Build(words));
        }
        Ok(Self {
            archive: folder.join("release/libhaltline_image.a"),
            folder: folder.to_path_buf(),
        })
    }

    /// Names of the exported functions, sorted.
    ///
    /// # Errors
    /// If `nm` cannot be run.
    pub fn functions(&self) -> Result<Vec<String>, ImageError> {
        let mut command = Command::new("nm");
        command
            .args(["--defined-only", "--extern-only"])
            .arg(&self.archive);
        let output = run(&mut command)?;
        let text = String::from_utf8_lossy(&output.stdout);
        let mut names: Vec<String> = text
            .lines()
            .filter_map(|line| line.split_whitespace().nth(2))
            .filter(|name| name.starts_with("image_"))
            .map(str::to_owned)
            .collect();
        names.sort();
        names.dedup();
        Ok(names)
    }

    /// Links `function` alone.
    ///
    /// # Errors
    /// If the C compiler cannot be run or the stub cannot be written.
    pub fn link(&self, function: &str) -> Result<Linked, ImageError> {
        let stub = self.folder.join(format!("{function}.c"));
        let text = format!(
            "extern void {function}(void);\nint main(void) {{ {function}(); return 0; }}\n"
        );
        fs::write(&stub, text)
            .map_err(|error| ImageError::Io(format!("cannot write {}", stub.display()), error))?;
        let out = self.folder.join(function);
        let mut command = Command::new("cc");
        command
            .args(["-O1", "-ffunction-sections", "-fdata-sections"])
            .args([stub.as_os_str(), self.archive.as_os_str()])
            .args(["-Wl,--gc-sections", "-o"].map(OsStr::new))
            .arg(&out);
        let output = run(&mut command)?;
        if output.status.success() {
            return Ok(Linked::PanicFree);
        }
        let words = String::from_utf8_lossy(&output.stderr).into_owned();
        Ok(if words.contains(TRAP) {
            Linked::PanicReachable
        } else {
            Linked::Failed(words)
        })
    }
}
