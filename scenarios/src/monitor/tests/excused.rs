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
    bench.monitors.touch(Touch { t_s: 1.2, body: 0 }, &[]);
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
    let words = |moves: bool, seen_last: bool| {
        let mut bench = Bench::running(&robot);
        bench.monitors.claim = claim::Claim::new(&robot, vec!["box".to_owned()], vec![moves]);
        bench.tick(decision(Action::Pass, 0.01), |_| {});
        bench.tick(decision(Action::Pass, 0.01), |inputs| {
            if !seen_last {
                inputs.scans[0].bodies.fill(None);
            }
        });
        bench.monitors.touch(Touch { t_s: 1.2, body: 0 }, &[]);
        bench.monitors.finish()[0].violations[0].what.clone()
    };
    assert!(words(true, false).contains(OUT_OF_SIGHT));
    assert!(!words(true, true).contains(OUT_OF_SIGHT), "it was in sight");
    assert!(
        !words(false, false).contains(OUT_OF_SIGHT),
        "what stands is remembered"
    );
}
