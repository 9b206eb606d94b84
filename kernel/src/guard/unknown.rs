//! Whether a tube enters space nobody has looked at.

use super::BodyPoint;
use super::seen::{CELL_MM, CELLS, Rows, Seen, flip_left_of_edge};
use super::tube::{EIGHTH_BITS, Sample, Tube, eighths_up};
use crate::geometry::frame::{PointMm, ROTATION_BITS, Rotation};
use crate::geometry::rect::Rect;
use crate::odometry::LocalPose;

/// Samples nearer to each other than this are tested once, µm.
const STRIDE_UM: u64 = 32_000;
/// Path in µm for each eighth of a millimetre by which a cell may come nearer: one in 64. A robot
/// that swings its tail by less does not enter anything new.
const SLACK_UM: u64 = 8_000;
/// Edge of the window in 1/256 cells.
const WINDOW: i32 = 128 << 8;

/// The centre of an unknown cell that `tube` enters, if any (body frame).
///
/// A cell counts if its centre lies in a sample grown by everything except obstacle motion and
/// sensor terms, and the nominal footprint is nearer to it there than at the start: what lies
/// beside or behind a robot that drives straight on is no news. (An excused *region* would travel
/// with the robot, and a slow one would never meet unknown space.)
/// # Bound
/// O(samples × cells of a grown footprint).
/// # Source
/// GUARD-02; spec/model.md "Unknown space".
#[must_use]
pub fn entered(tube: &Tube, footprint: Rect, seen: &Seen, pose: LocalPose) -> Option<BodyPoint> {
    let place = Placement::new(pose, seen);
    let samples = tube.samples();
    let last = samples.len().saturating_sub(1);
    let stride = stride(tube);
    let mut rows: Rows = [0; CELLS];
    //= spec/guard.md#guard-02
    //# The guard MUST refuse a motion when one of its samples, inflated by every term but sensor and moving, contains
    //# the centre of an unknown cell to which the nominal footprint comes nearer there than it is at the start.
    for (number, sample) in samples.iter().enumerate().skip(tube.nominal_from) {
        if number.checked_rem(stride) != Some(0) && number != last {
            continue;
        }
        let rect = footprint.grown(eighths_up(growth_um(tube, sample, stride)));
        let span = place.fill(&mut rows, sample.corners(rect));
        if !place.inside(sample.corners(rect)) {
            return Some(body_point(sample.centre));
        }
        let path_um = step_um(tube).saturating_mul(number as u64);
        let slack = path_um.checked_div(SLACK_UM).unwrap_or(0).saturating_add(1);
        for row in span {
            // Leaves the row empty for the next sample.
            let mut unknown = rows.get_mut(row).map_or(0, core::mem::take) & !seen.known(row);
            while unknown != 0 {
                let cell = place.cell_in_body(unknown.trailing_zeros(), row);
                if comes_nearer(footprint, sample, cell, slack) {
                    return Some(cell);
                }
                unknown &= unknown.wrapping_sub(1);
            }
        }
    }
    None
}

/// Whether the nominal footprint at `sample` is nearer to `cell` than at the start, by more than
/// `slack` eighths of a millimetre.
fn comes_nearer(footprint: Rect, sample: &Sample, cell: BodyPoint, slack: u64) -> bool {
    let point = PointMm {
        x: i32::from(cell.x_mm),
        y: i32::from(cell.y_mm),
    };
    let resting = Sample::at_rest(footprint);
    let (Some(before), Some(there)) = (resting.enter(point), sample.enter(point)) else {
        // Too far away to be compared: a cell inside a sample never is.
        return true;
    };
    let before = footprint.distance_squared(before).isqrt();
    let there = footprint.distance_squared(there).isqrt();
    there.saturating_add(slack) < before
}

/// Path between two samples, µm; zero on the spot.
fn step_um(tube: &Tube) -> u64 {
    let steps = tube.samples().len().saturating_sub(1) as u64;
    tube.plan.path.checked_div(steps).unwrap_or(0)
}

/// Every how many samples unknown space is tested.
fn stride(tube: &Tube) -> usize {
    let stride = STRIDE_UM.checked_div(step_um(tube)).unwrap_or(1);
    usize::try_from(stride).unwrap_or(1).max(1)
}

/// Inflation that counts against unknown space when only every `stride`-th sample is tested, µm.
fn growth_um(tube: &Tube, sample: &Sample, stride: usize) -> u64 {
    u64::from(sample.spread_um)
        .saturating_add(u64::from(sample.rounding_um))
        .saturating_add(tube.sampling_um.saturating_mul(stride as u64))
        .saturating_add(tube.tracking_um)
}

fn body_point(eighths: PointMm) -> BodyPoint {
    let mm = |value: i32| i16::try_from(value >> EIGHTH_BITS).unwrap_or(i16::MAX);
    BodyPoint {
        x_mm: mm(eighths.x),
        y_mm: mm(eighths.y),
    }
}

/// The body frame inside the window of cells.
pub(super) struct Placement<'a> {
    rotation: Rotation,
    pose: LocalPose,
    seen: &'a Seen,
}

impl<'a> Placement<'a> {
    pub(super) fn new(pose: LocalPose, seen: &'a Seen) -> Self {
        Self {
            rotation: Rotation::new(pose.heading),
            pose,
            seen,
        }
    }

    /// `corner` (body frame, eighths) in eighths from the anchor.
    fn in_odometry(&self, corner: PointMm) -> (i64, i64) {
        let scaled = self.rotation.apply(corner);
        let eighths = |um: i32| i64::from(um).div_euclid(125);
        (
            eighths(self.pose.x_um).saturating_add(i64::from(scaled.x)),
            eighths(self.pose.y_um).saturating_add(i64::from(scaled.y)),
        )
    }

    /// Marks the cells whose centre lies in the convex polygon; returns the rows to look at.
    pub(super) fn fill(&self, rows: &mut Rows, corners: [PointMm; 4]) -> core::ops::Range<usize> {
        let points = corners.map(|corner| {
            let (x, y) = self.in_odometry(corner);
            self.seen.cell_point_eighths(x, y)
        });
        let [a, b, c, d] = points;
        for (from, to) in [(a, b), (b, c), (c, d), (d, a)] {
            flip_left_of_edge(rows, from, to);
        }
        let row = |y: i32| usize::try_from(y.max(0) >> 8).unwrap_or(0).min(CELLS);
        let low = points.iter().map(|p| p.y).min().unwrap_or(0);
        let high = points.iter().map(|p| p.y).max().unwrap_or(0);
        row(low)..row(high).saturating_add(1).min(CELLS)
    }

    /// Whether all corners lie inside the window.
    fn inside(&self, corners: [PointMm; 4]) -> bool {
        let limit = WINDOW;
        corners.iter().all(|&corner| {
            let (x, y) = self.in_odometry(corner);
            let cell = self.seen.cell_point_eighths(x, y);
            (0..limit).contains(&cell.x) && (0..limit).contains(&cell.y)
        })
    }

    /// Centre of a cell in the body frame.
    fn cell_in_body(&self, column: u32, row: usize) -> BodyPoint {
        let corner = self.seen.corner_mm();
        let half = CELL_MM / 2;
        let index = |value: u64| i32::try_from(value).unwrap_or(0).saturating_mul(CELL_MM);
        let from_robot = PointMm {
            x: corner
                .x
                .saturating_add(index(u64::from(column)))
                .saturating_add(half)
                .saturating_sub(self.pose.x_um.div_euclid(1000)),
            y: corner
                .y
                .saturating_add(index(row as u64))
                .saturating_add(half)
                .saturating_sub(self.pose.y_um.div_euclid(1000)),
        };
        let scaled = self.rotation.inverse().apply_scaled(from_robot);
        let mm = |value: i32| i16::try_from(value >> ROTATION_BITS).unwrap_or(i16::MAX);
        BodyPoint {
            x_mm: mm(scaled.x),
            y_mm: mm(scaled.y),
        }
    }
}

#[cfg(test)]
mod tests;
