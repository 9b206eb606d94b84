//! Reads one robot's part of a MRCLAM data set: whitespace columns, `#` comments.
//!
//! A line that does not fit is an error with its number, never skipped.

use crate::LogError;
use haltline::marker::{IDS, INCREMENT_MAX_M, INCREMENT_MAX_RAD, POSITION_MAX_M};
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

/// A text and the file it came from.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// Names it in messages.
    pub path: &'a Path,
    /// Its content.
    pub text: &'a str,
}

/// The five files of one robot.
#[derive(Clone, Copy, Debug)]
pub struct Sources<'a> {
    /// `Barcodes.dat`.
    pub barcodes: Source<'a>,
    /// `Landmark_Groundtruth.dat`.
    pub landmarks: Source<'a>,
    /// `RobotN_Odometry.dat`.
    pub odometry: Source<'a>,
    /// `RobotN_Measurement.dat`.
    pub measurement: Source<'a>,
    /// `RobotN_Groundtruth.dat`.
    pub truth: Source<'a>,
}

/// Reads the five files of one robot.
///
/// # Errors
/// Unusable input with file and line.
pub fn read(folder: &Path, robot: u16) -> Result<DataSet, LogError> {
    if !folder.is_dir() {
        return Err(LogError::input(format!(
            "{}: not a folder; give the one that holds Barcodes.dat and Robot{robot}_Odometry.dat",
            folder.display()
        )));
    }
    let files = [
        "Barcodes.dat".to_owned(),
        "Landmark_Groundtruth.dat".to_owned(),
        format!("Robot{robot}_Odometry.dat"),
        format!("Robot{robot}_Measurement.dat"),
        format!("Robot{robot}_Groundtruth.dat"),
    ]
    .map(|name| folder.join(name));
    let mut texts: [String; 5] = std::array::from_fn(|_| String::new());
    for (text, path) in texts.iter_mut().zip(&files) {
        *text = std::fs::read_to_string(path).map_err(|error| LogError::read(path, &error))?;
    }
    let source = |index: usize| Source {
        path: &files[index],
        text: &texts[index],
    };
    parse(&Sources {
        barcodes: source(0),
        landmarks: source(1),
        odometry: source(2),
        measurement: source(3),
        truth: source(4),
    })
}

/// Reads the texts of one robot's files.
///
/// # Errors
/// Unusable input with file and line.
pub fn parse(sources: &Sources<'_>) -> Result<DataSet, LogError> {
    let columns = "time barcode range bearing";
    Ok(DataSet {
        subjects: subjects(sources.barcodes)?,
        landmarks: landmarks(sources.landmarks)?,
        commands: in_order(sources.odometry, "time v omega", 1, command)?,
        measurements: in_order(sources.measurement, columns, 1, measurement)?,
        truth: in_order(sources.truth, "time x y theta", 2, truth)?,
    })
}

fn subjects(source: Source<'_>) -> Result<BTreeMap<u32, u16>, LogError> {
    let mut subjects = BTreeMap::new();
    for ([subject, code], line) in rows::<2>(source, "subject barcode")? {
        let wrong = |why| LogError::line(source.path, line, why);
        let subject = subject_number(subject).map_err(wrong)?;
        let code = barcode(code).map_err(wrong)?;
        if let Some(other) = subjects.insert(code, subject) {
            return Err(wrong(format!(
                "barcode {code} is that of subject {other} already"
            )));
        }
    }
    Ok(subjects)
}

fn landmarks(source: Source<'_>) -> Result<BTreeMap<u16, [f64; 2]>, LogError> {
    let mut landmarks = BTreeMap::new();
    for ([subject, x, y, ..], line) in rows::<5>(source, "subject x y std_x std_y")? {
        let wrong = |why| LogError::line(source.path, line, why);
        let subject = subject_number(subject).map_err(wrong)?;
        if landmarks.insert(subject, [x, y]).is_some() {
            return Err(wrong(format!("landmark {subject} stands above already")));
        }
    }
    Ok(landmarks)
}

fn command([time_s, speed_mps, turn_radps]: [f64; 3]) -> Result<Command, String> {
    // What the filter takes as one motion; a command holds for at most a second.
    let usable = speed_mps.abs() <= INCREMENT_MAX_M && turn_radps.abs() <= INCREMENT_MAX_RAD;
    usable
        .then_some(Command {
            time_s,
            speed_mps,
            turn_radps,
        })
        .ok_or_else(|| {
            format!(
                "{speed_mps:?} m/s and {turn_radps:?} rad/s: more than {INCREMENT_MAX_M} m/s or one turn a second cannot be"
            )
        })
}

fn measurement([time_s, code, range_m, bearing_rad]: [f64; 4]) -> Result<Measurement, String> {
    Ok(Measurement {
        time_s,
        barcode: barcode(code)?,
        range_m,
        bearing_rad,
    })
}

fn truth([time_s, x_m, y_m, theta_rad]: [f64; 4]) -> Result<Truth, String> {
    let pose = [x_m, y_m, theta_rad];
    if pose.iter().all(|part| part.abs() <= POSITION_MAX_M) {
        Ok(Truth { time_s, pose })
    } else {
        Err(format!("a pose beyond {POSITION_MAX_M:.0} m or rad"))
    }
}

fn barcode(value: f64) -> Result<u32, String> {
    whole(value, f64::from(u32::MAX))
        .ok_or_else(|| format!("barcode {value}: write a whole number that is not negative"))
}

fn subject_number(value: f64) -> Result<u16, String> {
    whole(value, IDS as f64 - 1.0)
        .and_then(|value| u16::try_from(value).ok())
        .ok_or_else(|| format!("subject {value}: write a whole number below {IDS}"))
}

fn whole(value: f64, most: f64) -> Option<u32> {
    (value.fract() == 0.0 && (0.0..=most).contains(&value)).then_some(value as u32)
}

/// Rows of `N` finite numbers with their lines; the first number counts something or is a time.
fn rows<const N: usize>(
    source: Source<'_>,
    columns: &str,
) -> Result<Vec<([f64; N], usize)>, LogError> {
    let Source { path, text } = source;
    let mut rows = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let fields: Vec<&str> = line.split_whitespace().collect();
        if fields.is_empty() {
            continue;
        }
        let wrong = |why: String| LogError::line(path, index + 1, why);
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

/// Rows in the order of time, at least so many.
fn in_order<const N: usize, T>(
    source: Source<'_>,
    columns: &str,
    least: usize,
    make: impl Fn([f64; N]) -> Result<T, String>,
) -> Result<Vec<T>, LogError> {
    let (rows, path) = (rows::<N>(source, columns)?, source.path);
    for pair in rows.windows(2) {
        let (before, after, line) = (pair[0].0[0], pair[1].0[0], pair[1].1);
        if after < before {
            let why = format!("time {after} s is before {before} s of the row above");
            return Err(LogError::line(path, line, why));
        }
    }
    if rows.len() < least {
        let why = format!("{} rows, needs at least {least}: {columns}", rows.len());
        return Err(LogError::line(path, rows.len() + 1, why));
    }
    let made = |(row, line)| make(row).map_err(|why| LogError::line(path, line, why));
    rows.into_iter().map(made).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(barcodes: &str, measurement: &str) -> Result<DataSet, String> {
        let source = |name: &'static str, text| Source {
            path: Path::new(name),
            text,
        };
        parse(&Sources {
            barcodes: source("Barcodes.dat", barcodes),
            landmarks: source("Landmarks.dat", "6 1 2 0.1 0.1\n"),
            odometry: source("Odometry.dat", "0 0.1 0\n1 0.1 0\n"),
            measurement: source("Measurement.dat", measurement),
            truth: source("Truth.dat", "0 0 0 0\n1 0.1 0 0\n"),
        })
        .map_err(|error| error.message)
    }

    #[test]
    fn whole_numbers_are_whole_and_fit() {
        let good = read("# head\n6 72\n", "0.5 72 1.0 0.1\n").expect("good");
        assert_eq!(good.subjects.get(&72), Some(&6));
        for (barcodes, measurement, part) in [
            (
                "6 72\n6.7 5\n",
                "0 72 1 0\n",
                "Barcodes.dat:2: subject 6.7: write",
            ),
            ("70000 72\n", "0 72 1 0\n", "Barcodes.dat:1: subject 70000"),
            (
                "6 72\n",
                "0 72 1 0\n1 72.5 1 0\n",
                "Measurement.dat:2: barcode 72.5",
            ),
            ("6 72\n", "0 -1 1 0\n", "Measurement.dat:1: barcode -1"),
            (
                "6 72\n",
                "0 1e12 1 0\n",
                "Measurement.dat:1: barcode 1000000000000",
            ),
        ] {
            let said = read(barcodes, measurement).expect_err("refused");
            assert!(said.contains(part), "{said}");
        }
    }
}
