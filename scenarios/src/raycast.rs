//! Where a beam ends: analytic casts against segments, boxes and discs.

use crate::math::{Pose, sin_cos};
use crate::world::{Shape, World};

/// A ray in the world: origin in metres, direction of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Origin.
    pub origin: [f64; 2],
    /// Unit direction.
    pub direction: [f64; 2],
}

impl Ray {
    /// From a place along a heading.
    #[must_use]
    pub fn new(origin: [f64; 2], heading: f64) -> Self {
        let (sin, cos) = sin_cos(heading);
        Self {
            origin,
            direction: [cos, sin],
        }
    }
}

/// First visible body along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Return {
    /// Distance, metres; zero if the origin lies inside the body.
    pub range: f64,
    /// Index of the body.
    pub body: usize,
}

/// The bodies in the order of their distance, so that a beam need not ask those behind its return.
#[derive(Clone, Debug)]
pub struct Order {
    /// Body, the least distance at which it may be met, the radius that holds it; nearest first.
    bodies: Vec<(usize, f64, f64)>,
}

impl Order {
    /// The visible bodies as seen from `origin` at time `t_s`; good for as long as neither they nor
    /// the origin have moved by more than `slack_m` against each other.
    #[must_use]
    pub fn new(world: &World, t_s: f64, origin: [f64; 2], slack_m: f64) -> Self {
        let visible = world.bodies().iter().enumerate();
        let mut bodies: Vec<_> = visible
            .filter(|(_, body)| !body.invisible)
            .map(|(index, body)| {
                let pose = world.pose(index, t_s);
                let away = libm::hypot(pose.x - origin[0], pose.y - origin[1]);
                let reach = body.shape.reach();
                (index, away - reach - slack_m, reach)
            })
            .collect();
        bodies.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        Self { bodies }
    }
}

/// Nearest return of `ray` at time `t_s` within `range_max`; invisible bodies let it through.
#[must_use]
pub fn cast(world: &World, t_s: f64, ray: &Ray, range_max: f64) -> Option<Return> {
    cast_in_order(
        world,
        t_s,
        ray,
        range_max,
        &Order::new(world, t_s, ray.origin, 0.0),
    )
}

/// The same with an order that is still good; of two returns at one distance the later body's counts.
#[must_use]
pub fn cast_in_order(
    world: &World,
    t_s: f64,
    ray: &Ray,
    range_max: f64,
    order: &Order,
) -> Option<Return> {
    let mut best: Option<Return> = None;
    for (index, near, reach) in &order.bodies {
        let limit = best.map_or(range_max, |hit| hit.range);
        if *near > limit {
            break;
        }
        let Some(body) = world.bodies().get(*index) else {
            continue;
        };
        let pose = world.pose(*index, t_s);
        if misses_bounds(ray, &pose, *reach, limit) {
            continue;
        }
        if let Some(range) = range_to(ray, &body.shape, &pose)
            && range <= limit
            && (range < limit || best.is_none_or(|hit| *index > hit.body))
        {
            best = Some(Return {
                range,
                body: *index,
            });
        }
    }
    best
}

/// Whether the disc of radius `reach` around the body's origin is out of the ray's way.
fn misses_bounds(ray: &Ray, pose: &Pose, reach: f64, limit: f64) -> bool {
    let [dx, dy] = [pose.x - ray.origin[0], pose.y - ray.origin[1]];
    let along = dx * ray.direction[0] + dy * ray.direction[1];
    let across = dx * ray.direction[1] - dy * ray.direction[0];
    across.abs() > reach || along < -reach || along > limit + reach
}

/// Distance along the ray to the shape; zero from inside, none if it is missed.
#[must_use]
pub fn range_to(ray: &Ray, shape: &Shape, pose: &Pose) -> Option<f64> {
    match shape {
        Shape::Segment(a, b) => segment(ray, pose.apply(*a), pose.apply(*b)),
        Shape::Box(half) => rectangle(ray, pose, *half),
        Shape::Circle(radius) => disc(ray, [pose.x, pose.y], *radius),
    }
}

fn segment(ray: &Ray, a: [f64; 2], b: [f64; 2]) -> Option<f64> {
    let [dx, dy] = ray.direction;
    let [ex, ey] = [b[0] - a[0], b[1] - a[1]];
    let [ox, oy] = [a[0] - ray.origin[0], a[1] - ray.origin[1]];
    let cross = dx * ey - dy * ex;
    // A wall seen exactly edge-on reflects nothing.
    if cross.abs() < 1e-15 {
        return None;
    }
    let range = (ox * ey - oy * ex) / cross;
    let part = (ox * dy - oy * dx) / cross;
    (range >= 0.0 && (0.0..=1.0).contains(&part)).then_some(range)
}

/// Slab test in the box's own frame.
fn rectangle(ray: &Ray, pose: &Pose, half: [f64; 2]) -> Option<f64> {
    let origin = pose.apply_inverse(ray.origin);
    let direction = Pose::new(0.0, 0.0, pose.theta).apply_inverse(ray.direction);
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for axis in [0, 1] {
        let (o, d, h) = match axis {
            0 => (origin[0], direction[0], half[0]),
            _ => (origin[1], direction[1], half[1]),
        };
        if d.abs() < 1e-15 {
            if o.abs() > h {
                return None;
            }
            continue;
        }
        let (near, far) = ((-h - o) / d, (h - o) / d);
        enter = enter.max(near.min(far));
        leave = leave.min(near.max(far));
    }
    (enter <= leave).then_some(enter)
}

fn disc(ray: &Ray, centre: [f64; 2], radius: f64) -> Option<f64> {
    let [dx, dy] = [centre[0] - ray.origin[0], centre[1] - ray.origin[1]];
    let along = dx * ray.direction[0] + dy * ray.direction[1];
    let outside = dx * dx + dy * dy - radius * radius;
    if outside <= 0.0 {
        return Some(0.0);
    }
    let discriminant = along * along - outside;
    (along >= 0.0 && discriminant >= 0.0).then(|| along - discriminant.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Body, Course, Trigger};
    use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    fn from_origin(heading: f64) -> Ray {
        Ray::new([0.0, 0.0], heading)
    }

    fn is(range: Option<f64>, expected: f64) {
        let range = range.expect("the ray hits");
        assert!((range - expected).abs() < 1e-12, "{range} != {expected}");
    }

    #[test]
    fn segment_by_hand() {
        let wall = Shape::Segment([2.0, -1.0], [2.0, 1.0]);
        let still = Pose::default();
        is(range_to(&from_origin(0.0), &wall, &still), 2.0);
        // 2 m ahead at 26.565 degrees is the end point (2, 1): distance sqrt(5).
        is(
            range_to(
                &from_origin(libm::atan2(0.9999999999999, 2.0)),
                &wall,
                &still,
            ),
            5.0_f64.sqrt(),
        );
        assert_eq!(range_to(&from_origin(FRAC_PI_4), &wall, &still), None);
        assert_eq!(range_to(&from_origin(PI), &wall, &still), None);
    }

    #[test]
    fn turned_box_shows_its_corner() {
        let square = Shape::Box([0.5, 0.5]);
        let pose = Pose::new(3.0, 0.0, FRAC_PI_4);
        is(
            range_to(&from_origin(0.0), &square, &pose),
            3.0 - 0.5_f64.sqrt(),
        );
        assert_eq!(range_to(&from_origin(FRAC_PI_2), &square, &pose), None);
        assert_eq!(range_to(&from_origin(PI), &square, &pose), None);
    }

    #[test]
    fn disc_by_hand_and_from_inside() {
        let pole = Shape::Circle(0.5);
        let pose = Pose::new(2.0, 0.3, 0.0);
        is(range_to(&from_origin(0.0), &pole, &pose), 2.0 - 0.4);
        is(range_to(&Ray::new([2.1, 0.3], 0.0), &pole, &pose), 0.0);
        assert_eq!(range_to(&Ray::new([2.6, 0.3], 0.0), &pole, &pose), None);
    }

    #[test]
    fn nearest_visible_body_wins() {
        let circle = |x: f64, invisible| Body {
            name: String::new(),
            shape: Shape::Circle(0.1),
            home: Pose::new(x, 0.0, 0.0),
            invisible,
            trigger: Trigger::At(0.0),
            course: Course::Still,
        };
        let world = World::new(vec![
            circle(5.0, false),
            circle(3.0, false),
            circle(1.0, true),
        ]);
        let hit = cast(&world, 0.0, &from_origin(0.0), 10.0).expect("a return");
        assert_eq!(hit.body, 1);
        is(Some(hit.range), 2.9);
        assert_eq!(cast(&world, 0.0, &from_origin(0.0), 2.0), None);
    }
}
