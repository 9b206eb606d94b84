//! Reads recorded drives in the `sena` format: CSV, plain or gzip.
//!
//! Two header lines; then in each line a time, the odometry increment since the last line in the
//! robot frame at the last line, and the ranges of one sweep from right to left. A range of 0 means
//! no valid return. A line that does not fit is an error with its number, never skipped.

use crate::LogError;
use std::io::Read as _;
use std::path::Path;

/// The laser as the header describes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Header {
    /// Beams per sweep.
    pub beams: usize,
    /// Angle between the first and the last beam, radians.
    pub aperture_rad: f64,
    /// Largest range, metres.
    pub max_range_m: f64,
    /// Laser position in the robot frame: x, y in metres, yaw in radians.
    pub sensor_m_rad: [f64; 3],
}

/// One line of the log.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Time since the start, seconds.
    pub t_s: f64,
    /// Odometry increment since the row before, in the robot frame then: x, y in metres, angle in radians.
    pub increment_m_rad: [f64; 3],
    /// Ranges in metres, right to left; 0 is no valid return.
    pub ranges_m: Vec<f32>,
}

/// A recorded drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    /// The laser.
    pub header: Header,
    /// The drive in order of time; at least two rows.
    pub rows: Vec<Row>,
}

/// Reads a log.
///
/// # Errors
/// Unusable input with file and line.
pub fn read(path: &Path) -> Result<Log, LogError> {
    parse(path, &text(path)?)
}

/// Longest text that a compressed log may hold, bytes; hours of sweeps are shorter.
const TEXT_MAX: u64 = 1 << 30;

/// A few bytes of gzip can stand for any number: reading stops at `most`.
fn inflate(bytes: &[u8], most: u64) -> Result<String, String> {
    let mut text = String::new();
    let mut decoder = flate2::read::MultiGzDecoder::new(bytes).take(most + 1);
    let read = decoder
        .read_to_string(&mut text)
        .map_err(|error| format!("broken gzip: {error}"))?;
    if read as u64 > most {
        return Err(format!("holds more than {most} bytes of text"));
    }
    Ok(text)
}

/// The text of a log file, plain or gzip.
///
/// # Errors
/// No such file, broken gzip, or not a text.
pub fn text(path: &Path) -> Result<String, LogError> {
    if !path.exists() {
        return Err(LogError::input(format!(
            "{}: no such file. The recorded drive is not part of the project; \
             give the path of your copy",
            path.display()
        )));
    }
    let bytes = std::fs::read(path).map_err(|error| LogError::read(path, &error))?;
    if bytes.starts_with(&[0x1f, 0x8b]) {
        inflate(&bytes, TEXT_MAX)
            .map_err(|why| LogError::input(format!("{}: {why}", path.display())))
    } else {
        String::from_utf8(bytes)
            .map_err(|_| LogError::input(format!("{}: not a text file", path.display())))
    }
}

/// Reads the text of a log; `path` names it in messages.
///
/// # Errors
/// Unusable text with file and line.
pub fn parse(path: &Path, text: &str) -> Result<Log, LogError> {
    let mut lines = text.lines().enumerate();
    let Some((_, first)) = lines.next() else {
        return Err(LogError::line(path, 1, "the file is empty"));
    };
    let header = parse_header(first).map_err(|why| LogError::line(path, 1, why))?;
    match lines.next() {
        Some((_, second)) if second.starts_with('#') => {}
        _ => {
            return Err(LogError::line(
                path,
                2,
                "the second line must be a comment naming the columns: # t_s,dx_m,dy_m,dtheta_rad,range_m...",
            ));
        }
    }
    let mut rows: Vec<Row> = Vec::new();
    for (index, line) in lines {
        let row = parse_row(line, &header).map_err(|why| LogError::line(path, index + 1, why))?;
        if let Some(last) = rows.last()
            && row.t_s <= last.t_s
        {
            let why = format!("time {} s is not after {} s", row.t_s, last.t_s);
            return Err(LogError::line(path, index + 1, why));
        }
        rows.push(row);
    }
    if rows.len() < 2 {
        let why = "a drive needs at least two rows";
        return Err(LogError::line(path, rows.len() + 3, why));
    }
    Ok(Log { header, rows })
}

fn parse_header(line: &str) -> Result<Header, String> {
    let words: Vec<&str> = line.trim_start_matches('#').split_whitespace().collect();
    let value = |key: &str| -> Result<f64, String> {
        words
            .iter()
            .position(|word| *word == key)
            .and_then(|at| words.get(at + 1))
            .ok_or_else(|| format!("the header lacks `{key} VALUE`"))?
            .parse::<f64>()
            .ok()
            .filter(|value| value.is_finite())
            .ok_or_else(|| format!("the header's `{key}` is not a number"))
    };
    let beams = value("beams")?;
    if !(2.0..=10_000.0).contains(&beams) || beams.fract() > 0.0 {
        return Err(format!(
            "beams = {beams}: must be a whole number from 2 to 10000"
        ));
    }
    let aperture_rad = value("aperture_rad")?;
    if !(aperture_rad > 0.0 && aperture_rad <= std::f64::consts::TAU) {
        return Err(format!(
            "aperture_rad = {aperture_rad}: must be above 0 and at most 2 pi"
        ));
    }
    if value("right_to_left")? < 0.5 {
        return Err("right_to_left must be 1: beams in the other order are not read".into());
    }
    Ok(Header {
        beams: beams as usize,
        aperture_rad,
        max_range_m: value("max_range_m")?,
        sensor_m_rad: [
            value("sensor_x_m")?,
            value("sensor_y_m")?,
            value("sensor_yaw_rad")?,
        ],
    })
}

fn parse_row(line: &str, header: &Header) -> Result<Row, String> {
    let fields: Vec<&str> = line.split(',').collect();
    let wanted = header.beams + 4;
    if fields.len() != wanted {
        return Err(format!(
            "{} values, expected {wanted}: t_s, dx_m, dy_m, dtheta_rad and {} ranges",
            fields.len(),
            header.beams
        ));
    }
    let number = |column: usize| -> Result<f64, String> {
        crate::number(fields[column])
            .ok_or_else(|| format!("value {} is not a number: `{}`", column + 1, fields[column]))
    };
    let ranges_m = (4..wanted)
        .map(|column| {
            let range = number(column)?;
            if range < 0.0 {
                return Err(format!("value {}: range {range} m is negative", column + 1));
            }
            Ok(range as f32)
        })
        .collect::<Result<_, _>>()?;
    Ok(Row {
        t_s: number(0)?,
        increment_m_rad: [number(1)?, number(2)?, number(3)?],
        ranges_m,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "# beams 3 aperture_rad 3.14 right_to_left 1 max_range_m 80 sensor_x_m 0.5 \
                        sensor_y_m 0 sensor_yaw_rad 0 sigma_m 0.01\n# t_s,...\n";

    fn error(body: &str) -> String {
        parse(Path::new("x.csv"), &format!("{HEAD}{body}"))
            .expect_err("must be refused")
            .message
    }

    #[test]
    fn a_good_log_is_read() {
        let body = "0.0,0,0,0,1,2,0\n0.2,0.1,0,0.01,1,2,3\n";
        let log = parse(Path::new("x.csv"), &format!("{HEAD}{body}")).expect("good");
        assert_eq!(log.rows.len(), 2);
        assert_eq!(log.header.beams, 3);
        assert_eq!(log.rows[1].ranges_m, vec![1.0, 2.0, 3.0]);
    }

    #[test]
    fn bad_lines_are_named() {
        assert!(error("0.0,0,0,0,1,2\n").starts_with("x.csv:3: 6 values, expected 7"));
        assert!(error("0.0,0,0,0,1,x,3\n").contains("x.csv:3: value 6 is not a number: `x`"));
        assert!(error("0.0,0,0,0,1,NaN,3\n").contains("value 6"));
        assert!(error("0.0,0,0,0,1,-2,3\n").contains("negative"));
        let twice = "0.1,0,0,0,1,2,3\n0.1,0,0,0,1,2,3\n";
        assert!(error(twice).starts_with("x.csv:4: time"));
        assert!(error("0.1,0,0,0,1,2,3\n").contains("at least two rows"));
    }

    #[test]
    fn a_compressed_text_has_a_longest_length() {
        use std::io::Write as _;
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(&[b'0'; 100_000]).expect("in memory");
        let bytes = encoder.finish().expect("in memory");
        assert!(bytes.len() < 1000);
        assert_eq!(inflate(&bytes, 100_000).expect("fits").len(), 100_000);
        let said = inflate(&bytes, 99_999).expect_err("too long");
        assert!(said.contains("more than 99999 bytes"), "{said}");
    }

    #[test]
    fn a_bad_header_is_line_one() {
        let failure = parse(Path::new("x.csv"), "hello\n").expect_err("refused");
        assert!(
            failure
                .message
                .starts_with("x.csv:1: the header lacks `beams VALUE`")
        );
    }
}
