//! Routes: via points to pass, a destination to stop at, and which of them comes next.

use crate::input::Pose;
use crate::time::Instant;
use crate::units::{BinaryAngle, Length};
use core::f64::consts::PI;

/// A via point counts as passed within this many tolerances once the robot is beyond it.
const PASSED_WITHIN: f64 = 3.0;
/// µm per metre.
const MICRO: f64 = 1e6;

/// A point to pass, odometry frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Via {
    /// Position along x, µm.
    pub x_um: i64,
    /// Position along y, µm.
    pub y_um: i64,
    /// It counts as passed within this distance.
    pub tolerance: Length,
}

/// Where to come to rest, odometry frame.
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
#[derive(Clone, Copy, Debug)]
pub struct Route<'a> {
    /// When it was ordered. A route ordered before the last release of a latched stop is void.
    pub stamp: Instant,
    /// Another id starts at the first via point.
    pub id: u32,
    /// Via points in their order; any number.
    pub via: &'a [Via],
    /// Where it ends.
    pub goal: Destination,
}

/// How far a route has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Course {
    /// The route's id.
    pub id: u32,
    /// Index of the next via point; their number once the destination is next.
    pub next: usize,
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

impl Route<'_> {
    /// Whether all tolerances of the next targets can be met: positive, the angle below half a turn.
    pub(super) fn is_valid(&self) -> bool {
        let goal = &self.goal;
        goal.tolerance > Length::ZERO
            && (goal.heading.is_none() || (1..1 << 31).contains(&goal.heading_tolerance))
            && self.via.iter().all(|via| via.tolerance > Length::ZERO)
    }

    /// Position and tolerance of target `index`, metres from `origin` along the odometry axes.
    fn target(&self, index: usize, origin: &Pose) -> ([f64; 2], f64) {
        let (x_um, y_um, tolerance) = match self.via.get(index) {
            Some(via) => (via.x_um, via.y_um, via.tolerance),
            None => (self.goal.x_um, self.goal.y_um, self.goal.tolerance),
        };
        let metres = |to: i64, from: i64| to.saturating_sub(from) as f64 / MICRO;
        (
            [metres(x_um, origin.x_um), metres(y_um, origin.y_um)],
            f64::from(tolerance.as_um()) / MICRO,
        )
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
            });
        while course.next < route.via.len() && course.has_passed(route, pose) {
            course.next = course.next.saturating_add(1);
        }
        course
    }

    /// Within the tolerance, or nearby and beyond the point in the direction of the next one.
    fn has_passed(&self, route: &Route<'_>, pose: &Pose) -> bool {
        let ([x, y], tolerance) = route.target(self.next, pose);
        let ([onward_x, onward_y], _) = route.target(self.next.saturating_add(1), pose);
        let distance = libm::hypot(x, y);
        let beyond = x * (onward_x - x) + y * (onward_y - y) < 0.0;
        distance <= tolerance || (beyond && distance <= PASSED_WITHIN * tolerance)
    }

    /// The next target from `pose`.
    pub fn sight(&self, route: &Route<'_>, pose: &Pose) -> Sight {
        let ([x, y], tolerance_m) = route.target(self.next, pose);
        let (sin, cos) = libm::sincos(radians(pose.heading));
        Sight {
            position: [cos * x + sin * y, cos * y - sin * x],
            distance_m: libm::hypot(x, y),
            tolerance_m,
            is_goal: self.next >= route.via.len(),
        }
    }
}

/// An angle in (-π, π].
pub(super) fn radians(angle: BinaryAngle) -> f64 {
    f64::from(angle.minus(BinaryAngle::ZERO)) * (PI / 2_147_483_648.0)
}
