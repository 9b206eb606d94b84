//! Lines of the safety core that tests run, by `cargo llvm-cov`.

use super::{Coverage, TESTS, core_files, core_sha256, keep, run, still, tool};
use crate::prove::tools::ProveError;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs the tests with counters, keeps and returns what they ran.
///
/// # Errors
/// A tool cannot be had, a test fails, or the report is not understood.
pub fn measure(root: &Path) -> Result<Coverage, ProveError> {
    let version = tool("llvm-cov")?;
    let source_sha256 = core_sha256(root)?;
    let report = root.join("target/coverage.json");
    let mut command = Command::new("cargo");
    command.envs(readers()?);
    command
        .current_dir(root)
        .args(["llvm-cov", "--release", "--json", "--summary-only"]);
    command.args([
        "--package",
        "haltline",
        "--package",
        "haltline-spec",
        "--output-path",
    ]);
    run(command.arg(&report).args(TESTS))?;
    let text = fs::read_to_string(&report).map_err(|error| ProveError::file(&report, error))?;
    let files = figures(root, &text)?;
    let sum = |part: usize| {
        files.values().fold([0, 0], |[ran, all]: [u64; 2], file| {
            [ran + file[part][0], all + file[part][1]]
        })
    };
    still(root, &source_sha256)?;
    let coverage = Coverage {
        source_sha256,
        tool: version,
        lines: sum(0),
        regions: sum(1),
        files: files
            .iter()
            .map(|(name, file)| (name.clone(), file[0]))
            .collect(),
    };
    keep(root, |measured| measured.coverage = Some(coverage.clone()))?;
    Ok(coverage)
}

/// Where the readers of counters are, which must be as new as the compiler that writes them: the toolchain's own, or
/// those of Debian's package for the same version of LLVM, installed if need be.
fn readers() -> Result<Vec<(&'static str, PathBuf)>, ProveError> {
    if std::env::var_os("LLVM_COV").is_some()
        || run(Command::new("rustup").args(["component", "add", "llvm-tools"])).is_ok()
    {
        return Ok(Vec::new());
    }
    let said = Command::new("rustc").arg("-vV").output();
    let said = said.map_err(|error| ProveError::Words(format!("rustc -vV: {error}")))?;
    let said = String::from_utf8_lossy(&said.stdout).into_owned();
    let version = said
        .lines()
        .find_map(|line| line.strip_prefix("LLVM version: "));
    let major = version
        .and_then(|version| version.split('.').next())
        .unwrap_or_default();
    let folder = PathBuf::from(format!("/usr/lib/llvm-{major}/bin"));
    if !folder.join("llvm-cov").exists() {
        let package = format!("llvm-{major}");
        println!("installing {package}");
        run(Command::new("apt-get").args(["install", "-qy", "--no-install-recommends", &package]))?;
    }
    Ok(vec![
        ("LLVM_COV", folder.join("llvm-cov")),
        ("LLVM_PROFDATA", folder.join("llvm-profdata")),
    ])
}

/// Lines and regions, run and all, of each file of the core.
fn figures(root: &Path, text: &str) -> Result<BTreeMap<String, [[u64; 2]; 2]>, ProveError> {
    let wrong = |what: &str| ProveError::Words(format!("the report of llvm-cov: {what}"));
    let report: Value = serde_json::from_str(text).map_err(|error| wrong(&error.to_string()))?;
    let entries = report["data"][0]["files"]
        .as_array()
        .ok_or_else(|| wrong("no files"))?;
    let mut found = BTreeMap::new();
    for name in core_files(root)? {
        let is_it = |entry: &&Value| {
            entry["filename"]
                .as_str()
                .is_some_and(|path| path.ends_with(&name))
        };
        // A file of declarations alone has nothing to run.
        let Some(entry) = entries.iter().find(is_it) else {
            continue;
        };
        let part = |kind: &str| {
            let summary = &entry["summary"][kind];
            Some([summary["covered"].as_u64()?, summary["count"].as_u64()?])
        };
        let both = part("lines")
            .zip(part("regions"))
            .ok_or_else(|| wrong("no summary"))?;
        found.insert(name, [both.0, both.1]);
    }
    if found.is_empty() {
        return Err(wrong("no file of the safety core"));
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prove::command::checkout;

    #[test]
    fn only_the_core_counts() {
        let file = |name: &str, covered: u64| {
            format!(
                r#"{{"filename":"/x/{name}","summary":{{"lines":{{"count":10,"covered":{covered}}},"regions":{{"count":4,"covered":2}}}}}}"#
            )
        };
        let [one, other] = [
            file("kernel/src/watch.rs", 7),
            file("kernel/src/dwa/arc.rs", 1),
        ];
        let text = format!(r#"{{"data":[{{"files":[{one},{other}]}}]}}"#);
        let found = figures(&checkout(), &text).expect("understood");
        assert_eq!(
            found,
            BTreeMap::from([("kernel/src/watch.rs".to_owned(), [[7, 10], [2, 4]])])
        );
        assert!(figures(&checkout(), "{}").is_err());
    }
}
