//! Passing the motion and the sightings by a distribution, linearly or by sigma points.

use super::sigma::{self, Spread, Weights};
use super::{pose, rotation, vector};
use haltline::marker::{Increment, OdometryNoise, Pose2, wrap};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Where a marker's pose is to be found.
#[derive(Clone, Copy, Debug)]
pub(super) enum Target {
    /// In the state, from this number on.
    Learned(usize),
    /// In the map.
    Mapped(Pose2),
}

/// One sighting: which marker, what was measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measurement {
    pub(super) marker: Target,
    pub(super) seen: Vector3<f64>,
    pub(super) noise: Matrix3<f64>,
    /// Numbers measured: 3, or 2 without the heading.
    pub(super) numbers: usize,
}

/// What a frame is expected to look like.
pub(super) struct Moments {
    mean: DVector<f64>,
    /// Covariance of the innovation, noise included.
    pub(super) spread: DMatrix<f64>,
    /// Covariance of state and measurement.
    pub(super) cross: DMatrix<f64>,
}

fn block(state: &DVector<f64>, at: usize) -> Vector3<f64> {
    state.fixed_rows::<3>(at).into_owned()
}

impl Target {
    fn pose(self, state: &DVector<f64>) -> Pose2 {
        match self {
            Self::Learned(at) => pose(&block(state, at)),
            Self::Mapped(known) => known,
        }
    }
}

/// What the sightings would be in this state (Loh 3.6).
fn expected(state: &DVector<f64>, measurements: &[Measurement]) -> DVector<f64> {
    let robot = pose(&block(state, 0));
    let mut numbers = Vec::new();
    for measurement in measurements {
        let marker = measurement.marker.pose(state);
        let seen = vector(&robot.sees(&marker));
        numbers.extend_from_slice(&seen.as_slice()[..measurement.numbers]);
    }
    DVector::from_vec(numbers)
}

/// Wraps the headings of a difference of two stacked measurements.
fn wrap_differences(difference: &mut DVector<f64>, measurements: &[Measurement]) {
    let mut at = 0;
    for measurement in measurements {
        if measurement.numbers == 3 {
            difference[at + 2] = wrap(difference[at + 2]);
        }
        at += measurement.numbers;
    }
}

/// The derivative of [`expected`] (Loh 3.10 corrected, 3.11).
fn derivative(state: &DVector<f64>, measurements: &[Measurement]) -> DMatrix<f64> {
    let rows = measurements.iter().map(|m| m.numbers).sum();
    let mut h = DMatrix::zeros(rows, state.len());
    let robot = pose(&block(state, 0));
    let turn = rotation(robot.heading_rad).transpose();
    let mut at = 0;
    for measurement in measurements {
        let n = measurement.numbers;
        let marker = measurement.marker.pose(state);
        let seen = robot.sees(&marker);
        let mut by_robot = -turn;
        by_robot[(0, 2)] = seen.y_m;
        by_robot[(1, 2)] = -seen.x_m;
        h.view_mut((at, 0), (n, 3)).copy_from(&by_robot.rows(0, n));
        if let Target::Learned(column) = measurement.marker {
            h.view_mut((at, column), (n, 3)).copy_from(&turn.rows(0, n));
        }
        at += n;
    }
    h
}

fn noise(measurements: &[Measurement]) -> DMatrix<f64> {
    let rows = measurements.iter().map(|m| m.numbers).sum();
    let mut r = DMatrix::zeros(rows, rows);
    let mut at = 0;
    for measurement in measurements {
        let n = measurement.numbers;
        let own = measurement.noise.view((0, 0), (n, n));
        r.view_mut((at, at), (n, n)).copy_from(&own);
        at += n;
    }
    r
}

impl Moments {
    pub(super) fn linear(
        mean: &DVector<f64>,
        covariance: &DMatrix<f64>,
        measurements: &[Measurement],
    ) -> Self {
        let h = derivative(mean, measurements);
        let cross = covariance * h.transpose();
        Self {
            mean: expected(mean, measurements),
            spread: &h * &cross + noise(measurements),
            cross,
        }
    }

    /// Falls back to the derivative where the covariance has no root.
    pub(super) fn unscented(
        spread: Spread,
        mean: &DVector<f64>,
        covariance: &DMatrix<f64>,
        measurements: &[Measurement],
    ) -> Self {
        let weights = Weights::new(spread, mean.len());
        let Some(offsets) = sigma::offsets(&weights, covariance) else {
            return Self::linear(mean, covariance, measurements);
        };
        let middle = expected(mean, measurements);
        let passed: Vec<DVector<f64>> = offsets
            .column_iter()
            .map(|offset| {
                let mut off = expected(&(mean + offset), measurements) - &middle;
                wrap_differences(&mut off, measurements);
                off
            })
            .collect();
        let passed = DMatrix::from_columns(&passed);
        let (shift, own) = sigma::combine(&weights, &passed);
        Self {
            cross: sigma::cross(&weights, &offsets, &passed, &shift),
            mean: middle + shift,
            spread: own + noise(measurements),
        }
    }

    /// Measured minus expected.
    pub(super) fn innovation(&self, measurements: &[Measurement]) -> DVector<f64> {
        let seen = measurements
            .iter()
            .flat_map(|m| m.seen.as_slice()[..m.numbers].iter());
        let mut innovation = DVector::from_vec(seen.copied().collect()) - &self.mean;
        wrap_differences(&mut innovation, measurements);
        innovation
    }
}

fn moved(state: &DVector<f64>, increment: &Increment) -> DVector<f64> {
    let step = Pose2::new(increment.forward_m, increment.left_m, increment.turn_rad);
    let mut after = state.clone();
    let robot = pose(&block(state, 0));
    after.rows_mut(0, 3).copy_from(&vector(&robot.then(&step)));
    after
}

/// Loh 3.15, the noise left out.
pub(super) fn move_linear(
    mean: &DVector<f64>,
    covariance: &DMatrix<f64>,
    increment: &Increment,
) -> (DVector<f64>, DMatrix<f64>) {
    let after = moved(mean, increment);
    let n = mean.len();
    let mut f = DMatrix::identity(n, n);
    f[(0, 2)] = mean[1] - after[1];
    f[(1, 2)] = after[0] - mean[0];
    let covariance = &f * covariance * f.transpose();
    (after, covariance)
}

/// Loh, algorithm 3.1, the noise left out.
pub(super) fn move_unscented(
    spread: Spread,
    mean: &DVector<f64>,
    covariance: &DMatrix<f64>,
    increment: &Increment,
) -> (DVector<f64>, DMatrix<f64>) {
    let weights = Weights::new(spread, mean.len());
    let Some(offsets) = sigma::offsets(&weights, covariance) else {
        return move_linear(mean, covariance, increment);
    };
    let middle = moved(mean, increment);
    let passed: Vec<DVector<f64>> = offsets
        .column_iter()
        .map(|offset| {
            let mut off = moved(&(mean + offset), increment) - &middle;
            off[2] = wrap(off[2]);
            off
        })
        .collect();
    let (shift, covariance) = sigma::combine(&weights, &DMatrix::from_columns(&passed));
    (middle + shift, covariance)
}

/// Variances along, across and in heading of one increment.
pub(super) fn odometry_variances(noise: &OdometryNoise, increment: &Increment) -> Vector3<f64> {
    let way = increment.forward_m.hypot(increment.left_m);
    Vector3::new(
        noise.along_m2_per_m * way + noise.position_m2_per_sample,
        noise.across_m2_per_m * way + noise.position_m2_per_sample,
        noise.heading_rad2_per_m * way
            + noise.heading_rad2_per_rad * increment.turn_rad.abs()
            + noise.heading_rad2_per_sample,
    )
}

/// The same in the frame of the map; a turn's error bends the way by half of it.
pub(super) fn odometry_noise(
    heading_rad: f64,
    increment: &Increment,
    variances: Vector3<f64>,
) -> Matrix3<f64> {
    let mut bend = Matrix3::identity();
    bend[(0, 2)] = -increment.left_m / 2.0;
    bend[(1, 2)] = increment.forward_m / 2.0;
    let by = rotation(heading_rad) * bend;
    by * Matrix3::from_diagonal(&variances) * by.transpose()
}
