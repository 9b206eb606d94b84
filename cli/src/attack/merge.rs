//! Joining the shards of a campaign.

use crate::failure::{Exit, Failure, prepare, write_file};
use haltline_attack::record::{Find, Record};
use std::path::{Path, PathBuf};

/// Reads the records of all folders, copies the counterexamples, writes one record.
///
/// # Errors
/// A folder without a record, a record that is none, or shards that do not belong together.
pub(super) fn merge(folders: &[PathBuf], out: &Path) -> Result<Exit, Failure> {
    prepare(out)?;
    let mut joined: Option<Record> = None;
    let mut finds: Vec<(PathBuf, Find)> = Vec::new();
    for folder in folders {
        let record = read(folder)?;
        for find in record.violations.iter().chain(record.broken.values()) {
            // What a record says is a name in its own folder, never a way out of it.
            if Path::new(&find.file).file_name() != Some(find.file.as_ref()) {
                let why = format!("`{}` is no file name", find.file);
                return Err(Failure::input(format!("{}: {why}", folder.display())));
            }
            finds.push((folder.clone(), find.clone()));
        }
        joined = Some(match joined {
            None => record,
            Some(mut whole) => {
                whole
                    .join(record)
                    .map_err(|why| Failure::input(format!("{}: {why}", folder.display())))?;
                whole
            }
        });
    }
    let Some(whole) = joined else {
        return Err(Failure::input("name at least one folder"));
    };
    let kept = |file: &str| {
        let mut all = whole.violations.iter().chain(whole.broken.values());
        all.any(|find| find.file == file)
    };
    for (folder, find) in finds.iter().filter(|(_, find)| kept(&find.file)) {
        let from = folder.join(&find.file);
        let bytes = std::fs::read(&from).map_err(|error| Failure::read(&from, &error))?;
        write_file(&out.join(&find.file), &bytes)?;
    }
    super::finish(&whole, out)
}

fn read(folder: &Path) -> Result<Record, Failure> {
    let path = folder.join("attack.json");
    let text = std::fs::read_to_string(&path).map_err(|error| Failure::read(&path, &error))?;
    serde_json::from_str(&text)
        .map_err(|error| Failure::line(&path, error.line(), format!("is no record: {error}")))
}
