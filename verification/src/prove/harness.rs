//! Finds the harnesses in the sources of the proof crate, with the attributes that Kani knows.

use std::fs;
use std::path::{Path, PathBuf};

use super::tools::ProveError;

/// One `#[kani::proof]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Harness {
    /// Name of the function.
    pub name: String,
    /// File, relative to the proof crate, with `/`.
    pub file: String,
    /// Line of the function, from 1.
    pub line: usize,
    /// First line of its documentation: what it proves.
    pub what: String,
    /// Requirements it is evidence for.
    pub requirements: Vec<String>,
    /// Bound of loops, if it has any.
    pub unwind: Option<u32>,
    /// The SAT solver; `minisat` unless told otherwise.
    pub solver: String,
    /// Whether it is a false twin, which must fail.
    pub twin: bool,
    /// Identities of its covers.
    pub covers: Vec<u32>,
}

/// The harnesses in `folder/src`, in the order of files and lines.
///
/// # Errors
/// If a file cannot be read, or a proof has no twin or no cover.
pub fn harnesses(folder: &Path) -> Result<Vec<Harness>, ProveError> {
    let mut files = Vec::new();
    rust_files(&folder.join("src"), &mut files)?;
    files.sort();
    let mut found = Vec::new();
    for path in files {
        let text = fs::read_to_string(&path).map_err(|error| ProveError::file(&path, error))?;
        let inner = path.strip_prefix(folder).unwrap_or(&path);
        let name = inner.to_string_lossy().replace('\\', "/");
        found.extend(in_file(&name, &text));
    }
    for proof in found.iter().filter(|harness| !harness.twin) {
        let place = format!("{}:{}: {}", proof.file, proof.line, proof.name);
        let twin = format!("{}_twin", proof.name);
        if !found.iter().any(|other| other.twin && other.name == twin) {
            return Err(ProveError::Words(format!(
                "{place} has no false twin '{twin}'"
            )));
        }
        if proof.covers.is_empty() {
            return Err(ProveError::Words(format!("{place} has no kani::cover!")));
        }
    }
    Ok(found)
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) -> Result<(), ProveError> {
    for entry in fs::read_dir(folder).map_err(|error| ProveError::file(folder, error))? {
        let path = entry
            .map_err(|error| ProveError::file(folder, error))?
            .path();
        if path.is_dir() {
            rust_files(&path, found)?;
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
    Ok(())
}

/// The text between the parentheses of an attribute like `#[kani::unwind(9)]`.
fn argument<'a>(line: &'a str, attribute: &str) -> Option<&'a str> {
    line.strip_prefix("#[kani::")?
        .strip_prefix(attribute)?
        .strip_prefix('(')?
        .split(')')
        .next()
}

fn in_file(file: &str, text: &str) -> Vec<Harness> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        if line.trim() != "#[kani::proof]" {
            continue;
        }
        // Documentation and citations before it, other attributes after it.
        let above = lines.get(..index).unwrap_or(&[]);
        let head: Vec<&str> = above
            .iter()
            .rev()
            .take_while(|line| line.starts_with("//"))
            .copied()
            .collect();
        let below = lines.get(index..).unwrap_or(&[]);
        let attributes = below.iter().take_while(|line| line.starts_with("#["));
        let length = attributes.clone().count();
        let Some(name) = below.get(length).and_then(|line| line.strip_prefix("fn ")) else {
            continue;
        };
        let name = name.split('(').next().unwrap_or_default().to_owned();
        let covers = covers_of(&lines, index + length)
            .into_iter()
            .map(|line| place(file, line))
            .collect();
        found.push(Harness {
            twin: attributes
                .clone()
                .any(|line| *line == "#[kani::should_panic]"),
            unwind: attributes
                .clone()
                .find_map(|line| argument(line, "unwind"))
                .and_then(|text| text.parse().ok()),
            solver: attributes
                .clone()
                .find_map(|line| argument(line, "solver"))
                .unwrap_or("minisat")
                .to_owned(),
            what: head
                .iter()
                .filter_map(|line| line.strip_prefix("/// "))
                .next_back()
                .unwrap_or_default()
                .to_owned(),
            requirements: head
                .iter()
                .rev()
                .filter_map(|line| line.strip_prefix("//= spec/"))
                .filter_map(|target| target.split('#').nth(1))
                .map(str::to_uppercase)
                .collect(),
            file: file.to_owned(),
            line: index + length + 1,
            name,
            covers,
        });
    }
    found
}

/// Lines (from 1) of the covers in the function that starts at index `start`, and in the functions
/// of the same file that it calls by name.
fn covers_of(lines: &[&str], start: usize) -> Vec<usize> {
    let body = |from: usize| {
        lines
            .iter()
            .enumerate()
            .skip(from)
            .take_while(|(_, line)| **line != "}")
    };
    let mut starts = vec![start];
    for (index, line) in lines.iter().enumerate() {
        let Some(rest) = line.strip_prefix("fn ") else {
            continue;
        };
        let name = rest.split(['(', '<']).next().unwrap_or_default();
        let is_called = body(start)
            .skip(1)
            .flat_map(|(_, line)| line.split(|c: char| !(c.is_alphanumeric() || c == '_')))
            .any(|word| word == name);
        if is_called {
            starts.push(index);
        }
    }
    starts
        .into_iter()
        .flat_map(body)
        .filter(|(_, line)| line.contains("kani::cover!("))
        .map(|(index, _)| index + 1)
        .collect()
}

/// A number for a place in the sources; the shim computes the same one.
#[must_use]
pub fn place(file: &str, line: usize) -> u32 {
    let hash = file.bytes().fold(0x811c_9dc5_u32, |hash, byte| {
        (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
    });
    (hash ^ u32::try_from(line).unwrap_or(0)).wrapping_mul(0x0100_0193)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_documentation_and_covers_are_found() {
        let text = "/// Holds.\n///\n/// More.\n//= spec/guard.md#guard-01\n//= type=proof\n\
                    #[kani::proof]\n#[kani::unwind(9)]\n#[kani::solver(kissat)]\nfn a() {\n\
                    \x20   kani::cover!(true);\n}\n\n#[kani::proof]\n#[kani::should_panic]\nfn a_twin() {\n}\n";
        let found = in_file("src/x.rs", text);
        assert_eq!(found.len(), 2);
        let a = &found[0];
        assert_eq!((a.name.as_str(), a.line, a.unwind), ("a", 9, Some(9)));
        assert_eq!(
            (a.what.as_str(), a.solver.as_str(), a.twin),
            ("Holds.", "kissat", false)
        );
        assert_eq!(a.requirements, ["GUARD-01"]);
        assert_eq!(a.covers, [place("src/x.rs", 10)]);
        assert!(found[1].twin && found[1].covers.is_empty());
    }
}
