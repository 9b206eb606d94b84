//! Routes: via points to pass, a destination to stop at, and which of them comes next.

use crate::convert::{Round, round};
use crate::input::Pose;
use crate::time::Instant;
use crate::units::{BinaryAngle, Length};
use core::f64::consts::PI;

/// A via point counts as passed within this many tolerances once the robot is beyond it.
const PASSED_WITHIN: f64 = 3.0;
/// How many tolerances of a via point to look beyond it. Steering for a point this far ahead
/// cuts a right angle by about a third of it.
const CUT: f64 = 3.0;
/// How near a point that is only steered for may come, m.
const STEERING_TOLERANCE_M: f64 = 1e-3;
/// Most via points of a route: a tick looks at all of them.
pub const VIA_MAX: usize = 1024;
/// µm per metre.
const MICRO: f64 = 1e6;

/// A point to pass, frame of the route.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Via {
    /// Position along x, µm.
    pub x_um: i64,
    /// Position along y, µm.
    pub y_um: i64,
    /// It counts as passed within this distance.
    pub tolerance: Length,
}

/// Where to come to rest, frame of the route.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Destination {
    /// Position along x, µm.
    pub x_um: i64,
    /// Position along y, µm.
    pub y_um: i64,
    /// The position counts as reached within this distance.
    pub tolerance: Length,
    /// Heading to take there; `None`: any.
    pub heading: Option<BinaryAngle>,
    /// The heading counts as reached within this angle, counts of 2⁻³² turn, below half a turn.
    pub heading_tolerance: u32,
}

/// An order: pass the via points in turn, then stop at the destination.
///
/// Handed in afresh with every tick; nothing of it is kept but how far it has come.
#[derive(Clone, Copy, Debug, Default)]
pub struct Route<'a> {
    /// When it was ordered. A route ordered before the last release of a latched stop is void.
    pub stamp: Instant,
    /// Another id starts at the first via point.
    pub id: u32,
    /// Via points in their order, at most [`VIA_MAX`].
    pub via: &'a [Via],
    /// Where it ends.
    pub goal: Destination,
    /// Pose of the odometry frame in the route's frame (REP 105: `map` to `odom`), anew in every
    /// tick; the default for a route in the odometry frame itself. See [`super::Localiser`].
    pub odometry_frame: Pose,
}

/// How far a route has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Course {
    /// The route's id.
    pub id: u32,
    /// Index of the next via point; their number once the destination is next.
    pub next: usize,
    /// Where the leg to the next target begins: the target before, or where the route began, µm.
    from: (i64, i64),
}

/// The next target as seen from the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sight {
    /// Body frame, metres.
    pub position: [f64; 2],
    /// Distance, metres.
    pub distance_m: f64,
    /// It counts as reached within this distance, metres.
    pub tolerance_m: f64,
    /// Whether it is the destination.
    pub is_goal: bool,
}

impl Sight {
    /// Whether the destination's position is reached.
    pub fn is_reached(&self) -> bool {
        self.is_goal && self.distance_m <= self.tolerance_m
    }
}

impl Route<'_> {
    /// The robot's pose in the route's frame; `None` if it is too far away for its numbers.
    pub(super) fn locate(&self, pose: &Pose) -> Option<Pose> {
        //= spec/navigate.md#nav-13
        //# A route MUST be followed at the robot's pose in the frame of the route.
        let frame = &self.odometry_frame;
        let (sin, cos) = libm::sincos(radians(frame.heading));
        let (x, y) = (pose.x_um as f64, pose.y_um as f64);
        let shifted = |from: i64, by: f64| from.checked_add(round(by, Round::Nearest)?);
        Some(Pose {
            x_um: shifted(frame.x_um, cos * x - sin * y)?,
            y_um: shifted(frame.y_um, sin * x + cos * y)?,
            heading: frame.heading.plus(pose.heading),
        })
    }

    /// Whether it is short enough and its tolerances can be met: positive, the angle below half a turn.
    /// # Bound
    /// O(via points).
    pub(super) fn is_valid(&self) -> bool {
        let goal = &self.goal;
        self.via.len() <= VIA_MAX
            && goal.tolerance > Length::ZERO
            && (goal.heading.is_none() || (1..1 << 31).contains(&goal.heading_tolerance))
            && self.via.iter().all(|via| via.tolerance > Length::ZERO)
    }

    /// The destination's position in the body frame at `pose`, m.
    pub(super) fn goal_seen(&self, pose: &Pose) -> [f64; 2] {
        let (place, _) = self.target(self.via.len(), pose);
        Sight::of(pose, place, None).position
    }

    /// Position and tolerance of target `index`, metres from `origin` along the odometry axes.
    fn target(&self, index: usize, origin: &Pose) -> ([f64; 2], f64) {
        let (x_um, y_um, tolerance) = match self.via.get(index) {
            Some(via) => (via.x_um, via.y_um, via.tolerance),
            None => (self.goal.x_um, self.goal.y_um, self.goal.tolerance),
        };
        let (x, y) = offset((x_um, y_um), origin);
        ([x, y], f64::from(tolerance.as_um()) / MICRO)
    }
}

impl Course {
    /// The course after passing every via point that `pose` has reached.
    ///
    /// # Bound
    /// O(via points), once over the whole route.
    pub fn of(before: Option<Self>, route: &Route<'_>, pose: &Pose) -> Self {
        let mut course = before
            .filter(|course| course.id == route.id && course.next <= route.via.len())
            .unwrap_or(Self {
                id: route.id,
                next: 0,
                from: (pose.x_um, pose.y_um),
            });
        while let Some(via) = route.via.get(course.next) {
            if !course.has_passed(route, pose) {
                break;
            }
            course.from = (via.x_um, via.y_um);
            course.next = course.next.saturating_add(1);
        }
        course
    }

    /// Within the tolerance, or nearby and beyond the point in the direction of the next one.
    fn has_passed(&self, route: &Route<'_>, pose: &Pose) -> bool {
        let ([x, y], tolerance) = route.target(self.next, pose);
        let distance = libm::hypot(x, y);
        if distance <= tolerance || distance > PASSED_WITHIN * tolerance {
            return distance <= tolerance;
        }
        let onward = (self.next..route.via.len()).find_map(|index| {
            let ([to_x, to_y], _) = route.target(index.saturating_add(1), pose);
            let way = (to_x - x, to_y - y);
            (libm::hypot(way.0, way.1) > STEERING_TOLERANCE_M).then_some(way)
        });
        onward.is_some_and(|(along, across)| x * along + y * across < 0.0)
    }

    /// What to steer for from `pose`: the point `ahead_m` onwards on the legs between the via
    /// points, counted from the place on the present leg that is nearest to the robot. On the way
    /// to the first via point and to the destination there is no leg to keep to.
    ///
    /// Where the route bends by a right angle or more, never more than [`CUT`] tolerances beyond
    /// the next via point, and farther the less it bends: the tolerance says how far the corner
    /// may be cut.
    /// # Bound
    /// O(via points within `ahead_m`).
    pub fn onward(&self, route: &Route<'_>, pose: &Pose, ahead_m: f64) -> Sight {
        let (mut to, tolerance_m) = route.target(self.next, pose);
        let (mut place, rest) = self.on_leg(to, pose);
        let bend = self.bend(route, pose, to);
        let mut left = ahead_m.min(rest + CUT * tolerance_m / bend);
        for next in self.next..route.via.len() {
            let ([x, y], [to_x, to_y]) = (place, to);
            let (along, across) = (to_x - x, to_y - y);
            let length = libm::hypot(along, across);
            if length > left {
                let part = left / length;
                let place = [x + along * part, y + across * part];
                return Sight::of(pose, place, None);
            }
            (place, left) = (to, left - length);
            to = route.target(next.saturating_add(1), pose).0;
        }
        Course {
            next: route.via.len(),
            ..*self
        }
        .straight(route, pose)
    }

    /// Sine of the angle between this leg and the next, 1 for more than a right angle; above zero.
    fn bend(&self, route: &Route<'_>, pose: &Pose, [x, y]: [f64; 2]) -> f64 {
        let ([on_x, on_y], _) = route.target(self.next.saturating_add(1), pose);
        let (from_x, from_y) = if self.next == 0 {
            (0.0, 0.0)
        } else {
            offset(self.from, pose)
        };
        let (leg_x, leg_y) = (x - from_x, y - from_y);
        let (next_x, next_y) = (on_x - x, on_y - y);
        let lengths = libm::hypot(leg_x, leg_y) * libm::hypot(next_x, next_y);
        let sine = (leg_x * next_y - leg_y * next_x).abs() / lengths;
        if leg_x * next_x + leg_y * next_y <= 0.0 {
            return 1.0;
        }
        sine.clamp(1e-6, 1.0)
    }

    /// The next target itself.
    pub fn straight(&self, route: &Route<'_>, pose: &Pose) -> Sight {
        let (place, tolerance_m) = route.target(self.next, pose);
        let is_goal = self.next >= route.via.len();
        Sight::of(pose, place, is_goal.then_some(tolerance_m))
    }

    /// The place on the present leg nearest to the robot, and the rest of the leg, m.
    fn on_leg(&self, [to_x, to_y]: [f64; 2], pose: &Pose) -> ([f64; 2], f64) {
        if self.next == 0 {
            return ([0.0; 2], libm::hypot(to_x, to_y));
        }
        let (x, y) = offset(self.from, pose);
        let (along, across) = (to_x - x, to_y - y);
        let squared = along * along + across * across;
        let part = if squared > 0.0 {
            (-(x * along + y * across) / squared).clamp(0.0, 1.0)
        } else {
            1.0
        };
        let place = [x + along * part, y + across * part];
        (place, libm::sqrt(squared) * (1.0 - part))
    }
}

impl Sight {
    /// `place` along the odometry axes, seen from `pose`; with a tolerance it is the destination.
    ///
    /// What is only steered for is never reached: passing is judged by the course.
    fn of(pose: &Pose, [x, y]: [f64; 2], goal_tolerance_m: Option<f64>) -> Self {
        let (sin, cos) = libm::sincos(radians(pose.heading));
        Self {
            position: [cos * x + sin * y, cos * y - sin * x],
            distance_m: libm::hypot(x, y),
            tolerance_m: goal_tolerance_m.unwrap_or(STEERING_TOLERANCE_M),
            is_goal: goal_tolerance_m.is_some(),
        }
    }
}

/// A place in µm, from `origin` along the odometry axes, m.
fn offset((x_um, y_um): (i64, i64), origin: &Pose) -> (f64, f64) {
    let metres = |to: i64, from: i64| to.saturating_sub(from) as f64 / MICRO;
    (metres(x_um, origin.x_um), metres(y_um, origin.y_um))
}

/// An angle in (-π, π].
pub(super) fn radians(angle: BinaryAngle) -> f64 {
    f64::from(angle.minus(BinaryAngle::ZERO)) * (PI / 2_147_483_648.0)
}
