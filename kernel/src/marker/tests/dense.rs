//! The textbook filter with dense matrices: an independent computation of the same numbers.

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

impl Dense {
    pub(super) fn new(start: &Pose2, variances: [f64; 3]) -> Self {
        Self {
            mean: DVector::from_row_slice(vector(start).as_slice()),
            covariance: DMatrix::from_diagonal(&DVector::from_row_slice(&variances)),
            ids: Vec::new(),
        }
    }

    fn block(&self, at: usize) -> Vector3<f64> {
        self.mean.fixed_rows::<3>(at).into_owned()
    }

    pub(super) fn predict(&mut self, increment: &Increment, variances: [f64; 3]) {
        let move_by = Pose2::new(increment.forward_m, increment.left_m, increment.turn_rad);
        let n = self.mean.len();
        let at = self.block(0);
        let mut f = DMatrix::identity(n, n);
        let jacobian = derivative(|v| vector(&pose(v).then(&move_by)), at);
        f.view_mut((0, 0), (3, 3)).copy_from(&jacobian);
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
        let q = noise * Matrix3::from_diagonal(&Vector3::from(variances)) * noise.transpose();
        self.covariance = &f * &self.covariance * f.transpose();
        let mut own = self.covariance.view_mut((0, 0), (3, 3));
        own += q;
        let after = pose(at).then(&move_by);
        self.mean.rows_mut(0, 3).copy_from(&vector(&after));
    }

    pub(super) fn slot(&self, id: u16) -> Option<usize> {
        let at = self.ids.iter().position(|known| *known == id)?;
        Some(3 + 3 * at)
    }

    /// A sighting of a marker in the state; `prior` is where it is linearised.
    pub(super) fn update(&mut self, sighting: &Sighting, prior: &DVector<f64>) {
        let at = self.slot(sighting.id).unwrap();
        let n = self.mean.len();
        let rows = if sighting.heading_rad.is_some() { 3 } else { 2 };
        let robot: Vector3<f64> = prior.fixed_rows::<3>(0).into_owned();
        let marker: Vector3<f64> = prior.fixed_rows::<3>(at).into_owned();
        let h_robot = derivative(|v| vector(&pose(v).sees(&pose(marker))), robot);
        let h_marker = derivative(|v| vector(&pose(robot).sees(&pose(v))), marker);
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
        let mut innovation = vector(&seen) - vector(&pose(robot).sees(&pose(marker)));
        innovation[2] = wrap(innovation[2]);
        let moved = &self.mean - prior;
        let rest = innovation.rows(0, rows) - &h * moved;
        let s = &h * &self.covariance * h.transpose() + &r;
        let k = &self.covariance * h.transpose() * s.try_inverse().unwrap();
        self.mean += &k * rest;
        let joseph = DMatrix::identity(n, n) - &k * h;
        self.covariance = &joseph * &self.covariance * joseph.transpose() + &k * r * k.transpose();
    }

    pub(super) fn append(&mut self, sighting: &Sighting) {
        let n = self.mean.len();
        let seen = Pose2::new(sighting.x_m, sighting.y_m, sighting.heading_rad.unwrap());
        let robot = self.block(0);
        let g = derivative(|v| vector(&pose(v).then(&seen)), robot);
        let l = derivative(|v| vector(&pose(robot).then(&pose(v))), vector(&seen));
        let mut grow = DMatrix::zeros(n + 3, n);
        grow.view_mut((0, 0), (n, n)).fill_with_identity();
        grow.view_mut((n, 0), (3, 3)).copy_from(&g);
        self.covariance = &grow * &self.covariance * grow.transpose();
        let mut own = self.covariance.view_mut((n, n), (3, 3));
        own += l * noise(sighting) * l.transpose();
        let marker = vector(&pose(robot).then(&seen));
        self.mean = DVector::from_iterator(n + 3, self.mean.iter().chain(marker.iter()).copied());
        self.ids.push(sighting.id);
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
    let n = sighting.noise;
    Matrix3::new(
        n.xx_m2,
        n.xy_m2,
        0.0,
        n.xy_m2,
        n.yy_m2,
        0.0,
        0.0,
        0.0,
        n.heading_rad2,
    )
}
