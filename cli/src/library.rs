//! Finding robots and scenarios: the user's files first, then those that come with the program.

use crate::failure::Failure;
use crate::provenance::{self, EMBEDDED_SCENARIOS, FileHash};
use haltline_robots::Robot;
use haltline_scenarios::file::{Scenario, load_dir, load_file, parse};
use std::path::{Path, PathBuf};

/// Where the shipped scenarios lie in a checkout.
pub const SCENARIO_FOLDER: &str = "scenarios/files";
/// Where the shipped robots lie in a checkout.
const ROBOT_FOLDER: &str = "robots";

/// Reads a robot file.
///
/// # Errors
/// Unusable input with file and line.
pub fn robot(path: &Path) -> Result<Robot, Failure> {
    Robot::load(path).map_err(|error| Failure::input(error.to_string()))
}

/// The robot of that name: from `robots/` of the checkout, else as it comes with the program.
///
/// # Errors
/// There is no such robot, or its file is unusable.
pub fn robot_by_name(name: &str) -> Result<Robot, Failure> {
    let path = PathBuf::from(ROBOT_FOLDER).join(format!("{name}.toml"));
    if path.is_file() {
        return robot(&path);
    }
    Robot::embedded(name).map_err(|error| Failure::input(error.to_string()))
}

/// Name by which scenarios call a robot: the stem of its file.
#[must_use]
pub fn robot_name(robot: &Robot) -> String {
    let stem = Path::new(&robot.file).file_stem();
    stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}

/// Scenarios, the files they came from, and the folder to name in commands.
pub struct Library {
    /// All scenarios, sweeps unfolded.
    pub scenarios: Vec<Scenario>,
    /// Hash of each file, in the order of their names.
    pub files: Vec<FileHash>,
    /// Folder of the files.
    pub folder: String,
}

/// All scenarios of a folder, or those that come with the program.
///
/// # Errors
/// The folder cannot be read, holds no scenario, or a file is wrong.
pub fn scenarios(folder: Option<&Path>) -> Result<Library, Failure> {
    let shipped = Path::new(SCENARIO_FOLDER);
    match folder.or(Some(shipped).filter(|shipped| shipped.is_dir())) {
        Some(folder) => from_folder(folder),
        None => embedded(),
    }
}

fn from_folder(folder: &Path) -> Result<Library, Failure> {
    let scenarios = load_dir(folder).map_err(|error| Failure::input(error.to_string()))?;
    let listing = std::fs::read_dir(folder).map_err(|error| Failure::read(folder, &error))?;
    let mut paths: Vec<PathBuf> = listing
        .filter_map(Result::ok)
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .collect();
    paths.sort();
    let files = paths
        .iter()
        .map(|path| {
            let bytes = std::fs::read(path).map_err(|error| Failure::read(path, &error))?;
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            Ok(FileHash {
                file: name.into_owned(),
                sha256: provenance::sha256(&bytes),
            })
        })
        .collect::<Result<_, Failure>>()?;
    Ok(Library {
        scenarios,
        files,
        folder: folder.display().to_string(),
    })
}

fn embedded() -> Result<Library, Failure> {
    let mut scenarios = Vec::new();
    for (stem, text) in EMBEDDED_SCENARIOS {
        let found = parse(text, &format!("{stem}.toml"), stem)
            .map_err(|error| Failure::input(error.to_string()))?;
        scenarios.extend(found);
    }
    Ok(Library {
        scenarios,
        files: EMBEDDED_SCENARIOS
            .iter()
            .map(|(stem, text)| FileHash {
                file: format!("{stem}.toml"),
                sha256: provenance::sha256(text.as_bytes()),
            })
            .collect(),
        folder: SCENARIO_FOLDER.to_owned(),
    })
}

/// One scenario of a file: the variant asked for, else the first.
///
/// # Errors
/// The file is wrong, or has no such variant; the message lists those it has.
pub fn scenario(path: &Path, variant: Option<&str>) -> Result<(Scenario, usize), Failure> {
    let all = if path.is_file() || !is_shipped(path) {
        load_file(path)
    } else {
        shipped(path)
    }
    .map_err(|error| Failure::input(error.to_string()))?;
    let count = all.len();
    let label = |scenario: &Scenario| {
        let prefix = format!("{}/", scenario.group);
        scenario.name.strip_prefix(&prefix).map(str::to_owned)
    };
    let labels: Vec<String> = all.iter().filter_map(label).collect();
    let found = match variant {
        None => all.into_iter().next(),
        Some(wanted) => all
            .into_iter()
            .find(|one| label(one).as_deref() == Some(wanted) || one.name == wanted),
    };
    found.map(|scenario| (scenario, count)).ok_or_else(|| {
        let known = if labels.is_empty() {
            "it is a single scenario".to_owned()
        } else {
            format!("it has {}", labels.join(", "))
        };
        let wanted = variant.unwrap_or_default();
        Failure::input(format!(
            "{}: no variant `{wanted}`; {known}",
            path.display()
        ))
    })
}

/// Whether a path that does not exist names a scenario that comes with the program.
fn is_shipped(path: &Path) -> bool {
    path.starts_with(SCENARIO_FOLDER) && shipped_text(path).is_some()
}

fn shipped_text(path: &Path) -> Option<(&'static str, &'static str)> {
    let stem = path.file_stem()?.to_str()?;
    EMBEDDED_SCENARIOS
        .iter()
        .copied()
        .find(|(known, _)| *known == stem)
}

fn shipped(path: &Path) -> Result<Vec<Scenario>, haltline_scenarios::file::ScenarioError> {
    shipped_text(path).map_or_else(
        || load_file(path),
        |(stem, text)| parse(text, &path.display().to_string(), stem),
    )
}
