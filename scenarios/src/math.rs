//! Plane geometry in metres and radians with the same bits on every machine.
//!
//! Sines come from `libm`, not from the system's mathematics library, because a scenario must give
//! the same bytes wherever it runs. Nothing here is shared with the kernel.

use core::f64::consts::{PI, TAU};

/// A pose: position in metres, heading in radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Position along x.
    pub x: f64,
    /// Position along y.
    pub y: f64,
    /// Heading, counter-clockwise; not wrapped.
    pub theta: f64,
}

impl Pose {
    /// The pose at this place with this heading.
    #[must_use]
    pub const fn new(x: f64, y: f64, theta: f64) -> Self {
        Self { x, y, theta }
    }

    /// Maps a point of this pose's frame into the parent frame.
    #[must_use]
    pub fn apply(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = sin_cos(self.theta);
        [self.x + cos * x - sin * y, self.y + sin * x + cos * y]
    }

    /// Maps a point of the parent frame into this pose's frame.
    #[must_use]
    pub fn apply_inverse(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = sin_cos(self.theta);
        let (dx, dy) = (x - self.x, y - self.y);
        [cos * dx + sin * dy, cos * dy - sin * dx]
    }

    /// The pose of a frame given in this pose's frame.
    #[must_use]
    pub fn then(&self, inner: Self) -> Self {
        let [x, y] = self.apply([inner.x, inner.y]);
        Self::new(x, y, self.theta + inner.theta)
    }

    /// Moves along an arc of constant body twist for `dt` seconds, in closed form.
    #[must_use]
    pub fn advance(&self, v_mps: f64, omega_radps: f64, dt_s: f64) -> Self {
        let turn = omega_radps * dt_s;
        let half = turn / 2.0;
        // sin(x)/x by its series where the quotient loses digits.
        let sinc = if half.abs() < 1e-4 {
            1.0 - half * half / 6.0
        } else {
            libm::sin(half) / half
        };
        let chord = v_mps * dt_s * sinc;
        let (sin, cos) = sin_cos(self.theta + half);
        Self::new(
            self.x + chord * cos,
            self.y + chord * sin,
            self.theta + turn,
        )
    }

    /// Linear interpolation, `part` from 0 (self) to 1 (other); headings are not wrapped.
    #[must_use]
    pub fn towards(&self, other: &Self, part: f64) -> Self {
        Self::new(
            self.x + (other.x - self.x) * part,
            self.y + (other.y - self.y) * part,
            self.theta + (other.theta - self.theta) * part,
        )
    }
}

/// Sine and cosine, portable to the last bit.
#[must_use]
pub fn sin_cos(angle: f64) -> (f64, f64) {
    (libm::sin(angle), libm::cos(angle))
}

/// The same angle in (−π, π].
#[must_use]
pub fn wrap(angle: f64) -> f64 {
    let wrapped = angle - TAU * libm::floor(angle / TAU + 0.5);
    if wrapped <= -PI { PI } else { wrapped }
}

/// Seconds of a count of microseconds.
#[must_use]
pub fn seconds(us: u64) -> f64 {
    us as f64 * 1e-6
}

/// Microseconds of a time in seconds, to the nearest; zero for anything below zero.
#[must_use]
pub fn microseconds(s: f64) -> u64 {
    let us = libm::round(s * 1e6);
    if us > 0.0 { us as u64 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn quarter_circle_ends_at_one_one() {
        let end = Pose::default().advance(1.0, 1.0, core::f64::consts::FRAC_PI_2);
        assert!(close(end.x, 1.0) && close(end.y, 1.0), "{end:?}");
    }

    #[test]
    fn series_and_quotient_meet() {
        let below = Pose::default().advance(1.0, 1.9e-4, 1.0);
        let above = Pose::default().advance(1.0, 2.1e-4, 1.0);
        assert!((below.y / above.y - 1.9 / 2.1).abs() < 1e-7);
    }

    #[test]
    fn inverse_undoes_apply() {
        let pose = Pose::new(1.0, -2.0, 2.5);
        let [x, y] = pose.apply_inverse(pose.apply([0.3, 0.7]));
        assert!(close(x, 0.3) && close(y, 0.7));
    }

    #[test]
    fn wrapping_keeps_half_a_turn_positive() {
        assert!(close(wrap(-PI), PI));
        assert!(close(wrap(3.0 * PI), PI));
        assert!(close(wrap(-0.5), -0.5));
    }
}
