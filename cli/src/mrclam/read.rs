//! Reads one robot's part of a MRCLAM data set: whitespace columns, `#` comments.
//!
//! A line that does not fit is an error with its number, never skipped.

use crate::failure::Failure;
use std::collections::BTreeMap;
use std::path::Path;

/// Subjects up to this number are robots, those above are landmarks.
pub const ROBOTS: u16 = 5;

/// A commanded motion that begins at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Unix time, s.
    pub time_s: f64,
    /// Forward speed, m/s.
    pub speed_mps: f64,
    /// Turn rate, rad/s.
    pub turn_radps: f64,
}

/// A barcode seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Unix time, s.
    pub time_s: f64,
    /// What was read, which may be no barcode at all.
    pub barcode: u32,
    /// Distance, m.
    pub range_m: f64,
    /// Direction, counter-clockwise from ahead, rad.
    pub bearing_rad: f64,
}

/// A true pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Unix time, s.
    pub time_s: f64,
    /// x m, y m, heading rad.
    pub pose: [f64; 3],
}

/// What one robot did and saw, and what is true.
#[derive(Clone, Debug, PartialEq)]
pub struct DataSet {
    /// Subject of each barcode.
    pub subjects: BTreeMap<u32, u16>,
    /// True position of each landmark, m.
    pub landmarks: BTreeMap<u16, [f64; 2]>,
    /// In the order of time.
    pub commands: Vec<Command>,
    /// In the order of time.
    pub measurements: Vec<Measurement>,
    /// In the order of time.
    pub truth: Vec<Truth>,
}

/// Reads the five files of one robot.
///
/// # Errors
/// Unusable input with file and line.
pub fn read(folder: &Path, robot: u16) -> Result<DataSet, Failure> {
    if !folder.is_dir() {
        return Err(Failure::input(format!(
            "{}: not a folder; give the one that holds Barcodes.dat and Robot{robot}_Odometry.dat",
            folder.display()
        )));
    }
    let own = |kind: &str| folder.join(format!("Robot{robot}_{kind}.dat"));
    let barcodes = rows::<2>(&folder.join("Barcodes.dat"), "subject barcode")?;
    let landmarks = rows::<5>(
        &folder.join("Landmark_Groundtruth.dat"),
        "subject x y std_x std_y",
    )?;
    let commands = in_order(&own("Odometry"), "time v omega", false)?;
    let measurements = in_order(&own("Measurement"), "time barcode range bearing", false)?;
    let truth = in_order(&own("Groundtruth"), "time x y theta", true)?;
    Ok(DataSet {
        subjects: barcodes
            .iter()
            .map(|([s, code], _)| (*code as u32, *s as u16))
            .collect(),
        landmarks: landmarks
            .iter()
            .map(|([s, x, y, ..], _)| (*s as u16, [*x, *y]))
            .collect(),
        commands: commands
            .into_iter()
            .map(|[time_s, speed_mps, turn_radps]| Command {
                time_s,
                speed_mps,
                turn_radps,
            })
            .collect(),
        measurements: measurements
            .into_iter()
            .map(|[time_s, barcode, range_m, bearing_rad]| Measurement {
                time_s,
                barcode: barcode as u32,
                range_m,
                bearing_rad,
            })
            .collect(),
        truth: truth
            .into_iter()
            .map(|[time_s, x, y, theta]| Truth {
                time_s,
                pose: [x, y, theta],
            })
            .collect(),
    })
}

/// Rows of `N` finite numbers with their lines; the first number counts something or is a time.
fn rows<const N: usize>(path: &Path, columns: &str) -> Result<Vec<([f64; N], usize)>, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| Failure::read(path, &error))?;
    let mut rows = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let fields: Vec<&str> = line.split_whitespace().collect();
        if fields.is_empty() {
            continue;
        }
        let wrong = |why: String| Failure::line(path, index + 1, why);
        if fields.len() != N {
            let found = fields.len();
            return Err(wrong(format!("{found} values, expected {N}: {columns}")));
        }
        let mut row = [0.0; N];
        for (value, field) in row.iter_mut().zip(&fields) {
            *value = field
                .parse::<f64>()
                .ok()
                .filter(|value| value.is_finite())
                .ok_or_else(|| wrong(format!("`{field}` is not a number; expected: {columns}")))?;
        }
        if row[0] < 0.0 {
            return Err(wrong(format!(
                "`{}` is negative; expected: {columns}",
                fields[0]
            )));
        }
        rows.push((row, index + 1));
    }
    Ok(rows)
}

/// Rows in the order of time, at least two where `needed`; at least one otherwise.
fn in_order<const N: usize>(
    path: &Path,
    columns: &str,
    needed: bool,
) -> Result<Vec<[f64; N]>, Failure> {
    let rows = rows::<N>(path, columns)?;
    for pair in rows.windows(2) {
        let (before, after, line) = (pair[0].0[0], pair[1].0[0], pair[1].1);
        if after < before {
            let why = format!("time {after} s is before {before} s of the row above");
            return Err(Failure::line(path, line, why));
        }
    }
    let least = if needed { 2 } else { 1 };
    if rows.len() < least {
        let why = format!("{} rows, needs at least {least}: {columns}", rows.len());
        return Err(Failure::line(path, rows.len() + 1, why));
    }
    Ok(rows.into_iter().map(|(row, _)| row).collect())
}
