//! The description beside the picture: the few lines of YAML that `map_server` knows.
//!
//! Reads block mappings of scalars and one flow sequence, with comments and quotes, which is
//! what map files consist of; it refuses everything else that YAML can do.

use crate::error::{MapError, shown};
use haltline::grid::Occupancy;

/// Edges of a pixel that are read and written, metres.
pub(crate) const RESOLUTIONS_M: core::ops::RangeInclusive<f64> = 0.001..=1000.0;

/// What the YAML file says.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Path of the picture, relative to the YAML file.
    pub image: String,
    /// Edge of a pixel, metres.
    pub resolution_m: f64,
    /// Pose of the lower left pixel: x (m), y (m), yaw (rad).
    pub origin: [f64; 3],
    /// Above this probability a pixel is occupied.
    pub occupied_thresh: f64,
    /// Below this probability a pixel is free.
    pub free_thresh: f64,
    /// Whether white means occupied.
    pub negate: bool,
}

impl Description {
    /// A description with the thresholds that `map_server` writes.
    #[must_use]
    pub fn new(image: &str, resolution_m: f64, origin: [f64; 3]) -> Self {
        Self {
            image: image.to_owned(),
            resolution_m,
            origin,
            occupied_thresh: 0.65,
            free_thresh: 0.196,
            negate: false,
        }
    }

    /// What a grey means: black is occupied, white is free, unless negated.
    #[must_use]
    pub fn occupancy(&self, grey: u8) -> Occupancy {
        let darkness = if self.negate { grey } else { 255 - grey };
        let probability = f64::from(darkness) / 255.0;
        if probability > self.occupied_thresh {
            Occupancy::Occupied
        } else if probability < self.free_thresh {
            Occupancy::Free
        } else {
            Occupancy::Unknown
        }
    }
}

/// The description as text.
#[must_use]
pub fn render_yaml(description: &Description) -> String {
    let d = description;
    let [x, y, yaw] = d.origin;
    format!(
        "image: {}\nmode: trinary\nresolution: {:?}\norigin: [{x:?}, {y:?}, {yaw:?}]\n\
         negate: {}\noccupied_thresh: {:?}\nfree_thresh: {:?}\n",
        quoted(&d.image),
        d.resolution_m,
        u8::from(d.negate),
        d.occupied_thresh,
        d.free_thresh,
    )
}

/// A scalar that reads back as the same text: single quotes unless it is plainly plain.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
    if !text.is_empty() && text.chars().all(plain) && !text.starts_with('-') {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "''"))
    }
}

/// Reads a description; `file` names it in errors.
///
/// `negate`, `occupied_thresh`, `free_thresh` and `mode` may be missing and default to 0, 0.65,
/// 0.196 and `trinary`.
///
/// # Errors
/// Missing, unknown or repeated keys, values out of range, and YAML beyond plain maps.
pub fn parse_yaml(text: &str, file: &str) -> Result<Description, MapError> {
    let entries = entries(text, file)?;
    let get = |key: &str| entries.iter().find(|entry| entry.key == key);
    let required = |key: &str, example: &str| {
        get(key).ok_or_else(|| {
            MapError::new(
                file,
                0,
                format!("has no {key}"),
                format!("write `{key}: {example}`"),
            )
        })
    };
    if let Some(mode) = get("mode").filter(|mode| mode.value != "trinary") {
        return Err(mode.error(file, "write `mode: trinary`"));
    }
    let image = required("image", "map.pgm")?;
    if image.value.is_empty() {
        return Err(image.error(file, "write the name of the picture"));
    }
    let resolution = required("resolution", "0.1")?;
    let resolution_m = resolution.number(file, RESOLUTIONS_M)?;
    let origin = required("origin", "[-10.0, -10.0, 0.0]")?.origin(file)?;
    let mut description = Description::new(&image.value, resolution_m, origin);
    if let Some(entry) = get("occupied_thresh") {
        description.occupied_thresh = entry.number(file, 0.0..=1.0)?;
    }
    if let Some(entry) = get("free_thresh") {
        description.free_thresh = entry.number(file, 0.0..=1.0)?;
    }
    // One of them may stand alone, against the default of the other.
    if let Some(entry) = get("free_thresh").or_else(|| get("occupied_thresh"))
        && description.free_thresh > description.occupied_thresh
    {
        return Err(entry.error(file, "keep free_thresh at most occupied_thresh"));
    }
    if let Some(entry) = get("negate") {
        description.negate = match entry.value.as_str() {
            "0" | "false" => false,
            "1" | "true" => true,
            _ => return Err(entry.error(file, "write 0 or 1")),
        };
    }
    Ok(description)
}

/// One `key: value` with its line.
struct Entry {
    line: usize,
    key: String,
    value: String,
}

const KEYS: [&str; 7] = [
    "image",
    "mode",
    "resolution",
    "origin",
    "negate",
    "occupied_thresh",
    "free_thresh",
];

fn entries(text: &str, file: &str) -> Result<Vec<Entry>, MapError> {
    let mut entries: Vec<Entry> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let number = index + 1;
        let error = |problem: String, advice: String| MapError::new(file, number, problem, advice);
        let blank = line.trim_start();
        if blank.is_empty() || blank.starts_with('#') || line.trim_end() == "---" {
            continue;
        }
        let Some((key, value)) = line.split_once(':') else {
            return Err(error(
                format!("`{}` is not `key: value`", shown(line)),
                "write one `key: value` per line".to_owned(),
            ));
        };
        let key = key.trim_end();
        if !KEYS.contains(&key) {
            return Err(error(
                format!("unknown key `{}`", shown(key)),
                format!("use {}", KEYS.join(", ")),
            ));
        }
        if entries.iter().any(|entry| entry.key == key) {
            return Err(error(
                format!("{key} is given twice"),
                "keep one of them".to_owned(),
            ));
        }
        let value = scalar(value).ok_or_else(|| {
            error(
                format!("cannot read `{}`", shown(value.trim())),
                "write a plain value on the same line".to_owned(),
            )
        })?;
        entries.push(Entry {
            line: number,
            key: key.to_owned(),
            value,
        });
    }
    Ok(entries)
}

/// A plain or quoted scalar, or a flow sequence as it stands; comments go.
fn scalar(text: &str) -> Option<String> {
    let trimmed = text.trim();
    if !trimmed.is_empty() && !text.starts_with([' ', '\t']) {
        return None;
    }
    let (value, rest) = match trimmed.chars().next() {
        Some('\'') => single_quoted(trimmed.get(1..)?)?,
        Some('"') => {
            let (value, rest) = trimmed.get(1..)?.split_once('"')?;
            // Escapes are not needed in a file name and not understood.
            (!value.contains('\\')).then(|| (value.to_owned(), rest))?
        }
        Some('&' | '*' | '!' | '|' | '>' | '{' | '%' | '@' | '`') => return None,
        _ => {
            let end = trimmed.find(" #").unwrap_or(trimmed.len());
            let end = if trimmed.starts_with('#') { 0 } else { end };
            (trimmed.get(..end)?.trim_end().to_owned(), "")
        }
    };
    let rest = rest.trim_start();
    (rest.is_empty() || rest.starts_with('#')).then_some(value)
}

/// The text up to the closing quote, doubled quotes undone, and what follows.
fn single_quoted(text: &str) -> Option<(String, &str)> {
    let mut value = String::new();
    let mut rest = text;
    loop {
        let (part, after) = rest.split_once('\'')?;
        value.push_str(part);
        match after.strip_prefix('\'') {
            Some(after) => {
                value.push('\'');
                rest = after;
            }
            None => return Some((value, after)),
        }
    }
}

impl Entry {
    fn error(&self, file: &str, advice: impl Into<String>) -> MapError {
        let problem = format!("{} is `{}`", self.key, shown(&self.value));
        MapError::new(file, self.line, problem, advice)
    }

    fn number(&self, file: &str, range: core::ops::RangeInclusive<f64>) -> Result<f64, MapError> {
        finite(&self.value)
            .filter(|number| range.contains(number))
            .ok_or_else(|| {
                let (least, most) = (range.start(), range.end());
                self.error(file, format!("write a number from {least} to {most}"))
            })
    }

    fn origin(&self, file: &str) -> Result<[f64; 3], MapError> {
        let inside = self.value.strip_prefix('[');
        let inside = inside.and_then(|value| value.strip_suffix(']'));
        let numbers: Option<Vec<f64>> =
            inside.and_then(|inside| inside.split(',').map(finite).collect());
        let origin: Option<[f64; 3]> = numbers.and_then(|numbers| numbers.try_into().ok());
        origin.ok_or_else(|| self.error(file, "write [x, y, yaw] in metres and radians"))
    }
}

fn finite(text: &str) -> Option<f64> {
    text.trim()
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite())
}
