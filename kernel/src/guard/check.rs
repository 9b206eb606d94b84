//! Points against tubes: the inner loop of the guard.

use super::tube::{EIGHTH_BITS, Sample, Swept, Tube};
use super::{BodyPoint, Budget};
use crate::geometry::frame::PointMm;
use crate::geometry::rect::Rect;

/// Own inflation of a point beyond which it blocks whatever tube's bounding box it meets.
const EXTRA_MAX_MM: u16 = 1_200;
/// What rounding may do to a distance comparison, eighths of a millimetre.
///
/// It can be spent once per departure, since the place of rest is the reference; the critical
/// zone bounds what many departures add up to.
const NEARER_SLACK: u64 = 16;

/// A known point in the body frame at the tube's start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CloudPoint {
    /// Forward, millimetres.
    pub x_mm: i16,
    /// Left, millimetres.
    pub y_mm: i16,
    /// The point's own inflation (sensor, beam gap, odometry, age), millimetres, rounded up.
    pub extra_mm: u16,
    /// Whether this point and the next of the slice bound one surface.
    pub joined: bool,
}

impl CloudPoint {
    /// A point beyond every horizon, in nobody's way.
    pub const FAR: Self = Self {
        x_mm: i16::MAX,
        y_mm: i16::MAX,
        extra_mm: 0,
        joined: false,
    };

    #[inline]
    fn point(&self) -> PointMm {
        PointMm {
            x: i32::from(self.x_mm),
            y: i32::from(self.y_mm),
        }
    }
}

/// Where a tube was touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Touch {
    /// Index of the point in its slice.
    pub index: usize,
    /// The point.
    pub point: BodyPoint,
    /// Inflation at the touched sample, without the point's own terms.
    pub budget: Budget,
}

/// The first point of `cloud` that `tube` touches, if any; with the number of excused points.
///
/// With an `excuse`, a point inside the inflation where the robot rested blocks only if a later
/// sample brings the footprint nearer to it.
/// # Bound
/// O(points × samples), at most one segment test each.
/// # Source
/// GUARD-01, GUARD-14, GUARD-19.
#[must_use]
pub fn first_touch(
    tube: &Tube,
    footprint: Rect,
    cloud: &[CloudPoint],
    excuse: Option<&Excuse>,
) -> Option<Touch> {
    let touched = first_blocked(&tube.swept(), footprint, cloud, excuse)?;
    let (point, sample) = (cloud.get(touched.0)?, tube.samples().get(touched.1)?);
    Some(Touch {
        index: touched.0,
        point: BodyPoint {
            x_mm: point.x_mm,
            y_mm: point.y_mm,
        },
        budget: tube.budget(sample),
    })
}

/// Numbers of the first point of `cloud` that a sample touches, and of that sample.
//= spec/time.md#time-04
//# The cost of a verdict MUST grow at most linearly with the number of known points.
#[must_use]
pub fn first_blocked(
    tube: &Swept<'_>,
    footprint: Rect,
    cloud: &[CloudPoint],
    excuse: Option<&Excuse>,
) -> Option<(usize, usize)> {
    let mut previous: Option<&CloudPoint> = None;
    for (index, point) in cloud.iter().enumerate() {
        //= spec/guard.md#guard-14
        //# Two neighbouring returns that are closer to each other than the least width of the footprint MUST be
        //# treated as the segment between them.
        let start = match previous {
            Some(before) if before.joined => before,
            _ => point,
        };
        previous = Some(point);
        //= spec/guard.md#guard-17
        //# A refused motion MUST NOT become accepted by adding a known point, by turning a known cell into an unknown
        //# one or by enlarging an error bound.
        let extra = point.extra_mm.max(start.extra_mm);
        if !meets_bounds(&tube.bounds, i32::from(extra), start.point(), point.point()) {
            continue;
        }
        if let Some(sample) = touched_sample(tube, footprint, start, point, extra, excuse) {
            return Some((index, sample));
        }
    }
    None
}

/// Whether the bounding box of two points, grown by `extra`, meets `bounds`.
///
/// Points are `i16`, `extra` is `u16` and the bounds are a few metres: nothing wraps.
#[inline]
fn meets_bounds(bounds: &Rect, extra: i32, a: PointMm, b: PointMm) -> bool {
    a.x.min(b.x).wrapping_sub(extra) <= bounds.front
        && a.x.max(b.x).wrapping_add(extra) >= bounds.rear.wrapping_neg()
        && a.y.min(b.y).wrapping_sub(extra) <= bounds.left
        && a.y.max(b.y).wrapping_add(extra) >= bounds.right.wrapping_neg()
}

fn touched_sample(
    tube: &Swept<'_>,
    footprint: Rect,
    start: &CloudPoint,
    end: &CloudPoint,
    extra_mm: u16,
    excuse: Option<&Excuse>,
) -> Option<usize> {
    if extra_mm > EXTRA_MAX_MM {
        return (!tube.samples.is_empty()).then_some(0);
    }
    let extra = eighths(extra_mm);
    let excused_beyond =
        excuse.and_then(|excuse| excuse.distance(&tube.start, footprint, start, end, extra));
    for (number, sample) in tube.samples.iter().enumerate() {
        // A segment is at most as long as the join limit: if one end is out of
        // reach by the offset bound, the whole segment is.
        let (Some(a), Some(b)) = (sample.enter(start.point()), sample.enter(end.point())) else {
            continue;
        };
        if !sample.rect.grown(extra).touches(a, b) {
            continue;
        }
        let Some(before) = excused_beyond else {
            return Some(number);
        };
        //= spec/guard.md#guard-19
        //# In a static world, a known point outside footprint and critical zone but inside the inflation of the place
        //# where the robot rests or rested last MUST block every motion that brings the footprint nearer to it by
        //# more than rounding.
        let excused = number < tube.nominal_from
            || not_nearer(footprint.segment_distance_squared(a, b), before);
        if !excused {
            return Some(number);
        }
    }
    None
}

/// Whole millimetres in eighths.
fn eighths(mm: u16) -> i32 {
    i32::from(mm) << EIGHTH_BITS
}

/// What a robot that leaves rest is excused: points near the place where it rested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Excuse {
    /// Where the robot rested, seen from the body frame at the tube's start, with the footprint
    /// grown by the inflation it had there. `None`: it rests now, and the tube's own start counts.
    pub rested: Option<Sample>,
}

impl Excuse {
    /// Squared distance of the footprint where the robot rested from an excused segment, which no
    /// sample may undercut; `None` if the segment is not excused.
    fn distance(
        &self,
        at_start: &Sample,
        footprint: Rect,
        start: &CloudPoint,
        end: &CloudPoint,
        extra: i32,
    ) -> Option<u64> {
        let rested = self.rested.as_ref().unwrap_or(at_start);
        let (a, b) = (rested.enter(start.point())?, rested.enter(end.point())?);
        if !rested.rect.grown(extra).touches(a, b) {
            return None;
        }
        let distance = footprint.segment_distance_squared(a, b);
        (distance > 0).then_some(distance)
    }

    /// Squared distance of the footprint from the nearest excused point that is still inside the
    /// tube's first inflation; `None` if there is none left.
    #[must_use]
    pub fn nearest(&self, tube: &Tube, footprint: Rect, cloud: &[CloudPoint]) -> Option<u64> {
        cloud
            .iter()
            .filter_map(|point| {
                let extra = eighths(point.extra_mm);
                let seen = tube.start.enter(point.point())?;
                let inside = tube.start.rect.grown(extra).contains(seen);
                let excused = self
                    .distance(&tube.start, footprint, point, point, extra)
                    .is_some();
                (inside && excused).then(|| footprint.distance_squared(seen))
            })
            .min()
    }
}

/// Whether a squared distance is not below another one, but for rounding (eighths of a millimetre).
fn not_nearer(now: u64, before: u64) -> bool {
    now.isqrt().saturating_add(NEARER_SLACK) >= before.isqrt()
}
