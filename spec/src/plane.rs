//! Poses, outlines and bodies in the plane, and the exact distance between them.
//!
//! SI units and radians throughout; frames as in REP 103 (x forward, y left).

use parry2d_f64::math::{Pose as Isometry, Vector};
use parry2d_f64::query;
use parry2d_f64::shape::{Ball, Cuboid, Segment, Shape};

/// Position in metres and heading in radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Along x, metres.
    pub x_m: f64,
    /// Along y, metres.
    pub y_m: f64,
    /// Counter-clockwise from x, radians.
    pub theta_rad: f64,
}

impl Pose {
    /// A pose from its three numbers (m, m, rad).
    #[must_use]
    pub const fn new(x_m: f64, y_m: f64, theta_rad: f64) -> Self {
        Self {
            x_m,
            y_m,
            theta_rad,
        }
    }

    /// The pose after the rotation centre moved `path_m` along its heading while turning by
    /// `turn_rad` at an even rate: the closed form of an arc.
    #[must_use]
    pub fn along_arc(self, path_m: f64, turn_rad: f64) -> Self {
        let half = turn_rad / 2.0;
        // sin(x)/x; the series is exact to 1e-17 below the switch.
        let sinc = if half.abs() < 1e-4 {
            1.0 - half * half / 6.0
        } else {
            half.sin() / half
        };
        let (sin, cos) = (self.theta_rad + half).sin_cos();
        Self {
            x_m: self.x_m + path_m * sinc * cos,
            y_m: self.y_m + path_m * sinc * sin,
            theta_rad: self.theta_rad + turn_rad,
        }
    }

    /// A point given in this pose's frame, in the frame this pose is given in.
    #[must_use]
    pub fn place(self, point: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.theta_rad.sin_cos();
        [
            self.x_m + cos * point[0] - sin * point[1],
            self.y_m + sin * point[0] + cos * point[1],
        ]
    }

    /// A point given in the frame this pose is given in, in this pose's own frame.
    #[must_use]
    pub fn enter(self, point: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.theta_rad.sin_cos();
        let (dx, dy) = (point[0] - self.x_m, point[1] - self.y_m);
        [cos * dx + sin * dy, -sin * dx + cos * dy]
    }

    fn isometry(self) -> Isometry {
        Isometry::new(Vector::new(self.x_m, self.y_m), self.theta_rad)
    }
}

/// A robot's outline: distances of the four edges from the rotation centre, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outline {
    /// To the front edge.
    pub front_m: f64,
    /// To the rear edge.
    pub rear_m: f64,
    /// To the left edge.
    pub left_m: f64,
    /// To the right edge.
    pub right_m: f64,
}

impl Outline {
    /// The corners in the robot's frame.
    #[must_use]
    pub fn corners(&self) -> [[f64; 2]; 4] {
        [
            [self.front_m, self.left_m],
            [-self.rear_m, self.left_m],
            [-self.rear_m, -self.right_m],
            [self.front_m, -self.right_m],
        ]
    }

    /// Distance of the farthest corner from the rotation centre, metres.
    #[must_use]
    pub fn rho_m(&self) -> f64 {
        self.front_m
            .max(self.rear_m)
            .hypot(self.left_m.max(self.right_m))
    }

    /// Whether a point of the robot's frame lies inside the outline grown by `margin_m`.
    #[must_use]
    pub fn contains(&self, point: [f64; 2], margin_m: f64) -> bool {
        point[0] <= self.front_m + margin_m
            && point[0] >= -self.rear_m - margin_m
            && point[1] <= self.left_m + margin_m
            && point[1] >= -self.right_m - margin_m
    }

    /// Distance of a point of the robot's frame from the outline; zero inside.
    #[must_use]
    pub fn distance_m(&self, point: [f64; 2]) -> f64 {
        let dx = (point[0] - self.front_m)
            .max(-self.rear_m - point[0])
            .max(0.0);
        let dy = (point[1] - self.left_m)
            .max(-self.right_m - point[1])
            .max(0.0);
        dx.hypot(dy)
    }

    /// Distance between the outline standing at `pose` and a segment, metres; 0 if they meet.
    ///
    /// `None` if the geometry library refuses the pair, which it never does.
    #[must_use]
    pub fn distance_to_segment_m(&self, pose: Pose, a: [f64; 2], b: [f64; 2]) -> Option<f64> {
        let (cuboid, centre) = self.cuboid();
        let [x_m, y_m] = pose.place(centre);
        let standing = Pose::new(x_m, y_m, pose.theta_rad).isometry();
        let segment = Segment::new(Vector::new(a[0], a[1]), Vector::new(b[0], b[1]));
        query::distance(&standing, &cuboid, &Pose::default().isometry(), &segment)
            .ok()
            .map(|found| found.distance)
    }

    fn cuboid(&self) -> (Cuboid, [f64; 2]) {
        let half = Vector::new(
            (self.front_m + self.rear_m) / 2.0,
            (self.left_m + self.right_m) / 2.0,
        );
        let centre = [
            (self.front_m - self.rear_m) / 2.0,
            (self.left_m - self.right_m) / 2.0,
        ];
        (Cuboid::new(half), centre)
    }
}

/// Shape of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// A disc.
    Disc {
        /// Radius, metres.
        radius_m: f64,
    },
    /// A rectangle around its pose.
    Box {
        /// Half its extent along its own x, metres.
        half_x_m: f64,
        /// Half its extent along its own y, metres.
        half_y_m: f64,
    },
}

/// Something the robot must not touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Its shape.
    pub form: Form,
    /// Where its centre is.
    pub pose: Pose,
}

impl Body {
    /// A disc at a place.
    #[must_use]
    pub const fn disc(x_m: f64, y_m: f64, radius_m: f64) -> Self {
        Self {
            form: Form::Disc { radius_m },
            pose: Pose::new(x_m, y_m, 0.0),
        }
    }

    /// A rectangle with its centre at `pose`.
    #[must_use]
    pub const fn rectangle(pose: Pose, half_x_m: f64, half_y_m: f64) -> Self {
        Self {
            form: Form::Box { half_x_m, half_y_m },
            pose,
        }
    }

    /// The same body moved by a displacement.
    #[must_use]
    pub fn moved(mut self, dx_m: f64, dy_m: f64) -> Self {
        self.pose.x_m += dx_m;
        self.pose.y_m += dy_m;
        self
    }

    /// Radius of a circle around its centre that contains it, metres.
    #[must_use]
    pub fn reach_m(&self) -> f64 {
        match self.form {
            Form::Disc { radius_m } => radius_m,
            Form::Box { half_x_m, half_y_m } => half_x_m.hypot(half_y_m),
        }
    }

    /// Distance between the body and an outline standing at `pose`, metres; 0 if they overlap.
    ///
    /// `None` if the geometry library refuses the pair, which for these shapes it never does.
    #[must_use]
    pub fn distance_m(&self, outline: &Outline, pose: Pose) -> Option<f64> {
        let (cuboid, centre) = outline.cuboid();
        let [x_m, y_m] = pose.place(centre);
        let standing = Pose::new(x_m, y_m, pose.theta_rad).isometry();
        let (ball, rectangle);
        let shape: &dyn Shape = match self.form {
            Form::Disc { radius_m } => {
                ball = Ball::new(radius_m);
                &ball
            }
            Form::Box { half_x_m, half_y_m } => {
                rectangle = Cuboid::new(Vector::new(half_x_m, half_y_m));
                &rectangle
            }
        };
        query::distance(&standing, &cuboid, &self.pose.isometry(), shape)
            .ok()
            .map(|found| found.distance)
    }

    /// Distance along a ray from `origin` in direction `angle_rad` to the body, metres;
    /// 0 if the origin is inside, `None` if the ray misses.
    #[must_use]
    pub fn range_m(&self, origin: [f64; 2], angle_rad: f64) -> Option<f64> {
        let from = self.pose.enter(origin);
        let (sin, cos) = (angle_rad - self.pose.theta_rad).sin_cos();
        match self.form {
            Form::Disc { radius_m } => ray_disc(from, [cos, sin], radius_m),
            Form::Box { half_x_m, half_y_m } => ray_box(from, [cos, sin], [half_x_m, half_y_m]),
        }
    }
}

/// First crossing of a ray with a disc around the origin.
fn ray_disc(from: [f64; 2], along: [f64; 2], radius_m: f64) -> Option<f64> {
    let gap = from[0].hypot(from[1]) - radius_m;
    if gap <= 0.0 {
        return Some(0.0);
    }
    let nearest = -(from[0] * along[0] + from[1] * along[1]);
    let aside = from[0] * along[1] - from[1] * along[0];
    let inside = radius_m * radius_m - aside * aside;
    (nearest > 0.0 && inside >= 0.0).then(|| nearest - inside.sqrt())
}

/// First crossing of a ray with an axis-parallel box around the origin (slab method).
fn ray_box(from: [f64; 2], along: [f64; 2], half: [f64; 2]) -> Option<f64> {
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for axis in 0..2 {
        if along[axis].abs() < 1e-12 {
            if from[axis].abs() > half[axis] {
                return None;
            }
            continue;
        }
        let one = (-half[axis] - from[axis]) / along[axis];
        let two = (half[axis] - from[axis]) / along[axis];
        enter = enter.max(one.min(two));
        leave = leave.min(one.max(two));
    }
    (enter <= leave).then_some(enter)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Draw;
    use parry2d_f64::query::{Ray, RayCast};

    #[test]
    fn arcs_agree_with_tiny_steps() {
        let mut draw = Draw::new(1);
        for _ in 0..200 {
            let start = Pose::new(draw.unit(), draw.unit(), draw.between(-3.0, 3.0));
            let (path, turn) = (draw.between(-1.0, 1.0), draw.between(-2.0, 2.0));
            let exact = start.along_arc(path, turn);
            let mut pose = start;
            for _ in 0..10_000 {
                let middle = pose.theta_rad + turn / 20_000.0;
                pose.x_m += path / 1e4 * middle.cos();
                pose.y_m += path / 1e4 * middle.sin();
                pose.theta_rad += turn / 1e4;
            }
            assert!((pose.x_m - exact.x_m).hypot(pose.y_m - exact.y_m) < 1e-7);
            assert!((pose.theta_rad - exact.theta_rad).abs() < 1e-9);
        }
    }

    #[test]
    fn rays_agree_with_parry() {
        let mut draw = Draw::new(2);
        let mut hits = 0;
        for _ in 0..20_000 {
            let pose = Pose::new(
                draw.between(-2.0, 2.0),
                draw.between(-2.0, 2.0),
                draw.between(-3.0, 3.0),
            );
            let (a, b) = (draw.between(0.05, 1.0), draw.between(0.05, 1.0));
            let angle = draw.between(-4.0, 4.0);
            let ray = Ray::new(Vector::new(0.0, 0.0), Vector::new(angle.cos(), angle.sin()));
            let (disc, cuboid) = (Ball::new(a), Cuboid::new(Vector::new(a, b)));
            let round = Body::disc(pose.x_m, pose.y_m, a).range_m([0.0, 0.0], angle);
            let square = Body::rectangle(pose, a, b).range_m([0.0, 0.0], angle);
            for (ours, theirs) in [
                (round, disc.cast_ray(&pose.isometry(), &ray, 1e9, true)),
                (square, cuboid.cast_ray(&pose.isometry(), &ray, 1e9, true)),
            ] {
                match (ours, theirs) {
                    (Some(one), Some(two)) => {
                        hits += 1;
                        assert!((one - two).abs() < 1e-6, "{one} {two}");
                    }
                    (None, None) => {}
                    // Grazing rays may differ in the last digit.
                    _ => assert!(
                        grazes(&Body::rectangle(pose, a, b), angle)
                            || grazes(&Body::disc(pose.x_m, pose.y_m, a), angle)
                    ),
                }
            }
        }
        assert!(hits > 1000);
    }

    fn grazes(body: &Body, angle: f64) -> bool {
        [-1e-6, 1e-6]
            .map(|d| body.range_m([0.0, 0.0], angle + d).is_some())
            .windows(2)
            .any(|pair| pair[0] != pair[1])
    }

    #[test]
    fn distance_of_point_like_body_is_the_outlines_own() {
        let outline = Outline {
            front_m: 0.7,
            rear_m: 0.2,
            left_m: 0.3,
            right_m: 0.5,
        };
        let mut draw = Draw::new(3);
        for _ in 0..2000 {
            let pose = Pose::new(draw.unit(), draw.unit(), draw.between(-3.0, 3.0));
            let point = [draw.between(-2.0, 2.0), draw.between(-2.0, 2.0)];
            let body = Body::disc(point[0], point[1], 1e-9);
            let theirs = body.distance_m(&outline, pose).unwrap();
            assert!((outline.distance_m(pose.enter(point)) - theirs).abs() < 1e-6);
        }
    }
}
