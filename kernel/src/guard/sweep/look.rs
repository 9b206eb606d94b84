//! What a scan says about a place known before: does it show it, has it looked past it?

use super::Sweep;
use crate::arith::narrow;
use crate::geometry::frame::PointMm;
use crate::geometry::trig::bearing;
use crate::input::Beam;
use crate::units::BinaryAngle;

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

impl<const B: usize> Sweep<B> {
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
}

struct Ray {
    range_mm: i32,
    bearing: BinaryAngle,
    beam: i64,
    index: usize,
}
