//! From metres to pixels: the one place that knows that y points up in the world and down on paper.

/// A world rectangle shown at a scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Least x and y shown, metres.
    pub min_m: [f64; 2],
    /// Largest x and y shown, metres.
    pub max_m: [f64; 2],
    /// Pixels per metre.
    pub scale: f64,
    /// Pixel of the upper left corner.
    pub origin: [f64; 2],
}

impl View {
    /// Shows all of `[min, max]` in a box at `origin` at most `size` pixels wide and high, scale kept.
    #[must_use]
    pub fn fit(min_m: [f64; 2], max_m: [f64; 2], origin: [f64; 2], size: [f64; 2]) -> Self {
        let width = (max_m[0] - min_m[0]).max(0.1);
        let height = (max_m[1] - min_m[1]).max(0.1);
        Self {
            min_m,
            max_m: [min_m[0] + width, min_m[1] + height],
            scale: (size[0] / width).min(size[1] / height),
            origin,
        }
    }

    /// Pixel of a world point.
    #[must_use]
    pub fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.origin[0] + (x - self.min_m[0]) * self.scale,
            self.origin[1] + (self.max_m[1] - y) * self.scale,
        ]
    }

    /// Pixels of many world points.
    #[must_use]
    pub fn all(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        points.iter().map(|point| self.at(*point)).collect()
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> [f64; 2] {
        [
            (self.max_m[0] - self.min_m[0]) * self.scale,
            (self.max_m[1] - self.min_m[1]) * self.scale,
        ]
    }
}

/// Smallest rectangle around points; `None` if there is no finite one.
#[must_use]
pub fn bounds(points: impl IntoIterator<Item = [f64; 2]>) -> Option<([f64; 2], [f64; 2])> {
    points
        .into_iter()
        .filter(|p| p[0].is_finite() && p[1].is_finite())
        .fold(None, |around, p| {
            let (min, max) = around.unwrap_or((p, p));
            Some((
                [min[0].min(p[0]), min[1].min(p[1])],
                [max[0].max(p[0]), max[1].max(p[1])],
            ))
        })
}

/// A pose in the plane: x, y in metres, heading in radians.
pub type Pose = [f64; 3];

/// A body-frame point seen from the world.
#[must_use]
pub fn transform([x, y, theta]: Pose, [px, py]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = theta.sin_cos();
    [x + cos * px - sin * py, y + sin * px + cos * py]
}

/// Outline of a rectangle given by front, rear, left, right from the rotation centre, in metres.
#[must_use]
pub fn outline(pose: Pose, [front, rear, left, right]: [f64; 4]) -> Vec<[f64; 2]> {
    [
        [front, left],
        [-rear, left],
        [-rear, -right],
        [front, -right],
    ]
    .iter()
    .map(|corner| transform(pose, *corner))
    .collect()
}

/// A round step for a scale bar or an axis: 1, 2 or 5 times a power of ten, about `span / parts`.
#[must_use]
pub fn round_step(span: f64, parts: f64) -> f64 {
    let raw = (span / parts).abs().max(1e-9);
    let power = 10f64.powf(raw.log10().floor());
    let lead = raw / power;
    let nice = if lead < 1.5 {
        1.0
    } else if lead < 3.5 {
        2.0
    } else if lead < 7.5 {
        5.0
    } else {
        10.0
    };
    nice * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn y_points_up() {
        let view = View::fit([0.0, 0.0], [10.0, 5.0], [0.0, 0.0], [100.0, 100.0]);
        let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9;
        assert!(near(view.at([0.0, 5.0]), [0.0, 0.0]));
        assert!(near(view.at([10.0, 0.0]), [100.0, 50.0]));
    }

    #[test]
    fn outline_turns_with_the_robot() {
        let corners = outline(
            [1.0, 1.0, std::f64::consts::FRAC_PI_2],
            [2.0, 1.0, 0.5, 0.5],
        );
        assert!((corners[0][0] - 0.5).abs() < 1e-12 && (corners[0][1] - 3.0).abs() < 1e-12);
    }

    #[test]
    fn steps_are_round() {
        assert!((round_step(10.0, 5.0) - 2.0).abs() < 1e-12);
        assert!((round_step(0.9, 4.0) - 0.2).abs() < 1e-12);
    }
}
