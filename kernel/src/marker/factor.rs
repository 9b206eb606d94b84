//! The covariance of robot and markers as `P = L D Lᵀ`, markers first, the robot last.
//!
//! `L` has a unit diagonal and `D` is positive, so `P` is symmetric and positive by what is
//! stored, not by what rounding leaves of it: no operation here subtracts from `D`. It refuses
//! to be a matrix: only the blocks that somebody needs are ever multiplied out.
//!
//! With the robot last, its motion touches nothing but its own rows, a new marker is appended,
//! and forgetting the robot leaves the markers as they are. Corrections follow Bierman's
//! sequential form, one row of the measurement at a time.
//!
//! # Source
//! Bierman 1977, "Factorization Methods for Discrete Sequential Estimation", chapter V (with
//! the order of the state reversed); Gill, Golub, Murray, Saunders 1974 for the removal.

use super::linear::{
    IDENTITY, Ldl, Matrix, Vector, ZERO, apply, diagonal, difference, dot, sandwich, sum, times,
    times_transposed,
};
#[cfg(test)]
mod peek;

use super::rotation::{Fold, Step};
use super::state::{Row, StateVector};

/// Largest variances of the robot's pose, m² and rad²: beyond them nothing is known anyway.
pub(super) const VARIANCE_MAX: Vector = [1e8, 1e8, HEADING_UNKNOWN_RAD2];
/// Variance of a heading that may be any, rad².
pub(super) const HEADING_UNKNOWN_RAD2: f64 = 10.0;

/// `L` and `D` for up to `N` markers of three numbers each, and the robot.
#[derive(Clone, Debug)]
pub(super) struct Factor<const N: usize> {
    len: usize,
    /// `D` of the markers.
    pivots: [Vector; N],
    /// `columns[j][c][i]`: rows of marker `i` in column `c` of marker `j`, diagonal and the
    /// zeros above it included.
    columns: [[[Vector; N]; 3]; N],
    /// `robot_rows[j][c]`: the robot's rows of the same column.
    robot_rows: [Matrix; N],
    /// The robot's own part: what the markers do not explain.
    robot: Ldl,
}

impl<const N: usize> Factor<N> {
    /// Only the robot, with this covariance.
    pub(super) fn new(robot: &Matrix) -> Self {
        Self {
            len: 0,
            pivots: [[1.0; 3]; N],
            columns: [[[[0.0; 3]; N]; 3]; N],
            robot_rows: [ZERO; N],
            robot: Ldl::of(robot),
        }
    }

    /// Markers in the state.
    pub(super) const fn len(&self) -> usize {
        self.len
    }

    /// The robot moves: `P_rr` becomes `F P_rr Fᵀ + Q`.
    ///
    /// # Bound
    /// O(markers).
    pub(super) fn moved(&mut self, jacobian: &Matrix, noise: &Matrix) {
        for column in self.robot_rows.iter_mut().take(self.len).flatten() {
            *column = apply(jacobian, *column);
        }
        let own = sandwich(jacobian, &self.robot.matrix());
        self.robot = Ldl::of(&sum(&own, noise));
        //= spec/ekf.md#ekf-02
        //# After any sequence of inputs, valid or not, the state MUST be finite and its covariance finite, symmetric
        //# and positive.
        self.bound_robot();
    }

    /// Where the robot's variances are too large they are made smaller, and all that is shared
    /// with the markers in proportion: `S P S` with a diagonal `S` is as positive as `P`.
    fn bound_robot(&mut self) {
        let mut own = self.robot.matrix();
        let mut variances = [own[0][0], own[1][1], own[2][2]];
        let rows = self.robot_rows.iter().zip(&self.pivots).take(self.len);
        for (row, pivot) in rows.flat_map(|(rows, pivots)| rows.iter().zip(pivots)) {
            for (variance, entry) in variances.iter_mut().zip(row) {
                *variance += entry * entry * pivot;
            }
        }
        let mut pairs = variances.iter().zip(&VARIANCE_MAX);
        if pairs.all(|(variance, most)| variance <= most) {
            return;
        }
        let mut scale = [1.0; 3];
        for ((scale, variance), most) in scale.iter_mut().zip(variances).zip(VARIANCE_MAX) {
            *scale = libm::sqrt(most / variance.max(most));
        }
        own = sandwich(&diagonal(scale), &own);
        self.robot = Ldl::of(&own);
        for row in self.robot_rows.iter_mut().take(self.len).flatten() {
            for (entry, scale) in row.iter_mut().zip(scale) {
                *entry *= scale;
            }
        }
    }

    /// `H P Hᵀ` for three rows, their noise not included.
    ///
    /// # Bound
    /// O(markers).
    pub(super) fn spread(&self, slot: Option<usize>, rows: &[Row; 3]) -> Matrix {
        let mut lower = [0.0; 6];
        let mut take = |f: Vector, d: f64| {
            let g = f.map(|x| x * d);
            let products = [
                g[0] * f[0],
                g[1] * f[0],
                g[1] * f[1],
                g[2] * f[0],
                g[2] * f[1],
                g[2] * f[2],
            ];
            for (entry, product) in lower.iter_mut().zip(products) {
                *entry += product;
            }
        };
        for (column, d) in self.robot.columns().iter().zip(self.robot.pivots) {
            take(rows.map(|row| dot(row.robot, *column)), d);
        }
        let markers = self.columns.iter().zip(&self.robot_rows).zip(&self.pivots);
        for ((columns, robot), pivots) in markers.take(self.len) {
            for ((column, robot), d) in columns.iter().zip(robot).zip(pivots) {
                let at = slot.and_then(|slot| column.get(slot)).copied();
                let at = at.unwrap_or_default();
                take(
                    rows.map(|row| dot(row.robot, *robot) + dot(row.marker, at)),
                    *d,
                );
            }
        }
        let [a, b, c, d, e, f] = lower;
        [[a, b, d], [b, c, e], [d, e, f]]
    }

    /// Covariance of the robot's pose.
    pub(super) fn robot_covariance(&self) -> Matrix {
        self.spread(None, &IDENTITY.map(|robot| row(robot, [0.0; 3])))
    }

    /// Covariance of one marker's pose.
    pub(super) fn marker_covariance(&self, slot: usize) -> Matrix {
        self.spread(Some(slot), &IDENTITY.map(|marker| row([0.0; 3], marker)))
    }

    /// Takes one measured number into account; `gain` becomes the Kalman gain.
    ///
    /// The noise of `row` must be positive; it is what keeps every pivot positive.
    /// # Bound
    /// O(markers²).
    pub(super) fn absorb(&mut self, slot: Option<usize>, row: &Row, gain: &mut StateVector<N>) {
        let mut total = self.absorb_robot(row, &mut gain.robot);
        let end = self.len.saturating_mul(3);
        let markers = self.columns.iter_mut().zip(&mut self.robot_rows);
        let markers = markers.zip(&mut self.pivots).enumerate().take(self.len);
        for (j, ((columns, robot), pivots)) in markers.rev() {
            let parts = columns.iter_mut().zip(robot).zip(pivots).enumerate();
            for (c, ((column, robot), pivot)) in parts.rev() {
                let at = slot.and_then(|slot| column.get(slot)).copied();
                let f = dot(row.robot, *robot) + dot(row.marker, at.unwrap_or_default());
                let step = Step::new(f, pivot, &mut total);
                step.rotate(robot, &mut gain.robot);
                let here = j.saturating_mul(3).saturating_add(c);
                let gains = gain.markers.as_flattened_mut().get_mut(here..end);
                let below = column.as_flattened_mut().get_mut(here..end);
                if let (Some([own, gains @ ..]), Some([_, below @ ..])) = (gains, below) {
                    *own = step.gain;
                    step.rotate(below, gains);
                }
            }
        }
        let scale = 1.0 / total;
        gain.robot = gain.robot.map(|g| g * scale);
        for g in gain.markers.iter_mut().take(self.len).flatten() {
            *g *= scale;
        }
    }

    /// The robot's own three columns of [`Self::absorb`]; returns the variance so far.
    fn absorb_robot(&mut self, row: &Row, gain: &mut Vector) -> f64 {
        let h = row.robot;
        let mut total = row.variance;
        let Ldl {
            below: [l10, l20, l21],
            pivots: [d0, d1, d2],
        } = &mut self.robot;
        let step = Step::new(h[2], d2, &mut total);
        gain[2] = step.gain;
        let step = Step::new(h[1] + *l21 * h[2], d1, &mut total);
        step.rotate_one(l21, &mut gain[2]);
        gain[1] = step.gain;
        let step = Step::new(h[0] + *l10 * h[1] + *l20 * h[2], d0, &mut total);
        step.rotate_one(l10, &mut gain[1]);
        step.rotate_one(l20, &mut gain[2]);
        gain[0] = step.gain;
        total
    }

    /// Appends a marker that depends on the robot by `jacobian` and has `noise` of its own.
    ///
    /// This is `P_mm = G P_rr Gᵀ + W` and `P_mx = G P_rx`; Loh 3.19 leaves out everything
    /// that has a G in it. Returns the slot, or `None` when full.
    /// # Bound
    /// O(markers).
    pub(super) fn append(&mut self, jacobian: &Matrix, noise: &Matrix) -> Option<usize> {
        let slot = self.len;
        let (pivots, columns) = (self.pivots.get_mut(slot)?, self.columns.get_mut(slot)?);
        let robot = self.robot.matrix();
        let marker = Ldl::of(&sum(&sandwich(jacobian, &robot), noise));
        *pivots = marker.pivots;
        for (column, unit) in columns.iter_mut().zip(marker.columns()) {
            *column = [[0.0; 3]; N];
            *column.get_mut(slot)? = unit;
        }
        let earlier = self.columns.iter_mut().zip(&self.robot_rows);
        for (columns, robot) in earlier.take(slot) {
            for (column, robot) in columns.iter_mut().zip(robot) {
                *column.get_mut(slot)? = apply(jacobian, *robot);
            }
        }
        // What remains of the robot once the new marker is given: Joseph's form, a sum.
        let gain = times_transposed(&robot, jacobian).map(|row| marker.solve(row));
        *self.robot_rows.get_mut(slot)? = marker.columns().map(|unit| apply(&gain, unit));
        let rest = difference(&IDENTITY, &times(&gain, jacobian));
        self.robot = Ldl::of(&sum(&sandwich(&rest, &robot), &sandwich(&gain, noise)));
        self.len = self.len.saturating_add(1);
        Some(slot)
    }

    /// Forgets the robot: it now depends on the marker at `slot` alone, by `jacobian`, with
    /// `noise` of its own; on nothing if there is no such marker.
    pub(super) fn tie_robot(&mut self, slot: Option<usize>, jacobian: &Matrix, noise: &Matrix) {
        let rows = self.robot_rows.iter_mut().zip(&self.columns);
        for (robot, columns) in rows.take(self.len) {
            for (robot, column) in robot.iter_mut().zip(columns) {
                let marker = slot.and_then(|slot| column.get(slot)).copied();
                *robot = apply(jacobian, marker.unwrap_or_default());
            }
        }
        self.robot = Ldl::of(noise);
    }

    /// Takes the marker at `slot` out; those behind it move up.
    ///
    /// What it contributed to the others is folded into their own parts, so the covariance of
    /// all that stays is unchanged.
    /// # Bound
    /// O(markers²).
    pub(super) fn remove(&mut self, slot: usize) {
        if slot >= self.len {
            return;
        }
        let given = (self.columns.get(slot), self.robot_rows.get(slot));
        let (Some(&columns), Some(&robot)) = given else {
            return;
        };
        let pivots = self.pivots.get(slot).copied().unwrap_or_default();
        for ((markers, robot), weight) in columns.into_iter().zip(robot).zip(pivots) {
            let first = slot.saturating_add(1);
            self.fold(first, StateVector { robot, markers }, weight);
        }
        close_gap(&mut self.pivots, slot);
        close_gap(&mut self.robot_rows, slot);
        close_gap(&mut self.columns, slot);
        for column in self.columns.as_flattened_mut() {
            close_gap(column, slot);
        }
        self.len = self.len.saturating_sub(1);
    }

    /// Adds an error of its own to one marker: `weight` times the square of `v`.
    /// # Bound
    /// O(markers²).
    pub(super) fn loosen(&mut self, slot: usize, v: Vector, weight: f64) {
        let mut whole = StateVector::ZERO;
        if let Some(marker) = whole.markers.get_mut(slot) {
            *marker = v;
            self.fold(slot, whole, weight);
        }
    }

    /// Adds `weight` times the square of `v` to everything from marker `first` on.
    fn fold(&mut self, first: usize, mut v: StateVector<N>, mut weight: f64) {
        let end = self.len.saturating_mul(3);
        let markers = self.columns.iter_mut().zip(&mut self.robot_rows);
        let markers = markers.zip(&mut self.pivots).enumerate().take(self.len);
        for (j, ((columns, robot), pivots)) in markers.skip(first) {
            let parts = columns.iter_mut().zip(robot).zip(pivots).enumerate();
            for (c, ((column, robot), pivot)) in parts {
                let here = j.saturating_mul(3).saturating_add(c);
                let rest = v.markers.as_flattened_mut().get_mut(here..end);
                let below = column.as_flattened_mut().get_mut(here..end);
                if let (Some([p, rest @ ..]), Some([_, below @ ..])) = (rest, below) {
                    let fold = Fold::new(*p, pivot, &mut weight);
                    fold.apply(below, rest);
                    fold.apply(robot, &mut v.robot);
                }
            }
        }
        let own = sum(
            &self.robot.matrix(),
            &sandwich(
                &[
                    [v.robot[0], 0.0, 0.0],
                    [v.robot[1], 0.0, 0.0],
                    [v.robot[2], 0.0, 0.0],
                ],
                &diagonal([weight, 0.0, 0.0]),
            ),
        );
        self.robot = Ldl::of(&own);
    }
}

/// A row without noise, to read covariances with.
const fn row(robot: Vector, marker: Vector) -> Row {
    Row {
        robot,
        marker,
        variance: 0.0,
    }
}

/// Moves everything behind `slot` up by one; the last entry is there twice.
///
/// Written out because `copy_within` keeps a panic for ranges that cannot be.
pub(super) fn close_gap<T: Copy>(items: &mut [T], slot: usize) {
    let mut items = items.iter_mut().skip(slot);
    let Some(mut hole) = items.next() else {
        return;
    };
    for next in items {
        *hole = *next;
        hole = next;
    }
}
