//! From text to scenarios: parsing, checking, and the variants of a sweep.

use std::fs;
use std::path::Path;

use toml::{Table, Value};

use super::check::check;
use super::places::Places;
use super::{Scenario, ScenarioError};
use crate::sweep::combinations;

/// Reads all `*.toml` of a directory, in the order of their names.
///
/// # Errors
/// The directory cannot be read, holds no scenario, or a file is wrong.
pub fn load_dir(dir: &Path) -> Result<Vec<Scenario>, ScenarioError> {
    let shown = dir.display().to_string();
    let listing = fs::read_dir(dir).map_err(|error| {
        ScenarioError::whole(
            &shown,
            format!("cannot be read ({error}); name a directory of scenario files"),
        )
    })?;
    let mut files: Vec<_> = listing
        .filter_map(Result::ok)
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .collect();
    files.sort();
    let mut scenarios = Vec::new();
    for file in &files {
        scenarios.extend(load_file(file)?);
    }
    if scenarios.is_empty() {
        let message = "holds no scenario; write at least one file that ends in .toml";
        return Err(ScenarioError::whole(&shown, message.to_owned()));
    }
    Ok(scenarios)
}

/// Reads one file; a sweep gives several scenarios.
///
/// # Errors
/// The file cannot be read or is wrong.
pub fn load_file(path: &Path) -> Result<Vec<Scenario>, ScenarioError> {
    let file = path.display().to_string();
    let stem = path
        .file_stem()
        .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let text = fs::read_to_string(path).map_err(|error| {
        ScenarioError::whole(
            &file,
            format!("cannot be read ({error}); name a scenario file in UTF-8"),
        )
    })?;
    parse(&text, &file, &stem)
}

/// Parses the text of a file whose stem is `stem`.
///
/// # Errors
/// Unknown keys, wrong types, impossible numbers or combinations.
pub fn parse(text: &str, file: &str, stem: &str) -> Result<Vec<Scenario>, ScenarioError> {
    let mut base: Scenario = toml::from_str(text)
        .map_err(|error| ScenarioError::at(file, text, error.span(), error.message().to_owned()))?;
    check(&base).map_err(|(span, message)| ScenarioError::at(file, text, span, message))?;
    base.group = stem.to_owned();
    base.name = stem.to_owned();
    base.places = Places::new(&base, file, text);
    if base.sweep.is_empty() {
        return Ok(vec![base]);
    }
    let table: Table = toml::from_str(text)
        .map_err(|error| ScenarioError::at(file, text, error.span(), error.message().to_owned()))?;
    let place = base.sweep.first().map(toml::Spanned::span);
    let axes: Vec<_> = base.sweep.iter().map(|axis| axis.get_ref()).collect();
    let wrong = |message: String| ScenarioError::at(file, text, place.clone(), message);
    combinations(&axes)
        .into_iter()
        .map(|variant| {
            let label = variant.label;
            let mut varied = Value::Table(table.clone());
            for (path, value) in variant.settings {
                set(&mut varied, &path, value).map_err(|what| wrong(format!("{label}: {what}")))?;
            }
            let mut scenario = reread(&varied).map_err(|what| wrong(format!("{label}: {what}")))?;
            check(&scenario).map_err(|(_, what)| wrong(format!("{label}: {what}")))?;
            scenario.group = stem.to_owned();
            scenario.name = format!("{stem}/{label}");
            scenario.places = base.places.clone();
            Ok(scenario)
        })
        .collect()
}

/// Through text once more, because places in a file are only known to the text parser.
fn reread(value: &Value) -> Result<Scenario, String> {
    let text = toml::to_string(value).map_err(|error| error.to_string())?;
    toml::from_str(&text).map_err(|error| error.message().to_owned())
}

/// Puts `value` at a dotted path, which must exist already.
fn set(root: &mut Value, path: &str, value: Value) -> Result<(), String> {
    let mut place = root;
    for part in path.split('.') {
        let next = match place {
            Value::Table(table) => table.get_mut(part),
            Value::Array(array) => part
                .parse::<usize>()
                .ok()
                .and_then(|index| array.get_mut(index)),
            _ => None,
        };
        place = next.ok_or_else(|| {
            format!("path `{path}` does not exist at `{part}`; write the value into the file first")
        })?;
    }
    *place = value;
    Ok(())
}
