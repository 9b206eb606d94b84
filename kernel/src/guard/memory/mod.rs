//! What the guard knows of its surroundings: the newest scans, remembered points, known space.
//!
//! A return is never lost but by the rule of MEMORY-02 and MEMORY-03; where a point
//! must be given up (store full, too old, out of reach) its place becomes unknown,
//! which counts as occupied.

mod cloud;
mod model;
#[cfg(test)]
mod tests;

pub use model::{MemoryModel, Staleness};

use super::check::CloudPoint;
use super::seen::{CELLS, COVER_MM, Rows, Seen, flip_left_of_edge};
use super::sweep::{Sight, Sweep, SweepPoint, SweepRules};
use crate::arith::{mul_div_up, mul_micro_up};
use crate::config::Scanner;
use crate::geometry::frame::{PointMm, polar};
use crate::geometry::rect::Rect;
use crate::guard::tube::Sample;
use crate::guard::unknown::Placement;
use crate::input::Beam;
use crate::odometry::{AnchorShift, LocalPose, Odometer};
use crate::time::Instant;
use crate::units::BinaryAngle;

/// Rounding of a stored point against a beam, mm.
const PLACE_ROUNDING_MM: u64 = 3;
/// Points this near to a remembered one along both axes are merged with it, mm.
const MERGE_MM: u32 = 2;
/// How many of the points stored last are candidates for merging; bounds the work of a scan.
const MERGE_WINDOW: usize = 64;

/// A point that the newest scans do not show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Remembered {
    /// Along x, mm from the anchor.
    pub x_mm: i16,
    /// Along y, mm from the anchor.
    pub y_mm: i16,
    /// Beam gap when it was seen, plus what merging added, mm.
    pub gap_mm: u16,
    /// Consecutive scans that looked past it.
    pub misses: u8,
    /// When it was last returned.
    pub stamp: Instant,
    /// Odometer when it was last returned.
    pub odometer: Odometer,
}

/// The guard's memory: up to `S` scanners of `B` beams and `M` remembered points.
#[derive(Clone, Debug)]
pub struct Memory<const S: usize, const B: usize, const M: usize> {
    sweeps: [Sweep<B>; S],
    scratch: Sweep<B>,
    remembered: [Remembered; M],
    count: usize,
    /// Known space.
    pub seen: Seen,
    clouds: [[CloudPoint; B]; S],
    remembered_cloud: [CloudPoint; M],
    overflows: u32,
    eroded_at: (Instant, Odometer),
}

impl<const S: usize, const B: usize, const M: usize> Default for Memory<S, B, M> {
    fn default() -> Self {
        Self {
            sweeps: [Sweep::default(); S],
            scratch: Sweep::default(),
            remembered: [Remembered::default(); M],
            count: 0,
            seen: Seen::default(),
            clouds: [[CloudPoint::FAR; B]; S],
            remembered_cloud: [CloudPoint::FAR; M],
            overflows: 0,
            eroded_at: (Instant::default(), Odometer::default()),
        }
    }
}

/// A scan ready to be remembered.
#[derive(Clone, Copy, Debug)]
pub struct Arrival<'a> {
    /// Index of the scanner.
    pub scanner: usize,
    /// Its configuration.
    pub setup: &'a Scanner,
    /// Its beams.
    pub beams: &'a [Beam],
    /// Time of the first beam.
    pub stamp: Instant,
    /// Where the robot was at the first and the last beam.
    pub poses: (LocalPose, LocalPose),
}

impl<const S: usize, const B: usize, const M: usize> Memory<S, B, M> {
    /// Takes in a scan; returns that it replaces are remembered unless it shows them, too.
    ///
    /// # Bound
    /// O((beams + remembered) × beams through one error disc + beams × remembered).
    pub fn accept(&mut self, model: &MemoryModel, arrival: Arrival<'_>, odometer: Odometer) {
        let rules = SweepRules {
            join_mm: model.join_mm,
            clear_max_mm: clear_max_mm(model, arrival.setup),
        };
        self.scratch.place(
            arrival.setup,
            rules,
            arrival.beams,
            arrival.stamp,
            arrival.poses,
            odometer,
        );
        let robot = PointMm {
            x: arrival.poses.1.x_um.div_euclid(1000),
            y: arrival.poses.1.y_um.div_euclid(1000),
        };
        self.seen.follow(robot);
        self.review(model, robot, odometer);
        //= spec/memory.md#memory-01
        //# A return within the range of the memory MUST be remembered until it is cleared, confirmed, expired or
        //# turned into unknown space.
        self.keep_replaced(model, arrival.scanner, robot, odometer);
        if let Some(sweep) = self.sweeps.get_mut(arrival.scanner) {
            core::mem::swap(sweep, &mut self.scratch);
            sweep.mark_seen(arrival.setup, rules, &mut self.seen);
        }
    }

    /// Drops remembered points that the new scan shows or has looked past often enough.
    fn review(&mut self, model: &MemoryModel, robot: PointMm, odometer: Odometer) {
        let now = self.scratch.stamp();
        let mut index = 0;
        while index < self.count {
            let Some(point) = self.remembered.get(index).copied() else {
                break;
            };
            let place = PointMm {
                x: i32::from(point.x_mm),
                y: i32::from(point.y_mm),
            };
            let stale = model.staleness(point.stamp, point.odometer, now, odometer);
            let error = place_error_mm(model, &stale, place, robot);
            let sight = self.scratch.look_at(place, error, same_mm(model, &stale));
            let misses = misses_after(sight, point.misses, model.clear_after_scans);
            let gone = misses.is_none();
            let lost = !gone && self.is_out_of_reach(model, &point, now, place, robot);
            //= spec/memory.md#memory-09
            //# A remembered hit older than `age_max` MUST NOT become free, only unknown.
            if lost {
                self.seen.forget(place);
            }
            if gone || lost {
                self.remove(index);
                continue;
            }
            if let (Some(slot), Some(misses)) = (self.remembered.get_mut(index), misses) {
                slot.misses = misses;
            }
            index = index.saturating_add(1);
        }
    }

    fn is_out_of_reach(
        &self,
        model: &MemoryModel,
        point: &Remembered,
        now: Instant,
        place: PointMm,
        robot: PointMm,
    ) -> bool {
        let age = now.since(point.stamp).unwrap_or_default();
        age > model.age_max || !is_near(place, robot, COVER_MM)
    }

    fn remove(&mut self, index: usize) {
        let last = self.count.saturating_sub(1);
        if let Some(filler) = self.remembered.get(last).copied()
            && let Some(slot) = self.remembered.get_mut(index)
        {
            *slot = filler;
        }
        self.count = last;
    }

    /// Remembers the returns of the scan about to be replaced that the new one does not show.
    fn keep_replaced(
        &mut self,
        model: &MemoryModel,
        scanner: usize,
        robot: PointMm,
        odometer: Odometer,
    ) {
        let Some(old) = self.sweeps.get(scanner) else {
            return;
        };
        let (stamp, then) = (old.stamp(), old.odometer());
        let stale = model.staleness(stamp, then, self.scratch.stamp(), odometer);
        for index in 0..old.points().len() {
            let Some(point) = self
                .sweeps
                .get(scanner)
                .and_then(|sweep| sweep.points().get(index).copied())
            else {
                break;
            };
            let place = PointMm {
                x: i32::from(point.x_mm),
                y: i32::from(point.y_mm),
            };
            if !is_near(place, robot, COVER_MM) {
                continue;
            }
            let error = place_error_mm(model, &stale, place, robot);
            let misses = match self.scratch.look_at(place, error, same_mm(model, &stale)) {
                Sight::Confirmed => continue,
                Sight::LookedPast => 1,
                Sight::OutOfView | Sight::Unclear => 0,
            };
            if misses < model.clear_after_scans {
                self.remember(point, misses, stamp, then);
            }
        }
    }

    fn remember(&mut self, point: SweepPoint, misses: u8, stamp: Instant, odometer: Odometer) {
        let place = PointMm {
            x: i32::from(point.x_mm),
            y: i32::from(point.y_mm),
        };
        let count = self.count;
        let recent = count.saturating_sub(MERGE_WINDOW);
        let near = self
            .remembered
            .iter_mut()
            .take(count)
            .skip(recent)
            .find(|known| {
                i32::from(known.x_mm).abs_diff(place.x) <= MERGE_MM
                    && i32::from(known.y_mm).abs_diff(place.y) <= MERGE_MM
            });
        // The older point's ball grows until it contains the newer one's.
        if let Some(known) = near {
            let apart = place_distance_up(known, place);
            let grown = point.gap_mm.saturating_add(apart);
            known.gap_mm = known.gap_mm.max(grown);
            known.misses = known.misses.min(misses);
            return;
        }
        match self.remembered.get_mut(count) {
            Some(slot) => {
                *slot = Remembered {
                    x_mm: point.x_mm,
                    y_mm: point.y_mm,
                    gap_mm: point.gap_mm,
                    misses,
                    stamp,
                    odometer,
                };
                self.count = count.saturating_add(1);
            }
            //= spec/memory.md#memory-05
            //# When the store is full, the surroundings of a hit that finds no place MUST become unknown.
            None => {
                self.overflows = self.overflows.saturating_add(1);
                self.seen.forget(place);
            }
        }
    }

    /// Lets known space age until `now`: obstacles move, odometry drifts, time passes.
    pub fn age(&mut self, model: &MemoryModel, now: Instant, odometer: Odometer) {
        let (then, before) = self.eroded_at;
        let stale = model.staleness(then, before, now, odometer);
        let lever_mm = u64::from(COVER_MM.unsigned_abs());
        let turned = mul_div_up(stale.turn_urad, lever_mm, 1000);
        //= spec/memory.md#memory-07
        //# The known region MUST shrink from its unwatched borders no slower than the obstacle speed bound and the
        //# odometry drift demand.
        self.seen.erode(
            stale
                .drift_um
                .saturating_add(stale.moved_um)
                .saturating_add(turned),
        );
        self.seen.expire(now, model.age_max);
        self.eroded_at = (now, odometer);
    }

    /// Marks the place of the robot's own body, `outline` in eighths of a millimetre, as known:
    /// nothing else can be there.
    pub fn occupy(&mut self, pose: LocalPose, outline: Rect) {
        let mut rows: Rows = [0; CELLS];
        Placement::new(pose, &self.seen).fill(&mut rows, Sample::at_rest(outline).corners(outline));
        self.seen.mark(&rows);
    }

    /// Takes the operator's word that the disc of `radius_mm` around the robot is free
    /// (as a regular 16-gon inside it), but no farther than the nearest known point: where a
    /// scan shows a wall inside the disc, the word does not hold for what the wall continues in.
    pub fn vouch(&mut self, model: &MemoryModel, pose: LocalPose, radius_mm: i32) {
        let centre = PointMm {
            x: pose.x_um.div_euclid(1000),
            y: pose.y_um.div_euclid(1000),
        };
        self.seen.follow(centre);
        let radius_mm = self
            .nearest_mm(model, centre)
            .min(radius_mm)
            .clamp(0, COVER_MM);
        let mut rows: Rows = [0; CELLS];
        let corner = |number: u32| {
            let spoke = polar(radius_mm, BinaryAngle::from_counts(number.wrapping_shl(28)));
            self.seen.cell_point(PointMm {
                x: centre.x.saturating_add(spoke.x),
                y: centre.y.saturating_add(spoke.y),
            })
        };
        for number in 0..16_u32 {
            flip_left_of_edge(&mut rows, corner(number), corner(number.saturating_add(1)));
        }
        self.seen.mark(&rows);
    }

    /// Distance from `centre` to the nearest known point less the sensor error, mm.
    fn nearest_mm(&self, model: &MemoryModel, centre: PointMm) -> i32 {
        let swept = self.sweeps.iter().flat_map(|sweep| sweep.points());
        let kept = self
            .remembered()
            .iter()
            .map(|point| (point.x_mm, point.y_mm));
        let nearest = swept
            .map(|point| (point.x_mm, point.y_mm))
            .chain(kept)
            .map(|(x, y)| {
                let square = |d: u32| u64::from(d).saturating_mul(u64::from(d));
                square(i32::from(x).abs_diff(centre.x))
                    .saturating_add(square(i32::from(y).abs_diff(centre.y)))
            })
            .min()
            .map_or(u64::MAX, u64::isqrt);
        let certain = nearest.saturating_sub(model.sensor_um.div_ceil(1000));
        i32::try_from(certain).unwrap_or(i32::MAX)
    }

    /// Follows the anchor.
    pub fn reanchor(&mut self, shift: AnchorShift) {
        for sweep in &mut self.sweeps {
            sweep.reanchor(shift);
        }
        let moved =
            |mm: i16, by: i32| i16::try_from(i32::from(mm).saturating_sub(by)).unwrap_or(i16::MAX);
        for point in self.remembered.iter_mut().take(self.count) {
            point.x_mm = moved(point.x_mm, shift.x_mm);
            point.y_mm = moved(point.y_mm, shift.y_mm);
        }
        self.seen.reanchor(shift);
    }

    /// Forgets everything: the past has no relation to the present any more.
    pub fn clear(&mut self) {
        self.count = 0;
        self.seen.clear();
        for sweep in &mut self.sweeps {
            *sweep = Sweep::default();
        }
    }

    /// The sweep of scanner `scanner`.
    #[must_use]
    pub fn sweep(&self, scanner: usize) -> Option<&Sweep<B>> {
        self.sweeps.get(scanner)
    }

    /// Points that the newest scans do not show, relative to the anchor.
    #[must_use]
    pub fn remembered(&self) -> &[Remembered] {
        self.remembered.get(..self.count).unwrap_or(&[])
    }

    /// Number of points whose place became unknown because the store was full.
    #[must_use]
    pub const fn overflows(&self) -> u32 {
        self.overflows
    }
}

/// How many consecutive scans have looked past a remembered point; `None` once it goes: shown
/// again, or looked past often enough.
/// # Source
/// MEMORY-02, MEMORY-03.
#[must_use]
pub fn misses_after(sight: Sight, misses: u8, clear_after_scans: u8) -> Option<u8> {
    match sight {
        Sight::Confirmed => None,
        //= spec/memory.md#memory-02
        //# A remembered hit MUST NOT be cleared before the configured number of consecutive scans had at least one
        //# beam through its error disc and all of these beams pass beyond it.
        Sight::LookedPast => {
            Some(misses.saturating_add(1)).filter(|&misses| misses < clear_after_scans)
        }
        Sight::OutOfView => Some(misses),
        Sight::Unclear => Some(0),
    }
}

/// Distance of a remembered point from `place`, mm, rounded up; both nearby.
fn place_distance_up(known: &Remembered, place: PointMm) -> u16 {
    let square = |d: u32| u64::from(d).saturating_mul(u64::from(d));
    let squared = square(i32::from(known.x_mm).abs_diff(place.x))
        .saturating_add(square(i32::from(known.y_mm).abs_diff(place.y)));
    u16::try_from(crate::arith::sqrt_up(squared)).unwrap_or(u16::MAX)
}

/// How near a new return must be to take a stored point's place, mm: what one body may differ
/// by within the sensor's error, less what odometry has blurred.
//= spec/memory.md#memory-03
//# A remembered hit MUST NOT be replaced by a new return unless the inflation of that return covers the error disc of
//# the hit.
fn same_mm(model: &MemoryModel, stale: &Staleness) -> i32 {
    let um = model.sensor_um.saturating_sub(stale.drift_um);
    i32::try_from(um / 1000).unwrap_or(0)
}

/// Position error of a stored point against a new beam, mm.
fn place_error_mm(model: &MemoryModel, stale: &Staleness, place: PointMm, robot: PointMm) -> i32 {
    let distance = place
        .x
        .abs_diff(robot.x)
        .saturating_add(place.y.abs_diff(robot.y));
    let lever = mul_micro_up(stale.turn_urad, u64::from(distance));
    let um = model.sensor_um.saturating_add(stale.drift_um);
    let mm = um
        .div_ceil(1000)
        .saturating_add(lever)
        .saturating_add(PLACE_ROUNDING_MM);
    i32::try_from(mm).unwrap_or(i32::MAX / 4).min(i32::MAX / 4)
}

fn is_near(place: PointMm, robot: PointMm, radius_mm: i32) -> bool {
    place.x.abs_diff(robot.x) <= radius_mm.unsigned_abs()
        && place.y.abs_diff(robot.y) <= radius_mm.unsigned_abs()
}

/// Range up to which a ray clears space: inside the window wherever the robot stands in it, and
/// not so far that a body of the least width fits between two beams (A-WIDTH).
fn clear_max_mm(model: &MemoryModel, scanner: &Scanner) -> i32 {
    let window = COVER_MM.saturating_sub(mount_reach_mm(scanner));
    let increment_urad = crate::odometry::turn_urad(scanner.increment);
    let seen_mm = model
        .body_width_um
        .saturating_mul(1000)
        .checked_div(increment_urad)
        .unwrap_or(0);
    window.min(i32::try_from(seen_mm).unwrap_or(i32::MAX))
}

/// Distance of the scanner from the rotation centre, mm, rounded up (sum of components).
fn mount_reach_mm(scanner: &Scanner) -> i32 {
    scanner
        .x
        .as_um()
        .saturating_abs()
        .saturating_add(scanner.y.as_um().saturating_abs())
        .saturating_add(999)
        .div_euclid(1000)
}
