//! Courses and triggers against values worked out by hand.

use super::*;

fn body(course: Course, trigger: Trigger) -> Body {
    Body {
        name: "body".to_owned(),
        shape: Shape::Circle(0.25),
        home: Pose::new(2.0, 1.0, 0.0),
        invisible: false,
        trigger,
        course,
    }
}

fn near(pose: Pose, x: f64, y: f64) {
    assert!(
        (pose.x - x).abs() < 1e-12 && (pose.y - y).abs() < 1e-12,
        "{pose:?} is not at ({x}, {y})"
    );
}

#[test]
fn straight_course_waits_moves_and_ends() {
    let course = Course::Straight {
        velocity: [0.0, -1.0],
        for_s: 2.0,
    };
    let world = World::new(vec![body(course, Trigger::At(1.0))]);
    near(world.pose(0, 0.5), 2.0, 1.0);
    near(world.pose(0, 1.5), 2.0, 0.5);
    near(world.pose(0, 9.0), 2.0, -1.0);
}

#[test]
fn door_turns_about_its_hinge() {
    let course = Course::Turn {
        pivot: [1.0, 1.0],
        rate: 1.0,
        for_s: core::f64::consts::FRAC_PI_2,
    };
    let door = body(course, Trigger::At(0.0));
    near(door.pose_after(10.0), 1.0, 2.0);
    assert!((door.top_speed() - 1.25).abs() < 1e-12);
}

#[test]
fn way_points_interpolate_and_hold_at_the_end() {
    let course = Course::WayPoints(vec![[0.0, 2.0, 1.0], [2.0, 4.0, 1.0], [3.0, 4.0, 3.0]]);
    let walker = body(course, Trigger::At(0.0));
    near(walker.pose_after(1.0), 3.0, 1.0);
    near(walker.pose_after(2.5), 4.0, 2.0);
    near(walker.pose_after(9.0), 4.0, 3.0);
    assert!((walker.top_speed() - 2.0).abs() < 1e-12);
}

#[test]
fn robot_trigger_fires_once_with_its_delay() {
    let course = Course::Straight {
        velocity: [1.0, 0.0],
        for_s: 10.0,
    };
    let trigger = Trigger::RobotPasses {
        x_m: 3.0,
        delay_s: 0.5,
    };
    let mut world = World::new(vec![body(course, trigger)]);
    world.observe_robot(1.0, 2.9);
    near(world.pose(0, 5.0), 2.0, 1.0);
    world.observe_robot(2.0, 3.0);
    world.observe_robot(4.0, 3.5);
    near(world.pose(0, 2.5), 2.0, 1.0);
    near(world.pose(0, 3.5), 3.0, 1.0);
}
