//! How far a rectangle can move along an arc before it touches a point (Loh 4.7–4.10, corrected).
//!
//! Closed form, no sampling: seen from the robot, the point moves on a circle around
//! the rotation centre of the path, and the first contact is where that circle enters
//! the rectangle. Refuses to guess: whatever is not finite counts as touched.

use super::footprint::{Footprint, Point};
use core::f64::consts::TAU;

/// Curvatures below this are straight: over 40 m the difference is less than 0.1 mm, 1/m.
pub const STRAIGHT_PER_M: f64 = 1e-7;
/// Tolerance at corners and for a point on an edge; errs towards contact, m.
const TOUCH_M: f64 = 1e-7;

/// Sense of travel along an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Front first.
    Forward,
    /// Rear first.
    Reverse,
}

/// Sense of turning on the spot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Counter-clockwise.
    Left,
    /// Clockwise.
    Right,
}

/// A path with constant curvature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Course {
    /// An arc or a straight line; travel is the rotation centre's own way in metres.
    Arc {
        /// ω/v, positive to the left when driving forward, 1/m.
        curvature_per_m: f64,
        /// Which way along it.
        direction: Direction,
    },
    /// Turning on the spot (R = 0); travel is the angle in radians.
    Spot(Turn),
}

/// How far a motion may go.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub enum Clearance {
    /// Nothing is ever touched.
    Free,
    /// First contact after this travel: metres on an arc, radians on the spot, never negative.
    Contact(f64),
}

impl Clearance {
    /// Whether `travel` (metres or radians) may be made without contact.
    #[must_use]
    pub fn allows(self, travel: f64) -> bool {
        match self {
            Self::Free => travel.is_finite(),
            Self::Contact(most) => travel <= most,
        }
    }

    /// `travel`, cut at the contact.
    #[must_use]
    pub fn cut(self, travel: f64) -> f64 {
        match self {
            Self::Free => travel,
            Self::Contact(most) => travel.min(most),
        }
    }

    /// The smaller of both.
    pub fn nearer(self, other: Self) -> Self {
        match (self, other) {
            (Self::Free, any) | (any, Self::Free) => any,
            (Self::Contact(one), Self::Contact(two)) => Self::Contact(one.min(two)),
        }
    }
}

/// Travel of `footprint` along `course` until it first touches `point`.
///
/// `point`: body frame, metres. A point inside or on an edge gives `Contact(0)`; so does
/// anything not finite. On a full circle without contact: `Free`.
/// # Bound
/// O(1), no loop.
/// # Source
/// Loh 4.8–4.10 with |R|/r; R = 0 and R = ∞ by rules of their own.
pub fn arc_distance(footprint: &Footprint, course: Course, point: Point) -> Clearance {
    let finite = point.iter().all(|value| value.is_finite());
    let (Some(track), true, true) = (Track::of(course), finite, footprint.is_valid()) else {
        return Clearance::Contact(0.0);
    };
    match track {
        Track::Line { sense } => {
            let travel = line_travel(footprint, sense, point);
            if travel.is_finite() {
                Clearance::Contact(travel)
            } else {
                Clearance::Free
            }
        }
        Track::Circle(circle) => {
            let (least, largest) = footprint.annulus_m(circle.centre_y);
            let [x, y] = point;
            let across = y - circle.centre_y;
            let radius = libm::sqrt(x * x + across * across);
            if radius < least - TOUCH_M || radius > largest + TOUCH_M {
                return Clearance::Free;
            }
            circle.travel(turn_key(footprint, circle, point))
        }
    }
}

/// Travel until the first contact with any of `points` (Loh 4.7).
/// # Bound
/// O(points).
pub fn clearance(
    footprint: &Footprint,
    course: Course,
    points: impl IntoIterator<Item = Point>,
) -> Clearance {
    points.into_iter().fold(Clearance::Free, |nearest, point| {
        nearest.nearer(arc_distance(footprint, course, point))
    })
}

/// A course as the computation needs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Track {
    /// Straight on; `sense` is +1 forward, −1 in reverse.
    Line { sense: f64 },
    /// Around a centre on the y axis.
    Circle(Circle),
}

/// A rotation of the robot around `(0, centre_y)`, body frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Circle {
    /// R, metres, left positive; zero on the spot.
    pub centre_y: f64,
    /// +1 when the robot turns counter-clockwise, −1 otherwise.
    pub sense: f64,
    /// Travel per radian: |R|, or 1 on the spot.
    pub per_radian: f64,
}

impl Track {
    /// `None` if the curvature is not finite.
    pub fn of(course: Course) -> Option<Self> {
        let (curvature, direction) = match course {
            Course::Spot(turn) => {
                let sense = if turn == Turn::Left { 1.0 } else { -1.0 };
                return Some(Self::Circle(Circle {
                    centre_y: 0.0,
                    sense,
                    per_radian: 1.0,
                }));
            }
            Course::Arc {
                curvature_per_m,
                direction,
            } => (curvature_per_m, direction),
        };
        let along = if direction == Direction::Forward {
            1.0
        } else {
            -1.0
        };
        if !curvature.is_finite() {
            return None;
        }
        if curvature.abs() < STRAIGHT_PER_M {
            return Some(Self::Line { sense: along });
        }
        let centre_y = 1.0 / curvature;
        Some(Self::Circle(Circle {
            centre_y,
            sense: along * curvature.signum(),
            per_radian: centre_y.abs(),
        }))
    }
}

impl Circle {
    /// The travel of a turn key.
    pub fn travel(self, key: f64) -> Clearance {
        if key.is_finite() {
            Clearance::Contact(self.per_radian * angle_of(key))
        } else {
            Clearance::Free
        }
    }

    /// The turn key of a travel; infinite from a full turn on.
    pub fn key_of(self, travel: f64) -> f64 {
        let angle = travel / self.per_radian;
        if angle.is_nan() || angle >= TAU {
            return f64::INFINITY;
        }
        let sine = libm::sin(angle / 2.0);
        if angle <= TAU / 2.0 {
            sine * sine
        } else {
            2.0 - sine * sine
        }
    }
}

/// Travel straight on until `point` is touched; infinite if never.
pub(super) fn line_travel(rect: &Footprint, sense: f64, point: Point) -> f64 {
    let [x, y] = point;
    if rect.contains(point) {
        return 0.0;
    }
    let beside = y > rect.left_m + TOUCH_M || y < -rect.right_m - TOUCH_M;
    let ahead = if sense > 0.0 {
        x - rect.front_m
    } else {
        -rect.rear_m - x
    };
    if beside || ahead < 0.0 {
        f64::INFINITY
    } else {
        ahead
    }
}

/// The angle θ in [0, 2π] whose key is given.
fn angle_of(key: f64) -> f64 {
    let half_sine = |square: f64| libm::asin(libm::sqrt(square.clamp(0.0, 1.0)));
    if key <= 1.0 {
        2.0 * half_sine(key)
    } else {
        TAU - 2.0 * half_sine(2.0 - key)
    }
}

/// The turn until `point` is touched as a key that grows with the angle θ; infinite if never.
///
/// sin²(θ/2) up to half a turn, 2 − sin²(θ/2) beyond: monotone, computed from the chord
/// without a transcendental function and without cancellation however large R is.
pub(super) fn turn_key(rect: &Footprint, circle: Circle, point: Point) -> f64 {
    if rect.contains(point) {
        return 0.0;
    }
    let [x, y] = point;
    let (centre, sense) = (circle.centre_y, circle.sense);
    let across = y - centre;
    // Each edge is entered at one of the circle's two intersections with its line only:
    // where the point's velocity sense·(y − R, −x) points inward.
    let at_x = |edge: f64, side: f64| {
        let square = (x - edge) * (x + edge) + across * across;
        let meets = centre + side * sense * libm::sqrt(square.max(0.0));
        let on_edge = meets <= rect.left_m + TOUCH_M && meets >= -rect.right_m - TOUCH_M;
        entry_key(circle, point, [edge, meets], square >= 0.0 && on_edge)
    };
    let at_y = |edge: f64, side: f64| {
        let square = x * x + (y - edge) * (y + edge - 2.0 * centre);
        let meets = side * sense * libm::sqrt(square.max(0.0));
        let on_edge = meets <= rect.front_m + TOUCH_M && meets >= -rect.rear_m - TOUCH_M;
        entry_key(circle, point, [meets, edge], square >= 0.0 && on_edge)
    };
    let front_rear = at_x(rect.front_m, -1.0).min(at_x(-rect.rear_m, 1.0));
    let left_right = at_y(rect.left_m, 1.0).min(at_y(-rect.right_m, -1.0));
    front_rear.min(left_right)
}

/// The key of the turn that brings `point` to `entry`; infinite unless it `exists`.
fn entry_key(circle: Circle, point: Point, entry: Point, exists: bool) -> f64 {
    if !exists {
        return f64::INFINITY;
    }
    let ([x, y], [entry_x, entry_y]) = (point, entry);
    let across = y - circle.centre_y;
    let (along_chord, across_chord) = (entry_x - x, entry_y - y);
    let chord = along_chord * along_chord + across_chord * across_chord;
    let key = chord / (4.0 * (x * x + across * across));
    if key.is_nan() {
        return 0.0;
    }
    // sin θ · r² from the chord: (point − centre) × (entry − point), turned against the robot.
    let sine = -circle.sense * (x * across_chord - across * along_chord);
    if sine >= 0.0 || chord <= TOUCH_M * TOUCH_M {
        key.min(1.0)
    } else {
        2.0 - key.min(1.0)
    }
}
