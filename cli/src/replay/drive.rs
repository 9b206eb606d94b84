//! The recorded drive as a course: poses, twists and returns in one frame.

use crate::picture::view::{Pose, transform};
use crate::sena::Log;

/// The drive at the time of one row.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Time since the start, seconds.
    pub t_s: f64,
    /// Pose in the frame of the first row.
    pub pose: Pose,
    /// Motion since the row before, m/s and rad/s: what the odometry measured.
    pub measured: [f64; 2],
    /// Motion until the next row: what the driver wanted.
    pub wanted: [f64; 2],
    /// Returns of the sweep in the frame of the first row, metres.
    pub returns_m: Vec<[f64; 2]>,
    /// Corners of the area that the sweep saw free: the laser, then each valid return.
    pub seen_m: Vec<[f64; 2]>,
}

/// All moments of a log.
#[must_use]
pub fn course(log: &Log) -> Vec<Moment> {
    let mut pose = [0.0, 0.0, 0.0];
    let mut twists = Vec::with_capacity(log.rows.len());
    let mut moments: Vec<Moment> = Vec::with_capacity(log.rows.len());
    let mut last_t_s = None;
    for row in &log.rows {
        let [dx, dy, dtheta] = row.increment_m_rad;
        let [x, y] = transform(pose, [dx, dy]);
        pose = [x, y, pose[2] + dtheta];
        let measured = last_t_s.map_or([0.0, 0.0], |last| twist(row.increment_m_rad, row.t_s - last));
        last_t_s = Some(row.t_s);
        twists.push(measured);
        let (returns_m, seen_m) = sweep(log, &row.ranges_m, pose);
        moments.push(Moment {
            t_s: row.t_s,
            pose,
            measured,
            wanted: [0.0, 0.0],
            returns_m,
            seen_m,
        });
    }
    for (moment, next) in moments.iter_mut().zip(twists.into_iter().skip(1)) {
        moment.wanted = next;
    }
    moments
}

/// Mean twist of an increment: the chord of an arc is shorter than the arc.
fn twist([dx, dy, dtheta]: [f64; 3], span_s: f64) -> [f64; 2] {
    let half = dtheta / 2.0;
    let stretch = if half.abs() > 1e-6 { half / half.sin() } else { 1.0 };
    let sign = if dx < 0.0 { -1.0 } else { 1.0 };
    [sign * dx.hypot(dy) * stretch / span_s, dtheta / span_s]
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
    use crate::sena::{Header, Row};

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

    #[test]
    fn beams_run_from_right_to_left() {
        let moments = course(&log());
        let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-9;
        assert!(near(moments[0].returns_m[0], [0.5, -1.0]));
        assert!(near(moments[0].returns_m[1], [2.5, 0.0]));
        assert!(near(moments[0].returns_m[2], [0.5, 3.0]));
        assert_eq!(moments[1].returns_m.len(), 2);
    }

    #[test]
    fn what_is_wanted_is_what_comes_next() {
        let moments = course(&log());
        assert!((moments[0].wanted[0] - 0.4).abs() < 1e-12);
        assert_eq!(moments[1].measured, moments[0].wanted);
        assert_eq!(moments[1].wanted, [0.0, 0.0]);
        assert!((length_m(&moments) - 0.2).abs() < 1e-12);
    }

    #[test]
    fn the_arc_is_longer_than_its_chord() {
        let [v, omega] = twist([1.0, 1.0, std::f64::consts::FRAC_PI_2], 1.0);
        assert!((v - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
        assert!((omega - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }
}
