//! CLAIM names contacts of which the claim does not speak: violations all the same, but with their reason.

use super::*;
use Standing::{Moving, Rested, Still};

/// The words on touching a body, moving or not, that was so far away before.
fn words(robot: &Robot, moves: bool, before: &[(f64, Standing)]) -> String {
    let mut bench = Bench::running(robot);
    bench.monitors.claim = claim::Claim::new(robot, vec!["box".to_owned()], vec![moves]);
    bench.tick(decision(Action::Pass, 0.01), |_| {});
    for (distance_m, standing) in before {
        bench.monitors.stands(&[*distance_m], *standing);
    }
    let _ = bench.monitors.touch(touch(1.2), &[]);
    bench.monitors.finish()[0].violations[0].what.clone()
}

#[test]
fn claim_says_where_a_robot_rested_beside_the_body() {
    let still = robot();
    let mut moving = robot();
    moving.values.obstacle_speed_mps = 1.0;
    assert!(words(&still, false, &[(0.01, Rested), (0.01, Moving)]).contains(EXCUSED));
    for (before, why) in [
        (
            &[(0.5, Rested), (0.01, Moving)][..],
            "it came near while it moved",
        ),
        (
            &[(0.01, Rested), (0.5, Moving), (0.01, Moving)],
            "it was left behind",
        ),
        (&[(0.01, Still)], "it never rested there"),
        (
            &[(0.05, Rested), (0.0, Moving)],
            "it came nearer by more than the drive may be off",
        ),
    ] {
        assert!(!words(&still, false, before).contains(EXCUSED), "{why}");
    }
    assert!(
        !words(&moving, false, &[(0.01, Rested)]).contains(EXCUSED),
        "in a moving world"
    );
}

#[test]
fn claim_says_that_a_body_bumped_into_the_standing_robot() {
    let mut robot = robot();
    robot.values.obstacle_speed_mps = 1.0;
    assert!(words(&robot, true, &[(0.0, Still), (0.0, Moving)]).contains(BUMPED));
    for (moves, before, why) in [
        (true, &[(0.0, Moving)][..], "the robot bumped into it"),
        (true, &[(0.0, Still), (0.1, Moving)], "they came apart"),
        (false, &[(0.0, Still)], "what stands cannot bump"),
    ] {
        assert!(!words(&robot, moves, before).contains(BUMPED), "{why}");
    }
}

#[test]
fn claim_says_that_a_moving_body_had_gone_out_of_sight() {
    let mut robot = robot();
    robot.values.obstacle_speed_mps = 1.0;
    let words = |moves: bool, now: Option<f32>| {
        let mut bench = Bench::running(&robot);
        bench.monitors.claim = claim::Claim::new(&robot, vec!["box".to_owned()], vec![moves]);
        bench.tick(decision(Action::Pass, 0.01), |_| {});
        bench.tick(decision(Action::Pass, 0.01), |inputs| {
            if let Some(range_m) = now {
                inputs.scans[0].bodies.fill(None);
                inputs.scans[0].ranges_m.fill(range_m);
            }
        });
        let _ = bench.monitors.touch(touch(1.2), &[]);
        bench.monitors.finish()[0].violations[0].what.clone()
    };
    // It was returned 5 m away, all around.
    assert!(words(true, Some(6.0)).contains(OUT_OF_SIGHT));
    for (moves, now, why) in [
        (true, None, "it was in sight"),
        (true, Some(4.0), "nobody looked past the place it was in"),
        (false, Some(6.0), "what stands is remembered"),
    ] {
        assert!(!words(moves, now).contains(OUT_OF_SIGHT), "{why}");
    }
}

/// A touch with a body that can move and that no beam had returned.
fn unseen(stood: bool, standing: Standing) -> (Judged, u64) {
    let mut robot = robot();
    robot.values.obstacle_speed_mps = 1.0;
    let mut bench = Bench::running(&robot);
    bench.monitors.claim = claim::Claim::new(&robot, vec!["box".to_owned()], vec![true]);
    bench.tick(decision(Action::Pass, 0.01), |inputs| {
        inputs.scans[0].bodies.fill(None);
    });
    bench.monitors.stands(&[0.0], standing);
    let touch = Touch {
        stood,
        ..touch(1.2)
    };
    let judged = bench.monitors.touch(touch, &[]);
    (judged, bench.monitors.finish()[0].violation_count)
}

#[test]
fn claim_fires_for_unseen_bodies_that_stood_where_the_robot_drove() {
    let (came, count) = unseen(false, Moving);
    assert_eq!(
        (came.outside, count),
        (Some(UNSEEN), 0),
        "unseen space does not attack"
    );
    let (stood, count) = unseen(true, Moving);
    assert_eq!((stood.outside, count), (None, 1), "its place was unknown");
    let (bumped, count) = unseen(true, Still);
    assert_eq!(
        (bumped.outside, count),
        (Some(UNSEEN), 0),
        "it came to the standing robot"
    );
}

/// The robot goes on at half a metre a second: for 0.14 s, then another quarter of a metre.
#[test]
fn claim_fires_when_a_new_return_on_the_way_is_passed_over() {
    let robot = robot();
    let answered = |action: Action, bearing: usize, range_m: f32, covered: bool| {
        let mut bench = Bench::running(&robot);
        bench.tick(decision(action, 0.5), |inputs| {
            inputs.scans[0].ranges_m[bearing] = range_m;
            if !covered {
                // Odometry that ends before the scan does.
                inputs.odometry = None;
            }
        });
        let claim = &bench.monitors.finish()[0];
        claim.violation_count > 0
    };
    assert!(answered(Action::Pass, 270, 0.25, true), "ahead");
    assert!(!answered(Action::Brake, 270, 0.25, true), "it braked");
    assert!(
        !answered(Action::Pass, 270, 1.0, true),
        "beyond where it can stop"
    );
    assert!(!answered(Action::Pass, 450, 0.6, true), "beside it");
    assert!(
        !answered(Action::Pass, 270, 0.25, false),
        "not to be placed yet"
    );
}

#[test]
fn the_operators_word_explains_nothing_that_was_seen_since() {
    let robot = robot();
    let word = Broken {
        id: crate::assumption::START,
        what: String::new(),
        body: Some(0),
        from_s: 0.0,
    };
    // Returned from where the footprint is now, behind its front edge, or from elsewhere.
    for (range_m, explained) in [(0.05_f32, false), (5.0, true)] {
        let mut bench = Bench::running(&robot);
        bench.monitors.vouched(&[0]);
        bench.tick(decision(Action::Pass, 0.01), |inputs| {
            inputs.scans[0].ranges_m[270] = range_m;
        });
        let judged = bench
            .monitors
            .touch(touch(1.2), std::slice::from_ref(&word));
        assert_eq!(!judged.assumptions.is_empty(), explained, "{range_m}");
    }
}
