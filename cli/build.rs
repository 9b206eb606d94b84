//! Records what was compiled: hashes of the kernel's sources, and where the code names requirements.
//!
//! The certificate must name the kernel that ran, not the one that lies on the disk later, so the
//! hashes are taken when the command is built. Nothing outside the checkout is read.

use haltline_verification::measure;
use haltline_verification::prove::command::standings;
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Folders whose Rust files cite requirements, relative to the root of the checkout.
const CITING: [&str; 8] = [
    "kernel/src",
    "kernel/tests",
    "robots/src",
    "drives/src",
    "drives/tests",
    "spec/tests",
    "cli/src",
    "cli/tests",
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR")?).join("..");
    let mut out = String::new();
    write_kernel_hashes(&root, &mut out)?;
    write_citations(&root, &mut out)?;
    write_scenarios(&root, &mut out)?;
    write_proofs(&root, &mut out)?;
    write_measured(&root, &mut out)?;
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

/// Every line below a citation (`//= spec/FILE#ID`): of code, or of a test if it says so. Harnesses
/// are left to the ledger, which knows whether they hold.
fn write_citations(root: &Path, out: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let mut files = Vec::new();
    for folder in CITING {
        list(root, folder, &mut files)?;
    }
    files.sort();
    files.dedup();
    out.push_str("pub const CITATIONS: &[(&str, &str, usize, bool)] = &[\n");
    for file in files.iter().filter(|file| file.ends_with(".rs")) {
        let text = std::fs::read_to_string(root.join(file))?;
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        for (index, line) in lines.iter().enumerate() {
            let Some((_, id)) = line
                .strip_prefix("//= spec/")
                .and_then(|target| target.split_once('#'))
            else {
                continue;
            };
            let kind = lines.get(index + 1).copied().unwrap_or_default();
            if kind == "//= type=proof" {
                continue;
            }
            let is_comment = |line: &&&str| line.starts_with("//") || line.is_empty();
            let below = lines.iter().skip(index).take_while(is_comment).count();
            let (id, at) = (id.to_uppercase(), index + below + 1);
            let is_test = kind == "//= type=test";
            writeln!(out, "    ({id:?}, {file:?}, {at}, {is_test}),")?;
        }
    }
    out.push_str("];\n");
    Ok(())
}

/// How the proof ledger stands against the sources that are compiled now.
fn write_proofs(root: &Path, out: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=../verification/ledger.json");
    println!("cargo::rerun-if-changed=../spec/lemmas");
    let stood = standings(root).map_err(|error| error.to_string());
    let text = serde_json::to_string(&stood)?;
    writeln!(out, "pub const PROOF_STANDINGS: &str = {text:?};")?;
    Ok(())
}

/// How the figures of coverage and mutants stand against the sources that are compiled now.
fn write_measured(root: &Path, out: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=../{}", measure::FILE);
    let stood = measure::standing(root).map_err(|error| error.to_string())?;
    let text = serde_json::to_string(&stood)?;
    writeln!(out, "pub const MEASURED: &str = {text:?};")?;
    Ok(())
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
