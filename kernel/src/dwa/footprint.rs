//! The robot's outline as the planner sees it: a rectangle around the rotation centre.

/// A point in the body frame: x forward, y left, metres.
pub type Point = [f64; 2];

/// A rectangle in the body frame, given by its four distances from the rotation centre, metres.
///
/// Need not be symmetric, but contains the rotation centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// To the front edge.
    pub front_m: f64,
    /// To the rear edge.
    pub rear_m: f64,
    /// To the left edge.
    pub left_m: f64,
    /// To the right edge.
    pub right_m: f64,
}

impl Footprint {
    /// Whether all distances are finite, none is negative and the rectangle has an area.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let sides = [self.front_m, self.rear_m, self.left_m, self.right_m];
        sides.iter().all(|side| side.is_finite() && *side >= 0.0)
            && self.front_m + self.rear_m > 0.0
            && self.left_m + self.right_m > 0.0
    }

    /// The rectangle with every edge `margin_m` farther out. Its corners stay square.
    #[must_use]
    pub fn inflated(&self, margin_m: f64) -> Self {
        Self {
            front_m: self.front_m + margin_m,
            rear_m: self.rear_m + margin_m,
            left_m: self.left_m + margin_m,
            right_m: self.right_m + margin_m,
        }
    }

    /// Whether `point` lies inside or on an edge.
    #[must_use]
    pub fn contains(&self, point: Point) -> bool {
        self.outside_m(point) <= 0.0
    }

    /// The margin by which the rectangle must be inflated to reach `point`, metres.
    ///
    /// Negative inside; the maximum norm, since inflated corners stay square.
    #[must_use]
    pub fn outside_m(&self, [x, y]: Point) -> f64 {
        let along = (x - self.front_m).max(-self.rear_m - x);
        let across = (y - self.left_m).max(-self.right_m - y);
        along.max(across)
    }

    /// Squared distance of `point` from the rectangle, m²; zero inside.
    #[must_use]
    pub fn distance_squared(&self, [x, y]: Point) -> f64 {
        let along = (x - self.front_m).max(-self.rear_m - x).max(0.0);
        let across = (y - self.left_m).max(-self.right_m - y).max(0.0);
        along * along + across * across
    }

    /// Distance of the farthest corner from the rotation centre, metres.
    #[must_use]
    pub fn corner_m(&self) -> f64 {
        libm::hypot(self.front_m.max(self.rear_m), self.left_m.max(self.right_m))
    }

    /// Radius of the largest circle around the rotation centre inside the rectangle, metres.
    #[must_use]
    pub fn inscribed_m(&self) -> f64 {
        let along = self.front_m.min(self.rear_m);
        along.min(self.left_m.min(self.right_m))
    }

    /// Least and largest distance of the rectangle from `(0, centre_y)`, metres (Loh 4.8, 4.9).
    #[must_use]
    pub fn annulus_m(&self, centre_y: f64) -> (f64, f64) {
        let least = (centre_y - self.left_m)
            .max(-self.right_m - centre_y)
            .max(0.0);
        let across = (self.left_m - centre_y).max(self.right_m + centre_y);
        let along = self.front_m.max(self.rear_m);
        (least, libm::sqrt(along * along + across * across))
    }
}
