//! Exact distances between the footprint and every body, by `parry2d`: no code of the kernel.

use haltline_robots::Footprint;
use parry2d_f64::math::{Pose as ParryPose, Rot2, Vector};
use parry2d_f64::query;
use parry2d_f64::shape::{Ball, Cuboid, Segment, Shape as ParryShape};

use crate::math::{Pose, sin_cos};
use crate::world::{Shape, World};

/// The judge: the robot's rectangle and the outlines of all bodies.
pub struct Judge {
    footprint: Cuboid,
    centre: [f64; 2],
    shapes: Vec<Box<dyn ParryShape>>,
}

impl Judge {
    /// Prepares the outlines.
    #[must_use]
    pub fn new(footprint: &Footprint, world: &World) -> Self {
        let half = [
            (footprint.front_m + footprint.rear_m) / 2.0,
            (footprint.left_m + footprint.right_m) / 2.0,
        ];
        let shapes = world
            .bodies()
            .iter()
            .map(|body| outline(&body.shape))
            .collect();
        Self {
            footprint: Cuboid::new(Vector::new(half[0], half[1])),
            centre: [
                (footprint.front_m - footprint.rear_m) / 2.0,
                (footprint.left_m - footprint.right_m) / 2.0,
            ],
            shapes,
        }
    }

    /// Distance from a point to each body at `t_s`.
    #[must_use]
    pub fn distances_from(&self, world: &World, point: [f64; 2], t_s: f64) -> Vec<f64> {
        let dot = isometry(&Pose::new(point[0], point[1], 0.0));
        self.shapes
            .iter()
            .enumerate()
            .map(|(index, shape)| {
                let body = isometry(&world.pose(index, t_s));
                query::distance(&dot, &Ball::new(0.0), &body, shape.as_ref())
                    .map_or(0.0, |found| found.distance)
            })
            .collect()
    }

    /// Distance from the footprint at `robot` to a point; zero inside.
    #[must_use]
    pub fn distance_to(&self, point: [f64; 2], robot: &Pose) -> f64 {
        let middle = robot.then(Pose::new(self.centre[0], self.centre[1], 0.0));
        let dot = isometry(&Pose::new(point[0], point[1], 0.0));
        query::distance(&isometry(&middle), &self.footprint, &dot, &Ball::new(0.0))
            .map_or(0.0, |found| found.distance)
    }

    /// Distance from the footprint at `robot` to each body at `t_s`; zero means contact.
    #[must_use]
    pub fn distances(&self, world: &World, robot: &Pose, t_s: f64) -> Vec<f64> {
        let middle = robot.then(Pose::new(self.centre[0], self.centre[1], 0.0));
        let robot = isometry(&middle);
        self.shapes
            .iter()
            .enumerate()
            .map(|(index, shape)| {
                let body = isometry(&world.pose(index, t_s));
                // Every pair used here is supported; were one not, calling it a contact is safe.
                query::distance(&robot, &self.footprint, &body, shape.as_ref())
                    .map_or(0.0, |found| found.distance)
            })
            .collect()
    }
}

fn outline(shape: &Shape) -> Box<dyn ParryShape> {
    match shape {
        Shape::Segment(a, b) => Box::new(Segment::new(
            Vector::new(a[0], a[1]),
            Vector::new(b[0], b[1]),
        )),
        Shape::Box(half) => Box::new(Cuboid::new(Vector::new(half[0], half[1]))),
        Shape::Circle(radius) => Box::new(Ball::new(*radius)),
    }
}

fn isometry(pose: &Pose) -> ParryPose {
    // The rotation comes from portable sines, so that clearances have the same bits everywhere.
    let (sin, cos) = sin_cos(pose.theta);
    let rotation = Rot2::from_cos_sin_unchecked(cos, sin);
    ParryPose::from_parts(Vector::new(pose.x, pose.y), rotation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Body, Course, Trigger};

    const JUNIOR: Footprint = Footprint {
        front_m: 0.7,
        rear_m: 0.5,
        left_m: 0.42,
        right_m: 0.42,
    };

    fn distance(shape: Shape, home: Pose, robot: Pose) -> f64 {
        let body = Body {
            name: String::new(),
            shape,
            home,
            invisible: true,
            trigger: Trigger::At(0.0),
            course: Course::Still,
        };
        let world = World::new(vec![body]);
        Judge::new(&JUNIOR, &world).distances(&world, &robot, 0.0)[0]
    }

    fn is(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-9, "{found} != {expected}");
    }

    #[test]
    fn front_and_rear_edges_are_not_mixed_up() {
        let wall = Shape::Segment([0.0, -1.0], [0.0, 1.0]);
        let robot = Pose::default();
        is(distance(wall, Pose::new(1.0, 0.0, 0.0), robot), 0.3);
        is(distance(wall, Pose::new(-1.0, 0.0, 0.0), robot), 0.5);
    }

    #[test]
    fn touching_is_contact_and_a_micrometre_is_not() {
        let wall = Shape::Segment([0.0, -1.0], [0.0, 1.0]);
        let robot = Pose::default();
        is(distance(wall, Pose::new(0.7, 0.0, 0.0), robot), 0.0);
        let apart = distance(wall, Pose::new(0.700_001, 0.0, 0.0), robot);
        assert!(apart > 0.9e-6, "{apart}");
    }

    #[test]
    fn segment_wholly_inside_is_contact() {
        let stick = Shape::Segment([-0.01, 0.0], [0.01, 0.0]);
        is(
            distance(stick, Pose::new(0.2, 0.1, 0.3), Pose::default()),
            0.0,
        );
        is(
            distance(Shape::Circle(0.01), Pose::default(), Pose::default()),
            0.0,
        );
    }

    #[test]
    fn corner_of_a_turned_robot_by_hand() {
        // Turned by 90 degrees the front edge lies at y = 0.7, its corners at x = -+0.42.
        let robot = Pose::new(0.0, 0.0, core::f64::consts::FRAC_PI_2);
        let pole = Shape::Circle(0.1);
        let at = Pose::new(0.42 + 0.3, 0.7 + 0.4, 0.0);
        is(distance(pole, at, robot), 0.4);
    }
}
