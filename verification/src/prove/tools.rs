//! Finds the programs a proof needs, or installs them.
//!
//! Debian's own packages where they exist; cbmc and the extra solvers come from a later release and
//! are unpacked into a folder of ours with the libraries they need, so nothing of the system changes.

use std::ffi::OsString;
use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Why nothing could be proved.
#[derive(Debug)]
pub enum ProveError {
    /// A program could not be started.
    Start(String, io::Error),
    /// A file could not be read or written.
    File(PathBuf, io::Error),
    /// A program failed; its words.
    Failed(String, String),
    /// Something else, in words.
    Words(String),
}

impl ProveError {
    pub(crate) fn file(path: &Path, error: io::Error) -> Self {
        Self::File(path.to_path_buf(), error)
    }
}

impl fmt::Display for ProveError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start(program, error) => write!(out, "cannot start {program}: {error}"),
            Self::File(path, error) => write!(out, "{}: {error}", path.display()),
            Self::Failed(program, words) => write!(out, "{program} failed:\n{words}"),
            Self::Words(words) => out.write_str(words),
        }
    }
}

impl std::error::Error for ProveError {}

/// Runs a program to its end.
///
/// # Errors
/// If it cannot be started or does not succeed.
pub fn run(command: &mut Command) -> Result<Output, ProveError> {
    let program = command.get_program().to_string_lossy().into_owned();
    let output = command
        .output()
        .map_err(|error| ProveError::Start(program.clone(), error))?;
    if output.status.success() {
        return Ok(output);
    }
    let mut words = String::from_utf8_lossy(&output.stderr).into_owned();
    words.push_str(&String::from_utf8_lossy(&output.stdout));
    Err(ProveError::Failed(program, words))
}

/// The programs of one run.
#[derive(Clone, Debug)]
pub struct Tools {
    /// wabt's translator.
    pub wasm2c: PathBuf,
    /// Folder of the unpacked later release.
    prefix: PathBuf,
}

/// Packages unpacked into the prefix; the libraries are those of the same release.
const PACKAGES: [&str; 8] = [
    "cbmc",
    "kissat",
    "cadical",
    "minisat",
    "libc6",
    "libgcc-s1",
    "libstdc++6",
    "zlib1g",
];
const SOURCE: &str = "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] \
                      http://deb.debian.org/debian trixie main\n";
const LIBRARIES: &str = "usr/lib/x86_64-linux-gnu";

impl Tools {
    /// Finds the tools, installing what is missing under `folder`.
    ///
    /// # Errors
    /// If something is missing and cannot be installed.
    pub fn ready(folder: &Path) -> Result<Self, ProveError> {
        let tools = Self {
            wasm2c: PathBuf::from("wasm2c"),
            prefix: folder.join("trixie"),
        };
        install_target()?;
        install_debian(&[("wasm2c", "wabt"), ("z3", "z3"), ("cvc5", "cvc5")])?;
        if !tools.prefix.join("usr/bin/cbmc").exists() {
            unpack(folder, &tools.prefix)?;
        }
        Ok(tools)
    }

    /// A command for a program of the prefix, with its own libraries.
    #[must_use]
    pub fn command(&self, program: &str) -> Command {
        let libraries = self.prefix.join(LIBRARIES);
        let mut command = Command::new(libraries.join("ld-linux-x86-64.so.2"));
        command.arg("--library-path").arg(self.library_path());
        command.arg(self.prefix.join("usr/bin").join(program));
        command
    }

    fn library_path(&self) -> OsString {
        let mut path = self.prefix.join(LIBRARIES).into_os_string();
        path.push(":");
        path.push(self.prefix.join("usr/lib"));
        path
    }

    /// A script that starts a solver of the prefix: cbmc wants a single word.
    ///
    /// # Errors
    /// If the script cannot be written.
    pub fn solver_script(&self, solver: &str) -> Result<PathBuf, ProveError> {
        let path = self.prefix.join(format!("{solver}.sh"));
        let command = self.command(solver);
        let words: Vec<String> = std::iter::once(command.get_program())
            .chain(command.get_args())
            .map(|word| format!("'{}'", word.to_string_lossy()))
            .collect();
        let quiet = if solver == "cadical" {
            "-q"
        } else {
            "--relaxed -q"
        };
        let text = format!("#!/bin/sh\nexec {} {quiet} \"$@\"\n", words.join(" "));
        if fs::read_to_string(&path).ok().as_deref() != Some(&text) {
            fs::write(&path, text).map_err(|error| ProveError::file(&path, error))?;
        }
        run(Command::new("chmod").arg("755").arg(&path))?;
        Ok(path)
    }

    /// Version of each tool, in a fixed order.
    ///
    /// # Errors
    /// If a tool cannot be asked.
    pub fn versions(&self) -> Result<Vec<(String, String)>, ProveError> {
        let first = |command: &mut Command, args: &[&str]| -> Result<String, ProveError> {
            let output = run(command.args(args))?;
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            Ok(text.lines().next().unwrap_or_default().trim().to_owned())
        };
        let rustc = first(&mut Command::new("rustc"), &["--version"])?;
        let mut found = vec![
            ("rustc".to_owned(), rustc),
            (
                "wasm2c".to_owned(),
                first(&mut Command::new(&self.wasm2c), &["--version"])?,
            ),
        ];
        for program in ["cbmc", "kissat", "cadical"] {
            found.push((
                program.to_owned(),
                first(&mut self.command(program), &["--version"])?,
            ));
        }
        found.push((
            "z3".to_owned(),
            first(&mut Command::new("z3"), &["--version"])?,
        ));
        found.push((
            "cvc5".to_owned(),
            first(&mut Command::new("cvc5"), &["--version"])?,
        ));
        Ok(found)
    }
}

fn install_target() -> Result<(), ProveError> {
    let listed = run(Command::new("rustc")
        .args(["--print", "target-libdir", "--target"])
        .arg("wasm32-unknown-unknown"));
    let there = listed
        .is_ok_and(|output| Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_dir());
    if !there {
        run(Command::new("rustup").args(["target", "add", "wasm32-unknown-unknown"]))?;
    }
    Ok(())
}

/// Installs Debian packages whose program cannot be found.
fn install_debian(wanted: &[(&str, &str)]) -> Result<(), ProveError> {
    let missing: Vec<&str> = wanted
        .iter()
        .filter(|(program, _)| !is_in_path(program))
        .map(|(_, package)| *package)
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    let root =
        run(Command::new("id").arg("-u")).is_ok_and(|output| output.stdout.starts_with(b"0\n"));
    let apt = |arguments: &[&str]| {
        let mut command = if root {
            Command::new("apt-get")
        } else {
            let mut command = Command::new("sudo");
            command.arg("apt-get");
            command
        };
        run(command.args(arguments).args(if arguments[0] == "install" {
            &missing[..]
        } else {
            &[]
        }))
    };
    apt(&["update", "-q"])?;
    apt(&["install", "-qy", "--no-install-recommends"])?;
    Ok(())
}

fn is_in_path(program: &str) -> bool {
    std::env::var_os("PATH").is_some_and(|path| {
        std::env::split_paths(&path).any(|folder| folder.join(program).is_file())
    })
}

/// Unpacks the packages of the later release with a private configuration of apt.
fn unpack(folder: &Path, prefix: &Path) -> Result<(), ProveError> {
    let apt = folder.join("apt");
    for inner in ["lists/partial", "cache/archives/partial", "debs"] {
        let path = apt.join(inner);
        fs::create_dir_all(&path).map_err(|error| ProveError::file(&path, error))?;
    }
    let list = apt.join("sources.list");
    fs::write(&list, SOURCE).map_err(|error| ProveError::file(&list, error))?;
    let private = |command: &mut Command| {
        for (key, value) in [
            ("Dir::Etc::SourceList", "sources.list"),
            ("Dir::State::Lists", "lists"),
            ("Dir::Cache", "cache"),
        ] {
            command
                .arg("-o")
                .arg(format!("{key}={}", apt.join(value).display()));
        }
        for option in [
            "Dir::Etc::SourceParts=/dev/null",
            "Dir::State::status=/dev/null",
            "APT::Sandbox::User=",
        ] {
            command.args(["-o", option]);
        }
    };
    let mut update = Command::new("apt-get");
    private(&mut update);
    run(update.args(["-q", "update"]))?;
    let mut download = Command::new("apt-get");
    private(&mut download);
    run(download
        .arg("download")
        .args(PACKAGES)
        .current_dir(apt.join("debs")))?;
    // Complete or not there at all: unpacked beside its place, then moved.
    let beside = folder.join("trixie-unpacking");
    for entry in fs::read_dir(apt.join("debs")).map_err(|error| ProveError::file(&apt, error))? {
        let path = entry.map_err(|error| ProveError::file(&apt, error))?.path();
        run(Command::new("dpkg").arg("-x").arg(path).arg(&beside))?;
    }
    fs::rename(&beside, prefix).map_err(|error| ProveError::file(prefix, error))
}
