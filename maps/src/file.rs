//! Reading and writing the two files of a map.

use crate::Map;
use crate::error::{MapError, shown};
use crate::pgm::{BYTES_MAX, CELLS_PER_SIDE_MAX, parse_pgm, render_pgm};
use crate::yaml::{Description, RESOLUTIONS_M, parse_yaml, render_yaml};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Longest YAML file, bytes.
const YAML_MAX: usize = 64 * 1024;

/// Reads the map that the YAML file at `path` describes; the picture is looked for beside it.
///
/// # Errors
/// Files that cannot be read, are not regular files, or are refused by
/// [`parse_yaml`] or [`parse_pgm`].
pub fn load(path: &Path) -> Result<Map, MapError> {
    let name = path.display().to_string();
    let bytes = read(path, YAML_MAX)?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let before = error.as_bytes().get(..valid).unwrap_or_default();
        let line = before.iter().filter(|byte| **byte == b'\n').count() + 1;
        MapError::new(
            &name,
            line,
            "is not UTF-8 text",
            "name the YAML file of the map",
        )
    })?;
    let description = parse_yaml(&text, &name)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let picture_path = folder.join(&description.image);
    let bytes = read(&picture_path, BYTES_MAX)?;
    let picture = parse_pgm(&bytes, &picture_path.display().to_string())?;
    Ok(Map::from_picture(&picture, &description))
}

/// Writes the map as `path` (which should end in `.yaml`) and a `.pgm` of the same name beside it.
///
/// # Errors
/// A map whose cells are not `width * height` within [`CELLS_PER_SIDE_MAX`] per side, numbers
/// that are not finite, and files that cannot be written.
pub fn save(map: &Map, path: &Path) -> Result<(), MapError> {
    let name = path.display().to_string();
    let refuse = |problem: String, advice: &str| MapError::new(&name, 0, problem, advice);
    check(map, &refuse)?;
    let picture_path = path.with_extension("pgm");
    let picture_name = picture_path.file_name().and_then(|name| name.to_str());
    let usable = picture_name.filter(|name| !name.contains(char::is_control));
    let Some(image) = usable.filter(|_| picture_path != path) else {
        return Err(refuse(
            format!("{} cannot name a map", shown(&name)),
            "name a file that ends in .yaml",
        ));
    };
    let description = Description::new(image, map.resolution_m, map.origin);
    write(&picture_path, &render_pgm(&map.picture(), map.resolution_m))?;
    write(path, render_yaml(&description).as_bytes())
}

/// Whether the map can be read again once it is written.
fn check(map: &Map, refuse: &dyn Fn(String, &str) -> MapError) -> Result<(), MapError> {
    let sides = 1..=CELLS_PER_SIDE_MAX;
    let fits = sides.contains(&map.width)
        && sides.contains(&map.height)
        && map.cells.len() == map.width * map.height;
    if !fits {
        let (width, height, cells) = (map.width, map.height, map.cells.len());
        return Err(refuse(
            format!("a map of {width} x {height} with {cells} cells cannot be written"),
            "give width * height cells, at most 4096 per side",
        ));
    }
    if !(RESOLUTIONS_M.contains(&map.resolution_m)
        && map.origin.iter().all(|number| number.is_finite()))
    {
        return Err(refuse(
            "resolution or origin is not a usable number".to_owned(),
            "give a resolution of 0.001 to 1000 m and a finite origin",
        ));
    }
    Ok(())
}

/// All bytes of a regular file of at most `limit` bytes.
fn read(path: &Path, limit: usize) -> Result<Vec<u8>, MapError> {
    let name = path.display().to_string();
    let cannot = |error: std::io::Error| {
        MapError::new(
            &name,
            0,
            format!("cannot be read: {error}"),
            "check path and rights",
        )
    };
    // Asked before opening: opening a pipe would wait for its other end.
    if !path.metadata().map_err(cannot)?.is_file() {
        return Err(MapError::new(
            &name,
            0,
            "is not a file",
            "name a regular file",
        ));
    }
    let mut bytes = Vec::new();
    let bound = u64::try_from(limit).unwrap_or(u64::MAX).saturating_add(1);
    File::open(path)
        .and_then(|file| file.take(bound).read_to_end(&mut bytes))
        .map_err(cannot)?;
    if bytes.len() > limit {
        return Err(MapError::new(
            &name,
            0,
            format!("is longer than {limit} bytes"),
            "crop or scale the map",
        ));
    }
    Ok(bytes)
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), MapError> {
    std::fs::write(path, bytes).map_err(|error| {
        MapError::new(
            &path.display().to_string(),
            0,
            format!("cannot be written: {error}"),
            "check folder and rights",
        )
    })
}
