//! Whether a tube enters space nobody has looked at.

use super::BodyPoint;
use super::seen::{CELL_MM, CELLS, Rows, Seen, flip_left_of_edge};
use super::tube::{EIGHTH_BITS, Sample, Tube, eighths_up};
use crate::geometry::frame::{PointMm, ROTATION_BITS, Rotation};
use crate::geometry::rect::Rect;
use crate::odometry::LocalPose;

/// Samples nearer to each other than this are tested once, µm.
const STRIDE_UM: u64 = 32_000;
/// Edge of the window in 1/256 cells.
const WINDOW: i32 = 128 << 8;

/// The centre of an unknown cell that `tube` enters, if any (body frame).
///
/// A cell counts if its centre lies in a sample grown by everything except obstacle
/// motion and sensor terms, but not in the footprint at the start grown by the same: there the
/// robot stands, and the tube's own width there is no news. (A wider excuse would travel with the
/// robot, and a slow one would never meet unknown space.)
/// # Bound
/// O(samples × rows of the window).
/// # Source
/// GUARD-02; spec/model.md "Unknown space".
#[must_use]
pub fn entered(tube: &Tube, footprint: Rect, seen: &Seen, pose: LocalPose) -> Option<BodyPoint> {
    let place = Placement::new(pose, seen);
    let samples = tube.samples();
    let last = samples.last()?;
    let step = tube
        .plan
        .path
        .checked_div(samples.len() as u64)
        .unwrap_or(0)
        .max(1);
    let stride = if tube.plan.path == 0 {
        1
    } else {
        usize::try_from(STRIDE_UM.checked_div(step).unwrap_or(1))
            .unwrap_or(1)
            .max(1)
    };
    let mut excused: Rows = [0; CELLS];
    let resting = footprint.grown(eighths_up(growth_um(tube, last, stride)));
    place.fill(&mut excused, tube.start.corners(resting));
    let strided = samples.iter().skip(1).step_by(stride);
    let mut rows: Rows = [0; CELLS];
    for sample in strided.chain(core::iter::once(last)) {
        let rect = footprint.grown(eighths_up(growth_um(tube, sample, stride)));
        let span = place.fill(&mut rows, sample.corners(rect));
        if !place.inside(sample.corners(rect)) {
            return Some(body_point(sample.centre));
        }
        for row in span {
            // Leaves the row empty for the next sample.
            let wanted = rows.get_mut(row).map_or(0, core::mem::take);
            let free = seen.known(row) | excused.get(row).copied().unwrap_or(0);
            let unknown = wanted & !free;
            if unknown != 0 {
                return Some(place.cell_in_body(unknown.trailing_zeros(), row));
            }
        }
    }
    None
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
