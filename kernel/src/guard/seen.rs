//! Known space: a rolling bitmap of cells whose centre a valid scan has looked at.
//!
//! Only says where nobody has looked, or looked too long ago; where something
//! *is* stays with the points. Memory of free space shrinks from its borders,
//! as fast as obstacles move and as odometry drifts.

use crate::arith::narrow;
use crate::geometry::frame::PointMm;
use crate::odometry::AnchorShift;
use crate::time::{Duration, Instant};

/// Edge of a cell, mm.
pub const CELL_MM: i32 = 64;
/// Cells along each axis of the window.
pub const CELLS: usize = 128;
/// Half the window's edge, mm.
pub const HALF_WINDOW_MM: i32 = 4_096;
/// The window follows the robot in steps of this many cells.
const FOLLOW_CELLS: i32 = 4;
/// Radius around the robot's rotation centre that always lies inside the window, mm.
pub const COVER_MM: i32 = HALF_WINDOW_MM - (FOLLOW_CELLS + 1) * CELL_MM;
const CELL_UM: u64 = 64_000;
/// Fractional bits of a coordinate inside the window, in cells.
const FRACTION: u32 = 8;
const CENTRE: i32 = 1 << (FRACTION - 1);

/// One bit per cell.
pub type Rows = [u128; CELLS];

/// A point inside the window in 1/256 cells from its lower corner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellPoint {
    /// Along x.
    pub x: i32,
    /// Along y.
    pub y: i32,
}

/// Flips, in every row whose centre line the edge crosses, all cells whose centre lies left of it.
///
/// Flipping all edges of a closed polygon leaves exactly the cells whose centre
/// is inside (even–odd rule).
/// # Bound
/// At most [`CELLS`] rows, one division.
pub fn flip_left_of_edge(rows: &mut Rows, from: CellPoint, to: CellPoint) {
    let (low, high) = if from.y <= to.y {
        (from, to)
    } else {
        (to, from)
    };
    // Rows j with low.y <= 256 j + 128 < high.y.
    let row_at = |y: i32| y.saturating_sub(CENTRE).saturating_add((1 << FRACTION) - 1) >> FRACTION;
    let first = row_at(low.y).max(0);
    let last = row_at(high.y).min(i32::try_from(CELLS).unwrap_or(0));
    if first >= last {
        return;
    }
    let rise = i64::from(high.y.saturating_sub(low.y));
    let slope = (i64::from(high.x.saturating_sub(low.x)) << 16)
        .checked_div(rise)
        .unwrap_or(0);
    for row in first..last {
        let above = i64::from(
            (row << FRACTION)
                .saturating_add(CENTRE)
                .saturating_sub(low.y),
        );
        let x = i64::from(low.x).saturating_add(above.saturating_mul(slope) >> 16);
        let columns = x
            .saturating_sub(i64::from(CENTRE))
            .saturating_add((1 << FRACTION) - 1)
            >> FRACTION;
        let columns = u32::try_from(columns.clamp(0, 128)).unwrap_or(0);
        let mask = 1_u128
            .checked_shl(columns)
            .map_or(u128::MAX, |bit| bit.wrapping_sub(1));
        if let Some(slot) = usize::try_from(row).ok().and_then(|row| rows.get_mut(row)) {
            *slot ^= mask;
        }
    }
}

/// The rolling window of known space.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    recent: Rows,
    older: Rows,
    /// Cell index of the window's lower corner, relative to the anchor.
    base_x: i32,
    base_y: i32,
    /// Erosion owed, µm (less than one cell after each call).
    owed_um: u64,
    turned_over: Instant,
}

impl Default for Seen {
    fn default() -> Self {
        let half = i32::try_from(CELLS / 2).unwrap_or(0);
        Self {
            recent: [0; CELLS],
            older: [0; CELLS],
            base_x: half.saturating_neg(),
            base_y: half.saturating_neg(),
            owed_um: 0,
            turned_over: Instant::default(),
        }
    }
}

impl Seen {
    /// `(x, y)` in millimetres from the anchor, as window coordinates.
    #[must_use]
    pub fn cell_point(&self, point: PointMm) -> CellPoint {
        let scale = |mm: i32, base: i32| {
            mm.saturating_mul(4)
                .saturating_sub(base.saturating_mul(1 << FRACTION))
        };
        CellPoint {
            x: scale(point.x, self.base_x),
            y: scale(point.y, self.base_y),
        }
    }

    /// Eighths of a millimetre from the anchor, as window coordinates.
    #[must_use]
    pub fn cell_point_eighths(&self, x: i64, y: i64) -> CellPoint {
        let scale = |eighths: i64, base: i32| {
            narrow((eighths >> 1).saturating_sub(i64::from(base).saturating_mul(1 << FRACTION)))
        };
        CellPoint {
            x: scale(x, self.base_x),
            y: scale(y, self.base_y),
        }
    }

    /// Marks all cells of `rows` as known.
    pub fn mark(&mut self, rows: &Rows) {
        for (known, new) in self.recent.iter_mut().zip(rows) {
            *known |= new;
        }
    }

    /// Known cells of row `row`.
    #[must_use]
    pub fn known(&self, row: usize) -> u128 {
        self.recent.get(row).copied().unwrap_or(0) | self.older.get(row).copied().unwrap_or(0)
    }

    /// Whether the cell containing `point` (millimetres from the anchor) is known.
    #[must_use]
    pub fn is_known(&self, point: PointMm) -> bool {
        let cell = self.cell_point(point);
        let (column, row) = (cell.x >> FRACTION, cell.y >> FRACTION);
        match (u32::try_from(column), usize::try_from(row)) {
            (Ok(column), Ok(row)) if column < 128 => (self.known(row) >> column) & 1 == 1,
            //= spec/memory.md#memory-10
            //# Space outside the window of the memory MUST be unknown.
            _ => false,
        }
    }

    /// Makes the 5 × 5 cells around `point` (millimetres from the anchor) unknown.
    ///
    /// Any rectangle at least two cells wide that contains the point then contains
    /// the centre of an unknown cell (spec/model.md, "Unknown space").
    pub fn forget(&mut self, point: PointMm) {
        let cell = self.cell_point(point);
        let column = (cell.x >> FRACTION).saturating_sub(2);
        let row = (cell.y >> FRACTION).saturating_sub(2);
        let block = if column >= 0 {
            u32::try_from(column)
                .ok()
                .and_then(|c| 31_u128.checked_shl(c))
        } else {
            31_u128.checked_shr(column.unsigned_abs())
        };
        let mask = !block.unwrap_or(0);
        for row in (row..row.saturating_add(5)).filter_map(|row| usize::try_from(row).ok()) {
            for rows in [&mut self.recent, &mut self.older] {
                if let Some(slot) = rows.get_mut(row) {
                    *slot &= mask;
                }
            }
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.recent = [0; CELLS];
        self.older = [0; CELLS];
        self.owed_um = 0;
    }

    /// Lets what is older than between half of `age_max` and `age_max` become unknown.
    pub fn expire(&mut self, now: Instant, age_max: Duration) {
        let half = age_max.as_us() / 2;
        let age = now.since(self.turned_over).unwrap_or_default().as_us();
        if age < half {
            return;
        }
        //= spec/memory.md#memory-08
        //# Space not seen for longer than `age_max` MUST be unknown.
        let forgotten = age >= age_max.as_us();
        self.older = if forgotten { [0; CELLS] } else { self.recent };
        self.recent = [0; CELLS];
        self.turned_over = now;
    }

    /// Shrinks known space by `um` from all its borders, in whole cells; the rest stays owed.
    ///
    /// # Bound
    /// At most [`CELLS`] rings.
    pub fn erode(&mut self, um: u64) {
        self.owed_um = self.owed_um.saturating_add(um);
        if self.owed_um / CELL_UM >= CELLS as u64 / 2 {
            self.clear();
            return;
        }
        for _ in 0..CELLS {
            if self.owed_um < CELL_UM {
                return;
            }
            self.owed_um = self.owed_um.saturating_sub(CELL_UM);
            erode_once(&mut self.recent);
            erode_once(&mut self.older);
        }
    }

    /// Follows the robot at `(x, y)` millimetres from the anchor; what leaves the window is unknown.
    pub fn follow(&mut self, robot: PointMm) {
        let half = i32::try_from(CELLS / 2).unwrap_or(0);
        let wanted = |mm: i32| mm.div_euclid(CELL_MM).saturating_sub(half);
        let dx = wanted(robot.x).saturating_sub(self.base_x);
        let dy = wanted(robot.y).saturating_sub(self.base_y);
        let near = |cells: i32| cells.unsigned_abs() <= FOLLOW_CELLS.unsigned_abs();
        if near(dx) && near(dy) {
            return;
        }
        shift(&mut self.recent, dx, dy);
        shift(&mut self.older, dx, dy);
        self.base_x = self.base_x.saturating_add(dx);
        self.base_y = self.base_y.saturating_add(dy);
    }

    /// Keeps the window in place when the anchor moves by whole cells.
    pub fn reanchor(&mut self, shift: AnchorShift) {
        self.base_x = self.base_x.saturating_sub(shift.x_mm / CELL_MM);
        self.base_y = self.base_y.saturating_sub(shift.y_mm / CELL_MM);
    }

    /// Lower corner of the window, millimetres from the anchor.
    #[must_use]
    pub fn corner_mm(&self) -> PointMm {
        PointMm {
            x: self.base_x.saturating_mul(CELL_MM),
            y: self.base_y.saturating_mul(CELL_MM),
        }
    }
}

/// Keeps a cell only if it and its eight neighbours are known; outside the window nothing is.
fn erode_once(rows: &mut Rows) {
    let narrow_row = |row: u128| row & (row << 1) & (row >> 1);
    let mut above = 0;
    for index in 0..CELLS {
        let here = narrow_row(rows.get(index).copied().unwrap_or(0));
        let below = narrow_row(rows.get(index.saturating_add(1)).copied().unwrap_or(0));
        if let Some(slot) = rows.get_mut(index) {
            *slot = above & here & below;
        }
        above = here;
    }
}

/// Moves the window by `(dx, dy)` cells over the content.
fn shift(rows: &mut Rows, dx: i32, dy: i32) {
    let old = *rows;
    for (index, slot) in rows.iter_mut().enumerate() {
        let source = i64::try_from(index)
            .unwrap_or(i64::MAX)
            .saturating_add(i64::from(dy));
        let row = usize::try_from(source)
            .ok()
            .and_then(|source| old.get(source).copied())
            .unwrap_or(0);
        *slot = if dx >= 0 {
            row.checked_shr(dx.unsigned_abs()).unwrap_or(0)
        } else {
            row.checked_shl(dx.unsigned_abs()).unwrap_or(0)
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: i32, y: i32) -> PointMm {
        PointMm { x, y }
    }

    fn filled(seen: &Seen, corners: &[PointMm]) -> Rows {
        let mut rows = [0; CELLS];
        for (index, &corner) in corners.iter().enumerate() {
            let next = corners[(index + 1) % corners.len()];
            flip_left_of_edge(&mut rows, seen.cell_point(corner), seen.cell_point(next));
        }
        rows
    }

    #[test]
    fn a_polygon_marks_exactly_the_cells_whose_centre_is_inside() {
        let seen = Seen::default();
        let corners = [
            point(-700, -500),
            point(900, -300),
            point(300, 1100),
            point(-200, 100),
        ];
        let rows = filled(&seen, &corners);
        for (j, row) in rows.iter().enumerate() {
            for i in 0..128 {
                let x = (f64::from(i) + 0.5) * 64.0 - 4096.0;
                let y = (j as f64 + 0.5) * 64.0 - 4096.0;
                let mut inside = false;
                for (index, a) in corners.iter().enumerate() {
                    let b = corners[(index + 1) % corners.len()];
                    let (ax, ay) = (f64::from(a.x), f64::from(a.y));
                    let (bx, by) = (f64::from(b.x), f64::from(b.y));
                    if (ay <= y) != (by <= y) && x < ax + (y - ay) * (bx - ax) / (by - ay) {
                        inside = !inside;
                    }
                }
                assert_eq!(row >> i & 1 == 1, inside, "cell {i}, {j}");
            }
        }
    }

    #[test]
    fn known_space_shrinks_by_a_ring_and_no_earlier() {
        let mut seen = Seen::default();
        let square = [
            point(-320, -320),
            point(320, -320),
            point(320, 320),
            point(-320, 320),
        ];
        let rows = filled(&seen, &square);
        seen.mark(&rows);
        assert!(seen.is_known(point(310, 310)));
        seen.erode(63_999);
        assert!(seen.is_known(point(310, 310)));
        seen.erode(1);
        assert!(!seen.is_known(point(310, 0)));
        assert!(seen.is_known(point(240, 240)));
        seen.erode(64_000 * 5);
        assert!(!seen.is_known(point(0, 0)));
    }

    #[test]
    fn the_window_follows_without_moving_what_it_knows() {
        let mut seen = Seen::default();
        let square = [point(0, 0), point(640, 0), point(640, 640), point(0, 640)];
        let rows = filled(&seen, &square);
        seen.mark(&rows);
        for x in (0..3000).step_by(100) {
            seen.follow(point(x, -x / 2));
            assert!(seen.is_known(point(320, 320)), "robot at {x}");
            assert!(!seen.is_known(point(-32, 320)));
        }
        seen.reanchor(AnchorShift {
            x_mm: 2048,
            y_mm: 0,
        });
        assert!(seen.is_known(point(320 - 2048, 320)));
    }

    #[test]
    fn old_space_becomes_unknown() {
        let mut seen = Seen::default();
        seen.mark(&[u128::MAX; CELLS]);
        let limit = Duration::from_ms(1000);
        seen.expire(Instant::from_us(600_000), limit);
        assert!(seen.is_known(point(0, 0)));
        seen.expire(Instant::from_us(1_200_000), limit);
        assert!(!seen.is_known(point(0, 0)));
    }

    #[test]
    fn forgetting_a_point_leaves_no_rectangle_around_it_known() {
        let mut seen = Seen::default();
        seen.mark(&[u128::MAX; CELLS]);
        seen.forget(point(1000, -1000));
        assert!(!seen.is_known(point(1000, -1000)));
        assert!(!seen.is_known(point(1128, -1000)));
        assert!(seen.is_known(point(1000 + 64 * 4, -1000)));
        // At the window's edge nothing wraps round.
        seen.forget(point(-4096, 4095));
        assert!(seen.is_known(point(4000, 4000)));
    }
}
