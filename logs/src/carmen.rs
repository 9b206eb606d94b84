//! Reads CARMEN logs: one message a line, words separated by blanks.
//!
//! Messages of other kinds are skipped; a `FLASER` line that does not fit is an error with its
//! number. A sweep that is not newer than the one before it is dropped and counted.

use crate::LogError;
use crate::sena::{self, Header, Log, Row};
use std::path::Path;

/// x m, y m, heading rad.
type Pose = [f64; 3];

/// Ranges from here on mean that nothing came back, m.
const RANGE_MAX_M: f64 = 80.0;
/// Numbers behind the ranges: laser pose, odometry pose, time.
const BEHIND: usize = 7;

/// A recorded drive.
pub struct Carmen {
    /// What the kernel is shown: odometry and sweeps.
    pub log: Log,
    /// Pose of the laser at each row, as the recording believed, m and rad.
    pub laser: Vec<Pose>,
    /// Sweeps that were not newer than the one before.
    pub dropped: usize,
}

/// One `FLASER` line.
struct Sweep {
    time_s: f64,
    ranges_m: Vec<f32>,
    laser: Pose,
    odometry: Pose,
}

/// Reads a log, plain or gzip.
///
/// # Errors
/// Unusable input with file and line.
pub fn read(path: &Path) -> Result<Carmen, LogError> {
    parse(path, &sena::text(path)?)
}

/// Reads the text of a log; `path` names it in messages.
///
/// # Errors
/// Unusable text with file and line.
pub fn parse(path: &Path, text: &str) -> Result<Carmen, LogError> {
    let mut sweeps: Vec<Sweep> = Vec::new();
    let (mut dropped, mut stated_offset_m) = (0, None);
    for (index, line) in text.lines().enumerate() {
        let wrong = |why: String| LogError::line(path, index + 1, why);
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.first().copied() {
            Some("PARAM") if words.get(1) == Some(&"robot_frontlaser_offset") => {
                let value = words.get(2).copied().unwrap_or_default();
                stated_offset_m = Some(number(value).map_err(wrong)?);
            }
            Some("FLASER") => {
                let sweep = sweep(&words).map_err(wrong)?;
                if let Some(last) = sweeps.last() {
                    if sweep.ranges_m.len() != last.ranges_m.len() {
                        let (now, before) = (sweep.ranges_m.len(), last.ranges_m.len());
                        return Err(wrong(format!(
                            "{now} ranges, the sweeps before have {before}"
                        )));
                    }
                    if sweep.time_s <= last.time_s {
                        dropped += 1;
                        continue;
                    }
                }
                sweeps.push(sweep);
            }
            _ => {}
        }
    }
    if sweeps.len() < 2 {
        let why = format!("{} FLASER lines, a drive needs at least two", sweeps.len());
        return Err(LogError::line(path, text.lines().count().max(1), why));
    }
    Ok(Carmen {
        log: Log {
            header: header(&sweeps[0], stated_offset_m),
            rows: rows(&sweeps),
        },
        laser: sweeps.iter().map(|sweep| sweep.laser).collect(),
        dropped,
    })
}

fn number(word: &str) -> Result<f64, String> {
    crate::number(word).ok_or_else(|| format!("`{word}` is not a number"))
}

/// `FLASER n r1..rn x y theta odom_x odom_y odom_theta time host logger_time`.
fn sweep(words: &[&str]) -> Result<Sweep, String> {
    let count = words.get(1).copied().unwrap_or_default();
    let count: usize = count
        .parse()
        .ok()
        .filter(|count| (2..=10_000).contains(count))
        .ok_or_else(|| format!("`{count}`: the number of ranges must be 2 to 10000"))?;
    let wanted = 2 + count + BEHIND;
    if words.len() < wanted {
        let found = words.len();
        return Err(format!(
            "{found} words, expected at least {wanted} for {count} ranges"
        ));
    }
    let ranges_m = words[2..2 + count].iter().map(|word| {
        let range = number(word)?;
        if range < 0.0 {
            return Err(format!("range {range} m is negative"));
        }
        // Zero is how the rest of the program writes "no valid return".
        Ok(if range < RANGE_MAX_M {
            range as f32
        } else {
            0.0
        })
    });
    let ranges_m = ranges_m.collect::<Result<_, String>>()?;
    let mut behind = [0.0; BEHIND];
    for (value, word) in behind.iter_mut().zip(&words[2 + count..]) {
        *value = number(word)?;
    }
    let [x, y, theta, odom_x, odom_y, odom_theta, time_s] = behind;
    Ok(Sweep {
        time_s,
        ranges_m,
        laser: [x, y, theta],
        odometry: [odom_x, odom_y, odom_theta],
    })
}

/// Pose of `b` in the frame of `a`.
fn between(a: Pose, b: Pose) -> Pose {
    let (sin, cos) = a[2].sin_cos();
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let turn = b[2] - a[2];
    let (turn_sin, turn_cos) = turn.sin_cos();
    [
        cos * dx + sin * dy,
        cos * dy - sin * dx,
        turn_sin.atan2(turn_cos),
    ]
}

/// The laser: half a turn, and where it sits if the log tells.
fn header(first: &Sweep, stated_offset_m: Option<f64>) -> Header {
    let beams = first.ranges_m.len();
    // An odd number reaches both ends of the half turn; an even one leaves out the last.
    let even = beams.is_multiple_of(2);
    let step_rad = std::f64::consts::PI / if even { beams } else { beams - 1 } as f64;
    let yaw_rad = if even { -step_rad / 2.0 } else { 0.0 };
    // In uncorrected logs the laser's pose is the odometry's, moved to the laser.
    let [x, y, turn] = between(first.odometry, first.laser);
    let raw = turn.abs() < 1e-4 && x.hypot(y) < 2.0;
    let offset_m = stated_offset_m.unwrap_or(if raw { x } else { 0.0 });
    Header {
        beams,
        aperture_rad: step_rad * (beams - 1) as f64,
        max_range_m: RANGE_MAX_M,
        sensor_m_rad: [offset_m, 0.0, yaw_rad],
    }
}

fn rows(sweeps: &[Sweep]) -> Vec<Row> {
    let begin_s = sweeps[0].time_s;
    let mut before = sweeps[0].odometry;
    sweeps
        .iter()
        .map(|sweep| {
            let increment_m_rad = between(before, sweep.odometry);
            before = sweep.odometry;
            Row {
                t_s: sweep.time_s - begin_s,
                increment_m_rad,
                ranges_m: sweep.ranges_m.clone(),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Carmen, String> {
        parse(Path::new("x.log"), text).map_err(|failure| failure.message)
    }

    const FIRST: &str = "FLASER 4 1 2 3 81.83 0.3 0 0 0 0 0 10.0 host 0.1\n";

    #[test]
    fn sweeps_odometry_and_the_lasers_place_are_read() {
        let second = "FLASER 4 1 2 3 4 1.3 0 1.57 1.0 0 1.5707963 10.5 host 0.6\n";
        let other = "# comment\nODOM 0 0 0 0 0 0 9 host 9\nPARAM x y\n";
        let read = parsed(&format!("{other}{FIRST}{second}")).expect("good");
        assert_eq!(read.log.rows.len(), 2);
        assert_eq!(read.log.rows[0].ranges_m, vec![1.0, 2.0, 3.0, 0.0]);
        let [x, y, turn] = read.log.rows[1].increment_m_rad;
        assert!((x - 1.0).abs() + y.abs() + (turn - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
        assert!((read.log.rows[1].t_s - 0.5).abs() < 1e-9);
        let header = &read.log.header;
        // Four beams: -90, -45, 0, 45 degrees.
        assert!((header.aperture_rad.to_degrees() - 135.0).abs() < 1e-9);
        assert!((header.sensor_m_rad[2].to_degrees() + 22.5).abs() < 1e-9);
        assert!((header.sensor_m_rad[0] - 0.3).abs() < 1e-9);
        assert!((read.laser[1][0] - 1.3).abs() < 1e-12);
    }

    #[test]
    fn old_sweeps_are_dropped_and_counted() {
        let later = FIRST.replace("10.0", "11.0");
        let read = parsed(&format!("{FIRST}{later}{FIRST}")).expect("good");
        assert_eq!((read.log.rows.len(), read.dropped), (2, 1));
    }

    #[test]
    fn bad_lines_are_named() {
        for (text, part) in [
            ("FLASER 4 1 2 3\n", "x.log:1: 5 words, expected at least 13"),
            ("\nFLASER many\n", "x.log:2: `many`"),
            (
                "FLASER 2 1 far 0 0 0 0 0 0 1\n",
                "x.log:1: `far` is not a number",
            ),
            ("FLASER 2 1 -2 0 0 0 0 0 0 1\n", "negative"),
            ("FLASER 2 1 2 0 0 nan 0 0 0 1\n", "`nan`"),
            ("PARAM robot_frontlaser_offset ?\n", "x.log:1: `?`"),
            ("ODOM 0 0 0 0 0 0 1 h 1\n", "0 FLASER lines"),
        ] {
            let said = parsed(text).err().expect("refused");
            assert!(said.contains(part), "{said}");
        }
        let other = "FLASER 2 1 2 0 0 0 0 0 0 20 h 1\n";
        let said = parsed(&format!("{FIRST}{other}")).err().expect("refused");
        assert!(
            said.contains("x.log:2: 2 ranges, the sweeps before have 4"),
            "{said}"
        );
    }
}
