//! How good the estimate was: absolute trajectory error, raw and after alignment, landmarks.

use super::drive::Sample;
use haltline::marker::{MarkerFilter, Pose2};
use haltline_logs::mrclam::{DataSet, Truth};
use serde::Serialize;

/// The true pose is not interpolated over longer gaps, s.
const TRUTH_GAP_S: f64 = 0.5;

/// The same place, found and true, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// As estimated.
    pub found: [f64; 2],
    /// As it is.
    pub truth: [f64; 2],
}

/// A rigid motion of the plane: turn, then shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// cos, sin of the turn.
    turn: [f64; 2],
    /// m.
    shift: [f64; 2],
}

impl Alignment {
    /// Nothing moves.
    pub const NONE: Self = Self {
        turn: [1.0, 0.0],
        shift: [0.0, 0.0],
    };

    /// The motion of the first points that brings them nearest to the second, in the mean of
    /// squares.
    #[must_use]
    pub fn of(pairs: &[Pair]) -> Self {
        let n = pairs.len().max(1) as f64;
        let mean = |pick: fn(&Pair) -> [f64; 2]| {
            let sum = pairs
                .iter()
                .map(pick)
                .fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
            [sum[0] / n, sum[1] / n]
        };
        let (from, to) = (mean(|pair| pair.found), mean(|pair| pair.truth));
        let (mut dot, mut cross) = (0.0, 0.0);
        for Pair { found, truth } in pairs {
            let a = [found[0] - from[0], found[1] - from[1]];
            let b = [truth[0] - to[0], truth[1] - to[1]];
            dot += a[0] * b[0] + a[1] * b[1];
            cross += a[0] * b[1] - a[1] * b[0];
        }
        let (sin, cos) = cross.atan2(dot).sin_cos();
        let turned = [cos * from[0] - sin * from[1], sin * from[0] + cos * from[1]];
        Self {
            turn: [cos, sin],
            shift: [to[0] - turned[0], to[1] - turned[1]],
        }
    }

    /// A point moved.
    #[must_use]
    pub fn apply(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [cos, sin] = self.turn;
        [
            cos * x - sin * y + self.shift[0],
            sin * x + cos * y + self.shift[1],
        ]
    }
}

/// Root mean square and largest distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distance {
    /// Root of the mean square, m.
    pub rms_m: f64,
    /// Largest, m.
    pub max_m: f64,
}

impl Distance {
    /// Between pairs of points, the first of each moved.
    #[must_use]
    pub fn of(pairs: &[Pair], alignment: &Alignment) -> Self {
        let squares = pairs.iter().map(|Pair { found, truth }| {
            let [x, y] = alignment.apply(*found);
            (x - truth[0]).powi(2) + (y - truth[1]).powi(2)
        });
        let (sum, max) = squares.fold((0.0, 0.0), |(sum, max), s| (sum + s, f64::max(max, s)));
        Self {
            rms_m: (sum / pairs.len().max(1) as f64).sqrt(),
            max_m: f64::sqrt(max),
        }
    }
}

/// Where the robot truly was; `None` outside of what is known.
#[must_use]
pub fn truth_at(truth: &[Truth], time_s: f64) -> Option<Pose2> {
    let after = truth.partition_point(|row| row.time_s < time_s);
    let (b, a) = (truth.get(after)?, truth.get(after.checked_sub(1)?)?);
    let span_s = b.time_s - a.time_s;
    if span_s > TRUTH_GAP_S {
        return None;
    }
    let part = (time_s - a.time_s) / span_s.max(1e-9);
    let mix = |at: usize| a.pose[at] + (b.pose[at] - a.pose[at]) * part;
    Some(Pose2::new(mix(0), mix(1), a.pose[2]))
}

/// Estimated and true positions of the same moments.
#[must_use]
pub fn paired(data: &DataSet, samples: &[Sample], pick: impl Fn(&Sample) -> Pose2) -> Vec<Pair> {
    samples
        .iter()
        .filter_map(|sample| {
            let truth = truth_at(&data.truth, sample.time_s)?;
            let pose = pick(sample);
            Some(Pair {
                found: [pose.x_m, pose.y_m],
                truth: [truth.x_m, truth.y_m],
            })
        })
        .collect()
}

/// Estimated and true positions of the landmarks found.
#[must_use]
pub fn landmarks(data: &DataSet, filter: &dyn MarkerFilter) -> Vec<Pair> {
    data.landmarks
        .iter()
        .filter_map(|(subject, truth)| {
            let pose = filter.marker(*subject)?.pose;
            Some(Pair {
                found: [pose.x_m, pose.y_m],
                truth: *truth,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alignment_finds_a_rigid_motion() {
        let points = [[0.0, 0.0], [1.0, 0.0], [3.0, 2.0], [-1.0, 4.0]];
        let motion = Alignment {
            turn: [0.6, 0.8],
            shift: [5.0, -2.0],
        };
        let pairs = points.map(|found| Pair {
            found,
            truth: motion.apply(found),
        });
        let found = Alignment::of(&pairs);
        assert!(Distance::of(&pairs, &found).max_m < 1e-12);
        assert!(Distance::of(&pairs, &Alignment::NONE).rms_m > 1.0);
    }

    #[test]
    fn truth_is_not_invented_in_gaps() {
        let row = |time_s, x| Truth {
            time_s,
            pose: [x, 0.0, 0.0],
        };
        let truth = [row(1.0, 0.0), row(1.2, 2.0), row(3.0, 9.0)];
        let at = truth_at(&truth, 1.1).map(|pose| pose.x_m);
        assert!((at.unwrap() - 1.0).abs() < 1e-9);
        assert_eq!(truth_at(&truth, 2.0), None);
        assert_eq!(truth_at(&truth, 0.5), None);
        assert_eq!(truth_at(&truth, 3.5), None);
    }
}
