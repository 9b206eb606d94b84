//! From the bodies of a scenario file to the world the engine moves.

use crate::file::value::floats;
use crate::file::{BoxBody, Circle, Material, Motion, Scenario, Wall};
use crate::math::Pose;
use crate::world::{Body, Course, Shape, Trigger, World};

/// The world of a scenario at time zero: walls, then boxes, then circles.
#[must_use]
pub fn populate(scenario: &Scenario) -> World {
    let walls = scenario
        .wall
        .iter()
        .enumerate()
        .map(|(i, wall)| line(i, wall.get_ref()));
    let boxes = scenario
        .boxes
        .iter()
        .enumerate()
        .map(|(i, body)| rectangle(i, body.get_ref()));
    let circles = scenario
        .circle
        .iter()
        .enumerate()
        .map(|(i, body)| disc(i, body.get_ref()));
    World::new(walls.chain(boxes).chain(circles).collect())
}

fn line(index: usize, wall: &Wall) -> Body {
    let (from, to) = (floats(wall.from_m), floats(wall.to_m));
    let middle = [(from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0];
    let half = [to[0] - middle[0], to[1] - middle[1]];
    body(
        named(wall.name.as_ref(), "wall", index),
        Shape::Segment([-half[0], -half[1]], half),
        Pose::new(middle[0], middle[1], 0.0),
        wall.material,
        wall.motion.as_ref().map(toml::Spanned::get_ref),
    )
}

fn rectangle(index: usize, rectangle: &BoxBody) -> Body {
    let [x, y] = floats(rectangle.center_m);
    let [length, width] = rectangle.size_m;
    body(
        named(rectangle.name.as_ref(), "box", index),
        Shape::Box([length.get() / 2.0, width.get() / 2.0]),
        Pose::new(x, y, rectangle.heading_deg.get().to_radians()),
        rectangle.material,
        rectangle.motion.as_ref().map(toml::Spanned::get_ref),
    )
}

fn disc(index: usize, circle: &Circle) -> Body {
    let [x, y] = floats(circle.center_m);
    body(
        named(circle.name.as_ref(), "circle", index),
        Shape::Circle(circle.radius_m.get()),
        Pose::new(x, y, 0.0),
        circle.material,
        circle.motion.as_ref().map(toml::Spanned::get_ref),
    )
}

fn named(name: Option<&String>, kind: &str, index: usize) -> String {
    name.cloned().unwrap_or_else(|| format!("{kind} {index}"))
}

fn body(
    name: String,
    shape: Shape,
    home: Pose,
    material: Material,
    motion: Option<&Motion>,
) -> Body {
    Body {
        name,
        shape,
        home,
        invisible: material == Material::Invisible,
        trigger: motion.map_or(Trigger::At(0.0), trigger),
        course: motion.map_or(Course::Still, course),
    }
}

fn trigger(motion: &Motion) -> Trigger {
    match motion.when_robot_passes_x_m {
        Some(x) => Trigger::RobotPasses {
            x_m: x.get(),
            delay_s: motion.delay_s.map_or(0.0, |v| v.get()),
        },
        None => Trigger::At(motion.from_s.map_or(0.0, |v| v.get())),
    }
}

fn course(motion: &Motion) -> Course {
    let for_s = motion.for_s.map_or(f64::INFINITY, |v| v.get());
    if let Some(velocity) = motion.velocity_mps {
        return Course::Straight {
            velocity: floats(velocity),
            for_s,
        };
    }
    if let (Some(rate), Some(pivot)) = (motion.turn_radps, motion.pivot_m) {
        return Course::Turn {
            pivot: floats(pivot),
            rate: rate.get(),
            for_s,
        };
    }
    let points = motion.way_points.iter().flatten();
    Course::WayPoints(
        points
            .map(|[t, x, y]| [t.get(), x.get(), y.get()])
            .collect(),
    )
}
