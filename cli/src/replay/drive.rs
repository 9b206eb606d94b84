//! The recorded drive as a course: poses, twists and returns in one frame.

use crate::picture::view::{Pose, transform};
use haltline_logs::sena::Log;

/// Rows on either side over which a motion is averaged: increments and stamps of a log often come
/// from different clocks, and single rows then jump.
const SMOOTHING: usize = 2;

/// The drive at the time of one tick of the kernel.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Time since the start, seconds.
    pub t_s: f64,
    /// Pose in the frame of the first row.
    pub pose: Pose,
    /// Motion one tick earlier, m/s and rad/s: what the drive was told.
    pub told: [f64; 2],
    /// Motion now: what the odometry measures.
    pub speed: [f64; 2],
    /// Motion one tick later: what the driver wanted.
    pub wanted: [f64; 2],
    /// Index of the row whose sweep ended now; none between two rows.
    pub row: Option<usize>,
    /// Returns of that sweep in the frame of the first row, metres.
    pub returns_m: Vec<[f64; 2]>,
    /// Corners of the area that the sweep saw free: the laser, then each valid return.
    pub seen_m: Vec<[f64; 2]>,
}

/// All ticks: one at each row, and more between two rows that are farther apart than the period.
#[must_use]
pub fn course(log: &Log, period_s: f64) -> Vec<Moment> {
    let poses = poses(log);
    let twists: Vec<[f64; 2]> = (0..poses.len()).map(|i| twist(log, &poses, i)).collect();
    let mut moments: Vec<Moment> = Vec::new();
    for (index, row) in log.rows.iter().enumerate() {
        let (returns_m, seen_m) = sweep(log, &row.ranges_m, poses[index]);
        moments.push(Moment {
            t_s: row.t_s,
            pose: poses[index],
            told: [0.0; 2],
            speed: twists[index],
            wanted: [0.0; 2],
            row: Some(index),
            returns_m,
            seen_m,
        });
        let Some(next) = log.rows.get(index + 1) else {
            break;
        };
        let span_s = next.t_s - row.t_s;
        let steps = (span_s / period_s.max(1e-3)).ceil().max(1.0);
        for step in 1..steps as usize {
            let part = step as f64 / steps;
            moments.push(Moment {
                t_s: row.t_s + span_s * part,
                pose: along(poses[index], next.increment_m_rad, part),
                told: [0.0; 2],
                speed: std::array::from_fn(|i| {
                    twists[index][i] + part * (twists[index + 1][i] - twists[index][i])
                }),
                wanted: [0.0; 2],
                row: None,
                returns_m: Vec::new(),
                seen_m: Vec::new(),
            });
        }
    }
    link(&mut moments);
    moments
}

/// Whether a twist is rest.
#[must_use]
pub fn rests([linear, angular]: [f64; 2]) -> bool {
    linear.abs() < 1e-9 && angular.abs() < 1e-9
}

/// Enters what was told before and wanted after each tick.
fn link(moments: &mut [Moment]) {
    let speeds: Vec<[f64; 2]> = moments.iter().map(|moment| moment.speed).collect();
    for (index, moment) in moments.iter_mut().enumerate() {
        moment.told = index
            .checked_sub(1)
            .map_or([0.0; 2], |before| speeds[before]);
        moment.wanted = speeds.get(index + 1).copied().unwrap_or([0.0; 2]);
    }
}

fn poses(log: &Log) -> Vec<Pose> {
    let mut pose = [0.0; 3];
    log.rows
        .iter()
        .map(|row| {
            pose = along(pose, row.increment_m_rad, 1.0);
            pose
        })
        .collect()
}

/// Pose after a part of an increment, driven as one arc.
fn along(from: Pose, [dx, dy, dtheta]: [f64; 3], part: f64) -> Pose {
    let [x, y] = transform(from, [dx, dy]);
    // The chord of a part of an arc, seen from the chord of the whole.
    let half = dtheta / 2.0;
    let (stretch, bend) = if half.abs() > 1e-6 {
        ((half * part).sin() / half.sin(), half * part - half)
    } else {
        (part, 0.0)
    };
    let chord = [x - from[0], y - from[1]];
    let (sin, cos) = bend.sin_cos();
    [
        from[0] + stretch * (cos * chord[0] - sin * chord[1]),
        from[1] + stretch * (sin * chord[0] + cos * chord[1]),
        from[2] + dtheta * part,
    ]
}

/// Mean motion around a row; zero where the robot did not move at that row at all.
fn twist(log: &Log, poses: &[Pose], index: usize) -> [f64; 2] {
    let stands = |row: usize| {
        log.rows
            .get(row)
            .is_none_or(|row| row.increment_m_rad.iter().all(|part| part.abs() < 1e-4))
    };
    if stands(index) && stands(index + 1) {
        return [0.0, 0.0];
    }
    let from = index.saturating_sub(SMOOTHING);
    let to = (index + SMOOTHING).min(poses.len().saturating_sub(1));
    let span_s = log.rows[to].t_s - log.rows[from].t_s;
    if span_s <= 0.0 {
        return [0.0, 0.0];
    }
    let path: f64 = log.rows[from + 1..=to]
        .iter()
        .map(|row| arc_m(row.increment_m_rad))
        .sum();
    [path / span_s, (poses[to][2] - poses[from][2]) / span_s]
}

/// Signed length of the arc of an increment: the chord is shorter.
fn arc_m([dx, dy, dtheta]: [f64; 3]) -> f64 {
    let half = dtheta / 2.0;
    let stretch = if half.abs() > 1e-6 {
        half / half.sin()
    } else {
        1.0
    };
    let sign = if dx < 0.0 { -1.0 } else { 1.0 };
    sign * dx.hypot(dy) * stretch
}

fn sweep(log: &Log, ranges_m: &[f32], pose: Pose) -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
    let header = &log.header;
    let step = header.aperture_rad / (header.beams.max(2) - 1) as f64;
    let [x, y, yaw] = header.sensor_m_rad;
    let laser = transform(pose, [x, y]);
    let mut returns = Vec::new();
    let mut seen = vec![laser];
    for (index, range) in ranges_m.iter().enumerate() {
        let range_m = f64::from(*range);
        if range_m <= 0.0 || range_m > header.max_range_m {
            // Nothing is known about this ray; the fan goes back to the laser.
            if seen.last() != Some(&laser) {
                seen.push(laser);
            }
            continue;
        }
        let angle = yaw - header.aperture_rad / 2.0 + index as f64 * step;
        let point = transform(pose, [x + range_m * angle.cos(), y + range_m * angle.sin()]);
        returns.push(point);
        seen.push(point);
    }
    (returns, seen)
}

/// Length of the path in metres.
#[must_use]
pub fn length_m(moments: &[Moment]) -> f64 {
    moments
        .windows(2)
        .map(|pair| {
            let (a, b) = (pair[0].pose, pair[1].pose);
            (b[0] - a[0]).hypot(b[1] - a[1])
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use haltline_logs::sena::{Header, Row};

    fn log() -> Log {
        let row = |t_s, dx, ranges: [f32; 3]| Row {
            t_s,
            increment_m_rad: [dx, 0.0, 0.0],
            ranges_m: ranges.to_vec(),
        };
        Log {
            header: Header {
                beams: 3,
                aperture_rad: std::f64::consts::PI,
                max_range_m: 80.0,
                sensor_m_rad: [0.5, 0.0, 0.0],
            },
            rows: vec![
                row(0.0, 0.0, [1.0, 2.0, 3.0]),
                row(0.5, 0.2, [1.0, 0.0, 3.0]),
            ],
        }
    }

    fn near(a: [f64; 2], b: [f64; 2]) -> bool {
        (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-9
    }

    #[test]
    fn beams_run_from_right_to_left() {
        let moments = course(&log(), 1.0);
        assert!(near(moments[0].returns_m[0], [0.5, -1.0]));
        assert!(near(moments[0].returns_m[1], [2.5, 0.0]));
        assert!(near(moments[0].returns_m[2], [0.5, 3.0]));
        assert_eq!(moments[1].returns_m.len(), 2);
    }

    #[test]
    fn ticks_fill_the_time_between_rows() {
        let moments = course(&log(), 0.1);
        let rows: Vec<_> = moments.iter().map(|m| m.row).collect();
        assert_eq!(rows, vec![Some(0), None, None, None, None, Some(1)]);
        assert!((moments[2].t_s - 0.2).abs() < 1e-12);
        assert!(near([moments[2].pose[0], moments[2].pose[1]], [0.08, 0.0]));
        assert!(near(moments[2].told, moments[1].speed));
        assert!(near(moments[2].wanted, moments[3].speed));
        assert!((length_m(&moments) - 0.2).abs() < 1e-12);
    }

    #[test]
    fn parts_of_an_increment_lie_on_its_arc() {
        // A quarter circle of radius 1 to the left.
        let quarter = [1.0, 1.0, std::f64::consts::FRAC_PI_2];
        let [x, y, theta] = along([0.0; 3], quarter, 0.5);
        let eighth = std::f64::consts::FRAC_PI_4;
        assert!(near([x, y], [eighth.sin(), 1.0 - eighth.cos()]), "{x} {y}");
        assert!((theta - eighth).abs() < 1e-12);
        assert!((arc_m(quarter) - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
    }
}
