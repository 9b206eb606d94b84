//! The conservative update rule: every beam speaks about every cell it crosses.
//!
//! In one scan a cell is updated at most once, with the strongest evidence for "occupied" of
//! all beams that cross it; so the order of beams is irrelevant, and cells near the scanner,
//! crossed by many beams, learn no faster than others. A cell that contains a hit is occupied
//! after the scan: no hit is lost between cells or under free evidence.

use super::fan::{Fan, along};
use super::frame::{Place, Spot, Window};
use super::model::{Echo, SensorModel};
use super::{CellIndex, OccupancyGrid, Reached};
use crate::geometry::trig::{SIN_BITS, sin_cos};
use crate::units::BinaryAngle;

/// Evidence of a cell that no beam crossed; all evidence is greater.
const NONE: i8 = i8::MIN;
/// Evidence of a cell with a hit in it; all other evidence is less.
const HIT: i8 = i8::MAX;
/// Fractional bits of path lengths in µm.
const PATH_BITS: u32 = 8;

impl<const W: usize, const H: usize> OccupancyGrid<W, H> {
    pub(super) fn every_beam(&mut self, sensor: Place, fan: &Fan<'_>, reached: &Reached) {
        for row in reached.rows.clone() {
            if let Some(row) = self
                .window
                .row(row)
                .and_then(|row| self.evidence.get_mut(row))
            {
                row.fill(NONE);
            }
        }
        let mut layer = Layer {
            window: self.window,
            evidence: &mut self.evidence,
            model: self.rules.model,
            cell_um: self.frame.cell_um,
        };
        let start = self.frame.spot(sensor.x_um, sensor.y_um);
        for (direction, echo) in fan.echoes() {
            layer.cross(start, direction, echo);
            //= spec/grid.md#grid-02
            //# With the every-beam rule, the cell of a hit MUST be occupied after the scan.
            if let Echo::Hit { range_um } = echo {
                let (x, y) = along(direction, range_um);
                let (x, y) = (sensor.x_um.saturating_add(x), sensor.y_um.saturating_add(y));
                layer.raise(self.frame.spot(x, y).cell, HIT);
            }
        }
        self.apply(reached);
    }

    /// Adds the scan's evidence to the cells.
    fn apply(&mut self, reached: &Reached) {
        let rules = &self.rules;
        let [floor, ceiling, threshold, occupied] = [
            rules.floor,
            rules.ceiling,
            rules.occupied_from,
            rules.model.occupied,
        ]
        .map(super::LogOdds::as_counts);
        for row in reached.rows.clone().filter_map(|row| self.window.row(row)) {
            let Some((cells, evidence)) = self.log_odds.get_mut(row).zip(self.evidence.get(row))
            else {
                continue;
            };
            for (cell, &evidence) in cells.iter_mut().zip(evidence) {
                //= spec/grid.md#grid-01
                //# The value of every cell MUST stay between floor and ceiling.
                *cell = match evidence {
                    NONE => *cell,
                    HIT => cell.saturating_add(occupied).max(threshold).min(ceiling),
                    _ => cell.saturating_add(evidence).max(floor).min(ceiling),
                };
            }
        }
    }
}

/// The evidence of one scan while it is gathered.
struct Layer<'g, const W: usize, const H: usize> {
    window: Window<W, H>,
    evidence: &'g mut [[i8; W]; H],
    model: SensorModel,
    cell_um: i64,
}

impl<const W: usize, const H: usize> Layer<'_, W, H> {
    /// Keeps the stronger evidence; returns whether the cell lies on the map.
    #[inline]
    fn raise(&mut self, cell: CellIndex, evidence: i8) -> bool {
        let slot = self.window.slot(cell);
        let stored = slot.and_then(|(row, column)| self.evidence.get_mut(row)?.get_mut(column));
        stored
            .map(|stored| *stored = evidence.max(*stored))
            .is_some()
    }

    /// Enters the evidence of one beam into every cell it crosses.
    ///
    /// The place of a cell on the beam is its centre's projection on it, which is within half
    /// a diagonal of any point where the beam crosses the cell.
    fn cross(&mut self, start: Spot, direction: BinaryAngle, echo: Echo) {
        let mut walk = Walk::new(start, direction, self.cell_um);
        let end = path(self.model.reach_um(echo));
        // Half a diagonal, and what path lengths may be off by rounding.
        let aside_um = (self.cell_um.saturating_mul(46_342) >> 16).saturating_add(16);
        let free_um = i64::from(self.model.free_um(echo)).saturating_sub(aside_um);
        // Up to here the middle of every crossed cell is plainly free.
        let free = path(u32::try_from(free_um).unwrap_or(0));
        let Some(entered) = self.cross_free(&mut walk, free.min(end)) else {
            return;
        };
        self.cross_edge(
            &mut walk,
            &Line::new(start, direction, self.cell_um),
            echo,
            end,
            entered,
        );
    }

    /// Frees cells up to the path length `free`; returns whether the beam is on the map by
    /// then, `None` if it left it.
    fn cross_free(&mut self, walk: &mut Walk, free: u64) -> Option<bool> {
        let evidence = self.model.free.as_counts();
        let mut entered = false;
        // Ends: every step crosses a border, and the borders of an axis are a cell or more apart.
        while walk.leave() <= free {
            let on_map = self.raise(walk.cell, evidence);
            // The map is convex: a beam that left it does not return.
            if entered && !on_map {
                return None;
            }
            entered = on_map;
            walk.step();
        }
        Some(entered)
    }

    /// Asks the model about every cell from where the beam is to the path length `end`.
    fn cross_edge(&mut self, walk: &mut Walk, line: &Line, echo: Echo, end: u64, entered: bool) {
        let mut entered = entered;
        while walk.at <= end {
            let on_map = match self.model.evidence(line.project(walk.cell), echo) {
                Some(evidence) => self.raise(walk.cell, evidence.as_counts()),
                None => self.window.slot(walk.cell).is_some(),
            };
            if entered && !on_map {
                return;
            }
            entered = on_map;
            walk.step();
        }
    }
}

/// A beam as a line, for the place of cells along it.
struct Line {
    start: Spot,
    cos: i64,
    sin: i64,
    cell_um: i64,
}

impl Line {
    fn new(start: Spot, direction: BinaryAngle, cell_um: i64) -> Self {
        let (sin, cos) = sin_cos(direction);
        Self {
            start,
            cos: i64::from(cos),
            sin: i64::from(sin),
            cell_um,
        }
    }

    /// Where the middle of `cell` projects on the beam, µm from the scanner, rounded down.
    fn project(&self, cell: CellIndex) -> i64 {
        let along = |index: i32, start: i32, offset: i64| {
            i64::from(index)
                .saturating_sub(i64::from(start))
                .saturating_mul(self.cell_um)
                .saturating_add(self.cell_um / 2)
                .saturating_sub(offset)
        };
        let x = along(cell.column(), self.start.cell.column(), self.start.x_um);
        let y = along(cell.row(), self.start.cell.row(), self.start.y_um);
        x.saturating_mul(self.cos)
            .saturating_add(y.saturating_mul(self.sin))
            >> SIN_BITS
    }
}

/// The cells along a beam, border by border (Amanatides and Woo 1987), in path lengths of
/// 2⁻⁸ µm.
struct Walk {
    cell: CellIndex,
    /// Path length at which the cell was entered.
    at: u64,
    column: Borders,
    row: Borders,
}

/// The borders of one axis along a beam.
#[derive(Clone, Copy)]
struct Borders {
    /// Path length of the next border.
    next: u64,
    /// Path length from border to border.
    apart: u64,
    /// Direction in which cells count.
    step: i32,
}

impl Borders {
    /// `part`: the direction's component along the axis; `offset_um`: from the lower border.
    fn new(part: i32, offset_um: i64, cell_um: i64) -> Self {
        let ahead_um = if part < 0 {
            offset_um
        } else {
            cell_um.saturating_sub(offset_um)
        };
        let length = |um: i64| {
            (um.max(0).unsigned_abs() << (SIN_BITS + PATH_BITS))
                .checked_div(u64::from(part.unsigned_abs()))
                .unwrap_or(u64::MAX)
        };
        Self {
            next: length(ahead_um),
            apart: length(cell_um),
            step: part.signum(),
        }
    }
}

impl Walk {
    fn new(start: Spot, direction: BinaryAngle, cell_um: i64) -> Self {
        let (sin, cos) = sin_cos(direction);
        Self {
            cell: start.cell,
            at: 0,
            column: Borders::new(cos, start.x_um, cell_um),
            row: Borders::new(sin, start.y_um, cell_um),
        }
    }

    /// Path length at which the cell is left.
    #[inline]
    fn leave(&self) -> u64 {
        self.column.next.min(self.row.next)
    }

    /// Into the next cell.
    #[inline]
    fn step(&mut self) {
        self.at = self.leave();
        // Which border comes next is as good as random; selecting costs less than guessing.
        let column_first = self.column.next <= self.row.next;
        let (columns, along) = if column_first {
            (self.column.step, self.column.apart)
        } else {
            (0, 0)
        };
        let (rows, across) = if column_first {
            (0, 0)
        } else {
            (self.row.step, self.row.apart)
        };
        // Cells within reach of a beam are far from the ends of the range.
        self.cell.column = self.cell.column.wrapping_add(columns);
        self.cell.row = self.cell.row.wrapping_add(rows);
        self.column.next = self.column.next.saturating_add(along);
        self.row.next = self.row.next.saturating_add(across);
    }
}

fn path(um: u32) -> u64 {
    u64::from(um) << PATH_BITS
}
