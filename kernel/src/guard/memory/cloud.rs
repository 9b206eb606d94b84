//! All known points in the body frame, each with its own inflation.

use super::{Memory, MemoryModel, Staleness};
use crate::arith::mul_div_up;
use crate::geometry::frame::{BodyView, PointMm};
use crate::guard::check::CloudPoint;
use crate::odometry::{LocalPose, Odometer};
use crate::time::Instant;

impl<const S: usize, const B: usize, const M: usize> Memory<S, B, M> {
    /// Places all points in the body frame of `pose`, each with its own inflation.
    ///
    /// # Bound
    /// O(points).
    pub fn refresh(
        &mut self,
        model: &MemoryModel,
        pose: LocalPose,
        now: Instant,
        odometer: Odometer,
    ) {
        let view = BodyView::new(pose.x_um, pose.y_um, pose.heading);
        for (sweep, cloud) in self.sweeps.iter().zip(self.clouds.iter_mut()) {
            let stale = model.staleness(sweep.stamp(), sweep.odometer(), now, odometer);
            let own = OwnTerms::new(model, &stale);
            for (point, slot) in sweep.points().iter().zip(cloud.iter_mut()) {
                *slot = own.place(&view, (point.x_mm, point.y_mm), point.gap_mm, point.joined);
            }
        }
        let remembered = self.remembered.get(..self.count).unwrap_or(&[]);
        // Neighbours in the store mostly come from one scan.
        let mut same: Option<(Instant, OwnTerms)> = None;
        for (point, slot) in remembered.iter().zip(self.remembered_cloud.iter_mut()) {
            let own = match same {
                Some((stamp, own)) if stamp == point.stamp => own,
                _ => {
                    let stale = model.staleness(point.stamp, point.odometer, now, odometer);
                    OwnTerms::new(model, &stale)
                }
            };
            same = Some((point.stamp, own));
            *slot = own.place(&view, (point.x_mm, point.y_mm), point.gap_mm, false);
        }
    }

    /// All known points in the body frame of the last [`Self::refresh`]: scans, then memory.
    pub fn clouds(&self) -> impl Iterator<Item = &[CloudPoint]> {
        self.sweeps
            .iter()
            .zip(&self.clouds)
            .map(|(sweep, cloud)| cloud.get(..sweep.points().len()).unwrap_or(&[]))
            .chain(core::iter::once(
                self.remembered_cloud.get(..self.count).unwrap_or(&[]),
            ))
    }

    /// Causes of the own inflation of point `index` of slice `slice` of [`Self::clouds`].
    #[must_use]
    pub fn cause(
        &self,
        model: &MemoryModel,
        (slice, index): (usize, usize),
        now: Instant,
        odometer: Odometer,
    ) -> (Staleness, u16) {
        if let Some(sweep) = self.sweeps.get(slice) {
            let gap = sweep.points().get(index).map_or(0, |point| point.gap_mm);
            (
                model.staleness(sweep.stamp(), sweep.odometer(), now, odometer),
                gap,
            )
        } else {
            let point = self.remembered.get(index).copied().unwrap_or_default();
            (
                model.staleness(point.stamp, point.odometer, now, odometer),
                point.gap_mm,
            )
        }
    }
}

/// Own inflation of all points seen at one time.
#[derive(Clone, Copy)]
struct OwnTerms {
    constant_mm: u64,
    /// Heading error in 2⁻²⁰ per mm of distance, rounded up.
    lever_q20: u64,
}

impl OwnTerms {
    fn new(model: &MemoryModel, stale: &Staleness) -> Self {
        Self {
            constant_mm: model
                .sensor_um
                .saturating_add(stale.drift_um)
                .saturating_add(stale.moved_um)
                .div_ceil(1000),
            lever_q20: mul_div_up(stale.turn_urad, 1_048_577, 1_000_000),
        }
    }

    #[inline]
    fn place(&self, view: &BodyView, (x, y): (i16, i16), gap_mm: u16, joined: bool) -> CloudPoint {
        let seen = view.see(PointMm {
            x: i32::from(x),
            y: i32::from(y),
        });
        let Some((x_mm, y_mm)) =
            seen.and_then(|p| Some((i16::try_from(p.x).ok()?, i16::try_from(p.y).ok()?)))
        else {
            // A segment to a far point would be longer than the join limit allows.
            return CloudPoint::FAR;
        };
        let distance =
            u64::from(x_mm.unsigned_abs()).saturating_add(u64::from(y_mm.unsigned_abs()));
        let lever_mm = distance.saturating_mul(self.lever_q20).div_ceil(1 << 20);
        let extra = self
            .constant_mm
            .saturating_add(lever_mm)
            .saturating_add(u64::from(gap_mm));
        CloudPoint {
            x_mm,
            y_mm,
            extra_mm: u16::try_from(extra).unwrap_or(u16::MAX),
            joined,
        }
    }
}
