//! One accepted scan in the odometry frame: its points, its rays, and what it can see.
//!
//! Every beam is placed by the odometry at its own time; nothing is extrapolated.

use super::seen::{CELLS, CellPoint, Rows, Seen, flip_left_of_edge};
use crate::arith::narrow;
use crate::config::{MaskRect, Scanner};
use crate::geometry::frame::{PointMm, Rotation, polar};
use crate::geometry::trig::bearing;
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

/// What a scan says about a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sight {
    /// No beam points there.
    OutOfView,
    /// Occluded, only partly looked at, or on an unusable beam.
    Unclear,
    /// A return at that place.
    Confirmed,
    /// Every beam through the error disc went on beyond it.
    LookedPast,
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

    /// Marks every cell in `seen` whose centre this scan looked at.
    ///
    /// # Bound
    /// O(beams + rows crossed by the polygon's edges).
    /// # Source
    /// MEMORY-06: visibility is per beam; between two beams the nearer range counts unless
    /// both returns bound one surface.
    pub fn mark_seen(&self, scanner: &Scanner, rules: SweepRules, seen: &mut Seen) {
        let mut rows: Rows = [0; CELLS];
        let start = seen.cell_point(self.point_at(0, 0));
        let mut pen = start;
        let mut line = |rows: &mut Rows, to: CellPoint| {
            flip_left_of_edge(rows, pen, to);
            pen = to;
        };
        for index in 1..self.count {
            let (before, here) = (index.saturating_sub(1), index);
            let (mut first, mut second) = (
                self.clear_mm(scanner, rules, before),
                self.clear_mm(scanner, rules, here),
            );
            if (first.saturating_sub(second)).abs() > rules.join_mm || first == 0 || second == 0 {
                first = first.min(second);
                second = first;
            }
            line(&mut rows, seen.cell_point(self.point_at(before, first)));
            line(&mut rows, seen.cell_point(self.point_at(here, second)));
        }
        let last = self.point_at(self.count.saturating_sub(1), 0);
        line(&mut rows, seen.cell_point(last));
        line(&mut rows, start);
        seen.mark(&rows);
    }

    /// Up to which range beam `index` found nothing, mm.
    fn clear_mm(&self, scanner: &Scanner, rules: SweepRules, index: usize) -> i32 {
        let millimetres = |um: i32| um.div_euclid(1000);
        let clear = match self.beams.get(index) {
            Some(Beam::Hit(range)) => i32::from(*range)
                .saturating_sub(millimetres(scanner.error.as_um()).saturating_add(1)),
            Some(Beam::NoReturn) => millimetres(scanner.no_return_clear.as_um()),
            _ => 0,
        };
        clear.max(0).min(rules.clear_max_mm)
    }

    /// What this scan says about `place` (mm from the anchor) known to within `error_mm`.
    ///
    /// A return within `same_mm` of it takes its place over.
    ///
    /// # Bound
    /// O(beams through the error disc).
    /// # Source
    /// MEMORY-02, MEMORY-03.
    #[must_use]
    pub fn look_at(&self, place: PointMm, error_mm: i32, same_mm: i32) -> Sight {
        // The scanner moves while it scans: first guess the beam, then use its own origin.
        let guess = self.ray_towards(place, self.count / 2);
        let ray = self.ray_towards(place, guess.index);
        if ray.range_mm <= error_mm || self.increment == 0 {
            return Sight::Unclear;
        }
        let half = bearing(ray.range_mm, error_mm).as_counts();
        let width = half
            .checked_div(self.increment.unsigned_abs())
            .unwrap_or(u32::MAX);
        let width = i64::from(width);
        let low = ray.beam.saturating_sub(width.saturating_add(1));
        let high = ray.beam.saturating_add(width).saturating_add(2);
        let (mut past, mut inside) = (true, 0_u32);
        let last = i64::try_from(self.count).unwrap_or(0).saturating_sub(1);
        if low > last || high < 0 {
            return Sight::OutOfView;
        }
        let within_disc = |beam: i64| self.off_axis(beam, ray.bearing) <= half;
        for beam in low.max(0)..=high.min(last) {
            let Some(&value) = usize::try_from(beam).ok().and_then(|b| self.beams.get(b)) else {
                return Sight::Unclear;
            };
            if within_disc(beam) {
                inside = inside.saturating_add(1);
                past &= self.goes_beyond(value, ray.range_mm.saturating_add(error_mm));
            }
        }
        let whole = (low >= 0 || !within_disc(-1))
            && (high <= last || !within_disc(last.saturating_add(1)));
        if self.shows(ray.beam, ray.range_mm, same_mm) {
            Sight::Confirmed
        } else if past && inside > 0 && whole {
            Sight::LookedPast
        } else {
            Sight::Unclear
        }
    }

    /// Whether a beam went on farther than `range_mm`. Silence does so only up to the range
    /// that the scanner's `no_return_clear` vouches for.
    fn goes_beyond(&self, beam: Beam, range_mm: i32) -> bool {
        match beam {
            Beam::Hit(range) => i32::from(range) > range_mm,
            Beam::NoReturn => range_mm <= self.silence_clear_mm,
            Beam::TooNear | Beam::Invalid => false,
        }
    }

    /// Whether one of the two beams around a place returned from `range_mm`, or both from one
    /// surface before and behind it.
    ///
    /// Only these two: a return farther to the side says nothing about this place, and its own
    /// inflation, which covers one beam gap, would not cover it.
    fn shows(&self, beam: i64, range_mm: i32, same_mm: i32) -> bool {
        let hit = |beam: i64| match usize::try_from(beam).ok().and_then(|b| self.beams.get(b)) {
            Some(Beam::Hit(range)) => Some(i32::from(*range)),
            _ => None,
        };
        let last = i64::try_from(self.count).unwrap_or(0).saturating_sub(1);
        if beam < 0 || beam >= last {
            return false;
        }
        let near = |range: i32| range.abs_diff(range_mm) <= same_mm.unsigned_abs();
        match (hit(beam), hit(beam.saturating_add(1))) {
            (Some(a), Some(b)) => {
                let bridged = a.abs_diff(b) <= self.join_mm.unsigned_abs()
                    && range_mm >= a.min(b)
                    && range_mm <= a.max(b);
                near(a) || near(b) || bridged
            }
            (Some(range), None) | (None, Some(range)) => near(range),
            (None, None) => false,
        }
    }

    /// Angle between beam `beam` and `bearing`, counts.
    fn off_axis(&self, beam: i64, bearing: BinaryAngle) -> u32 {
        let turned = self.increment.wrapping_mul(narrow(beam)).cast_unsigned();
        self.bearing
            .plus(BinaryAngle::from_counts(turned))
            .minus(bearing)
            .unsigned_abs()
    }

    /// Range, bearing and beam number (rounded down, unclamped) of `place` seen from beam `index`.
    fn ray_towards(&self, place: PointMm, index: usize) -> Ray {
        let (x, y) = self.origin_at(index);
        let offset = PointMm {
            x: place.x.saturating_sub(x.div_euclid(1000)),
            y: place.y.saturating_sub(y.div_euclid(1000)),
        };
        let bearing = bearing(offset.x, offset.y);
        let square =
            |d: i32| u64::from(d.unsigned_abs()).saturating_mul(u64::from(d.unsigned_abs()));
        let range = square(offset.x).saturating_add(square(offset.y)).isqrt();
        // Beams count up in the direction of the increment; half a turn behind the middle
        // of the scan is the farthest a place can be from it.
        let turned = i64::from(bearing.minus(self.direction_of(self.count / 2)));
        let step = i64::from(self.increment);
        let middle = i64::try_from(self.count / 2).unwrap_or(0);
        let beam = turned
            .saturating_mul(step.signum())
            .div_euclid(step.saturating_abs().max(1))
            .saturating_add(middle);
        let last = i64::try_from(self.count.saturating_sub(1)).unwrap_or(0);
        Ray {
            range_mm: narrow(i64::try_from(range).unwrap_or(i64::MAX)),
            bearing,
            beam,
            index: usize::try_from(beam.max(0).min(last)).unwrap_or(0),
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

struct Ray {
    range_mm: i32,
    bearing: BinaryAngle,
    beam: i64,
    index: usize,
}

fn stored(mm: i32) -> Option<i16> {
    (mm.abs() <= STORE_MAX_MM)
        .then(|| i16::try_from(mm).ok())
        .flatten()
}

fn within(a: PointMm, b: PointMm, distance_mm: i32) -> bool {
    let square = |d: i32| u64::from(d.unsigned_abs()).saturating_mul(u64::from(d.unsigned_abs()));
    square(a.x.saturating_sub(b.x)).saturating_add(square(a.y.saturating_sub(b.y)))
        <= square(distance_mm)
}

fn masks(mask: &MaskRect, body: PointMm) -> bool {
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
