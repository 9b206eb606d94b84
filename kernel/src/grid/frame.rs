//! Where things are in cells: the grid's own frame, the window of cells it holds.

use super::CellIndex;
use crate::arith::narrow;
use crate::config::Scanner;
use crate::geometry::trig::{SIN_BITS, sin_cos};
use crate::input::Pose;
use crate::units::{BinaryAngle, Length};

/// Poses farther than this from the origin of their frame along an axis are refused, µm (1000 km).
pub const POSE_MAX_UM: i64 = 1_000_000_000_000;

const FRACTION: i64 = (1 << SIN_BITS) - 1;

/// The grid's frame within the frame that poses are given in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct GridFrame {
    /// Lower left corner of cell (0, 0), and direction of its rows.
    pub(super) origin: Pose,
    /// Edge of a cell, µm, 10⁴ to 10⁶.
    pub(super) cell_um: i64,
}

/// A place in the grid's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// Along the rows, µm; at most 3·10¹² in magnitude.
    pub(super) x_um: i64,
    /// Across the rows, µm; at most 3·10¹² in magnitude.
    pub(super) y_um: i64,
    /// Heading against the rows.
    pub(super) heading: BinaryAngle,
}

/// A place as a cell and an offset from that cell's lower left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Spot {
    /// The cell.
    pub(super) cell: CellIndex,
    /// Offset along the row, µm, from 0 to below one cell.
    pub(super) x_um: i64,
    /// Offset across the rows, µm, from 0 to below one cell.
    pub(super) y_um: i64,
}

impl GridFrame {
    /// `pose` in the grid's frame, rounded down to µm; `None` beyond [`POSE_MAX_UM`].
    pub(super) fn place(&self, pose: &Pose) -> Option<Place> {
        let x = checked_offset(pose.x_um, self.origin.x_um)?;
        let y = checked_offset(pose.y_um, self.origin.y_um)?;
        let heading = self.origin.heading;
        let (x_um, y_um) = rotated(x, y, BinaryAngle::ZERO.minus(heading));
        Some(Place {
            x_um,
            y_um,
            heading: BinaryAngle::from_counts(pose.heading.minus(heading).cast_unsigned()),
        })
    }

    /// Where `scanner` is when the robot is at `place`.
    pub(super) fn mounted(place: Place, scanner: &Scanner) -> Place {
        let mount = (i64::from(scanner.x.as_um()), i64::from(scanner.y.as_um()));
        let turned = rotated(mount.0, mount.1, place.heading.minus(BinaryAngle::ZERO));
        Place {
            x_um: place.x_um.saturating_add(turned.0),
            y_um: place.y_um.saturating_add(turned.1),
            heading: place.heading,
        }
    }

    /// The cell at a place of the grid's frame.
    pub(super) fn spot(&self, x_um: i64, y_um: i64) -> Spot {
        let index = |um: i64| narrow(um.checked_div_euclid(self.cell_um).unwrap_or(0));
        let rest = |um: i64| um.checked_rem_euclid(self.cell_um).unwrap_or(0);
        Spot {
            cell: CellIndex::new(index(x_um), index(y_um)),
            x_um: rest(x_um),
            y_um: rest(y_um),
        }
    }

    /// From `place` to the lower left corner of `cell`, µm.
    pub(super) fn towards(&self, place: Place, cell: CellIndex) -> (i64, i64) {
        let along = |index: i32, from: i64| {
            i64::from(index)
                .saturating_mul(self.cell_um)
                .saturating_sub(from)
        };
        (
            along(cell.column(), place.x_um),
            along(cell.row(), place.y_um),
        )
    }

    /// Length as a whole number of cells, rounded up; negative lengths are none.
    pub(super) fn cells_up(&self, length: Length) -> i32 {
        let um = u64::from(length.as_um().max(0).unsigned_abs());
        let cells = um.div_ceil(self.cell_um.max(1).unsigned_abs());
        crate::arith::to_i32(cells)
    }
}

/// `value - origin` if both are usable.
fn checked_offset(value: i64, origin: i64) -> Option<i64> {
    let usable = -POSE_MAX_UM..=POSE_MAX_UM;
    (usable.contains(&value) && usable.contains(&origin)).then(|| value.saturating_sub(origin))
}

/// Rotates a vector of up to 2·10¹² µm per component by `turn` counts of 2⁻³² turn.
///
/// Whole millimetres and the rest are multiplied apart, so that nothing exceeds 63 bits.
pub(super) fn rotated(x_um: i64, y_um: i64, turn: i32) -> (i64, i64) {
    let (sin, cos) = sin_cos(BinaryAngle::from_counts(turn.cast_unsigned()));
    let (sin, cos) = (i64::from(sin), i64::from(cos));
    let (x_mm, y_mm) = (x_um.div_euclid(1000), y_um.div_euclid(1000));
    let (x_rest, y_rest) = (x_um.rem_euclid(1000), y_um.rem_euclid(1000));
    let component = |a: i64, b: i64, a_rest: i64, b_rest: i64, p: i64, q: i64| {
        let rest = p
            .saturating_mul(a_rest)
            .saturating_add(q.saturating_mul(b_rest));
        let scaled_mm = p
            .saturating_mul(a)
            .saturating_add(q.saturating_mul(b))
            .saturating_add(rest.div_euclid(1000));
        let fraction_um = (scaled_mm & FRACTION).saturating_mul(1000) >> SIN_BITS;
        (scaled_mm >> SIN_BITS)
            .saturating_mul(1000)
            .saturating_add(fraction_um)
    };
    (
        component(x_mm, y_mm, x_rest, y_rest, cos, sin.saturating_neg()),
        component(x_mm, y_mm, x_rest, y_rest, sin, cos),
    )
}

/// The cells a grid of `W` columns and `H` rows holds, and where it keeps them.
///
/// Storage is a ring in both directions, so that a rolling grid moves without copying.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window<const W: usize, const H: usize> {
    /// The lowest cell of both axes.
    low: CellIndex,
    ring_column: usize,
    ring_row: usize,
}

impl<const W: usize, const H: usize> Window<W, H> {
    pub(super) fn new(low: CellIndex) -> Self {
        Self {
            low,
            ring_column: ring(low.column(), W),
            ring_row: ring(low.row(), H),
        }
    }

    pub(super) const fn low(&self) -> CellIndex {
        self.low
    }

    /// Where `cell` is stored, row first; `None` off the map.
    #[inline]
    pub(super) fn slot(&self, cell: CellIndex) -> Option<(usize, usize)> {
        Some((self.row(cell.row())?, self.column(cell.column())?))
    }

    /// Where a row is stored.
    #[inline]
    pub(super) fn row(&self, row: i32) -> Option<usize> {
        slot(row, self.low.row(), self.ring_row, H)
    }

    /// Where a column is stored within its row.
    #[inline]
    pub(super) fn column(&self, column: i32) -> Option<usize> {
        slot(column, self.low.column(), self.ring_column, W)
    }

    /// The columns held.
    pub(super) fn columns(&self) -> core::ops::Range<i32> {
        span(self.low.column(), W)
    }

    /// The rows held.
    pub(super) fn rows(&self) -> core::ops::Range<i32> {
        span(self.low.row(), H)
    }
}

fn span(low: i32, size: usize) -> core::ops::Range<i32> {
    low..low.saturating_add(i32::try_from(size).unwrap_or(i32::MAX))
}

/// Where the lowest index of an axis of `size` cells is stored. Public for proofs only.
#[must_use]
pub fn ring(low: i32, size: usize) -> usize {
    let size = i64::try_from(size).unwrap_or(i64::MAX);
    let rest = i64::from(low).checked_rem_euclid(size).unwrap_or(0);
    usize::try_from(rest).unwrap_or(0)
}

/// Where index `index` of an axis is stored; `None` off the map. Public for proofs only.
#[must_use]
#[inline]
pub fn slot(index: i32, low: i32, ring: usize, size: usize) -> Option<usize> {
    // A cell below `low` becomes huge and fails the test: `low` is at most POSE_MAX_UM away,
    // so nothing wraps all the way round into the window.
    let local = index.wrapping_sub(low).cast_unsigned() as usize;
    if local >= size {
        return None;
    }
    let stored = local.wrapping_add(ring);
    Some(if stored >= size {
        stored.wrapping_sub(size)
    } else {
        stored
    })
}

/// `range` cut to what lies within `held`.
pub(super) fn overlap(
    range: core::ops::RangeInclusive<i32>,
    held: &core::ops::Range<i32>,
) -> core::ops::Range<i32> {
    let start = (*range.start()).max(held.start);
    let end = range.end().saturating_add(1).min(held.end);
    start..end.max(start)
}
