//! The recent past of the odometry: where the robot was when a beam was fired, and how far it has come.
//!
//! Never extrapolates: a time the odometry does not cover has no pose.

use crate::arith::{MICRO, magnitude, narrow};
use crate::input::{Odometry, Pose, Twist};
use crate::time::Instant;
use crate::units::BinaryAngle;

/// Number of odometry samples kept.
pub const HISTORY: usize = 32;
/// The anchor moves in steps of this, a whole number of millimetres and of memory cells, µm.
pub const ANCHOR_STEP_UM: i64 = 2_048_000;
/// The robot stays within this distance of the anchor along each axis, µm.
const ANCHOR_REACH_UM: i64 = 8_192_000;

/// A pose relative to the anchor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LocalPose {
    /// Along x of the odometry frame, µm.
    pub x_um: i32,
    /// Along y of the odometry frame, µm.
    pub y_um: i32,
    /// Heading in the odometry frame.
    pub heading: BinaryAngle,
}

/// How far the robot has driven and turned since the kernel started; never decreases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Odometer {
    /// Path length, µm.
    pub travelled_um: u64,
    /// Sum of the magnitudes of all turns, µrad.
    pub turned_urad: u64,
}

/// Whole millimetres by which everything stored relative to the anchor must shift.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AnchorShift {
    /// Subtract from x, mm.
    pub x_mm: i32,
    /// Subtract from y, mm.
    pub y_mm: i32,
}

/// Ring of odometry samples in order of their stamps.
#[derive(Clone, Copy, Debug)]
pub struct Track {
    ring: [Odometry; HISTORY],
    newest: usize,
    count: usize,
    odometer: Odometer,
    anchor_x_um: i64,
    anchor_y_um: i64,
}

impl Default for Track {
    fn default() -> Self {
        Self {
            ring: [Odometry::default(); HISTORY],
            newest: 0,
            count: 0,
            odometer: Odometer::default(),
            anchor_x_um: 0,
            anchor_y_um: 0,
        }
    }
}

impl Track {
    /// The newest sample.
    #[must_use]
    pub fn newest(&self) -> Option<&Odometry> {
        (self.count > 0)
            .then(|| self.ring.get(self.newest))
            .flatten()
    }

    /// Distance and turn so far.
    #[must_use]
    pub const fn odometer(&self) -> Odometer {
        self.odometer
    }

    /// Appends a sample that the caller has found newer than the newest; returns how the
    /// anchor moved, if the robot left its surroundings.
    pub fn push(&mut self, odometry: Odometry) -> Option<AnchorShift> {
        if let Some(before) = self.newest().copied() {
            self.odometer = advanced(self.odometer, &before, &odometry);
        } else {
            self.anchor_x_um = snapped(odometry.pose.x_um);
            self.anchor_y_um = snapped(odometry.pose.y_um);
        }
        let next = self.newest.saturating_add(1);
        self.newest = if next >= HISTORY { 0 } else { next };
        if let Some(slot) = self.ring.get_mut(self.newest) {
            *slot = odometry;
        }
        self.count = self.count.saturating_add(1).min(HISTORY);
        self.follow(&odometry)
    }

    /// Forgets all poses but the newest: after a jump the past has no relation to the present.
    pub fn restart(&mut self, odometry: Odometry) {
        let odometer = self.odometer;
        *self = Self::default();
        self.odometer = odometer;
        self.push(odometry);
    }

    fn follow(&mut self, odometry: &Odometry) -> Option<AnchorShift> {
        let x = odometry.pose.x_um.saturating_sub(self.anchor_x_um);
        let y = odometry.pose.y_um.saturating_sub(self.anchor_y_um);
        if x.saturating_abs() < ANCHOR_REACH_UM && y.saturating_abs() < ANCHOR_REACH_UM {
            return None;
        }
        let (dx, dy) = (snapped(x), snapped(y));
        self.anchor_x_um = self.anchor_x_um.saturating_add(dx);
        self.anchor_y_um = self.anchor_y_um.saturating_add(dy);
        Some(AnchorShift {
            x_mm: narrow(dx.div_euclid(1000)),
            y_mm: narrow(dy.div_euclid(1000)),
        })
    }

    /// The newest pose relative to the anchor.
    #[must_use]
    pub fn pose(&self) -> Option<LocalPose> {
        self.newest().map(|odometry| self.local(odometry))
    }

    /// Position of the anchor in the odometry frame, µm.
    #[must_use]
    pub const fn anchor_um(&self) -> (i64, i64) {
        (self.anchor_x_um, self.anchor_y_um)
    }

    /// The pose at `time`, interpolated; `None` outside the recorded span.
    ///
    /// # Bound
    /// At most [`HISTORY`] steps.
    #[must_use]
    pub fn pose_at(&self, time: Instant) -> Option<LocalPose> {
        let mut later = self.newest()?;
        if later.stamp < time {
            return None;
        }
        let mut index = self.newest;
        for _ in 1..self.count {
            index = index.checked_sub(1).unwrap_or(HISTORY.saturating_sub(1));
            let earlier = self.ring.get(index)?;
            if earlier.stamp <= time {
                return Some(self.between(earlier, later, time));
            }
            later = earlier;
        }
        (later.stamp == time).then(|| self.local(later))
    }

    /// The pose at `time` in the odometry frame, interpolated; `None` outside the recorded span.
    #[must_use]
    pub fn world_pose_at(&self, time: Instant) -> Option<Pose> {
        let local = self.pose_at(time)?;
        Some(Pose {
            x_um: self.anchor_x_um.saturating_add(i64::from(local.x_um)),
            y_um: self.anchor_y_um.saturating_add(i64::from(local.y_um)),
            heading: local.heading,
        })
    }

    fn local(&self, odometry: &Odometry) -> LocalPose {
        LocalPose {
            x_um: narrow(odometry.pose.x_um.saturating_sub(self.anchor_x_um)),
            y_um: narrow(odometry.pose.y_um.saturating_sub(self.anchor_y_um)),
            heading: odometry.pose.heading,
        }
    }

    fn between(&self, earlier: &Odometry, later: &Odometry, time: Instant) -> LocalPose {
        let (a, b) = (self.local(earlier), self.local(later));
        let span = later.stamp.since(earlier.stamp).unwrap_or_default().as_us();
        let part = time.since(earlier.stamp).unwrap_or_default().as_us();
        let fraction = part
            .saturating_mul(1 << 16)
            .checked_div(span)
            .unwrap_or(1 << 16);
        let fraction = i64::try_from(fraction).unwrap_or(1 << 16);
        let blend = |from: i32, to: i32| {
            let way = i64::from(to).saturating_sub(i64::from(from));
            narrow(i64::from(from).saturating_add(way.saturating_mul(fraction) >> 16))
        };
        let turn = i64::from(b.heading.minus(a.heading)).saturating_mul(fraction) >> 16;
        LocalPose {
            x_um: blend(a.x_um, b.x_um),
            y_um: blend(a.y_um, b.y_um),
            heading: a
                .heading
                .plus(BinaryAngle::from_counts(narrow(turn).cast_unsigned())),
        }
    }
}

/// Rounds down to a whole anchor step.
fn snapped(um: i64) -> i64 {
    um.div_euclid(ANCHOR_STEP_UM).saturating_mul(ANCHOR_STEP_UM)
}

/// Counts of 2⁻³² turn as µrad, rounded up.
#[must_use]
pub fn turn_urad(counts: i32) -> u64 {
    // 2π · 10⁶ / 2³² = 1.4629e-3.
    u64::from(counts.unsigned_abs())
        .saturating_mul(6_283_186)
        .div_ceil(1 << 32)
}

/// Distance between two samples, µm, rounded up.
#[must_use]
pub fn distance_um(before: &Odometry, after: &Odometry) -> u64 {
    let dx = after.pose.x_um.saturating_sub(before.pose.x_um);
    let dy = after.pose.y_um.saturating_sub(before.pose.y_um);
    let square = |d: i64| d.unsigned_abs().saturating_mul(d.unsigned_abs());
    crate::arith::sqrt_up(square(dx).saturating_add(square(dy)))
}

/// Path length and turn between two samples count at least what the twists say,
/// so that wiggling between samples is not lost.
fn advanced(odometer: Odometer, before: &Odometry, after: &Odometry) -> Odometer {
    let span = after.stamp.since(before.stamp).unwrap_or_default().as_us();
    let by_twist = |rate: u64| rate.saturating_mul(span).div_ceil(MICRO);
    let rate = |twist: &Twist| {
        (
            magnitude(twist.linear.as_um_per_s()),
            magnitude(twist.angular.as_urad_per_s()),
        )
    };
    let (v, w) = rate(&after.twist);
    let turned = turn_urad(after.pose.heading.minus(before.pose.heading));
    Odometer {
        travelled_um: odometer
            .travelled_um
            .saturating_add(distance_um(before, after).max(by_twist(v))),
        turned_urad: odometer.turned_urad.saturating_add(turned.max(by_twist(w))),
    }
}
