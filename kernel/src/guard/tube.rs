//! The tube: inflated rectangles along the nominal arc that contain every admissible motion.
//!
//! Refuses motions whose tube would be longer, wider or more curved than its
//! fixed number of samples can cover; never approximates inward.

use super::hull::Hull;
use super::plan::{Dynamics, Plan};
use super::{Budget, Refusal};
use crate::arith::{add, mul_div_up, mul_micro_up, narrow, to_i32};
use crate::geometry::frame::{PointMm, ROTATION_BITS, Rotation, rounded_q30};
use crate::geometry::rect::Rect;
use crate::odometry::LocalPose;
use crate::units::{BinaryAngle, Length};

/// Largest number of samples of a tube.
pub const SAMPLES_MAX: usize = 97;
/// Usual number of steps of a driving tube; more only where the arc turns sharply.
const STEPS: u64 = 48;
/// Least step of a driving tube, µm.
const STEP_MIN_UM: u64 = 2_000;
/// A driving step turns at most 5 degrees, µrad.
const STEP_TURN_URAD: u64 = 87_266;
/// A step on the spot turns at most 2 degrees, µrad.
const SPOT_TURN_URAD: u64 = 34_906;
/// Paths and reach (corner distance plus inflation) beyond these are refused, µm.
const PATH_MAX_UM: u64 = 4_000_000;
const REACH_MAX_UM: u64 = 3_000_000;
//= spec/guard.md#guard-21
//# Every rounding in the computation of a tube MUST enlarge the tube or be covered by the rounding term of its
//# budget.
/// Rounding of points and transforms, µm: 0.5 decoding + 0.71 storing + 1.06 body frame
/// + 0.3 sample frame, rounded up.
const ROUNDING_UM: u64 = 3_000;
/// Fractional bits of a length in eighths of a millimetre.
pub(crate) const EIGHTH_BITS: u32 = 3;
/// Offsets (in eighths) beyond which a sample cannot be touched and products would not fit.
const OFFSET_MAX: u32 = 46_340;

/// One inflated rectangle of the tube, in the body frame at the tube's start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sample {
    /// Rotation centre, eighths of a millimetre.
    pub(crate) centre: PointMm,
    /// Rotation from the body frame into the sample's frame.
    pub(crate) into: Rotation,
    /// Footprint grown by everything but the points' own terms, eighths of a millimetre.
    pub(crate) rect: Rect,
    /// Spread term, µm.
    pub(crate) spread_um: u32,
    /// Obstacle motion while the robot is on its way here, µm.
    pub(crate) moving_um: u32,
    /// Rounding term, µm.
    pub(crate) rounding_um: u32,
}

impl Default for Rotation {
    fn default() -> Self {
        Self {
            cos: 1 << ROTATION_BITS,
            sin: 0,
        }
    }
}

/// The tube of one hull of motions.
#[derive(Clone, Debug)]
pub struct Tube {
    samples: [Sample; SAMPLES_MAX],
    count: usize,
    /// The pose at the start, inflated like the first sample.
    pub(crate) start: Sample,
    /// Samples before this one lie against the commanded sense of turning.
    pub(crate) nominal_from: usize,
    /// Bounding box of all samples, millimetres, outward.
    pub(crate) bounds: Rect,
    pub(crate) sampling_um: u64,
    pub(crate) tracking_um: u64,
    pub(crate) plan: Plan,
}

/// The samples of a tube, as points are checked against them.
#[derive(Clone, Copy, Debug)]
pub struct Swept<'a> {
    /// The inflated samples.
    pub samples: &'a [Sample],
    /// Bounding box of all samples, millimetres, outward.
    pub bounds: Rect,
    /// The pose at the start, inflated like the first sample.
    pub start: Sample,
    /// Samples before this one lie against the commanded sense of turning.
    pub nominal_from: usize,
}

/// What the tube needs besides the hull.
#[derive(Clone, Copy, Debug, Default)]
pub struct TubeParameters {
    /// The robot's dynamics.
    pub dynamics: Dynamics,
    /// Footprint in eighths of a millimetre, rounded up.
    pub footprint: Rect,
    /// Tracking error of the drive, µm.
    pub tracking_um: u64,
    /// Bound of the obstacles' speed, µm/s.
    pub obstacle_speed: u64,
}

/// Walks the nominal arc: half a turn, a chord, half a turn. Public for proofs only.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Walk {
    /// Along x, 2⁻¹² mm.
    pub x_q12: i32,
    /// Along y, 2⁻¹² mm.
    pub y_q12: i32,
    /// Heading at the sample.
    pub heading: BinaryAngle,
    /// Half the turn of a step.
    pub half_turn: BinaryAngle,
    /// Length of a step, 2⁻¹² mm; negative backwards.
    pub chord_q12: i32,
}

impl Walk {
    /// The next sample.
    pub fn step(&mut self) {
        self.heading = self.heading.plus(self.half_turn);
        let (sin, cos) = crate::geometry::trig::sin_cos(self.heading);
        let along = |component: i32| {
            rounded_q30(i64::from(self.chord_q12).saturating_mul(i64::from(component)))
        };
        self.x_q12 = self.x_q12.saturating_add(along(cos));
        self.y_q12 = self.y_q12.saturating_add(along(sin));
        self.heading = self.heading.plus(self.half_turn);
    }
}

/// Micrometres in eighths of a millimetre, rounded up.
#[doc(hidden)]
#[must_use]
pub fn eighths_up(um: u64) -> i32 {
    to_i32(mul_div_up(um, 1 << EIGHTH_BITS, 1000))
}

/// Half of `curvature · step` (µrad/m, µm) in counts of 2⁻³² turn.
#[doc(hidden)]
#[must_use]
pub fn half_turn_counts(curvature: i32, step_um: u64) -> BinaryAngle {
    let turn = i64::from(curvature).saturating_mul(i64::try_from(step_um).unwrap_or(i64::MAX));
    // 10⁻¹² rad → counts: 2³²/(2π)/2 = 341 782 638 per rad.
    let counts = turn
        .div_euclid(1000)
        .saturating_mul(341_782_638)
        .div_euclid(1_000_000_000);
    BinaryAngle::from_counts(narrow(counts).cast_unsigned())
}

impl Tube {
    /// Builds the tube of `hull` when any of its motions may last for `reaction_us`.
    ///
    /// # Errors
    /// Why the motion has no tube the guard could check.
    /// # Bound
    /// At most [`SAMPLES_MAX`] samples.
    /// # Source
    /// spec/model.md "Driving tube", "Turning on the spot".
    pub fn new(
        parameters: &TubeParameters,
        hull: &Hull,
        reaction_us: u64,
    ) -> Result<Self, Refusal> {
        let plan = Plan::new(&parameters.dynamics, hull, reaction_us)?;
        let mut tube = Self {
            samples: [Sample::default(); SAMPLES_MAX],
            count: 0,
            start: Sample::default(),
            nominal_from: 0,
            bounds: Rect {
                front: i32::MIN,
                rear: i32::MIN,
                left: i32::MIN,
                right: i32::MIN,
            },
            sampling_um: 0,
            tracking_um: parameters.tracking_um,
            plan,
        };
        if plan.path > 0 {
            tube.drive(parameters)?;
        } else {
            tube.turn(parameters)?;
        }
        // The inflation of the first sample holds at the start, too.
        let first = tube.samples().first().copied().unwrap_or_default();
        tube.start = Sample {
            centre: PointMm::default(),
            into: Rotation::default(),
            ..first
        };
        Ok(tube)
    }

    fn drive(&mut self, parameters: &TubeParameters) -> Result<(), Refusal> {
        let plan = self.plan;
        //= spec/guard.md#guard-18
        //# The guard MUST refuse a motion whose tube needs more samples, a longer path or larger coordinates than it
        //# can represent.
        if plan.path > PATH_MAX_UM {
            return Err(Refusal::TooLong);
        }
        let bend = u64::from(plan.curvature.unsigned_abs());
        //= spec/guard.md#guard-05
        //# The samples of a tube MUST begin at the start pose, end at the longest path to rest, and be spaced by
        //# steps that turn by at most 5 degrees.
        let turn_steps = mul_micro_up(bend, plan.path).div_ceil(STEP_TURN_URAD);
        let steps = plan
            .path
            .div_ceil(STEP_MIN_UM)
            .min(STEPS)
            .max(turn_steps)
            .max(1);
        let step = plan.path.div_ceil(steps);
        // Half the arc path of the farthest corner between two samples.
        let corner_path = add(
            step,
            mul_micro_up(mul_micro_up(parameters.dynamics.corner, bend), step),
        );
        self.sampling_um = corner_path.div_ceil(2);
        let chord = to_i32(mul_div_up(step, 4096, 1000)).saturating_mul(plan.direction);
        let half = half_turn_counts(plan.curvature, step);
        let mut walk = Walk {
            x_q12: 0,
            y_q12: 0,
            heading: BinaryAngle::ZERO,
            half_turn: if plan.direction < 0 {
                negated(half)
            } else {
                half
            },
            chord_q12: chord,
        };
        let mut path = 0_u64;
        for _ in 0..=steps {
            // Only what moves needs the time of arrival.
            let latest = if parameters.obstacle_speed == 0 {
                0
            } else {
                plan.latest_at(add(path, step))
            };
            self.push(parameters, &walk, path, latest)?;
            walk.step();
            path = add(path, step);
        }
        Ok(())
    }

    fn turn(&mut self, parameters: &TubeParameters) -> Result<(), Refusal> {
        let plan = self.plan;
        let sweep = add(plan.turn_left, plan.turn_right);
        if sweep > 6_283_186 {
            return Err(Refusal::TooLong);
        }
        let steps = sweep.div_ceil(SPOT_TURN_URAD).clamp(1, 96);
        let step = sweep.div_ceil(steps);
        self.sampling_um = mul_micro_up(parameters.dynamics.corner, step).div_ceil(2);
        // Counts per µrad are 2³²/(2π)/10⁶ = 683.565 28.
        let counts = |urad: u64| {
            let wide = mul_div_up(urad, 68_356_528, 100_000);
            BinaryAngle::from_counts(
                narrow(i64::try_from(wide).unwrap_or(i64::MAX)).cast_unsigned(),
            )
        };
        // Walk from the end that only tolerances reach towards the commanded one.
        let leftwards = plan.turn_left >= plan.turn_right;
        let against = plan.turn_left.min(plan.turn_right);
        self.nominal_from = usize::try_from(against.div_ceil(step.max(1))).unwrap_or(usize::MAX);
        let sense = |angle: BinaryAngle| if leftwards { angle } else { negated(angle) };
        let mut walk = Walk {
            x_q12: 0,
            y_q12: 0,
            heading: sense(negated(counts(against))),
            half_turn: sense(BinaryAngle::from_counts(
                counts(step).as_counts().div_ceil(2),
            )),
            chord_q12: 0,
        };
        for _ in 0..=steps {
            self.push(parameters, &walk, 0, plan.latest)?;
            walk.step();
        }
        Ok(())
    }

    /// Appends the sample at arc length `path`, inflated for all terms that do not depend on points.
    fn push(
        &mut self,
        parameters: &TubeParameters,
        walk: &Walk,
        path: u64,
        latest: u64,
    ) -> Result<(), Refusal> {
        let spread = self.plan.spread(path, parameters.dynamics.corner);
        let moving = mul_micro_up(parameters.obstacle_speed, latest);
        // Chords for arcs: s dθ²/24 ≤ s/2048 at 5 degrees a step.
        let rounding = add(ROUNDING_UM, path.div_ceil(2048));
        //= spec/guard.md#guard-06
        //# Every sample MUST be inflated by no less than the sum of sensor error, beam gap, odometry error, obstacle
        //# motion, tracking error, sampling, spread and rounding as derived in the model.
        let inflation = [moving, rounding, self.tracking_um, self.sampling_um]
            .iter()
            .fold(spread, |sum, &term| add(sum, term));
        if add(inflation, parameters.dynamics.corner) > REACH_MAX_UM {
            return Err(Refusal::TooLong);
        }
        let sample = Sample {
            centre: PointMm {
                x: walk.x_q12 >> 9,
                y: walk.y_q12 >> 9,
            },
            into: Rotation::new(walk.heading).inverse(),
            rect: parameters.footprint.grown(eighths_up(inflation)),
            spread_um: u32::try_from(spread).unwrap_or(u32::MAX),
            moving_um: u32::try_from(moving).unwrap_or(u32::MAX),
            rounding_um: u32::try_from(rounding).unwrap_or(u32::MAX),
        };
        let Some(slot) = self.samples.get_mut(self.count) else {
            return Err(Refusal::TooLong);
        };
        *slot = sample;
        self.count = self.count.saturating_add(1);
        self.bounds = joined(self.bounds, sample.bounds_mm());
        Ok(())
    }

    /// What points are checked against.
    pub(crate) fn swept(&self) -> Swept<'_> {
        Swept {
            samples: self.samples(),
            bounds: self.bounds,
            start: self.start,
            nominal_from: self.nominal_from,
        }
    }

    /// The samples, from the start to the pose at rest.
    #[must_use]
    pub fn samples(&self) -> &[Sample] {
        self.samples.get(..self.count).unwrap_or(&[])
    }

    /// The inflation of `sample` without the points' own terms.
    #[must_use]
    pub(crate) fn budget(&self, sample: &Sample) -> Budget {
        let length = |um: u64| Length::from_um(to_i32(um));
        Budget {
            moving: length(u64::from(sample.moving_um)),
            tracking: length(self.tracking_um),
            sampling: length(self.sampling_um),
            spread: length(u64::from(sample.spread_um)),
            rounding: length(u64::from(sample.rounding_um)),
            ..Budget::default()
        }
    }
}

fn negated(angle: BinaryAngle) -> BinaryAngle {
    BinaryAngle::from_counts(angle.as_counts().wrapping_neg())
}

fn joined(a: Rect, b: Rect) -> Rect {
    Rect {
        front: a.front.max(b.front),
        rear: a.rear.max(b.rear),
        left: a.left.max(b.left),
        right: a.right.max(b.right),
    }
}

impl Sample {
    /// A sample by its parts, for proofs.
    #[doc(hidden)]
    #[must_use]
    pub fn from_parts(centre: PointMm, into: Rotation, rect: Rect) -> Self {
        Self {
            centre,
            into,
            rect,
            ..Self::default()
        }
    }

    /// Rotation centre, eighths of a millimetre.
    #[must_use]
    pub const fn centre(&self) -> PointMm {
        self.centre
    }

    /// Inflated footprint without the points' own terms, eighths of a millimetre.
    #[must_use]
    pub const fn rect(&self) -> Rect {
        self.rect
    }

    /// `rect` around the body itself.
    #[must_use]
    pub fn at_rest(rect: Rect) -> Self {
        Self {
            rect,
            ..Self::default()
        }
    }

    /// A rectangle standing at `there`, seen from a body at `here`.
    #[must_use]
    pub fn seen_from(here: LocalPose, there: LocalPose, rect: Rect) -> Self {
        let eighths = |to: i32, from: i32| to.saturating_sub(from).div_euclid(125);
        let offset = PointMm {
            x: eighths(there.x_um, here.x_um),
            y: eighths(there.y_um, here.y_um),
        };
        let turn = BinaryAngle::from_counts(there.heading.minus(here.heading).cast_unsigned());
        Self {
            centre: Rotation::new(here.heading).inverse().apply(offset),
            into: Rotation::new(turn).inverse(),
            rect,
            ..Self::default()
        }
    }

    /// `point` (body frame, millimetres) in the sample's frame, eighths of a millimetre.
    ///
    /// `None` where the point is too far away to touch the sample.
    #[doc(hidden)]
    #[must_use]
    #[inline]
    pub fn enter(&self, point: PointMm) -> Option<PointMm> {
        let offset = PointMm {
            x: (point.x << EIGHTH_BITS).saturating_sub(self.centre.x),
            y: (point.y << EIGHTH_BITS).saturating_sub(self.centre.y),
        };
        if offset.x.unsigned_abs() > OFFSET_MAX || offset.y.unsigned_abs() > OFFSET_MAX {
            return None;
        }
        let scaled = self.into.apply_scaled(offset);
        Some(PointMm {
            x: scaled.x >> ROTATION_BITS,
            y: scaled.y >> ROTATION_BITS,
        })
    }

    /// The four corners of the sample grown by `margin_um` less than its own inflation cap,
    /// in the body frame, eighths of a millimetre.
    pub(crate) fn corners(&self, rect: Rect) -> [PointMm; 4] {
        let back = self.into.inverse();
        let corner = |x: i32, y: i32| {
            let turned = back.apply(PointMm { x, y });
            PointMm {
                x: turned.x.saturating_add(self.centre.x),
                y: turned.y.saturating_add(self.centre.y),
            }
        };
        let (rear, right) = (rect.rear.saturating_neg(), rect.right.saturating_neg());
        [
            corner(rect.front, rect.left),
            corner(rear, rect.left),
            corner(rear, right),
            corner(rect.front, right),
        ]
    }

    /// Bounding box in the body frame, millimetres, outward.
    fn bounds_mm(&self) -> Rect {
        let corners = self.corners(self.rect);
        let up = |eighths: i32| (eighths >> EIGHTH_BITS).saturating_add(2);
        let most = |value: fn(&PointMm) -> i32| corners.iter().map(value).max().unwrap_or(0);
        Rect {
            front: up(most(|p| p.x)),
            rear: up(most(|p| p.x.saturating_neg())),
            left: up(most(|p| p.y)),
            right: up(most(|p| p.y.saturating_neg())),
        }
    }
}
