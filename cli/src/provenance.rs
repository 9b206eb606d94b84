//! What was compiled into this command, and hashes of what it reads.

use serde::Serialize;
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;

include!(concat!(env!("OUT_DIR"), "/provenance.rs"));

/// A file and the hash of its content.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FileHash {
    /// Path as named by the user, or from the root of the checkout.
    pub file: String,
    /// SHA-256, lower-case hexadecimal.
    pub sha256: String,
}

/// A place in the code that cites a requirement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Citation {
    /// File from the root of the checkout.
    pub file: &'static str,
    /// Line from 1.
    pub line: usize,
    /// Whether the place is in a test.
    pub is_test: bool,
}

/// SHA-256 as lower-case hexadecimal.
#[must_use]
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes)
        .iter()
        .fold(String::with_capacity(64), |mut hex, byte| {
            let _ = write!(hex, "{byte:02x}");
            hex
        })
}

/// Hashes of the kernel's sources as they were compiled.
#[must_use]
pub fn kernel_sources() -> Vec<FileHash> {
    KERNEL_SOURCES
        .iter()
        .map(|(file, hash)| FileHash {
            file: (*file).to_owned(),
            sha256: (*hash).to_owned(),
        })
        .collect()
}

/// One hash over a list of files: of the lines `sha256  file`, as `sha256sum` prints them.
#[must_use]
pub fn combined(files: &[FileHash]) -> String {
    let mut lines = String::new();
    for FileHash { file, sha256 } in files {
        let _ = writeln!(lines, "{sha256}  {file}");
    }
    sha256(lines.as_bytes())
}

/// Where code and tests cite a requirement (bare id).
#[must_use]
pub fn citations(id: &str) -> Vec<Citation> {
    CITATIONS
        .iter()
        .filter(|(cited, ..)| cited.eq_ignore_ascii_case(id))
        .map(|&(_, file, line, is_test)| Citation {
            file,
            line,
            is_test,
        })
        .collect()
}

/// Files of tests that cite a requirement of a family.
#[must_use]
pub fn tests_of_family(family: &str) -> Vec<&'static str> {
    let prefix = format!("{family}-");
    let mut files: Vec<&str> = CITATIONS
        .iter()
        .filter(|(id, _, _, is_test)| *is_test && id.starts_with(&prefix))
        .map(|(_, file, ..)| *file)
        .collect();
    files.sort_unstable();
    files.dedup();
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_that_cite_a_requirement_are_found() {
        let places = citations("ZONE-01");
        assert!(places.iter().any(|place| place.is_test), "{places:?}");
        assert!(places.iter().any(|place| !place.is_test), "{places:?}");
        assert!(citations("ZONE-99").is_empty());
    }

    #[test]
    fn hashes_are_those_of_the_tool_everybody_has() {
        // sha256sum of the empty file.
        assert_eq!(
            sha256(b""),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"
        );
    }

    #[test]
    fn the_kernel_that_was_compiled_is_listed() {
        let files = kernel_sources();
        assert!(files.iter().any(|f| f.file == "kernel/src/lib.rs"));
        assert!(files.iter().all(|f| f.sha256.len() == 64));
        let mut changed = files.clone();
        changed[0].sha256 = sha256(b"x");
        assert_ne!(combined(&files), combined(&changed));
    }
}
