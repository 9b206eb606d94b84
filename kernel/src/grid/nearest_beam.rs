//! The thesis' update rule: each cell listens to the beam nearest in angle to its centre.

use super::fan::Fan;
use super::frame::Place;
use super::model::{Echo, SensorModel};
use super::{CellIndex, LogOdds, OccupancyGrid, Reached};
use crate::arith::narrow;

impl<const W: usize, const H: usize> OccupancyGrid<W, H> {
    pub(super) fn nearest_beam(&mut self, sensor: Place, fan: &Fan<'_>, reached: &Reached) {
        let frame = self.frame;
        let (floor, ceiling) = (self.rules.floor.as_counts(), self.rules.ceiling.as_counts());
        let middle = frame.cell_um / 2;
        let farthest = square(i64::from(reached.reach_um));
        for row in reached.rows.clone() {
            let stored = self.window.row(row);
            let Some(cells) = stored.and_then(|row| self.log_odds.get_mut(row)) else {
                continue;
            };
            for column in reached.columns.clone() {
                let (x, y) = frame.towards(sensor, CellIndex::new(column, row));
                let (x, y) = (x.saturating_add(middle), y.saturating_add(middle));
                let squared = square(x).saturating_add(square(y));
                if squared > farthest {
                    continue;
                }
                let echo = fan
                    .nearest(narrow(x), narrow(y))
                    .and_then(|beam| fan.echo(beam));
                let evidence = echo.and_then(|echo| at(&self.rules.model, squared, echo));
                let stored = self.window.column(column).and_then(|at| cells.get_mut(at));
                if let (Some(evidence), Some(cell)) = (evidence, stored) {
                    *cell = cell
                        .saturating_add(evidence.as_counts())
                        .max(floor)
                        .min(ceiling);
                }
            }
        }
    }
}

/// The model's evidence at a squared distance; takes the root only where it matters.
fn at(model: &SensorModel, squared: u64, echo: Echo) -> Option<LogOdds> {
    if squared < square(i64::from(model.free_um(echo))) {
        return Some(model.free);
    }
    if squared > square(i64::from(model.reach_um(echo))) {
        return None;
    }
    let distance = i64::try_from(squared.isqrt()).unwrap_or(i64::MAX);
    model.evidence(distance, echo)
}

fn square(value: i64) -> u64 {
    value.unsigned_abs().saturating_mul(value.unsigned_abs())
}
