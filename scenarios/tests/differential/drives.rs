//! Drives and hosts that do not do what is assumed.

use crate::driving;
use crate::simulated::{case, touches};
use haltline::decision::{Action, Reason};
use haltline_scenarios::batch::{run_case, run_one};
use haltline_scenarios::file::Silence;
use haltline_scenarios::result::Outcome;

/// Autoware AEB computes with a deceleration that the vehicle need not have, says its README, and does not look
/// whether it brakes.
#[test]
fn brakes_that_do_not_work_are_noticed() {
    let mut room = driving(0.8);
    room.x.1 = room.pose[0] + 0.6 + 0.7;
    let mut reasons = Vec::new();
    for _ in 0..20 {
        let _ = room.tick(Some((0.8, 0.0)), false);
        // The drive goes on as fast as before.
        room.twist = [0.8, 0.0];
        reasons.push(room.tick(Some((0.8, 0.0)), false));
        room.twist = [0.8, 0.0];
        room.x.1 = room.x.1.max(room.pose[0] + 0.7);
    }
    assert!(
        reasons.iter().any(|d| d.reason == Reason::DriveMismatch),
        "{:?}",
        reasons.iter().map(|d| d.reason).collect::<Vec<_>>()
    );
    // Its latch is optional; ours stays.
    assert!(reasons.last().unwrap().action >= Action::Brake);
}

/// OpenCR #169, turtlebot3 #1154: the base drives on when the computer dies.
#[test]
fn a_dead_host_stops_the_robot_where_the_drive_has_a_watchdog() {
    let covered = case("host_death_covered");
    let run = run_case(&covered).unwrap();
    assert_eq!(run.result.judgement.outcome, Outcome::Pass);
    // The naive base has none.
    let mut naive = covered;
    naive.scenario.drive.silence = Some(Silence::None);
    assert!(touches(&run_one(&naive, true).unwrap()));
}
