//! `haltline new`: files to start from.

use crate::failure::{Exit, Failure};
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write as _};
use std::path::Path;

/// Writes the commented robot template to a file that does not exist yet.
///
/// # Errors
/// The file exists, or cannot be written.
pub fn robot(path: &Path) -> Result<Exit, Failure> {
    // `create_new` leaves no moment in which somebody else's file could be overwritten.
    let opened = OpenOptions::new().write(true).create_new(true).open(path);
    let mut file = opened.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => Failure::input(format!(
            "{}: exists already and is not overwritten; name another file",
            path.display()
        )),
        _ => Failure::input(format!("{}: cannot be written: {error}", path.display())),
    })?;
    file.write_all(haltline_robots::template().as_bytes())
        .map_err(|error| Failure::write(path, &error))?;
    say!("wrote {}", path.display());
    say!(
        "Replace each value by that of your robot, then run: haltline certify {}",
        path.display()
    );
    Ok(Exit::Holds)
}
