//! Records what was compiled: hashes of the kernel's sources, and where the code names requirements.
//!
//! The certificate must name the kernel that ran, not the one that lies on the disk later, so the
//! hashes are taken when the command is built. Nothing outside the checkout is read.

use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Folders whose Rust files may name requirements, relative to the root of the checkout.
const NAMING: [&str; 7] = [
    "kernel/src",
    "kernel/tests",
    "spec/tests",
    "scenarios/src/monitor",
    "scenarios/tests",
    "drives",
    "verification",
];

/// Families of requirements.
const FAMILIES: [&str; 10] = [
    "GUARD", "BRAKE", "LIMIT", "ZONE", "FRESH", "SILENT", "LATCH", "INPUT", "MEMORY", "TIME",
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR")?).join("..");
    let mut out = String::new();
    write_kernel_hashes(&root, &mut out)?;
    write_citations(&root, &mut out)?;
    write_scenarios(&root, &mut out)?;
    let target = PathBuf::from(std::env::var("OUT_DIR")?).join("provenance.rs");
    std::fs::write(target, out)?;
    Ok(())
}

fn write_kernel_hashes(root: &Path, out: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let mut files = vec!["kernel/Cargo.toml".to_owned()];
    list(root, "kernel/src", &mut files)?;
    files.sort();
    println!("cargo::rerun-if-changed=../kernel/Cargo.toml");
    out.push_str("pub const KERNEL_SOURCES: &[(&str, &str)] = &[\n");
    for file in files {
        let hash = Sha256::digest(std::fs::read(root.join(&file))?);
        let hex = hash.iter().fold(String::new(), |mut hex, byte| {
            let _ = write!(hex, "{byte:02x}");
            hex
        });
        writeln!(out, "    ({file:?}, {hex:?}),")?;
    }
    out.push_str("];\n");
    Ok(())
}

/// Every place in code or tests that names a requirement; `GUARD-01..05` names five.
fn write_citations(root: &Path, out: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let mut files = Vec::new();
    for folder in NAMING {
        list(root, folder, &mut files)?;
    }
    files.sort();
    files.dedup();
    out.push_str("pub const CITATIONS: &[(&str, &str, usize, bool)] = &[\n");
    for file in files.iter().filter(|file| file.ends_with(".rs")) {
        let is_test = file.contains("/tests");
        let text = std::fs::read_to_string(root.join(file))?;
        for (index, line) in text.lines().enumerate() {
            for id in ids(&line.to_uppercase()) {
                writeln!(out, "    ({id:?}, {file:?}, {}, {is_test}),", index + 1)?;
            }
        }
    }
    out.push_str("];\n");
    Ok(())
}

/// The requirement ids in a line of upper-case text.
fn ids(line: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for family in FAMILIES {
        for (at, _) in line.match_indices(family) {
            let after = &line.as_bytes()[at + family.len()..];
            let number = |bytes: &[u8]| match bytes {
                [a, b, ..] if a.is_ascii_digit() && b.is_ascii_digit() => {
                    Some((a - b'0') * 10 + (b - b'0'))
                }
                _ => None,
            };
            let Some(first) = after.strip_prefix(b"-").and_then(number) else {
                continue;
            };
            let last = after
                .get(3..)
                .and_then(|rest| number(rest.strip_prefix(b"..")?));
            found.extend((first..=last.unwrap_or(first)).map(|n| format!("{family}-{n:02}")));
        }
    }
    found.sort();
    found.dedup();
    found
}

/// The shipped scenarios, so that the command works outside a checkout.
fn write_scenarios(root: &Path, out: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let mut files = Vec::new();
    list(root, "scenarios/files", &mut files)?;
    files.sort();
    out.push_str("pub const EMBEDDED_SCENARIOS: &[(&str, &str)] = &[\n");
    for file in files.iter().filter(|file| file.ends_with(".toml")) {
        let text = std::fs::read_to_string(root.join(file))?;
        let stem = Path::new(file)
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy();
        writeln!(out, "    ({stem:?}, {text:?}),")?;
    }
    out.push_str("];\n");
    Ok(())
}

/// Adds all files below `folder`, as paths from the root with forward slashes.
fn list(root: &Path, folder: &str, files: &mut Vec<String>) -> std::io::Result<()> {
    let path = root.join(folder);
    if !path.is_dir() {
        return Ok(());
    }
    println!("cargo::rerun-if-changed=../{folder}");
    for entry in std::fs::read_dir(path)? {
        let entry = entry?;
        let name = format!("{folder}/{}", entry.file_name().to_string_lossy());
        if entry.file_type()?.is_dir() {
            list(root, &name, files)?;
        } else {
            files.push(name);
        }
    }
    Ok(())
}
