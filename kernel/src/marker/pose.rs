//! Poses and motions in the plane. It refuses nothing: its callers check what they pass.

use super::linear::Matrix;
use core::f64::consts::{PI, TAU};

/// A pose in the plane: of a frame, given in another one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose2 {
    /// Position along x, m.
    pub x_m: f64,
    /// Position along y, m.
    pub y_m: f64,
    /// Heading, counter-clockwise, rad.
    pub heading_rad: f64,
}

impl Pose2 {
    /// The pose at this place with this heading.
    #[must_use]
    pub const fn new(x_m: f64, y_m: f64, heading_rad: f64) -> Self {
        Self {
            x_m,
            y_m,
            heading_rad,
        }
    }

    /// The pose in the parent frame of `inner`, which is given in this pose's frame.
    #[must_use]
    pub fn then(&self, inner: &Self) -> Self {
        let (sin, cos) = sin_cos(self.heading_rad);
        Self {
            x_m: self.x_m + cos * inner.x_m - sin * inner.y_m,
            y_m: self.y_m + sin * inner.x_m + cos * inner.y_m,
            heading_rad: wrap(self.heading_rad + inner.heading_rad),
        }
    }

    /// `other` as seen from this pose; both given in the same frame.
    ///
    /// # Source
    /// Loh 3.6.
    #[must_use]
    pub fn sees(&self, other: &Self) -> Self {
        let (sin, cos) = sin_cos(self.heading_rad);
        let (dx, dy) = (other.x_m - self.x_m, other.y_m - self.y_m);
        Self {
            x_m: cos * dx + sin * dy,
            y_m: cos * dy - sin * dx,
            heading_rad: wrap(other.heading_rad - self.heading_rad),
        }
    }

    /// Distance between the two positions, m.
    #[must_use]
    pub fn distance_m(&self, other: &Self) -> f64 {
        libm::hypot(other.x_m - self.x_m, other.y_m - self.y_m)
    }

    /// Rotation by the heading, with a third row and column that change nothing.
    pub(super) fn rotation(&self) -> Matrix {
        let (sin, cos) = sin_cos(self.heading_rad);
        [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]
    }

    /// Whether all three numbers are finite and the position lies within `limit_m` on each axis.
    pub(super) fn is_within(&self, limit_m: f64) -> bool {
        self.x_m.abs() <= limit_m && self.y_m.abs() <= limit_m && self.heading_rad.is_finite()
    }

    /// As a vector [x, y, heading].
    pub(super) const fn as_vector(&self) -> [f64; 3] {
        [self.x_m, self.y_m, self.heading_rad]
    }

    /// Moved by `correction` = [x, y, heading], in the frame in which this pose is given.
    pub(super) fn corrected(&self, correction: [f64; 3]) -> Self {
        Self {
            x_m: self.x_m + correction[0],
            y_m: self.y_m + correction[1],
            heading_rad: wrap(self.heading_rad + correction[2]),
        }
    }
}

/// Motion since the last odometry sample: the new pose in the frame of the old one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Increment {
    /// Along the old heading, m.
    pub forward_m: f64,
    /// To the left of the old heading, m.
    pub left_m: f64,
    /// Turn, counter-clockwise, rad.
    pub turn_rad: f64,
}

impl Increment {
    /// An arc of this length and this turn: what wheels of constant speed do (REP 103).
    ///
    /// # Source
    /// Loh 3.7; 3.5 drives straight and turns afterwards.
    #[must_use]
    pub fn arc(distance_m: f64, turn_rad: f64) -> Self {
        let half = turn_rad / 2.0;
        let (sin, cos) = sin_cos(half);
        // sin(x)/x by its series where the quotient loses digits.
        let sinc = if half.abs() < 1e-4 {
            1.0 - half * half / 6.0
        } else {
            sin / half
        };
        Self {
            forward_m: distance_m * sinc * cos,
            left_m: distance_m * sinc * sin,
            turn_rad,
        }
    }

    /// Motion from one odometry pose to the next; both in the odometry frame.
    #[must_use]
    pub fn between(earlier: &Pose2, later: &Pose2) -> Self {
        let seen = earlier.sees(later);
        Self {
            forward_m: seen.x_m,
            left_m: seen.y_m,
            turn_rad: seen.heading_rad,
        }
    }

    pub(super) const fn as_pose(&self) -> Pose2 {
        Pose2::new(self.forward_m, self.left_m, self.turn_rad)
    }

    /// The same motion for `part` of its time, on the same arc up to third order in the turn.
    pub(super) fn scaled(&self, part: f64) -> Self {
        let (sin, cos) = sin_cos(self.turn_rad * (part - 1.0) / 2.0);
        Self {
            forward_m: (cos * self.forward_m - sin * self.left_m) * part,
            left_m: (sin * self.forward_m + cos * self.left_m) * part,
            turn_rad: self.turn_rad * part,
        }
    }
}

/// The same angle in (−π, π].
#[must_use]
pub fn wrap(angle_rad: f64) -> f64 {
    if angle_rad > -PI && angle_rad <= PI {
        return angle_rad;
    }
    let wrapped = angle_rad - TAU * libm::floor(angle_rad / TAU + 0.5);
    if wrapped <= -PI { PI } else { wrapped }
}

pub(super) fn sin_cos(angle_rad: f64) -> (f64, f64) {
    (libm::sin(angle_rad), libm::cos(angle_rad))
}
