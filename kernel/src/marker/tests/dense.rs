//! The same filter with dense matrices: an independent computation of the same numbers.
//!
//! Errors are motions of the plane about the origin, taken from the matrix exponential; the
//! kernel's are about an anchor for each pose. What both say of x, y and heading must agree.

use crate::marker::{Increment, Pose2, Sighting, wrap};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use std::vec::Vec;

pub(super) struct Dense {
    pub(super) mean: DVector<f64>,
    pub(super) covariance: DMatrix<f64>,
    pub(super) ids: Vec<u16>,
}

pub(super) fn vector(pose: &Pose2) -> Vector3<f64> {
    Vector3::new(pose.x_m, pose.y_m, pose.heading_rad)
}

/// Derivative of `f` by central differences.
pub(super) fn derivative(
    f: impl Fn(Vector3<f64>) -> Vector3<f64>,
    at: Vector3<f64>,
) -> Matrix3<f64> {
    let step = 1e-6;
    let columns: Vec<Vector3<f64>> = (0..3)
        .map(|axis| {
            let mut delta = Vector3::zeros();
            delta[axis] = step;
            let mut difference = f(at + delta) - f(at - delta);
            difference[2] = wrap(difference[2]);
            difference / (2.0 * step)
        })
        .collect();
    Matrix3::from_columns(&columns)
}

pub(super) fn pose(v: Vector3<f64>) -> Pose2 {
    Pose2::new(v[0], v[1], v[2])
}

/// The pose moved with the plane by the motion `error`.
fn displaced(at: &Pose2, error: Vector3<f64>) -> Pose2 {
    let [x, y, turn] = error.into();
    let motion = Matrix3::new(0.0, -turn, x, turn, 0.0, y, 0.0, 0.0, 0.0).exp();
    let to = motion * Vector3::new(at.x_m, at.y_m, 1.0);
    Pose2::new(to[0], to[1], wrap(at.heading_rad + turn))
}

/// Derivative by the error of the pose at which `f` is told to look.
fn by_error(f: impl Fn(&Pose2) -> Pose2, at: &Pose2) -> Matrix3<f64> {
    derivative(|e| vector(&f(&displaced(at, e))), Vector3::zeros())
}

impl Dense {
    pub(super) fn new(start: &Pose2, variances: [f64; 3]) -> Self {
        let count = by_error(|p| *p, start).try_inverse().unwrap();
        let own = count * Matrix3::from_diagonal(&Vector3::from(variances)) * count.transpose();
        Self {
            mean: DVector::from_row_slice(vector(start).as_slice()),
            covariance: DMatrix::from_row_slice(3, 3, own.as_slice()),
            ids: Vec::new(),
        }
    }

    fn block(&self, at: usize) -> Vector3<f64> {
        self.mean.fixed_rows::<3>(at).into_owned()
    }

    pub(super) fn predict(&mut self, increment: &Increment, variances: [f64; 3]) {
        let move_by = Pose2::new(increment.forward_m, increment.left_m, increment.turn_rad);
        let at = self.block(0);
        let after = pose(at).then(&move_by);
        let heading = Pose2::new(0.0, 0.0, at[2]);
        // Errors along, across and in turn; the last one bends the way.
        let noise = derivative(
            |e| {
                let bend = Vector3::new(
                    e[0] - e[2] * increment.left_m / 2.0,
                    e[1] + e[2] * increment.forward_m / 2.0,
                    e[2],
                );
                vector(&heading.then(&pose(bend)))
            },
            Vector3::zeros(),
        );
        let noise = by_error(|p| *p, &after).try_inverse().unwrap() * noise;
        let q = noise * Matrix3::from_diagonal(&Vector3::from(variances)) * noise.transpose();
        // A motion of the plane before the step is the same motion after it.
        let mut own = self.covariance.view_mut((0, 0), (3, 3));
        own += q;
        self.mean.rows_mut(0, 3).copy_from(&vector(&after));
    }

    pub(super) fn slot(&self, id: u16) -> Option<usize> {
        let at = self.ids.iter().position(|known| *known == id)?;
        Some(3 + 3 * at)
    }

    /// A sighting of a marker in the state.
    pub(super) fn update(&mut self, sighting: &Sighting) {
        let at = self.slot(sighting.id).unwrap();
        let n = self.mean.len();
        let rows = if sighting.heading_rad.is_some() { 3 } else { 2 };
        let (robot, marker) = (pose(self.block(0)), pose(self.block(at)));
        let h_robot = by_error(|p| p.sees(&marker), &robot);
        let h_marker = by_error(|p| robot.sees(p), &marker);
        let mut h = DMatrix::zeros(rows, n);
        h.view_mut((0, 0), (rows, 3))
            .copy_from(&h_robot.rows(0, rows));
        h.view_mut((0, at), (rows, 3))
            .copy_from(&h_marker.rows(0, rows));
        let r = noise(sighting).view((0, 0), (rows, rows)).into_owned();
        let seen = Pose2::new(
            sighting.x_m,
            sighting.y_m,
            sighting.heading_rad.unwrap_or(0.0),
        );
        let mut innovation = vector(&seen) - vector(&robot.sees(&marker));
        innovation[2] = wrap(innovation[2]);
        let s = &h * &self.covariance * h.transpose() + &r;
        let k = &self.covariance * h.transpose() * s.try_inverse().unwrap();
        let errors = &k * innovation.rows(0, rows);
        for at in (0..n).step_by(3) {
            let error = errors.fixed_rows::<3>(at).into_owned();
            let mended = vector(&displaced(&pose(self.block(at)), error));
            self.mean.rows_mut(at, 3).copy_from(&mended);
        }
        let joseph = DMatrix::identity(n, n) - &k * h;
        self.covariance = &joseph * &self.covariance * joseph.transpose() + &k * r * k.transpose();
    }

    pub(super) fn append(&mut self, sighting: &Sighting) {
        let n = self.mean.len();
        let heading = sighting.heading_rad.unwrap_or(0.0);
        let seen = Pose2::new(sighting.x_m, sighting.y_m, heading);
        let robot = self.block(0);
        let placed = pose(robot).then(&seen);
        // What moves the robot with the plane moves the marker by the same motion.
        let g = Matrix3::identity();
        let l = by_error(|p| *p, &placed).try_inverse().unwrap()
            * derivative(|v| vector(&pose(robot).then(&pose(v))), vector(&seen));
        let mut grow = DMatrix::zeros(n + 3, n);
        grow.view_mut((0, 0), (n, n)).fill_with_identity();
        grow.view_mut((n, 0), (3, 3)).copy_from(&g);
        self.covariance = &grow * &self.covariance * grow.transpose();
        let mut own = self.covariance.view_mut((n, n), (3, 3));
        let mut noise = noise(sighting);
        if sighting.heading_rad.is_none() {
            noise[(2, 2)] = 1e-12;
        }
        own += l * noise * l.transpose();
        let marker = vector(&placed);
        self.mean = DVector::from_iterator(n + 3, self.mean.iter().chain(marker.iter()).copied());
        self.ids.push(sighting.id);
    }

    /// The heading of a marker may be any.
    pub(super) fn free_heading(&mut self, id: u16) {
        let at = self.slot(id).unwrap();
        let count = by_error(|p| *p, &pose(self.block(at)))
            .try_inverse()
            .unwrap();
        let turn = count.column(2).into_owned();
        let mut own = self.covariance.view_mut((at, at), (3, 3));
        own += 10.0 * turn * turn.transpose();
    }

    /// Covariance of all [x, y, heading].
    pub(super) fn plain_covariance(&self) -> DMatrix<f64> {
        let n = self.mean.len();
        let mut plain = DMatrix::identity(n, n);
        for at in (0..n).step_by(3) {
            let by = by_error(|p| *p, &pose(self.block(at)));
            plain.view_mut((at, at), (3, 3)).copy_from(&by);
        }
        &plain * &self.covariance * plain.transpose()
    }

    pub(super) fn remove(&mut self, id: u16) {
        let at = self.slot(id).unwrap();
        self.mean = self.mean.clone().remove_rows(at, 3);
        self.covariance = self
            .covariance
            .clone()
            .remove_rows(at, 3)
            .remove_columns(at, 3);
        self.ids.retain(|known| *known != id);
    }
}

fn noise(sighting: &Sighting) -> Matrix3<f64> {
    Matrix3::from(sighting.noise.matrix(true))
}
