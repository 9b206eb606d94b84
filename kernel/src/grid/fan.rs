//! The beams of one scan as directions in the grid's frame, and what each of them measured.

use super::model::Echo;
use crate::config::{MaskRect, Scanner};
use crate::geometry::trig::{SIN_BITS, bearing, sin_cos};
use crate::input::Beam;
use crate::units::BinaryAngle;

/// Ranges are cut to what a beam can hold, µm.
const RANGE_MAX_UM: i32 = 65_535_000;

/// One scan seen from the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fan<'a> {
    scanner: &'a Scanner,
    beams: &'a [Beam],
    heading: BinaryAngle,
    masked: bool,
}

impl<'a> Fan<'a> {
    /// `heading` is the robot's in the grid's frame.
    pub(super) fn new(scanner: &'a Scanner, beams: &'a [Beam], heading: BinaryAngle) -> Self {
        Self {
            scanner,
            beams,
            heading,
            masked: scanner.masks.iter().any(Option::is_some),
        }
    }

    /// Every beam that says something, with its direction in the grid's frame.
    pub(super) fn echoes(&self) -> impl Iterator<Item = (BinaryAngle, Echo)> + '_ {
        (0..self.beams.len()).filter_map(|index| Some((self.direction(index), self.echo(index)?)))
    }

    /// What the beam measured; `None` if it says nothing or saw the robot itself.
    pub(super) fn echo(&self, index: usize) -> Option<Echo> {
        let um = |um: i32| um.clamp(0, RANGE_MAX_UM).unsigned_abs();
        match *self.beams.get(index)? {
            Beam::Invalid => None,
            Beam::NoReturn => match um(self.scanner.no_return_clear.as_um()) {
                0 => None,
                range_um => Some(Echo::Clear { range_um }),
            },
            Beam::TooNear => Some(Echo::Hit {
                range_um: um(self.scanner.range_min.as_um()),
            }),
            Beam::Hit(range_mm) => {
                let range_um = u32::from(range_mm).saturating_mul(1000);
                let own = self.masked && self.sees_itself(index, range_um);
                (!own).then_some(Echo::Hit { range_um })
            }
        }
    }

    /// The beam nearest in angle to the vector `(x, y)` of the grid's frame; `None` if that is
    /// more than half an increment away from every beam. In a tie the beam farther
    /// counter-clockwise counts, whichever way the scanner turns.
    ///
    /// # Bound
    /// O(1).
    pub(super) fn nearest(&self, x_um: i32, y_um: i32) -> Option<usize> {
        let count = u32::try_from(self.beams.len()).ok()?;
        let step = self.scanner.increment.unsigned_abs();
        let offset = bearing(x_um, y_um).minus(self.direction(0)).cast_unsigned();
        let (offset, half) = if self.clockwise() {
            (offset.wrapping_neg(), step.saturating_sub(1) / 2)
        } else {
            (offset, step / 2)
        };
        let (rounded, wrapped) = offset.overflowing_add(half);
        if wrapped {
            return usize::try_from(self.first_or_last(offset, count, step)).ok();
        }
        let index = rounded.checked_div(step)?;
        (index < count).then(|| usize::try_from(index).ok())?
    }

    /// Which of the two ends is nearer to `offset`, which lies just before a full turn.
    fn first_or_last(&self, offset: u32, count: u32, step: u32) -> u32 {
        let last = count.saturating_sub(1);
        let from_last = step.wrapping_mul(last).abs_diff(offset);
        let from_first = offset.wrapping_neg();
        if from_last < from_first || (from_last == from_first && self.clockwise()) {
            last
        } else {
            0
        }
    }

    fn clockwise(&self) -> bool {
        self.scanner.increment < 0
    }

    fn direction(&self, index: usize) -> BinaryAngle {
        self.heading.plus(self.body_direction(index))
    }

    fn body_direction(&self, index: usize) -> BinaryAngle {
        // Wraps by whole turns, which is what angles do.
        let steps = u32::try_from(index).unwrap_or(0);
        let turned = self.scanner.increment.cast_unsigned().wrapping_mul(steps);
        self.scanner
            .first_beam
            .plus(BinaryAngle::from_counts(turned))
    }

    fn sees_itself(&self, index: usize, range_um: u32) -> bool {
        let (x, y) = along(self.body_direction(index), range_um);
        let x = x.saturating_add(i64::from(self.scanner.x.as_um()));
        let y = y.saturating_add(i64::from(self.scanner.y.as_um()));
        let inside = |mask: &MaskRect| {
            (i64::from(mask.x_min.as_um())..=i64::from(mask.x_max.as_um())).contains(&x)
                && (i64::from(mask.y_min.as_um())..=i64::from(mask.y_max.as_um())).contains(&y)
        };
        self.scanner.masks.iter().flatten().any(inside)
    }
}

/// The vector of this length in this direction, µm, rounded down.
pub(super) fn along(direction: BinaryAngle, length_um: u32) -> (i64, i64) {
    let (sin, cos) = sin_cos(direction);
    let scaled = |part: i32| i64::from(part).saturating_mul(i64::from(length_um)) >> SIN_BITS;
    (scaled(cos), scaled(sin))
}
