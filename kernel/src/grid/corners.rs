//! Occupied cells as points: what a planner that avoids points makes of a grid (Loh ch. 4).

use super::frame::{Place, overlap, rotated};
use super::{CellIndex, Occupancy, OccupancyGrid};
use crate::arith::narrow;
use crate::geometry::frame::PointMm;
use crate::input::Pose;
use crate::units::Length;
use core::ops::Range;

/// Cells around the robot.
struct Near {
    columns: Range<i32>,
    rows: Range<i32>,
}

impl Near {
    fn contains(&self, cell: CellIndex) -> bool {
        self.columns.contains(&cell.column) && self.rows.contains(&cell.row)
    }
}

impl<const W: usize, const H: usize> OccupancyGrid<W, H> {
    /// Corners of occupied cells within `reach` of the robot, in its body frame at `pose`,
    /// each once, rounded to the nearest millimetre.
    ///
    /// Yields nothing where the pose is beyond [`super::POSE_MAX_UM`].
    /// # Bound
    /// At most `min((2 * reach / cell + 3)², W * H)` cells are looked at, and at most four
    /// points yielded for each.
    /// # Source
    /// Loh Alg. 4.1: the cells enter the point cloud by their corners.
    pub fn corners_near(
        &self,
        pose: &Pose,
        reach: Length,
    ) -> impl Iterator<Item = PointMm> + use<'_, W, H> {
        self.frame
            .place(pose)
            .into_iter()
            .flat_map(move |place| self.corners_around(place, reach))
    }

    fn corners_around(&self, place: Place, reach: Length) -> impl Iterator<Item = PointMm> {
        let near = self.near(place, reach);
        let (columns, rows) = (near.columns.clone(), near.rows.clone());
        let reach_um = u64::from(reach.as_um().max(0).unsigned_abs());
        let squared = reach_um.saturating_mul(reach_um);
        rows.flat_map(move |row| {
            columns
                .clone()
                .map(move |column| CellIndex::new(column, row))
        })
        .filter(|&cell| self.occupancy(cell) == Occupancy::Occupied)
        .flat_map(move |cell| self.own_corners(cell, &near))
        .map(move |vertex| self.frame.towards(place, vertex))
        .filter(move |&(x, y)| {
            let square = |um: i64| um.unsigned_abs().saturating_mul(um.unsigned_abs());
            square(x).saturating_add(square(y)) <= squared
        })
        .map(move |(x, y)| {
            let back = crate::units::BinaryAngle::ZERO.minus(place.heading);
            let (x, y) = rotated(x, y, back);
            let mm = |um: i64| narrow(um.saturating_add(500).div_euclid(1000));
            PointMm { x: mm(x), y: mm(y) }
        })
    }

    fn near(&self, place: Place, reach: Length) -> Near {
        let centre = self.frame.spot(place.x_um, place.y_um).cell;
        let cells = self.frame.cells_up(reach).saturating_add(1);
        let around = |index: i32| index.saturating_sub(cells)..=index.saturating_add(cells);
        Near {
            columns: overlap(around(centre.column), &self.window.columns()),
            rows: overlap(around(centre.row), &self.window.rows()),
        }
    }

    /// The corners of an occupied cell that no occupied cell before it has, as the cells whose
    /// lower left corner they are.
    fn own_corners(
        &self,
        cell: CellIndex,
        near: &Near,
    ) -> impl Iterator<Item = CellIndex> + use<W, H> {
        let at = |right: i32, up: i32| {
            CellIndex::new(
                cell.column.saturating_add(right),
                cell.row.saturating_add(up),
            )
        };
        let taken = |right: i32, up: i32| {
            let other = at(right, up);
            near.contains(other) && self.occupancy(other) == Occupancy::Occupied
        };
        let (left, below) = (taken(-1, 0), taken(0, -1));
        let (below_left, below_right) = (taken(-1, -1), taken(1, -1));
        [
            (!(left || below || below_left)).then_some(at(0, 0)),
            (!(below || below_right)).then_some(at(1, 0)),
            (!left).then_some(at(0, 1)),
            Some(at(1, 1)),
        ]
        .into_iter()
        .flatten()
    }
}
