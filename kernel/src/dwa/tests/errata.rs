//! Equations as printed in Loh 2018, and the properties that only the corrected ones have.

use super::super::margin::stop;
use super::super::objective::{clear, vel};
use super::*;

/// The critical area as printed (4.2), in our axes: x forward.
fn printed_4_2(point: Point, front_m: f64, eps_front_m: f64) -> bool {
    point[0] < front_m + eps_front_m
}

/// The corrected one: ahead, and within the width.
fn corrected_4_2(point: Point, foot: &Footprint, eps_m: f64, eps_front_m: f64) -> bool {
    let [x, y] = point;
    x > 0.0
        && x < foot.front_m + eps_front_m
        && y < foot.left_m + eps_m
        && y > -foot.right_m - eps_m
}

#[test]
fn printed_4_2_stops_for_what_lies_behind() {
    let behind = [-5.0, 0.0];
    let beside = [0.3, 8.0];
    let ahead = [0.8, 0.1];
    for harmless in [behind, beside] {
        assert!(printed_4_2(harmless, SEEKUR.front_m, 0.3));
        assert!(!corrected_4_2(harmless, &SEEKUR, 0.05, 0.3));
        // The planner has no such rule of its own: nothing of this keeps it from driving.
        let plan = plan(
            &seekur(Velocity::default(), [5.0, 0.0]),
            obstacles(&[harmless]),
        );
        assert_eq!(plan.outcome, Outcome::Moving);
    }
    assert!(printed_4_2(ahead, SEEKUR.front_m, 0.3));
    assert!(corrected_4_2(ahead, &SEEKUR, 0.05, 0.3));
}

/// The admissible pairs as printed (4.5).
fn printed_4_5(velocity: Velocity, dist_m: f64, limits: &Limits) -> bool {
    velocity.linear_mps <= (2.0 * dist_m * limits.braking_mps2).sqrt()
        && velocity.angular_radps <= (2.0 * dist_m * limits.angular_braking_radps2).sqrt()
}

fn corrected_4_5(velocity: Velocity, dist_m: f64, limits: &Limits) -> bool {
    stop(limits, velocity).travel <= dist_m
}

/// Where the robot comes to rest: both rates ramp down together after the reaction time.
fn simulated_stop_m(velocity: Velocity, limits: &Limits) -> f64 {
    let ramp = (velocity.linear_mps / limits.braking_mps2)
        .max(velocity.angular_radps.abs() / limits.angular_braking_radps2);
    let (mut time, mut travel) = (0.0, 0.0);
    let step = 1e-5;
    while time < limits.reaction_s + ramp {
        let part = 1.0 - ((time - limits.reaction_s) / ramp).max(0.0);
        travel += velocity.linear_mps * part * step;
        time += step;
    }
    travel
}

#[test]
fn printed_4_5_admits_what_cannot_stop_in_time() {
    let limits = seekur_limits();
    let mut random = Random(0x5eed_0004);
    let mut printed_faults = 0;
    for _ in 0..100 {
        let velocity = Velocity {
            linear_mps: random.between(0.05, 1.2),
            angular_radps: random.between(-1.4, 1.4),
        };
        let needed = simulated_stop_m(velocity, &limits);
        let dist = needed * random.between(0.5, 1.5);
        if printed_4_5(velocity, dist, &limits) && needed > dist {
            printed_faults += 1;
        }
        if (dist - needed).abs() > 1e-3 {
            assert_eq!(corrected_4_5(velocity, dist, &limits), needed < dist);
        }
    }
    assert!(printed_faults > 10, "{printed_faults}");
}

#[test]
fn printed_4_5_takes_metres_for_radians() {
    let limits = Limits {
        reaction_s: 1e-9,
        ..seekur_limits()
    };
    // R = 4 m, 1 m of way left: the robot may turn by 0.25 rad only.
    let velocity = Velocity {
        linear_mps: 0.3,
        angular_radps: 0.075,
    };
    assert!(corrected_4_5(velocity, 1.0, &limits));
    // R = 0.1 m, 0.1 m of way left is a whole radian: the print forbids what stops in time.
    let tight = Velocity {
        linear_mps: 0.08,
        angular_radps: 0.8,
    };
    assert!(!printed_4_5(tight, 0.1, &limits));
    assert!(corrected_4_5(tight, 0.1, &limits));
    // A negative turn rate passes the print whatever its size.
    let right = Velocity {
        linear_mps: 0.01,
        angular_radps: -1.4,
    };
    assert!(printed_4_5(right, 1e-3, &limits));
    assert!(!corrected_4_5(right, 1e-3, &limits));
}

/// Arc as printed (4.10): R/r times the point's own arc, here from the corrected angle.
fn printed_4_10(signed_radius: f64, point: Point, corrected: Clearance) -> f64 {
    let Clearance::Contact(travel) = corrected else {
        panic!("the case must touch")
    };
    let angle = travel / signed_radius.abs();
    let radius = (point[0]).hypot(point[1] - signed_radius);
    signed_radius / radius * (angle * radius)
}

#[test]
fn printed_4_10_is_negative_on_one_side_and_nothing_on_the_spot() {
    let point = [1.5, -0.6];
    let right = Course::Arc {
        curvature_per_m: -0.8,
        direction: Direction::Forward,
    };
    let corrected = arc_distance(&SEEKUR, right, point);
    assert!(printed_4_10(-1.0 / 0.8, point, corrected) < 0.0);
    assert!(matches!(corrected, Clearance::Contact(travel) if travel > 0.0));
    // Mirrored, the answer is the same.
    let left = Course::Arc {
        curvature_per_m: 0.8,
        direction: Direction::Forward,
    };
    assert_eq!(arc_distance(&SEEKUR, left, [1.5, 0.6]), corrected);
    // R = 0: the print gives no way at all, whatever the angle; the angle counts.
    let beside = [0.0, 0.7];
    let spot = arc_distance(&SEEKUR, Course::Spot(Turn::Left), beside);
    let Clearance::Contact(angle) = spot else {
        panic!("the front left corner must touch")
    };
    // The circle of radius 0.7 meets the left edge 0.56 ahead of the centre.
    assert!((angle - 0.56_f64.atan2(0.42)).abs() < 1e-9, "{angle}");
    assert!(0.0 / 0.7 * (angle * 0.7) < angle);
    // R = ∞: infinity over infinity.
    assert!((f64::INFINITY / f64::INFINITY).is_nan());
    let straight = Course::Arc {
        curvature_per_m: 0.0,
        direction: Direction::Forward,
    };
    assert_eq!(
        arc_distance(&SEEKUR, straight, [2.0, 0.1]),
        Clearance::Contact(1.4)
    );
}

/// Clearance as printed (A.4): metres.
fn printed_a_4(near_m: f64) -> f64 {
    near_m
}

#[test]
fn printed_a_4_is_not_a_part_of_one() {
    let situation = seekur(Velocity::default(), [5.0, 0.0]);
    for near_m in [0.0, 0.42, 0.9, 3.0, 40.0] {
        assert!((0.0..=1.0).contains(&clear(&situation, [near_m; 3])));
    }
    assert!(printed_a_4(3.0) > 1.0);
    assert!(clear(&situation, [0.9; 3]) > clear(&situation, [0.6; 3]));
}

/// Speed term as printed (A.5).
fn printed_a_5(speed_mps: f64, speed_max_mps: f64, near_goal: bool) -> f64 {
    if near_goal {
        speed_mps / speed_max_mps
    } else {
        (1.0 - speed_mps) / speed_max_mps
    }
}

/// Fast is better far from the goal, slow is better near it, and both lie in [0, 1].
fn rewards_rightly(term: fn(f64, f64, bool) -> f64, speed_max_mps: f64) -> [bool; 3] {
    let (slow, fast) = (0.1 * speed_max_mps, 0.9 * speed_max_mps);
    let inside = [slow, fast].iter().all(|&speed| {
        [true, false]
            .iter()
            .all(|&near| (0.0..=1.0).contains(&term(speed, speed_max_mps, near)))
    });
    [
        term(fast, speed_max_mps, false) > term(slow, speed_max_mps, false),
        term(slow, speed_max_mps, true) > term(fast, speed_max_mps, true),
        inside,
    ]
}

#[test]
fn printed_a_5_rewards_standing_still_far_away() {
    assert_eq!(rewards_rightly(vel, 0.5), [true; 3]);
    assert_eq!(rewards_rightly(vel, 1.2), [true; 3]);
    assert_eq!(rewards_rightly(printed_a_5, 0.5), [false; 3]);
    assert_eq!(rewards_rightly(printed_a_5, 1.2), [false; 3]);
}
