//! Files of the repository that name requirements, and the citations in them.

#![allow(dead_code)] // Each test uses a part of it.

use std::path::{Path, PathBuf};

/// Crates whose sources are read.
pub const CRATES: [&str; 10] = [
    "kernel",
    "spec",
    "scenarios",
    "robots",
    "cli",
    "verification",
    "drives",
    "maps",
    "pilots",
    "attack",
];

/// All files below `folder` with one of the endings; a folder that does not exist has none, and
/// what is built is no source.
pub fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for entry in entries {
        let path = entry.unwrap().path();
        if path.is_dir() && path.file_name().is_some_and(|name| name != "target") {
            found.extend(files(&path, endings));
        } else if path
            .extension()
            .is_some_and(|ending| endings.iter().any(|wanted| ending == *wanted))
        {
            found.push(path);
        }
    }
    found
}

/// The checkout.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Path, from the root, and text of every Rust source.
pub fn texts() -> Vec<(String, String)> {
    let root = root();
    let mut found: Vec<PathBuf> = CRATES
        .iter()
        .flat_map(|name| files(&root.join(name), &["rs"]))
        .collect();
    found.sort();
    found
        .into_iter()
        .map(|path| {
            let text = std::fs::read_to_string(&path).unwrap();
            let name = path.strip_prefix(&root).unwrap().to_string_lossy();
            (name.replace('\\', "/"), text)
        })
        .collect()
}

/// What a citation says about the line below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// It is what the requirement demands.
    Implementation,
    /// It is a test.
    Test,
    /// It is a harness.
    Proof,
    /// Something else.
    Other,
}

/// One citation in duvet's form.
#[derive(Clone, Debug)]
pub struct Citation {
    /// Requirement, in capitals.
    pub id: String,
    /// The specification's file, for instance `spec/guard.md`.
    pub of: String,
    /// File and line, from 1.
    pub place: (String, usize),
    /// What it claims to be.
    pub kind: Kind,
    /// The quotation as one line.
    pub quote: String,
    /// The first line below it that is neither comment nor attribute of a harness.
    pub below: String,
}

/// The citations of one file.
pub fn citations(name: &str, text: &str) -> Vec<Citation> {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let mut found = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        let target = line.strip_prefix("//= spec/");
        let Some((file, anchor)) = target.and_then(|target| target.split_once('#')) else {
            continue;
        };
        let mut rest = lines[index + 1..].iter().copied().peekable();
        let kind = match rest.next_if(|next| next.starts_with("//= type=")) {
            None => Kind::Implementation,
            Some("//= type=test") => Kind::Test,
            Some("//= type=proof") => Kind::Proof,
            Some(_) => Kind::Other,
        };
        let mut quote = Vec::new();
        while let Some(next) = rest.next_if(|next| next.starts_with("//# ")) {
            quote.push(&next[4..]);
        }
        let below = rest.find(|next| !next.starts_with("//") && !next.is_empty());
        found.push(Citation {
            id: anchor.to_uppercase(),
            of: format!("spec/{file}"),
            place: (name.to_owned(), index + 1),
            kind,
            quote: quote.join(" "),
            below: below.unwrap_or_default().to_owned(),
        });
    }
    found
}

/// From this line on, a file holds tests; files that are tests do from the first.
pub fn tests_from(name: &str, text: &str) -> usize {
    let is_test = name.contains("/tests/")
        || name.ends_with("tests.rs")
        || name.contains("/benches/")
        || name.contains("/examples/");
    if is_test {
        return 1;
    }
    let begin = text.lines().position(|line| line.trim() == "mod tests {");
    begin.map_or(usize::MAX, |index| index + 1)
}
