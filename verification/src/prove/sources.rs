//! Which sources a proof speaks about: the kernel modules its file imports, and theirs in turn.
//!
//! Works on the text, so that a ledger can be checked in a second without building anything.
//! Comments and tests do not count: they change no proof.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};

use super::tools::ProveError;

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

/// Source text without comments, blank lines and test modules.
fn essence(text: &str) -> String {
    let mut out = String::new();
    let mut lines = text.lines().map(str::trim);
    while let Some(line) = lines.next() {
        if line == "#[cfg(test)]" {
            // A test module with a body is the last thing in a file.
            match lines.next() {
                Some(next) if next.ends_with(';') => continue,
                _ => break,
            }
        }
        if !line.is_empty() && !line.starts_with("//") {
            out.push_str(line);
            out.push('\n');
        }
    }
    out
}

/// Files of the kernel that `file` depends on, sorted; `file` itself is not among them.
///
/// # Errors
/// If a source cannot be read.
pub fn kernel_files(root: &Path, file: &Path) -> Result<BTreeSet<PathBuf>, ProveError> {
    let source = root.join("kernel/src");
    let mut found = BTreeSet::new();
    let mut open = imports(&source, &read(file)?, "haltline::", &[]);
    while let Some(path) = open.pop() {
        if !found.insert(path.clone()) {
            continue;
        }
        let text = read(&path)?;
        let module = module_of(&source, &path);
        open.extend(imports(&source, &text, "crate::", &[]));
        open.extend(imports(&source, &text, "self::", &module));
        let parent = module.split_last().map_or(&[][..], |(_, parent)| parent);
        open.extend(imports(&source, &text, "super::", parent));
        // A module's own private files belong to it.
        for line in text.lines().map(str::trim) {
            if let Some(name) = line
                .strip_prefix("mod ")
                .and_then(|rest| rest.strip_suffix(';'))
                && name != "tests"
            {
                let mut inner = module.clone();
                inner.push(name.to_owned());
                open.extend(file_of(&source, &inner));
            }
        }
    }
    Ok(found)
}

/// Essence of a source file.
pub(crate) fn read(path: &Path) -> Result<String, ProveError> {
    let text = fs::read_to_string(path).map_err(|error| ProveError::file(path, error))?;
    Ok(essence(&text))
}

/// Path of modules of a source file, for instance `["guard", "check"]`.
fn module_of(source: &Path, path: &Path) -> Vec<String> {
    let inner = path.strip_prefix(source).unwrap_or(path).with_extension("");
    inner
        .iter()
        .map(|part| part.to_string_lossy().into_owned())
        .filter(|part| part != "mod" && part != "lib")
        .collect()
}

/// The file of the longest prefix of `path` that is a module.
fn file_of(source: &Path, path: &[String]) -> Option<PathBuf> {
    (1..=path.len()).rev().find_map(|length| {
        let base = path[..length]
            .iter()
            .fold(source.to_path_buf(), |at, part| at.join(part));
        [base.with_extension("rs"), base.join("mod.rs")]
            .into_iter()
            .find(|file| file.is_file())
    })
}

/// Files named by paths that begin with `start`, as in `crate::guard::{hull::Hull, plan}`.
fn imports(source: &Path, text: &str, start: &str, base: &[String]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for (at, _) in text.match_indices(start) {
        let before = text[..at].chars().next_back();
        if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
            continue;
        }
        for path in paths(&text[at + start.len()..]) {
            let whole: Vec<String> = base.iter().cloned().chain(path).collect();
            found.extend(file_of(source, &whole));
        }
    }
    found
}

/// The paths at the beginning of `text`; one level of braces is opened.
fn paths(text: &str) -> Vec<Vec<String>> {
    let word = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let head: String = text.chars().take_while(|&c| word(c)).collect();
    let split = |path: &str| -> Vec<String> {
        path.split("::")
            .filter(|part| !part.is_empty())
            .map(str::to_owned)
            .collect()
    };
    let Some(inner) = text[head.len()..].strip_prefix('{') else {
        return vec![split(&head)];
    };
    let mut depth = 1_i32;
    let inside: String = inner
        .chars()
        .take_while(|&c| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            depth > 0
        })
        .collect();
    let mut out = Vec::new();
    let (mut item, mut depth) = (String::new(), 0_i32);
    for c in inside.chars().chain([',']) {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if c == ',' && depth == 0 {
            let first: String = item.trim().chars().take_while(|&c| word(c)).collect();
            let mut path = split(&head);
            path.extend(split(&first).into_iter().filter(|part| part != "self"));
            out.push(path);
            item.clear();
        } else {
            item.push(c);
        }
    }
    out
}

/// Hash of what a proof speaks about: its own file, the kernel files, and `options`.
///
/// # Errors
/// If a source cannot be read.
pub fn hash(
    root: &Path,
    own: &[PathBuf],
    kernel: &BTreeSet<PathBuf>,
    options: &str,
) -> Result<String, ProveError> {
    let mut text = format!("{options}\n");
    for path in own.iter().chain(kernel) {
        let name = path.strip_prefix(root).unwrap_or(path).display();
        let _ = writeln!(text, "{}  {name}", sha256(read(path)?.as_bytes()));
    }
    Ok(sha256(text.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
    }

    #[test]
    fn braces_are_opened_and_paths_end_where_they_end() {
        let words = |text| {
            paths(text)
                .into_iter()
                .map(|path| path.join("/"))
                .collect::<Vec<_>>()
        };
        assert_eq!(words("a::b::C;"), ["a/b/C"]);
        assert_eq!(words("a::{b::{X, Y}, self, c}; d"), ["a/b", "a", "a/c"]);
    }

    #[test]
    fn the_point_test_needs_the_guard_and_no_planner() {
        let root = root();
        let files = kernel_files(&root, &root.join("kernel/src/guard/check.rs")).unwrap();
        assert!(
            files.is_empty(),
            "no `haltline::` in the kernel itself: {files:?}"
        );
        let file = std::env::temp_dir().join(format!("uses-check-{}.rs", std::process::id()));
        fs::write(&file, "use haltline::guard::check::CloudPoint;\n").unwrap();
        let files = kernel_files(&root, &file).unwrap();
        fs::remove_file(&file).unwrap();
        let has = |name: &str| files.iter().any(|file| file.ends_with(name));
        assert!(
            has("guard/check.rs") && has("geometry/rect.rs") && has("arith.rs"),
            "{files:?}"
        );
        assert!(!has("dwa/mod.rs") && !has("kernel/mod.rs"), "{files:?}");
    }
}
