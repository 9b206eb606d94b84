//! An occupancy grid for planning: what laser scans say about cells, as integer log-odds.
//!
//! It refuses to be evidence for safety: the guard never asks it. A wrong cell makes a plan
//! worse, never a motion unsafe. It remembers what the scanner no longer sees, forgets what it
//! sees through, and says [`Occupancy::Unknown`] about everything else, off the map included.
//!
//! [`OccupancyGrid`] lies fixed in the frame that poses are given in (a map); [`RollingGrid`]
//! follows the robot through the odometry frame. Poses are believed as they are; the whole
//! scan is taken at one pose, so it is as sharp as that pose and the scan's duration allow.
//!
//! Invariants: every cell lies within `floor..=ceiling` of its [`GridRules`]; the order of
//! the beams is irrelevant; nothing allocates, panics or overflows for any pose, scanner,
//! beams or cell index; the work of an update is bounded by the cells and beams (see
//! [`OccupancyGrid::update`]).

mod corners;
mod every_beam;
mod fan;
mod frame;
mod log_odds;
mod model;
mod nearest_beam;
mod rolling;
mod rules;
#[cfg(test)]
mod tests;

pub use frame::POSE_MAX_UM;
#[doc(hidden)]
pub use frame::{ring, slot};
pub use log_odds::LogOdds;
pub use model::{Echo, SensorModel};
pub use rolling::RollingGrid;
pub use rules::{CELLS_MAX, GridError, GridRules, UpdateRule};

use crate::config::Scanner;
use crate::input::{Beam, Pose};
use fan::{Fan, along};
use frame::{GridFrame, Place, Window, overlap, rotated};

/// A cell by its column and row in the grid's own frame; any pair of numbers is a valid
/// question, most of them off the map.
///
/// Cell `(0, 0)` has its lower left corner at the grid's origin, columns count along x of the
/// grid's frame and rows along y: `floor(x / cell), floor(y / cell)`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct CellIndex {
    column: i32,
    row: i32,
}

impl CellIndex {
    /// The cell in this column and row.
    #[must_use]
    pub const fn new(column: i32, row: i32) -> Self {
        Self { column, row }
    }

    /// Column, along x.
    #[must_use]
    pub const fn column(self) -> i32 {
        self.column
    }

    /// Row, along y.
    #[must_use]
    pub const fn row(self) -> i32 {
        self.row
    }
}

/// What is known about a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Occupancy {
    /// Looked through often enough.
    Free,
    /// Something is there.
    Occupied,
    /// Not seen, seen too little, contradictory, or off the map.
    Unknown,
}

/// Why a scan was not entered; the grid is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum ScanRefused {
    /// The number of beams is not the scanner's.
    BeamCount,
    /// The scanner's beams cover more than a full turn.
    Fan,
    /// The pose is farther than [`POSE_MAX_UM`] from the origin of its frame.
    Pose,
}

/// A fixed grid of `W` columns and `H` rows, `2 * W * H` bytes and little more.
///
/// It is returned by value: box it, or place it in a `static`, where the stack is small.
#[derive(Clone, Debug)]
pub struct OccupancyGrid<const W: usize, const H: usize> {
    rules: GridRules,
    frame: GridFrame,
    window: Window<W, H>,
    log_odds: [[i8; W]; H],
    /// Scratch of the every-beam rule: the strongest evidence of this scan.
    evidence: [[i8; W]; H],
}

/// Cells that a scan can speak about.
struct Reached {
    columns: core::ops::Range<i32>,
    rows: core::ops::Range<i32>,
    /// Farthest evidence of any beam, µm.
    reach_um: u32,
}

impl<const W: usize, const H: usize> OccupancyGrid<W, H> {
    /// An unknown map whose cell (0, 0) has its lower left corner at `origin`.
    ///
    /// `origin` is in the frame in which all poses are given (usually the map frame); its
    /// heading turns the grid.
    ///
    /// # Errors
    /// What [`GridRules::check`] refuses, or [`GridError::Origin`].
    pub fn new(rules: GridRules, origin: Pose) -> Result<Self, GridError> {
        rules.check(W, H)?;
        let frame = GridFrame {
            origin,
            cell_um: i64::from(rules.cell.as_um()),
        };
        frame.place(&origin).ok_or(GridError::Origin)?;
        Ok(Self {
            rules,
            frame,
            window: Window::new(CellIndex::default()),
            log_odds: [[0; W]; H],
            evidence: [[0; W]; H],
        })
    }

    /// The parameters.
    #[must_use]
    pub const fn rules(&self) -> &GridRules {
        &self.rules
    }

    /// The lowest column and row held; (0, 0) for a fixed grid.
    #[must_use]
    pub const fn lowest(&self) -> CellIndex {
        self.window.low()
    }

    /// Lower left corner of [`Self::lowest`] and direction of the rows, in the poses' frame.
    #[must_use]
    pub fn lower_left(&self) -> Pose {
        let (x_um, y_um) = self.corner_um(self.lowest());
        Pose {
            x_um,
            y_um,
            heading: self.frame.origin.heading,
        }
    }

    /// Lower left corner of `cell` in the poses' frame, µm.
    #[must_use]
    pub fn corner_um(&self, cell: CellIndex) -> (i64, i64) {
        let origin = self.frame.origin;
        let cell_um = self.frame.cell_um;
        let (x, y) = rotated(
            i64::from(cell.column).saturating_mul(cell_um),
            i64::from(cell.row).saturating_mul(cell_um),
            origin.heading.minus(crate::units::BinaryAngle::ZERO),
        );
        (origin.x_um.saturating_add(x), origin.y_um.saturating_add(y))
    }

    /// The cell at a point of the poses' frame, on the map or not; `None` beyond [`POSE_MAX_UM`].
    #[must_use]
    pub fn cell_at(&self, x_um: i64, y_um: i64) -> Option<CellIndex> {
        let place = self.frame.place(&Pose {
            x_um,
            y_um,
            ..Pose::default()
        })?;
        Some(self.frame.spot(place.x_um, place.y_um).cell)
    }

    /// What is known about `cell`; [`Occupancy::Unknown`] off the map.
    ///
    /// # Bound
    /// O(1).
    #[must_use]
    pub fn occupancy(&self, cell: CellIndex) -> Occupancy {
        match self.log_odds(cell) {
            Some(value) if value >= self.rules.occupied_from => Occupancy::Occupied,
            Some(value) if value <= self.rules.free_to => Occupancy::Free,
            //= spec/grid.md#grid-03
            //# A place off the grid MUST be unknown.
            _ => Occupancy::Unknown,
        }
    }

    /// The cell's value; `None` off the map.
    #[must_use]
    pub fn log_odds(&self, cell: CellIndex) -> Option<LogOdds> {
        let (row, column) = self.window.slot(cell)?;
        let counts = *self.log_odds.get(row)?.get(column)?;
        Some(LogOdds::from_counts(counts))
    }

    /// Sets a cell, clamped to `floor..=ceiling`; returns whether it lies on the map.
    pub fn set(&mut self, cell: CellIndex, value: LogOdds) -> bool {
        let value = value.max(self.rules.floor).min(self.rules.ceiling);
        let slot = self.window.slot(cell);
        let stored = slot.and_then(|(row, column)| self.log_odds.get_mut(row)?.get_mut(column));
        stored.map(|stored| *stored = value.as_counts()).is_some()
    }

    /// All cells held, row by row from the lowest.
    pub fn cells(&self) -> impl Iterator<Item = CellIndex> + use<W, H> {
        let columns = self.window.columns();
        self.window.rows().flat_map(move |row| {
            columns
                .clone()
                .map(move |column| CellIndex::new(column, row))
        })
    }

    /// Makes every cell unknown.
    pub fn clear(&mut self) {
        self.log_odds = [[0; W]; H];
    }

    /// Enters one scan taken with the robot at `pose`.
    ///
    /// `beams` are the scanner's, in its order. A hit inside one of the scanner's masks is the
    /// robot itself and says nothing. [`Beam::TooNear`] is a hit at the least range,
    /// [`Beam::NoReturn`] is free up to the scanner's `no_return_clear`. Whatever lies off the
    /// map is dropped.
    ///
    /// # Errors
    /// See [`ScanRefused`].
    /// # Bound
    /// [`UpdateRule::EveryBeam`]: per beam at most `2 * (range + delta_3) / cell + 3` cells,
    /// plus all cells twice. [`UpdateRule::NearestBeam`]: each cell once, and the beams once.
    /// # Source
    /// Loh 3.3, Alg. 3.3.
    pub fn update(
        &mut self,
        pose: &Pose,
        scanner: &Scanner,
        beams: &[Beam],
    ) -> Result<(), ScanRefused> {
        if beams.len() != usize::from(scanner.beams) {
            return Err(ScanRefused::BeamCount);
        }
        let steps = u64::from(scanner.beams).saturating_sub(1);
        if steps.saturating_mul(u64::from(scanner.increment.unsigned_abs())) > u64::from(u32::MAX) {
            return Err(ScanRefused::Fan);
        }
        //= spec/grid.md#grid-04
        //# A scan that cannot be placed MUST NOT change any cell.
        let place = self.frame.place(pose).ok_or(ScanRefused::Pose)?;
        let sensor = GridFrame::mounted(place, scanner);
        let fan = Fan::new(scanner, beams, place.heading);
        let reached = self.reached(sensor, &fan, scanner.increment.unsigned_abs());
        if reached.rows.is_empty() || reached.columns.is_empty() {
            return Ok(());
        }
        match self.rules.update {
            UpdateRule::EveryBeam => self.every_beam(sensor, &fan, &reached),
            UpdateRule::NearestBeam => self.nearest_beam(sensor, &fan, &reached),
        }
        Ok(())
    }

    /// A box around everything the scan speaks about, cut to the map.
    fn reached(&self, sensor: Place, fan: &Fan<'_>, step: u32) -> Reached {
        let (mut low, mut high, mut reach_um) = ((0_i64, 0_i64), (0_i64, 0_i64), 0_u32);
        for (direction, echo) in fan.echoes() {
            let reach = self.rules.model.reach_um(echo);
            let (x, y) = along(direction, reach);
            // Half a step to either side, along an arc: less than reach * step / 2 * 7 / 2³².
            let aside = u64::from(reach).saturating_mul(u64::from(step / 2)) >> 29;
            let aside = i64::try_from(aside).unwrap_or(i64::MAX);
            low.0 = low.0.min(x.saturating_sub(aside));
            low.1 = low.1.min(y.saturating_sub(aside));
            high.0 = high.0.max(x.saturating_add(aside));
            high.1 = high.1.max(y.saturating_add(aside));
            reach_um = reach_um.max(reach);
        }
        let spot = |(x, y): (i64, i64)| {
            let x = sensor.x_um.saturating_add(x);
            self.frame.spot(x, sensor.y_um.saturating_add(y)).cell
        };
        let (low, high) = (spot(low), spot(high));
        // One cell more for rounding.
        let range = |low: i32, high: i32| low.saturating_sub(1)..=high.saturating_add(1);
        Reached {
            columns: overlap(range(low.column, high.column), &self.window.columns()),
            rows: overlap(range(low.row, high.row), &self.window.rows()),
            reach_um,
        }
    }
}
