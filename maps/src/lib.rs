//! Occupancy grids as files: a PGM picture and a YAML description, as ROS `map_server` uses them.
//!
//! [`save`] writes both, [`load`] reads both; [`Map::from_grid`] and [`Map::to_grid`] exchange
//! cells with [`haltline::grid::OccupancyGrid`]. Files keep three values per cell (free,
//! occupied, unknown), so a grid comes back by what its cells mean, not by their log-odds.
//!
//! It refuses what it does not understand instead of guessing: other picture formats, other
//! modes than `trinary`, pictures that are too large, too short or too long, numbers that are
//! not numbers. Nothing is allocated by what a header claims before the bytes are there.

mod error;
mod file;
mod grid;
mod pgm;
mod yaml;

#[cfg(test)]
mod tests;

pub use error::MapError;
pub use file::{load, save};
pub use grid::EnterError;
pub use pgm::{CELLS_PER_SIDE_MAX, Picture, parse_pgm, render_pgm};
pub use yaml::{Description, parse_yaml, render_yaml};

use haltline::grid::Occupancy;

/// A map between files and grids.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Edge of a cell, metres.
    pub resolution_m: f64,
    /// Lower left corner of the lowest cell in the map frame and direction of the rows:
    /// x (m), y (m), yaw (rad).
    pub origin: [f64; 3],
    /// Cells, row by row, the lowest row first (a picture has the highest first).
    pub cells: Vec<Occupancy>,
}

impl Map {
    /// The cell in this column and row; [`Occupancy::Unknown`] off the map.
    #[must_use]
    pub fn occupancy(&self, column: usize, row: usize) -> Occupancy {
        if column >= self.width {
            return Occupancy::Unknown;
        }
        let index = row
            .checked_mul(self.width)
            .and_then(|start| start.checked_add(column));
        let cell = index.and_then(|index| self.cells.get(index));
        cell.copied().unwrap_or(Occupancy::Unknown)
    }

    /// The picture of this map by the default thresholds: occupied is black (0), free is
    /// almost white (254), unknown is grey (205), and the highest row comes first.
    #[must_use]
    pub fn picture(&self) -> Picture {
        let rows = (0..self.height).rev();
        let cells = rows.flat_map(|row| (0..self.width).map(move |column| (column, row)));
        let grey = |(column, row)| match self.occupancy(column, row) {
            Occupancy::Occupied => 0,
            Occupancy::Free => 254,
            Occupancy::Unknown => 205,
        };
        Picture {
            width: self.width,
            height: self.height,
            greys: cells.map(grey).collect(),
        }
    }

    /// The map that `picture` shows under `description`.
    #[must_use]
    pub fn from_picture(picture: &Picture, description: &Description) -> Self {
        let rows = picture.greys.chunks(picture.width.max(1)).rev();
        Self {
            width: picture.width,
            height: picture.height,
            resolution_m: description.resolution_m,
            origin: description.origin,
            cells: rows
                .flatten()
                .map(|grey| description.occupancy(*grey))
                .collect(),
        }
    }
}
