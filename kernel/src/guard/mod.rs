//! The guard: certifies that the tube of a motion touches no known point and enters no unknown space.
//!
//! Sees geometry, time, odometry and raw scans, nothing else: no grid, no filter,
//! no planner. Whatever it cannot bound it refuses.

pub mod check;
pub mod hull;
pub mod memory;
pub mod plan;
pub mod seen;
pub mod sweep;
pub mod tube;
pub mod unknown;

use self::hull::Hull;
use self::memory::{Memory, MemoryModel};
use self::tube::{Tube, TubeParameters};
use crate::arith::to_i32;
use crate::odometry::{LocalPose, Odometer};
use crate::time::{Duration, Instant};
use crate::units::Length;

/// Why a tube was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Refusal {
    /// A known point lies in the tube.
    KnownPoint,
    /// The tube enters space nobody has looked at, or looked at too long ago.
    UnknownSpace,
    /// The hull mixes turning on the spot with driving, or both directions of travel.
    MixedMotion,
    /// The tube is longer or wider than the guard can cover.
    TooLong,
}

/// A point in the body frame at the decision pose, millimetres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BodyPoint {
    /// Forward.
    pub x_mm: i16,
    /// Left.
    pub y_mm: i16,
}

/// Inflation of one sample, term by term (spec: GUARD, "inflation").
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Budget {
    /// Range and position error of the scanner.
    pub sensor: Length,
    /// What may hide between two beams at the blocking point (or at the footprint's distance).
    pub beam_gap: Length,
    /// Odometry error since the point was seen; memory drift for remembered points.
    pub odometry: Length,
    /// Motion of the obstacle: its speed bound times age plus latest time.
    pub moving: Length,
    /// Tracking error of the drive.
    pub tracking: Length,
    /// Half the longest corner path between two samples.
    pub sampling: Length,
    /// Spread of speed and curvature within the hull.
    pub spread: Length,
    /// Integer rounding of the computation itself.
    pub rounding: Length,
}

/// What the guard found for one motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Verdict {
    /// `None` if the tube was accepted.
    pub refusal: Option<Refusal>,
    /// The point (or centre of the unknown cell) that decided, if any.
    pub point: Option<BodyPoint>,
    /// Number of samples of the tube.
    pub samples: u16,
    /// Longest path to rest.
    pub stopping_path: Length,
    /// Latest time until rest.
    pub stopping_time: Duration,
    /// Inflation of the deciding sample, or of the last one if accepted.
    pub budget: Budget,
}

impl Budget {
    /// Sum of all terms; saturates.
    #[must_use]
    pub const fn total(&self) -> Length {
        Length::from_um(
            self.sensor
                .as_um()
                .saturating_add(self.beam_gap.as_um())
                .saturating_add(self.odometry.as_um())
                .saturating_add(self.moving.as_um())
                .saturating_add(self.tracking.as_um())
                .saturating_add(self.sampling.as_um())
                .saturating_add(self.spread.as_um())
                .saturating_add(self.rounding.as_um()),
        )
    }
}

/// Where and when a motion is judged, and against what.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a, const S: usize, const B: usize, const M: usize> {
    /// What is known of the surroundings, refreshed for `pose`.
    pub memory: &'a Memory<S, B, M>,
    /// How points age.
    pub model: &'a MemoryModel,
    /// The tube's start: the pose of the newest odometry.
    pub pose: LocalPose,
    /// Time of that pose.
    pub stamp: Instant,
    /// Odometer at that pose.
    pub odometer: Odometer,
    /// Present while the robot leaves rest: points inside the inflation where it rested block
    /// only motions that bring it nearer.
    pub excuse: Option<check::Excuse>,
}

/// Certifies the tube of `hull` in `scene` when any of its motions may last for `reaction_us`.
///
/// # Bound
/// O(points × samples).
/// # Source
/// GUARD-01, GUARD-02; spec/model.md.
pub fn certify<const S: usize, const B: usize, const M: usize>(
    parameters: &TubeParameters,
    hull: &Hull,
    reaction_us: u64,
    scene: &Scene<'_, S, B, M>,
) -> Verdict {
    let tube = match Tube::new(parameters, hull, reaction_us) {
        Ok(tube) => tube,
        Err(refusal) => return Verdict::without_tube(refusal),
    };
    for (slice, cloud) in scene.memory.clouds().enumerate() {
        //= spec/guard.md#guard-01
        //# The guard MUST refuse a motion when a known point lies in one of the inflated samples of its tube.
        if let Some(touch) =
            check::first_touch(&tube, parameters.footprint, cloud, scene.excuse.as_ref())
        {
            let (stale, gap_mm) = scene.memory.cause(
                scene.model,
                (slice, touch.index),
                scene.stamp,
                scene.odometer,
            );
            let mut budget = touch.budget;
            budget.charge(scene.model.sensor_um, &stale, gap_mm, touch.point);
            //= spec/guard.md#guard-20
            //# Every verdict MUST carry the inflation of the deciding sample, term by term, and the point or cell
            //# that decided.
            return Verdict::of(&tube, Some(Refusal::KnownPoint), Some(touch.point), budget);
        }
    }
    let unknown = unknown::entered(&tube, parameters.footprint, &scene.memory.seen, scene.pose);
    let refusal = unknown.map(|_| Refusal::UnknownSpace);
    let mut budget = tube
        .samples()
        .last()
        .map(|last| tube.budget(last))
        .unwrap_or_default();
    budget.sensor = Length::from_um(to_i32(scene.model.sensor_um));
    Verdict::of(&tube, refusal, unknown, budget)
}

/// The inflation of an accepted tube's start, and how near the nearest excused point still is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leave {
    /// Footprint grown by the inflation at the start, eighths of a millimetre.
    pub rect: crate::geometry::rect::Rect,
    /// Distance of the footprint from the nearest excused point, eighths of a millimetre.
    pub nearest: u64,
}

/// What of `excuse` is still needed by the tube of `hull`; `None` once everything is left behind.
#[must_use]
pub fn leave<const S: usize, const B: usize, const M: usize>(
    parameters: &TubeParameters,
    hull: &Hull,
    reaction_us: u64,
    memory: &Memory<S, B, M>,
    excuse: &check::Excuse,
) -> Option<Leave> {
    let tube = Tube::new(parameters, hull, reaction_us).ok()?;
    let nearest = memory
        .clouds()
        .filter_map(|cloud| excuse.nearest(&tube, parameters.footprint, cloud))
        .min()?;
    Some(Leave {
        rect: tube.start.rect,
        nearest: nearest.isqrt(),
    })
}

impl Verdict {
    const fn without_tube(refusal: Refusal) -> Self {
        Self {
            refusal: Some(refusal),
            point: None,
            samples: 0,
            stopping_path: Length::ZERO,
            stopping_time: Duration::ZERO,
            budget: Budget {
                sensor: Length::ZERO,
                beam_gap: Length::ZERO,
                odometry: Length::ZERO,
                moving: Length::ZERO,
                tracking: Length::ZERO,
                sampling: Length::ZERO,
                spread: Length::ZERO,
                rounding: Length::ZERO,
            },
        }
    }

    fn of(tube: &Tube, refusal: Option<Refusal>, point: Option<BodyPoint>, budget: Budget) -> Self {
        Self {
            refusal,
            point,
            samples: u16::try_from(tube.samples().len()).unwrap_or(u16::MAX),
            stopping_path: Length::from_um(to_i32(tube.plan.path)),
            stopping_time: Duration::from_us(tube.plan.latest),
            budget,
        }
    }
}

impl Budget {
    /// Adds the terms of one point.
    fn charge(&mut self, sensor_um: u64, stale: &memory::Staleness, gap_mm: u16, point: BodyPoint) {
        let distance = u64::from(point.x_mm.unsigned_abs())
            .saturating_add(u64::from(point.y_mm.unsigned_abs()));
        let lever = crate::arith::mul_div_up(stale.turn_urad, distance, 1000);
        self.sensor = Length::from_um(to_i32(sensor_um));
        self.beam_gap = Length::from_mm(i32::from(gap_mm));
        self.odometry = Length::from_um(to_i32(stale.drift_um.saturating_add(lever)));
        let moving = u64::from(self.moving.as_um().unsigned_abs()).saturating_add(stale.moved_um);
        self.moving = Length::from_um(to_i32(moving));
    }
}
