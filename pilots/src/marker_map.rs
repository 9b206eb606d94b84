//! Maps of markers as text: `id,x_m,y_m,heading_deg` lines.
//!
//! Blank lines and lines that begin with `#` are skipped, a first line of column names is
//! allowed. It refuses to guess: whatever else is odd is an error with its line.

use haltline::marker::{FilterError, IDS, MarkerEkf, POSITION_MAX_M, Pose2};
use std::fmt;
use std::path::{Path, PathBuf};

/// The column names, which may stand in the first line.
pub const HEADER: &str = "id,x_m,y_m,heading_deg";

/// What is wrong with a map, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MapError {
    /// Line, from 1.
    pub line: usize,
    /// What is wrong and what to write instead.
    pub message: String,
}

impl fmt::Display for MapError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "line {}: {}", self.line, self.message)
    }
}

impl std::error::Error for MapError {}

/// A marker whose pose is known beforehand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapEntry {
    /// Below [`IDS`].
    pub id: u16,
    /// Pose in the frame of the map; the heading is the marker's normal.
    pub pose: Pose2,
}

/// Why a file holds no map.
#[derive(Debug)]
pub enum FileError {
    /// It cannot be read, or is no text.
    Unreadable(PathBuf, std::io::Error),
    /// A line of it is wrong.
    Wrong(PathBuf, MapError),
}

impl fmt::Display for FileError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(path, error) => {
                write!(out, "{}: cannot be read: {error}", path.display())
            }
            Self::Wrong(path, MapError { line, message }) => {
                write!(out, "{}:{line}: {message}", path.display())
            }
        }
    }
}

impl std::error::Error for FileError {}

/// Reads a map from a file, such as `pilots/maps/loh_field_test.csv`.
///
/// # Errors
/// A file that cannot be read, or what [`parse`] refuses, with file and line.
pub fn read(path: &Path) -> Result<Vec<MapEntry>, FileError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| FileError::Unreadable(path.to_owned(), error))?;
    parse(&text).map_err(|error| FileError::Wrong(path.to_owned(), error))
}

/// Reads a map from text.
///
/// # Errors
/// The first line that is not understood, or an id that occurs twice.
pub fn parse(text: &str) -> Result<Vec<MapEntry>, MapError> {
    let mut entries: Vec<(usize, MapEntry)> = Vec::new();
    let mut header_allowed = true;
    // Spreadsheets put a byte order mark in front.
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let (number, line) = (index + 1, line.trim());
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let is_header = line.replace(' ', "") == HEADER;
        if std::mem::take(&mut header_allowed) && is_header {
            continue;
        }
        let entry = parse_line(line).map_err(|message| MapError {
            line: number,
            message,
        })?;
        if let Some((before, _)) = entries.iter().find(|(_, other)| other.id == entry.id) {
            let message = format!("marker {} stands in line {before} already", entry.id);
            return Err(MapError {
                line: number,
                message,
            });
        }
        entries.push((number, entry));
    }
    Ok(entries.into_iter().map(|(_, entry)| entry).collect())
}

fn parse_line(line: &str) -> Result<MapEntry, String> {
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    let [id, x, y, heading] = fields[..] else {
        let found = fields.len();
        return Err(format!("{found} columns; write four: {HEADER}"));
    };
    let id = match id.parse::<u16>() {
        Ok(id) if usize::from(id) < IDS => id,
        _ => return Err(format!("id '{id}': write a whole number below {IDS}")),
    };
    let number = |name: &str, text: &str, limit: f64| match text.parse::<f64>() {
        Ok(value) if value.abs() <= limit => Ok(value),
        _ => Err(format!(
            "{name} '{text}': write a number between -{limit} and {limit}"
        )),
    };
    let x_m = number("x_m", x, POSITION_MAX_M)?;
    let y_m = number("y_m", y, POSITION_MAX_M)?;
    let heading_deg = number("heading_deg", heading, 360.0)?;
    Ok(MapEntry {
        id,
        pose: Pose2::new(x_m, y_m, heading_deg.to_radians()),
    })
}

/// Writes a map that [`parse`] reads back.
#[must_use]
pub fn write(entries: &[MapEntry]) -> String {
    let mut text = format!("{HEADER}\n");
    for MapEntry { id, pose } in entries {
        let heading_deg = pose.heading_rad.to_degrees();
        text += &format!("{id},{},{},{heading_deg}\n", pose.x_m, pose.y_m);
    }
    text
}

/// Enters a whole map into a filter.
///
/// # Errors
/// The first entry that the filter refuses, with the reason; those before it are entered.
pub fn enter<const N: usize, const M: usize>(
    entries: &[MapEntry],
    filter: &mut MarkerEkf<N, M>,
) -> Result<(), (u16, FilterError)> {
    entries.iter().try_for_each(|entry| {
        let entered = filter.add_mapped(entry.id, entry.pose);
        entered.map_err(|error| (entry.id, error))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use haltline::marker::{FilterRules, MarkerFilter};

    #[test]
    fn maps_are_read_and_written() {
        let text = "\u{feff}id, x_m, y_m, heading_deg\r\n# west wall\r\n\r\n0, 1.5,-2,-90\r\n7,0,1e1,180\r\n";
        let entries = parse(text).unwrap();
        assert_eq!(entries.len(), 2);
        assert_eq!(entries[1].pose.y_m.to_bits(), 10.0_f64.to_bits());
        assert!((entries[0].pose.heading_rad + core::f64::consts::FRAC_PI_2).abs() < 1e-15);
        let again = parse(&write(&entries)).unwrap();
        for (a, b) in entries.iter().zip(&again) {
            assert!(a.id == b.id && a.pose.distance_m(&b.pose) < 1e-12);
            assert!((a.pose.heading_rad - b.pose.heading_rad).abs() < 1e-12);
        }
        assert_eq!(parse("").unwrap(), []);
    }

    #[test]
    fn errors_name_the_line_and_the_cure() {
        for (text, line, part) in [
            ("0,1,2", 1, "3 columns; write four: id,x_m"),
            ("0,1,2,3\n1024,0,0,0", 2, "below 1024"),
            ("-1,0,0,0", 1, "id '-1'"),
            ("# c\n0,nan,0,0", 2, "x_m 'nan'"),
            ("0,inf,0,0", 1, "x_m 'inf'"),
            ("0,1,two,0", 1, "y_m 'two'"),
            ("0,1,2,400", 1, "heading_deg '400'"),
            ("3,1,2,0\n\n3,1,2,0", 3, "stands in line 1 already"),
            ("0,1,2,3\nid,x_m,y_m,heading_deg", 2, "id 'id'"),
        ] {
            let error = parse(text).unwrap_err();
            assert_eq!(error.line, line, "{text}");
            assert!(error.to_string().contains(part), "{error}");
        }
    }

    #[test]
    fn errors_of_a_file_name_it() {
        let missing = read(Path::new("no/such.csv")).unwrap_err().to_string();
        assert!(
            missing.starts_with("no/such.csv: cannot be read: "),
            "{missing}"
        );
        let this = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
        let wrong = read(&this).unwrap_err().to_string();
        let expected = format!("{}:1: 1 columns; write four", this.display());
        assert!(wrong.starts_with(&expected), "{wrong}");
    }

    #[test]
    fn a_map_enters_a_filter_or_says_which_marker_does_not() {
        let entries = parse("5,1,2,0\n6,1,3,0").unwrap();
        let mut filter = {
            let rules = FilterRules::default();
            MarkerEkf::<1, 1>::new(rules, Pose2::default(), [0.1; 3]).unwrap()
        };
        assert_eq!(enter(&entries, &mut filter), Err((6, FilterError::Full)));
        assert!(filter.marker(5).is_some() && filter.marker(6).is_none());
    }
}
