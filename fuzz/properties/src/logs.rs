//! Recorded drives: every line is taken or refused by its number, times rise, and odometry adds up.

use crate::text::{filled, points_into, spoiled, text};
use crate::{Judged, Property, demand};
use haltline_logs::LogError;
use haltline_logs::carmen::{self, Carmen};
use haltline_logs::mrclam::{self, DataSet, Source, Sources};
use haltline_logs::sena::{self, Log};
use std::path::Path;

/// A refusal begins with file and line.
fn named(text: &str, file: &str, error: &LogError) -> Judged {
    let place = error
        .message
        .strip_prefix(file)
        .and_then(|rest| rest.strip_prefix(':'));
    let line = place.and_then(|rest| rest.split(':').next()?.parse::<usize>().ok());
    let Some(line) = line else {
        return Err(format!("no line: {}", error.message));
    };
    points_into(text, line.saturating_sub(1), &error.message).map(|()| 0)
}

fn rises(times: impl Iterator<Item = f64> + Clone) -> bool {
    let next = times.clone().skip(1);
    times.zip(next).all(|(before, after)| before < after)
}

pub const SENA: Property = Property {
    name: "sena",
    judge: |bytes| log(bytes, sena::parse),
    twins: &[
        ("a line lost", |bytes| {
            log(bytes, |path, text| {
                let mut log = sena::parse(path, text)?;
                log.rows.pop();
                Ok(log)
            })
        }),
        ("time goes back", |bytes| {
            log(bytes, |path, text| {
                let mut log = sena::parse(path, text)?;
                log.rows[0].t_s = 1e9;
                Ok(log)
            })
        }),
    ],
    draw: |draw| {
        spoiled(
            draw,
            "# beams 3 aperture_rad 3.14 right_to_left 1 max_range_m 80 sensor_x_m 0.5 sensor_y_m 0 sensor_yaw_rad 0\n\
             # t_s,...\n0.0,0,0,0,1,2,0\n0.2,0.1,0,0.01,1,2,3\n0.4,0.1,0,0.01,1,2,3\n0.6,0.1,0,0.01,1,2,3",
        )
    },
    cases: 8000,
};

fn log(bytes: &[u8], parse: fn(&Path, &str) -> Result<Log, LogError>) -> Judged {
    let Some(text) = text(bytes) else {
        return Ok(0);
    };
    let log = match parse(Path::new("d.csv"), text) {
        Ok(log) => log,
        Err(error) => return named(text, "d.csv", &error),
    };
    let lines = text.lines().count() - 2;
    demand(log.rows.len() == lines, || {
        format!("{} of {lines} lines", log.rows.len())
    })?;
    demand(rises(log.rows.iter().map(|row| row.t_s)), || {
        "times fall".to_owned()
    })?;
    for row in &log.rows {
        let finite = row.increment_m_rad.iter().all(|value| value.is_finite());
        // A range beyond what f32 holds is infinite: no return.
        let ranges = row.ranges_m.iter().all(|range| *range >= 0.0);
        let whole = row.ranges_m.len() == log.header.beams;
        demand(finite && ranges && whole, || format!("took {row:?}"))?;
    }
    Ok(log.rows.len())
}

pub const CARMEN: Property = Property {
    name: "carmen",
    judge: |bytes| sweeps(bytes, carmen::parse),
    twins: &[
        ("an increment lost", |bytes| {
            sweeps(bytes, |path, text| {
                let mut drive = carmen::parse(path, text)?;
                drive.log.rows[1].increment_m_rad[0] += 0.5;
                Ok(drive)
            })
        }),
        ("a sweep lost", |bytes| {
            sweeps(bytes, |path, text| {
                let mut drive = carmen::parse(path, text)?;
                drive.log.rows.pop();
                Ok(drive)
            })
        }),
    ],
    draw: |draw| {
        spoiled(
            draw,
            "# comment\nPARAM robot_frontlaser_offset 0.3\nODOM 0 0 0 0 0 0 9 host 9\n\
             FLASER 4 1 2 3 81.83 0.3 0 0 0 0 0 10.0 host 0.1\nFLASER 4 1 2 3 4 1.3 0 1.57 1.0 0 1.57 10.5 host 0.6\n\
             FLASER 4 1 2 3 4 1.3 1 1.57 1.0 1 1.57 11 host 1.1",
        )
    },
    cases: 8000,
};

fn sweeps(bytes: &[u8], parse: fn(&Path, &str) -> Result<Carmen, LogError>) -> Judged {
    let Some(text) = text(bytes) else {
        return Ok(0);
    };
    let drive = match parse(Path::new("d.log"), text) {
        Ok(drive) => drive,
        Err(error) => return named(text, "d.log", &error),
    };
    let words = |line: &str| {
        line.split_whitespace()
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let lines: Vec<Vec<String>> = text
        .lines()
        .map(words)
        .filter(|words| words.first().is_some_and(|word| word == "FLASER"))
        .collect();
    let rows = &drive.log.rows;
    demand(rows.len() + drive.dropped == lines.len(), || {
        format!("{} of {} sweeps", rows.len(), lines.len())
    })?;
    // Times as large as dates lose digits when the first is taken away, never their order.
    demand(
        rows.windows(2).all(|pair| pair[0].t_s <= pair[1].t_s),
        || "times fall".to_owned(),
    )?;
    let beams = drive.log.header.beams;
    demand(rows.iter().all(|row| row.ranges_m.len() == beams), || {
        "beams".to_owned()
    })?;
    if drive.dropped > 0 {
        return Ok(rows.len());
    }
    let odometry = |words: &Vec<String>| -> Option<[f64; 3]> {
        let at = |index: usize| words.get(2 + beams + 3 + index)?.parse().ok();
        Some([at(0)?, at(1)?, at(2)?])
    };
    let (first, last) = (
        lines.first().and_then(odometry),
        lines.last().and_then(odometry),
    );
    if let (Some(mut pose), Some(last)) = (first, last) {
        for row in rows {
            let ([x, y, turn], (sin, cos)) = (row.increment_m_rad, pose[2].sin_cos());
            pose = [
                pose[0] + cos * x - sin * y,
                pose[1] + sin * x + cos * y,
                pose[2] + turn,
            ];
        }
        let far = lines
            .iter()
            .filter_map(odometry)
            .flatten()
            .fold(1.0, |far: f64, at| far.max(at.abs()));
        let off = (pose[0] - last[0]).hypot(pose[1] - last[1]);
        demand(far > 1e6 || off <= 1e-6 * far, || {
            format!("{pose:?} should be {last:?}")
        })?;
    }
    Ok(rows.len())
}

pub const MRCLAM: Property = Property {
    name: "mrclam",
    judge: |bytes| data(bytes, mrclam::parse),
    twins: &[
        ("a measurement lost", |bytes| {
            data(bytes, |sources| {
                let mut data = mrclam::parse(sources)?;
                data.measurements.pop();
                Ok(data)
            })
        }),
        ("the barcode before rounding", |bytes| {
            data(bytes, |sources| {
                let mut data = mrclam::parse(sources)?;
                data.measurements[0].barcode += 1;
                Ok(data)
            })
        }),
    ],
    draw: |draw| {
        spoiled(
            draw,
            "# subject barcode\n1 5\n6 72\n%\n6 1.5 2.5 0.1 0.1\n%\n0 0.1 0\n1.5 0.2 0.1\n%\n0.5 72 1.0 0.1\n0.7 5 2 0\n%\n\
             0 0 0 0\n2 0.1 0 0",
        )
    },
    cases: 8000,
};

fn data(bytes: &[u8], parse: fn(&Sources<'_>) -> Result<DataSet, LogError>) -> Judged {
    let Some(text) = text(bytes) else {
        return Ok(0);
    };
    let mut parts = text.splitn(5, "%\n");
    let paths = ["b", "l", "o", "m", "t"].map(Path::new);
    let mut source = |index: usize| Source {
        path: paths[index],
        text: parts.next().unwrap_or_default(),
    };
    let sources = Sources {
        barcodes: source(0),
        landmarks: source(1),
        odometry: source(2),
        measurement: source(3),
        truth: source(4),
    };
    let data = match parse(&sources) {
        Ok(data) => data,
        Err(error) => {
            let names = [
                sources.barcodes,
                sources.landmarks,
                sources.odometry,
                sources.measurement,
                sources.truth,
            ];
            let from = names.iter().find(|source| {
                error
                    .message
                    .starts_with(&format!("{}:", source.path.display()))
            });
            let (text, file) = from.map_or(("", "?"), |source| {
                (source.text, source.path.to_str().unwrap_or("?"))
            });
            return named(text, file, &error);
        }
    };
    let lines =
        [sources.odometry, sources.measurement, sources.truth].map(|source| filled(source.text));
    let taken = [
        data.commands.len(),
        data.measurements.len(),
        data.truth.len(),
    ];
    demand(lines == taken, || format!("{taken:?} of {lines:?} lines"))?;
    let words = |line: &str| {
        line.split_whitespace()
            .nth(1)
            .and_then(|word| word.parse::<f64>().ok())
    };
    let written = sources
        .measurement
        .text
        .lines()
        .filter(|line| filled(line) > 0)
        .map(words);
    for (measurement, written) in data.measurements.iter().zip(written) {
        demand(written == Some(f64::from(measurement.barcode)), || {
            format!("{written:?} became {}", measurement.barcode)
        })?;
    }
    Ok(taken[1])
}
