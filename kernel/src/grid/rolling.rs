//! A grid that follows the robot through the odometry frame.
//!
//! Content keeps its place in the frame; what leaves the window is forgotten, what enters it
//! is unknown.

use super::frame::Window;
use super::{CellIndex, GridError, GridRules, OccupancyGrid, ScanRefused};
use crate::config::Scanner;
use crate::input::{Beam, Pose};

/// An [`OccupancyGrid`] whose window stays centred on the robot.
///
/// Its cells count from the origin of the odometry frame, so a [`CellIndex`] means the same
/// place before and after a move.
#[derive(Clone, Debug)]
pub struct RollingGrid<const W: usize, const H: usize> {
    grid: OccupancyGrid<W, H>,
}

impl<const W: usize, const H: usize> RollingGrid<W, H> {
    /// An unknown surrounding of the frame's origin.
    ///
    /// # Errors
    /// What [`GridRules::check`] refuses.
    pub fn new(rules: GridRules) -> Result<Self, GridError> {
        let mut grid = OccupancyGrid::new(rules, Pose::default())?;
        grid.window = centred(CellIndex::default());
        Ok(Self { grid })
    }

    /// The cells around the robot.
    #[must_use]
    pub const fn grid(&self) -> &OccupancyGrid<W, H> {
        &self.grid
    }

    /// Moves the window with the robot; cells that enter it are unknown.
    ///
    /// # Errors
    /// [`ScanRefused::Pose`]; nothing moves then.
    /// # Bound
    /// At most all cells once.
    pub fn follow(&mut self, pose: &Pose) -> Result<(), ScanRefused> {
        let grid = &mut self.grid;
        let place = grid.frame.place(pose).ok_or(ScanRefused::Pose)?;
        let window = centred(grid.frame.spot(place.x_um, place.y_um).cell);
        let before = core::mem::replace(&mut grid.window, window);
        if before == window {
            return Ok(());
        }
        let (columns, rows) = (before.columns(), before.rows());
        for row in window.rows() {
            let Some(cells) = window.row(row).and_then(|row| grid.log_odds.get_mut(row)) else {
                continue;
            };
            //= spec/grid.md#grid-05
            //# Cells that enter a rolling grid MUST be unknown, while cells that stay keep their value.
            if !rows.contains(&row) {
                cells.fill(0);
                continue;
            }
            for column in window.columns().filter(|column| !columns.contains(column)) {
                if let Some(cell) = window.column(column).and_then(|at| cells.get_mut(at)) {
                    *cell = 0;
                }
            }
        }
        Ok(())
    }

    /// Follows the robot to `pose` and enters a scan; see [`OccupancyGrid::update`].
    ///
    /// # Errors
    /// See [`ScanRefused`]. The window follows also where the beams are refused.
    pub fn update(
        &mut self,
        pose: &Pose,
        scanner: &Scanner,
        beams: &[Beam],
    ) -> Result<(), ScanRefused> {
        self.follow(pose)?;
        self.grid.update(pose, scanner, beams)
    }

    /// Makes every cell unknown, as after a jump of the odometry.
    pub fn clear(&mut self) {
        self.grid.clear();
    }
}

fn centred<const W: usize, const H: usize>(cell: CellIndex) -> Window<W, H> {
    let low =
        |index: i32, size: usize| index.saturating_sub(i32::try_from(size / 2).unwrap_or(i32::MAX));
    Window::new(CellIndex::new(low(cell.column, W), low(cell.row, H)))
}
