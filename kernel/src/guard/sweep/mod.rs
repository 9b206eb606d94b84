//! One accepted scan in the odometry frame: its points, its rays, and what it can see.
//!
//! Every beam is placed by the odometry at its own time; nothing is extrapolated.

mod look;
mod mark;
#[cfg(test)]
pub(in crate::guard) mod tests;

pub use look::Sight;

use crate::arith::narrow;
use crate::config::{MaskRect, Scanner};
use crate::geometry::frame::{PointMm, Rotation, polar};
use crate::input::Beam;
use crate::odometry::{AnchorShift, LocalPose, Odometer};
use crate::time::Instant;
use crate::units::BinaryAngle;

/// Segments between neighbouring returns are at most this long, mm.
pub const JOIN_MAX_MM: i32 = 1_500;
/// Points farther than this from the anchor cannot be stored, mm.
const STORE_MAX_MM: i32 = 32_000;

/// A return in the odometry frame, relative to the anchor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SweepPoint {
    /// Along x, mm.
    pub x_mm: i16,
    /// Along y, mm.
    pub y_mm: i16,
    /// Lateral distance to the next beam, mm, rounded up.
    pub gap_mm: u16,
    /// Whether this return and the next one bound one surface.
    pub joined: bool,
}

/// One scan of one scanner with up to `B` beams.
#[derive(Clone, Copy, Debug)]
pub struct Sweep<const B: usize> {
    beams: [Beam; B],
    count: usize,
    points: [SweepPoint; B],
    point_count: usize,
    stamp: Instant,
    odometer: Odometer,
    /// Scanner position at the first beam, µm from the anchor, and its motion per beam (2⁻¹⁶ µm).
    origin_um: (i32, i32),
    origin_step: (i64, i64),
    bearing: BinaryAngle,
    increment: i32,
    join_mm: i32,
    silence_clear_mm: i32,
    far_hits: u32,
}

impl<const B: usize> Default for Sweep<B> {
    fn default() -> Self {
        Self {
            beams: [Beam::Invalid; B],
            count: 0,
            points: [SweepPoint::default(); B],
            point_count: 0,
            stamp: Instant::default(),
            odometer: Odometer::default(),
            origin_um: (0, 0),
            origin_step: (0, 0),
            bearing: BinaryAngle::ZERO,
            increment: 0,
            join_mm: 0,
            silence_clear_mm: 0,
            far_hits: 0,
        }
    }
}

/// How scans become points.
#[derive(Clone, Copy, Debug)]
pub struct SweepRules {
    /// Neighbouring returns up to this far apart bound one surface, mm.
    pub join_mm: i32,
    /// Free rays are believed up to this range, mm.
    pub clear_max_mm: i32,
}

impl<const B: usize> Sweep<B> {
    /// Places `beams` of `scanner` fired while the robot moved from `start` to `end`.
    ///
    /// # Bound
    /// O(beams).
    pub fn place(
        &mut self,
        scanner: &Scanner,
        rules: SweepRules,
        beams: &[Beam],
        stamp: Instant,
        (start, end): (LocalPose, LocalPose),
        odometer: Odometer,
    ) {
        self.count = beams.len().min(B);
        self.stamp = stamp;
        self.odometer = odometer;
        self.far_hits = 0;
        self.join_mm = rules.join_mm;
        self.silence_clear_mm = scanner.no_return_clear.as_um().div_euclid(1000);
        self.place_rays(scanner, start, end);
        for (slot, &beam) in self.beams.iter_mut().zip(beams) {
            *slot = beam;
        }
        self.mask_own_parts(scanner);
        self.place_points(scanner, rules);
    }

    //= spec/guard.md#guard-16
    //# Every beam MUST be moved from the robot's pose at its own beam time to the start pose of the tube, its
    //# odometry error over that interval being part of its inflation.
    fn place_rays(&mut self, scanner: &Scanner, start: LocalPose, end: LocalPose) {
        let steps = i64::try_from(self.count.saturating_sub(1).max(1)).unwrap_or(1);
        let (from, to) = (mount_um(scanner, start), mount_um(scanner, end));
        let step = |from: i32, to: i32| {
            (i64::from(to).saturating_sub(i64::from(from)) << 16)
                .checked_div(steps)
                .unwrap_or(0)
        };
        self.origin_um = from;
        self.origin_step = (step(from.0, to.0), step(from.1, to.1));
        self.bearing = start.heading.plus(scanner.first_beam);
        let turn = i64::from(end.heading.minus(start.heading))
            .checked_div(steps)
            .unwrap_or(0);
        self.increment = narrow(i64::from(scanner.increment).saturating_add(turn));
    }

    /// Returns from the robot's own parts say nothing about the world.
    fn mask_own_parts(&mut self, scanner: &Scanner) {
        if scanner.masks.iter().all(Option::is_none) {
            return;
        }
        let mount = PointMm {
            x: scanner.x.as_um().div_euclid(1000),
            y: scanner.y.as_um().div_euclid(1000),
        };
        let mut direction = scanner.first_beam;
        for beam in self.beams.iter_mut().take(self.count) {
            if let Beam::Hit(range) = *beam {
                let hit = polar(i32::from(range), direction);
                let body = PointMm {
                    x: hit.x.saturating_add(mount.x),
                    y: hit.y.saturating_add(mount.y),
                };
                if scanner.masks.iter().flatten().any(|mask| masks(mask, body)) {
                    *beam = Beam::Invalid;
                }
            }
            direction = direction.plus(BinaryAngle::from_counts(scanner.increment.cast_unsigned()));
        }
    }

    fn place_points(&mut self, scanner: &Scanner, rules: SweepRules) {
        let minimum = scanner.range_min.as_um().div_euclid(1000);
        // 2π · 10⁶ / 2³² µrad per count; range in mm times µrad is nm.
        let increment_urad = crate::odometry::turn_urad(scanner.increment);
        self.point_count = 0;
        let mut previous: Option<(usize, PointMm)> = None;
        for index in 0..self.count {
            let range = match self.beams.get(index) {
                Some(Beam::Hit(range)) => i32::from(*range),
                //= spec/input.md#input-02
                //# A too-near beam MUST count as a return at the minimum range of its scanner.
                Some(Beam::TooNear) => minimum,
                _ => continue,
            };
            let at = self.point_at(index, range);
            let (Some(x_mm), Some(y_mm)) = (stored(at.x), stored(at.y)) else {
                self.far_hits = self.far_hits.saturating_add(1);
                previous = None;
                continue;
            };
            let near = previous.is_some_and(|(before, point)| {
                before.saturating_add(1) == index && within(point, at, rules.join_mm)
            });
            if near {
                self.join_last();
            }
            //= spec/guard.md#guard-15
            //# A return MUST be inflated by no less than its own lateral beam gap, range times angle to the
            //# neighbouring beam.
            let gap = u64::from(range.unsigned_abs())
                .saturating_mul(increment_urad)
                .div_ceil(1_000_000);
            self.append(SweepPoint {
                x_mm,
                y_mm,
                gap_mm: u16::try_from(gap).unwrap_or(u16::MAX),
                joined: false,
            });
            previous = Some((index, at));
        }
    }

    fn join_last(&mut self) {
        let last = self.point_count.saturating_sub(1);
        if let Some(point) = self.points.get_mut(last) {
            point.joined = true;
        }
    }

    fn append(&mut self, point: SweepPoint) {
        if let Some(slot) = self.points.get_mut(self.point_count) {
            *slot = point;
            self.point_count = self.point_count.saturating_add(1);
        }
    }

    /// Scanner position while beam `index` was fired, µm from the anchor.
    fn origin_at(&self, index: usize) -> (i32, i32) {
        let index = i64::try_from(index).unwrap_or(0);
        let along = |origin: i32, step: i64| {
            narrow(i64::from(origin).saturating_add(step.saturating_mul(index) >> 16))
        };
        (
            along(self.origin_um.0, self.origin_step.0),
            along(self.origin_um.1, self.origin_step.1),
        )
    }

    fn direction_of(&self, index: usize) -> BinaryAngle {
        let index = i32::try_from(index).unwrap_or(0);
        self.bearing.plus(BinaryAngle::from_counts(
            self.increment.wrapping_mul(index).cast_unsigned(),
        ))
    }

    /// The place `range` along beam `index`, mm from the anchor, rounded to nearest.
    fn point_at(&self, index: usize, range_mm: i32) -> PointMm {
        let (x, y) = self.origin_at(index);
        let (sin, cos) = crate::geometry::trig::sin_cos(self.direction_of(index));
        let place = |origin: i32, component: i32| {
            let along = i64::from(range_mm)
                .saturating_mul(1000)
                .saturating_mul(i64::from(component))
                >> 30;
            narrow(
                i64::from(origin)
                    .saturating_add(along)
                    .saturating_add(500)
                    .div_euclid(1000),
            )
        };
        PointMm {
            x: place(x, cos),
            y: place(y, sin),
        }
    }

    /// Moves everything when the anchor moves; what no longer fits is beyond every horizon.
    pub fn reanchor(&mut self, shift: AnchorShift) {
        let um = |mm: i32| mm.saturating_mul(1000);
        self.origin_um.0 = self.origin_um.0.saturating_sub(um(shift.x_mm));
        self.origin_um.1 = self.origin_um.1.saturating_sub(um(shift.y_mm));
        let moved = |mm: i16, by: i32| stored(i32::from(mm).saturating_sub(by)).unwrap_or(i16::MAX);
        for point in self.points.iter_mut().take(self.point_count) {
            point.x_mm = moved(point.x_mm, shift.x_mm);
            point.y_mm = moved(point.y_mm, shift.y_mm);
        }
    }

    /// The returns, in the order of the beams.
    #[must_use]
    pub fn points(&self) -> &[SweepPoint] {
        self.points.get(..self.point_count).unwrap_or(&[])
    }

    /// Time of the first beam.
    #[must_use]
    pub const fn stamp(&self) -> Instant {
        self.stamp
    }

    /// Odometer at the scan.
    #[must_use]
    pub const fn odometer(&self) -> Odometer {
        self.odometer
    }

    /// Number of beams; zero before the first scan.
    #[must_use]
    pub const fn beam_count(&self) -> usize {
        self.count
    }

    /// Returns too far away to be stored.
    #[must_use]
    pub const fn far_hits(&self) -> u32 {
        self.far_hits
    }
}

fn stored(mm: i32) -> Option<i16> {
    (mm.unsigned_abs() <= STORE_MAX_MM.unsigned_abs())
        .then(|| i16::try_from(mm).ok())
        .flatten()
}

fn within(a: PointMm, b: PointMm, distance_mm: i32) -> bool {
    let square = |d: i32| u64::from(d.unsigned_abs()).saturating_mul(u64::from(d.unsigned_abs()));
    square(a.x.saturating_sub(b.x)).saturating_add(square(a.y.saturating_sub(b.y)))
        <= square(distance_mm)
}

/// Whether a place in the body frame belongs to the robot itself.
pub(crate) fn masks(mask: &MaskRect, body: PointMm) -> bool {
    let um = |mm: i32| mm.saturating_mul(1000);
    (mask.x_min.as_um()..=mask.x_max.as_um()).contains(&um(body.x))
        && (mask.y_min.as_um()..=mask.y_max.as_um()).contains(&um(body.y))
}

/// Position of the scanner when the robot is at `pose`, µm from the anchor.
fn mount_um(scanner: &Scanner, pose: LocalPose) -> (i32, i32) {
    // Tenths of a millimetre fit the rotation's range up to 4.6 m.
    let mount = PointMm {
        x: scanner.x.as_um().div_euclid(100),
        y: scanner.y.as_um().div_euclid(100),
    };
    let turned = Rotation::new(pose.heading).apply(mount);
    (
        pose.x_um.saturating_add(turned.x.saturating_mul(100)),
        pose.y_um.saturating_add(turned.y.saturating_mul(100)),
    )
}
