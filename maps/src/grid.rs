//! Between maps and the kernel's grids.

use crate::Map;
use core::f64::consts::TAU;
use core::fmt;
use haltline::convert::{self, Round};
use haltline::grid::{CellIndex, GridError, GridRules, LogOdds, Occupancy, OccupancyGrid};
use haltline::input::Pose;

/// Why a map cannot become a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnterError {
    /// The map has this many columns and rows more than the grid can hold.
    TooLarge {
        /// Columns of the map.
        width: usize,
        /// Rows of the map.
        height: usize,
    },
    /// Resolution or origin do not fit the kernel's numbers (±2147 m).
    Numbers,
    /// The grid itself is refused.
    Grid(GridError),
}

impl fmt::Display for EnterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLarge { width, height } => {
                write!(f, "a map of {width} x {height} cells does not fit the grid")
            }
            Self::Numbers => f.write_str("resolution or origin is beyond 2147 m"),
            Self::Grid(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for EnterError {}

impl Map {
    /// What the cells of `grid` mean; a rolling grid gives its present window.
    #[must_use]
    pub fn from_grid<const W: usize, const H: usize>(grid: &OccupancyGrid<W, H>) -> Self {
        let corner = grid.lower_left();
        // Signed, so that a small turn to the right stays small.
        let yaw = f64::from(corner.heading.as_counts().cast_signed()) / 4_294_967_296.0 * TAU;
        Self {
            width: W,
            height: H,
            resolution_m: f64::from(grid.rules().cell.as_um()) / 1e6,
            origin: [metres(corner.x_um), metres(corner.y_um), yaw],
            cells: grid.cells().map(|cell| grid.occupancy(cell)).collect(),
        }
    }

    /// A grid with this map in its lower left corner, the rest unknown; `rules` gives
    /// everything but the size of a cell.
    ///
    /// A cell starts at the threshold of what it means, so that scans can still change it soon.
    ///
    /// # Errors
    /// See [`EnterError`].
    pub fn to_grid<const W: usize, const H: usize>(
        &self,
        rules: GridRules,
    ) -> Result<OccupancyGrid<W, H>, EnterError> {
        if self.width > W || self.height > H {
            let (width, height) = (self.width, self.height);
            return Err(EnterError::TooLarge { width, height });
        }
        let cell = convert::length(self.resolution_m, Round::Nearest).ok_or(EnterError::Numbers)?;
        let rules = GridRules { cell, ..rules };
        let origin = self.origin().ok_or(EnterError::Numbers)?;
        let mut grid = OccupancyGrid::new(rules, origin).map_err(EnterError::Grid)?;
        for index in grid.cells() {
            grid.set(index, value(self.at(index), &rules));
        }
        Ok(grid)
    }

    fn at(&self, index: CellIndex) -> Occupancy {
        let indices = (
            usize::try_from(index.column()),
            usize::try_from(index.row()),
        );
        match indices {
            (Ok(column), Ok(row)) => self.occupancy(column, row),
            _ => Occupancy::Unknown,
        }
    }

    fn origin(&self) -> Option<Pose> {
        let [x, y, yaw] = self.origin;
        let um = |metres| convert::length(metres, Round::Nearest).map(|l| i64::from(l.as_um()));
        Some(Pose {
            x_um: um(x)?,
            y_um: um(y)?,
            heading: convert::angle(yaw)?,
        })
    }
}

fn value(occupancy: Occupancy, rules: &GridRules) -> LogOdds {
    match occupancy {
        Occupancy::Occupied => rules.occupied_from,
        Occupancy::Free => rules.free_to,
        Occupancy::Unknown => LogOdds::PRIOR,
    }
}

/// Micrometres as metres; exact to the micrometre up to 9·10⁹ m.
#[allow(clippy::cast_precision_loss)]
fn metres(um: i64) -> f64 {
    um as f64 / 1e6
}
