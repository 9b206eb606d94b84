//! The map of a recorded drive: every sweep entered at the pose that the recording believed in.

use super::Carmen;
use crate::failure::{Failure, write_file};
use crate::picture::view::Pose;
use haltline::config::Scanner;
use haltline::convert;
use haltline::grid::{GridRules, OccupancyGrid};
use haltline::input::{Pose as GridPose, Reading};
use haltline::time::Instant;
use haltline::units::Length;
use haltline_maps::Map;
use haltline_robots::Robot;
use std::path::{Path, PathBuf};
use tiny_skia::{Color, Pixmap};

/// Cells per side.
const SIDE: usize = 1000;
/// Enough for a dozen copies of a grid of [`SIDE`] by [`SIDE`] cells.
const STACK_BYTES: usize = 32 << 20;
/// What is drawn around the poses, m.
const AROUND_M: f64 = 12.0;

/// Enters all sweeps and writes `map.png`.
///
/// # Errors
/// The drive is too large for a map, or the file cannot be written.
pub fn write_map(out: &Path, drive: &Carmen, robot: &Robot) -> Result<PathBuf, Failure> {
    let scanner = robot.config.scanners.first().copied().flatten();
    let scanner = scanner.ok_or_else(|| Failure::input("the robot has no scanner"))?;
    let scanner = at_the_pose(scanner);
    // A grid is made on the stack before it is boxed, and unoptimised builds copy it often.
    let map = std::thread::scope(|scope| {
        std::thread::Builder::new()
            .stack_size(STACK_BYTES)
            .spawn_scoped(scope, || map(drive, &scanner, robot))
            .map_err(|error| Failure::not_checkable(format!("no thread for the map: {error}")))?
            .join()
            .map_err(|_| Failure::not_checkable("drawing the map failed"))?
    })?;
    let path = out.join("map.png");
    let bytes = encode(&map)
        .ok_or_else(|| Failure::not_checkable(format!("{}: cannot be drawn", path.display())))?;
    write_file(&path, &bytes)?;
    Ok(path)
}

/// The log's poses are those of the laser itself.
fn at_the_pose(scanner: Scanner) -> Scanner {
    Scanner {
        x: Length::ZERO,
        y: Length::ZERO,
        ..scanner
    }
}

fn map(drive: &Carmen, scanner: &Scanner, robot: &Robot) -> Result<Map, Failure> {
    let too_large = |why: String| Failure::input(format!("the drive cannot be mapped: {why}"));
    let (low, high) = extent(&drive.laser);
    let span_m = (high[0] - low[0]).max(high[1] - low[1]);
    // 0.1 m, or coarser where the drive needs it.
    let cell_mm = (span_m / SIDE as f64 * 1000.0).ceil().max(100.0);
    if cell_mm > 1000.0 {
        return Err(too_large(format!("{span_m:.0} m across; at most {SIDE} m")));
    }
    let rules = GridRules {
        cell: Length::from_mm(cell_mm as i32),
        ..GridRules::default()
    };
    let corner = pose([low[0], low[1], 0.0]).ok_or_else(|| too_large("its poses".to_owned()))?;
    let grid = OccupancyGrid::<SIDE, SIDE>::new(rules, corner);
    let mut grid = Box::new(grid.map_err(|error| too_large(error.to_string()))?);
    let encoding = robot
        .values
        .scanners
        .first()
        .map(|scanner| scanner.encoding);
    let encoding = encoding.ok_or_else(|| Failure::input("the robot has no scanner"))?;
    for (row, at) in drive.log.rows.iter().zip(&drive.laser) {
        let beams: Vec<_> = row
            .ranges_m
            .iter()
            .map(|range| {
                convert::beam(
                    *range,
                    encoding.into(),
                    scanner.range_min,
                    scanner.range_max,
                )
            })
            .collect();
        let Some(at) = pose(*at) else { continue };
        grid.update(&at, scanner, &beams)
            .map_err(|refused| too_large(format!("{refused:?}")))?;
    }
    Ok(Map::from_grid(&grid))
}

fn pose(at: Pose) -> Option<GridPose> {
    match convert::odometry(Instant::default(), at, [0.0; 2], None) {
        Reading::Value(odometry) => Some(odometry.pose),
        _ => None,
    }
}

fn extent(poses: &[Pose]) -> ([f64; 2], [f64; 2]) {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for pose in poses {
        for axis in 0..2 {
            low[axis] = low[axis].min(pose[axis] - AROUND_M);
            high[axis] = high[axis].max(pose[axis] + AROUND_M);
        }
    }
    (low, high)
}

/// Black is occupied, white free, grey unknown; cut to what is known.
fn encode(map: &Map) -> Option<Vec<u8>> {
    let picture = map.picture();
    let unknown = 205;
    let rows: Vec<&[u8]> = picture.greys.chunks(picture.width).collect();
    let seen = |row: &&[u8]| row.iter().any(|grey| *grey != unknown);
    let top = rows.iter().position(seen)?;
    let bottom = rows.iter().rposition(seen)?;
    let rows = &rows[top..=bottom];
    let column = |at: usize| rows.iter().any(|row| row[at] != unknown);
    let left = (0..picture.width).find(|at| column(*at))?;
    let right = (0..picture.width).rfind(|at| column(*at))?;
    let (width, height) = (right - left + 1, rows.len());
    let mut canvas = Pixmap::new(width as u32, height as u32)?;
    canvas.fill(Color::WHITE);
    let greys = rows.iter().flat_map(|row| &row[left..=right]);
    for (pixel, grey) in canvas.pixels_mut().iter_mut().zip(greys) {
        *pixel = tiny_skia::ColorU8::from_rgba(*grey, *grey, *grey, 255).premultiply();
    }
    canvas.encode_png().ok()
}
