//! Whether a segment touches a rectangle: the one product-bearing test of the safety core.

use super::frame::PointMm;

/// An axis-parallel rectangle given by its distances from the origin of its own frame.
///
/// Any length unit; all callers use eighths of a millimetre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rect {
    /// Towards +x.
    pub front: i32,
    /// Towards −x (a positive number lies behind the origin).
    pub rear: i32,
    /// Towards +y.
    pub left: i32,
    /// Towards −y.
    pub right: i32,
}

impl Rect {
    /// The rectangle grown by `margin` on every side; saturates.
    #[must_use]
    pub const fn grown(self, margin: i32) -> Self {
        Self {
            front: self.front.saturating_add(margin),
            rear: self.rear.saturating_add(margin),
            left: self.left.saturating_add(margin),
            right: self.right.saturating_add(margin),
        }
    }

    /// Whether `point` lies inside or on the edge.
    #[must_use]
    pub const fn contains(&self, point: PointMm) -> bool {
        point.x <= self.front
            && point.x >= self.rear.saturating_neg()
            && point.y <= self.left
            && point.y >= self.right.saturating_neg()
    }

    /// Whether the closed segment from `a` to `b` touches the closed rectangle.
    ///
    /// Separating axes: the two sides and the normal of the segment. `a == b`
    /// is the point test. Exact while coordinates stay within ±2²⁹.
    /// # Bound
    /// O(1), no loop.
    #[must_use]
    pub fn touches(&self, a: PointMm, b: PointMm) -> bool {
        let (rear, right) = (self.rear.saturating_neg(), self.right.saturating_neg());
        let outside_x = (a.x > self.front && b.x > self.front) || (a.x < rear && b.x < rear);
        let outside_y = (a.y > self.left && b.y > self.left) || (a.y < right && b.y < right);
        if outside_x || outside_y {
            return false;
        }
        if self.contains(a) || self.contains(b) {
            return true;
        }
        // Signed areas of the four corners against the line; all on one side means apart.
        let (dx, dy) = (
            i64::from(b.x).saturating_sub(i64::from(a.x)),
            i64::from(b.y).saturating_sub(i64::from(a.y)),
        );
        let side = |x: i32, y: i32| {
            let along = i64::from(y).saturating_sub(i64::from(a.y));
            let across = i64::from(x).saturating_sub(i64::from(a.x));
            dx.saturating_mul(along)
                .saturating_sub(dy.saturating_mul(across))
        };
        let corners = [
            side(self.front, self.left),
            side(self.front, right),
            side(rear, self.left),
            side(rear, right),
        ];
        !(corners.iter().all(|&area| area > 0) || corners.iter().all(|&area| area < 0))
    }

    /// Squared distance from `point` to the rectangle; zero inside. Saturates.
    #[must_use]
    pub fn distance_squared(&self, point: PointMm) -> u64 {
        let beyond = |value: i32, high: i32, low: i32| -> u64 {
            let over = value
                .saturating_sub(high)
                .max(low.saturating_neg().saturating_sub(value))
                .max(0);
            u64::from(over.unsigned_abs())
        };
        let x = beyond(point.x, self.front, self.rear);
        let y = beyond(point.y, self.left, self.right);
        x.saturating_mul(x).saturating_add(y.saturating_mul(y))
    }
}

impl Rect {
    /// Squared distance from the segment `a`–`b` to the rectangle, rounded down; zero if they touch.
    ///
    /// Saturates like [`Rect::distance_squared`].
    #[must_use]
    pub fn segment_distance_squared(&self, a: PointMm, b: PointMm) -> u64 {
        if self.touches(a, b) {
            return 0;
        }
        let ends = self.distance_squared(a).min(self.distance_squared(b));
        let (rear, right) = (self.rear.saturating_neg(), self.right.saturating_neg());
        [
            (self.front, self.left),
            (self.front, right),
            (rear, self.left),
            (rear, right),
        ]
        .iter()
        .filter_map(|&(x, y)| above_segment(PointMm { x, y }, a, b))
        .fold(ends, u64::min)
    }
}

/// Squared distance from `point` to the line through `a` and `b`, rounded down, if its foot lies
/// between them.
fn above_segment(point: PointMm, a: PointMm, b: PointMm) -> Option<u64> {
    let minus = |p: PointMm, q: PointMm| {
        (
            i64::from(p.x).saturating_sub(i64::from(q.x)),
            i64::from(p.y).saturating_sub(i64::from(q.y)),
        )
    };
    let (dx, dy) = minus(b, a);
    let (px, py) = minus(point, a);
    let square = dx.saturating_mul(dx).saturating_add(dy.saturating_mul(dy));
    let foot = dx.saturating_mul(px).saturating_add(dy.saturating_mul(py));
    if foot <= 0 || foot >= square {
        return None;
    }
    let area = dx.saturating_mul(py).saturating_sub(dy.saturating_mul(px));
    let length = square.unsigned_abs().isqrt().saturating_add(1);
    let height = area.unsigned_abs().checked_div(length)?;
    Some(height.saturating_mul(height))
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECT: Rect = Rect {
        front: 60,
        rear: 40,
        left: 30,
        right: 20,
    };

    fn point(x: i32, y: i32) -> PointMm {
        PointMm { x, y }
    }

    #[test]
    fn edges_and_corners_count_as_touching() {
        assert!(RECT.touches(point(60, 30), point(60, 30)));
        assert!(RECT.touches(point(-40, -20), point(-100, -200)));
        assert!(!RECT.touches(point(61, 0), point(61, 0)));
        assert!(!RECT.touches(point(0, -21), point(0, -21)));
    }

    #[test]
    fn a_segment_through_the_middle_touches_although_its_ends_are_outside() {
        assert!(RECT.touches(point(-100, 5), point(100, 5)));
        assert!(RECT.touches(point(70, 0), point(0, 70)));
        assert!(!RECT.touches(point(95, 0), point(0, 95)));
    }

    #[test]
    fn a_long_segment_beside_a_corner_is_as_near_as_the_corner() {
        // The ends are far away; the line passes 10 in front of the front edge's corner.
        let distance = RECT.segment_distance_squared(point(70, -500), point(70, 500));
        assert!((81..=100).contains(&distance), "{distance}");
        assert_eq!(
            RECT.segment_distance_squared(point(50, -500), point(50, 500)),
            0
        );
        assert_eq!(
            RECT.segment_distance_squared(point(70, 10), point(80, 10)),
            100
        );
    }

    /// Against a brute-force walk along the segment, on a grid fine enough to be exact.
    #[test]
    fn agrees_with_walking_the_segment() {
        let mut touching = 0;
        for seed in 0..40_000_u32 {
            let draw = |salt: u32| {
                let mixed = seed
                    .wrapping_mul(747_796_405)
                    .wrapping_add(salt.wrapping_mul(2_891_336_453));
                ((mixed ^ (mixed >> 15)).wrapping_mul(2_246_822_519) >> 24).cast_signed() - 128
            };
            let (a, b) = (point(draw(1), draw(2)), point(draw(3), draw(4)));
            let walked = (0..=4096).any(|step| {
                let t = f64::from(step) / 4096.0;
                let x = f64::from(a.x) + t * f64::from(b.x - a.x);
                let y = f64::from(a.y) + t * f64::from(b.y - a.y);
                (-40.0..=60.0).contains(&x) && (-20.0..=30.0).contains(&y)
            });
            // Walking may miss a grazing touch, never invent one.
            if walked {
                touching += 1;
                assert!(RECT.touches(a, b), "{a:?} {b:?}");
            } else if RECT.touches(a, b) {
                assert!(!RECT.grown(-1).touches(a, b), "{a:?} {b:?}");
            }
        }
        assert!(touching > 1000);
    }
}
