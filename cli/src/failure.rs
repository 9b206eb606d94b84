//! How the command ends: four exit codes, and an error that says what to do.

use std::fmt;
use std::path::Path;
use std::process::ExitCode;

/// The four ways to end (documented in `--help`, relied on by CI).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Exit {
    /// All claims hold, or the command did what was asked.
    Holds,
    /// A claim failed.
    ClaimFailed,
    /// The input cannot be used.
    BadInput,
    /// Something needed for a verdict is missing.
    NotCheckable,
}

impl Exit {
    /// The process exit code.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Holds => 0,
            Self::ClaimFailed => 1,
            Self::BadInput => 2,
            Self::NotCheckable => 3,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit.code())
    }
}

/// Why the command gave up before a verdict.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// How to end.
    pub exit: Exit,
    /// What is wrong, where, and what to do; no trailing full stop needed.
    pub message: String,
}

impl Failure {
    /// Unusable input.
    pub fn input(message: impl Into<String>) -> Self {
        Self {
            exit: Exit::BadInput,
            message: message.into(),
        }
    }

    /// Unusable input at a line of a file.
    pub fn line(file: &Path, line: usize, message: impl fmt::Display) -> Self {
        Self::input(format!("{}:{line}: {message}", file.display()))
    }

    /// A missing precondition of the verdict.
    pub fn not_checkable(message: impl Into<String>) -> Self {
        Self {
            exit: Exit::NotCheckable,
            message: message.into(),
        }
    }

    /// A file that cannot be read.
    pub fn read(file: &Path, error: &std::io::Error) -> Self {
        Self::input(format!("{}: cannot be read: {error}", file.display()))
    }

    /// A file that cannot be written: no verdict was recorded.
    pub fn write(file: &Path, error: &std::io::Error) -> Self {
        Self::not_checkable(format!("{}: cannot be written: {error}", file.display()))
    }
}

impl From<haltline_logs::LogError> for Failure {
    fn from(error: haltline_logs::LogError) -> Self {
        Self::input(error.message)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// Creates the output folder and tries it out, before the work whose results it is for.
///
/// # Errors
/// [`Exit::BadInput`] if no file can be written there.
pub fn prepare(out: &Path) -> Result<(), Failure> {
    let probe = out.join(format!(".haltline-{}", std::process::id()));
    std::fs::create_dir_all(out)
        .and_then(|()| std::fs::write(&probe, b""))
        .and_then(|()| std::fs::remove_file(&probe))
        .map_err(|error| {
            let shown = out.display();
            Failure::input(format!(
                "--out {shown}: cannot be written: {error}; name a folder that can be"
            ))
        })
}

/// Writes a file, creating its folder.
///
/// # Errors
/// [`Exit::NotCheckable`] with the path if the folder or the file cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|error| Failure::write(folder, &error))?;
    }
    std::fs::write(path, bytes).map_err(|error| Failure::write(path, &error))
}

/// Writes a file whole or not at all: under another name first, then renamed.
///
/// # Errors
/// [`Exit::BadInput`] if it cannot be written; nothing is left behind then.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let cannot = |error: &std::io::Error| {
        Failure::input(format!("{}: cannot be written: {error}", path.display()))
    };
    let Some(name) = path.file_name() else {
        return Err(Failure::input(format!(
            "{}: names no file to write",
            path.display()
        )));
    };
    let mut hidden = std::ffi::OsString::from(".");
    hidden.push(name);
    hidden.push(format!(".haltline-{}", std::process::id()));
    let unfinished = path.with_file_name(hidden);
    let written =
        std::fs::write(&unfinished, bytes).and_then(|()| std::fs::rename(&unfinished, path));
    written.map_err(|error| {
        let _ = std::fs::remove_file(&unfinished);
        cannot(&error)
    })
}
