//! How a grid is cut, updated and read; the one place where its parameters can be refused.

use super::log_odds::LogOdds;
use super::model::SensorModel;
use crate::units::Length;

/// Which beam speaks about which cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpdateRule {
    /// Every beam speaks about every cell it crosses, the strongest evidence for "occupied"
    /// counts, and the cell of a hit is occupied after the scan, whatever else was seen.
    #[default]
    EveryBeam,
    /// Each cell listens to the beam nearest in angle to its centre (Loh 3.3.3). A hit
    /// between two cells, or of a beam that is nobody's nearest, can get lost.
    NearestBeam,
}

/// Parameters of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridRules {
    /// Edge of a square cell, 10 mm to 1 m.
    pub cell: Length,
    /// What one beam says about distances.
    pub model: SensorModel,
    /// Which beam speaks about which cell.
    pub update: UpdateRule,
    /// Least value of a cell: bounds the time in which a free cell can turn occupied.
    pub floor: LogOdds,
    /// Largest value of a cell: bounds the time in which an occupied cell can turn free.
    pub ceiling: LogOdds,
    /// A cell is occupied from this value on (Loh 3.22).
    pub occupied_from: LogOdds,
    /// A cell is free down from this value; in between it is unknown.
    pub free_to: LogOdds,
}

impl Default for GridRules {
    /// 0.1 m, p_thresh = 0.75 (Loh 6.3), free below 0.25, cells kept within 0.12 and 0.97.
    fn default() -> Self {
        Self {
            cell: Length::from_mm(100),
            model: SensorModel::default(),
            update: UpdateRule::default(),
            floor: LogOdds::from_counts(-64),
            ceiling: LogOdds::from_counts(112),
            occupied_from: LogOdds::from_counts(36),
            free_to: LogOdds::from_counts(-36),
        }
    }
}

/// Why a grid cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum GridError {
    /// Width and height must be 1 to [`CELLS_MAX`].
    Size,
    /// The cell's edge must be 10 mm to 1 m.
    Cell,
    /// Needs `0 <= delta_1 <= 1 m` and `0 <= delta_2 <= delta_3 <= 1 m`.
    Deltas,
    /// Needs evidence `-127 <= free < 0 < occupied <= 126` counts.
    Evidence,
    /// Needs `-127 <= floor <= free_to < 0 < occupied_from <= ceiling <= 126` counts.
    Thresholds,
    /// The grid's origin must be within 1000 km of the frame's.
    Origin,
}

impl core::fmt::Display for GridError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Size => "a grid has 1 to 4096 cells per side",
            Self::Cell => "a cell's edge is 10 mm to 1 m",
            Self::Deltas => "needs 0 <= delta_1 <= 1 m and 0 <= delta_2 <= delta_3 <= 1 m",
            Self::Evidence => "needs -127 <= free < 0 < occupied <= 126 counts",
            Self::Thresholds => {
                "needs -127 <= floor <= free_to < 0 < occupied_from <= ceiling <= 126 counts"
            }
            Self::Origin => "the grid's origin is within 1000 km of the frame's",
        })
    }
}

impl core::error::Error for GridError {}

/// Largest number of cells per side.
pub const CELLS_MAX: usize = 4096;

impl GridRules {
    /// Whether a grid of `width` times `height` cells can work by these rules.
    ///
    /// # Errors
    /// The first rule violated, in the order of [`GridError`].
    pub fn check(&self, width: usize, height: usize) -> Result<(), GridError> {
        let size = 1..=CELLS_MAX;
        if !size.contains(&width) || !size.contains(&height) {
            return Err(GridError::Size);
        }
        if !(10_000..=1_000_000).contains(&self.cell.as_um()) {
            return Err(GridError::Cell);
        }
        let metre = Length::from_mm(1000);
        let model = &self.model;
        let before = Length::ZERO <= model.delta_1 && model.delta_1 <= metre;
        let behind = Length::ZERO <= model.delta_2 && model.delta_2 <= model.delta_3;
        if !(before && behind && model.delta_3 <= metre) {
            return Err(GridError::Deltas);
        }
        let (free, occupied) = (model.free.as_counts(), model.occupied.as_counts());
        if !((-127..0).contains(&free) && (1..=126).contains(&occupied)) {
            return Err(GridError::Evidence);
        }
        let rising = [self.floor, self.free_to, self.occupied_from, self.ceiling];
        let within = (-127..0).contains(&self.free_to.as_counts())
            && (1..=126).contains(&self.occupied_from.as_counts())
            && self.floor.as_counts() >= -127
            && self.ceiling.as_counts() <= 126;
        if rising.is_sorted() && within {
            Ok(())
        } else {
            Err(GridError::Thresholds)
        }
    }
}
