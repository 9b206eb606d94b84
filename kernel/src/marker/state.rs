//! Rows and columns over the whole state: what a measurement looks at, and what it moves.

use super::linear::{Vector, add, dot, subtract};

/// One row of a measurement: how it depends on the robot and on one marker.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) robot: Vector,
    pub(super) marker: Vector,
    /// Noise of this row, independent of all other rows.
    pub(super) variance: f64,
}

/// A column over the whole state.
#[derive(Clone, Debug)]
pub(super) struct StateVector<const N: usize> {
    pub(super) robot: Vector,
    pub(super) markers: [Vector; N],
}

impl<const N: usize> StateVector<N> {
    pub(super) const ZERO: Self = Self {
        robot: [0.0; 3],
        markers: [[0.0; 3]; N],
    };

    /// Adds `other` times `by`.
    pub(super) fn add_scaled(&mut self, other: &Self, by: f64) {
        self.robot = add(self.robot, other.robot.map(|x| x * by));
        for (mine, theirs) in self.markers.iter_mut().zip(&other.markers) {
            *mine = add(*mine, theirs.map(|x| x * by));
        }
    }

    /// The product of a row with this column.
    pub(super) fn product(&self, row: &Row, slot: Option<usize>) -> f64 {
        let marker = slot.and_then(|slot| self.markers.get(slot));
        dot(row.robot, self.robot) + marker.map_or(0.0, |m| dot(row.marker, *m))
    }
}

impl Row {
    /// This row less `other` times `by`.
    pub(super) fn minus(&self, other: &Self, by: f64) -> Self {
        Self {
            robot: subtract(self.robot, other.robot.map(|x| x * by)),
            marker: subtract(self.marker, other.marker.map(|x| x * by)),
            variance: self.variance,
        }
    }
}
