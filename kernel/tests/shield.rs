//! The kernel in shield mode, driven through its public door in a small exact world.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs)]
#![allow(clippy::indexing_slicing, clippy::arithmetic_side_effects)]
mod common;

use common::{Room, config};
use haltline::decision::{Action, Reason, StopStatus};
use haltline::input::{Beam, Inputs, Reading, Scan};
use haltline::time::Instant;

#[test]
fn starts_latched_and_runs_after_a_reset_at_rest() {
    let mut room = Room::new((-3.0, 6.0), (-2.0, 2.0), config());
    for _ in 0..20 {
        let decision = room.tick(Some((0.5, 0.0)), false);
        assert_eq!(decision.status, StopStatus::Latched, "{decision:?}");
        assert!(room.twist == [0.0, 0.0]);
    }
    let decision = room.tick(Some((0.5, 0.0)), true);
    assert_eq!(decision.status, StopStatus::Running, "{decision:?}");
    // The command of the reset's own tick is dead; the next one counts.
    assert!(room.twist == [0.0, 0.0]);
    let decision = room.tick(Some((0.5, 0.0)), false);
    assert_eq!(decision.action, Action::Pass, "{decision:?}");
    assert!(room.twist[0] > 0.0);
}

#[test]
fn drives_up_to_a_wall_and_stops_before_it() {
    let mut room = Room::new((-3.0, 4.0), (-2.0, 2.0), config());
    let _ = room.start();
    let mut fastest: f64 = 0.0;
    let mut last = room.tick(Some((1.0, 0.0)), false);
    for tick in 0..400 {
        last = room.tick(Some((1.0, 0.0)), false);
        fastest = fastest.max(room.twist[0]);
        assert!(room.pose[0] + 0.6 < 4.0, "tick {tick}: {last:?}");
    }
    assert!(fastest > 0.6, "fastest {fastest}");
    assert!(room.twist[0].abs() < 0.02, "{last:?} at {:?}", room.pose);
    assert!(
        matches!(last.reason, Reason::GuardBlocked | Reason::GuardLimited),
        "{last:?}"
    );
    let gap = 4.0 - room.pose[0] - 0.6;
    assert!(gap < 0.12, "stops needlessly far away: {gap}");
}

#[test]
fn turns_on_the_spot_where_there_is_room_and_not_where_there_is_none() {
    let mut room = Room::new((-3.0, 3.0), (-2.0, 2.0), config());
    let _ = room.start();
    for _ in 0..100 {
        let _ = room.tick(Some((0.0, 0.5)), false);
    }
    assert!(room.pose[2] > 1.0, "{:?}", room.pose);
    // 0.5 m to each side: the corners (0.73 m) do not pass.
    let mut narrow = Room::new((-3.0, 3.0), (-0.5, 0.5), config());
    let _ = narrow.start();
    for _ in 0..200 {
        let _ = narrow.tick(Some((0.0, 0.5)), false);
    }
    assert!(narrow.pose[2] < 0.2, "{:?}", narrow.pose);
}

/// GUARD-02: nobody looks behind, so reversing ends where the operator's word ends.
#[test]
fn reverses_no_farther_than_the_vouched_area() {
    for speed in [-0.03, -0.1, -0.5] {
        let mut config = config();
        config.limits.speed_reverse = config.limits.speed_forward;
        let mut room = Room::new((-20.0, 6.0), (-2.0, 2.0), config);
        let _ = room.start();
        for _ in 0..1500 {
            let _ = room.tick(Some((speed, 0.0)), false);
        }
        // 1.2 m around the centre, 0.6 m to the rear edge, and at most a cell.
        assert!(room.pose[0] > -0.6 - 0.064, "at {speed}: {:?}", room.pose);
        assert!(room.pose[0] < -0.4, "at {speed}: {:?}", room.pose);
    }
}

/// A wall beside the robot goes on where the scanner does not look; the operator's word for the
/// disc ends where the scan shows something.
#[test]
fn turns_its_tail_into_no_wall_that_goes_on_out_of_view() {
    for wall in [0.53, 0.55, 0.6, 0.65] {
        for rate in [-0.5, -0.2, 0.5] {
            let mut room = Room::new((-20.0, 20.0), (-2.0, wall), config());
            let _ = room.start();
            for _ in 0..150 {
                let _ = room.tick(Some((0.0, rate)), false);
                let (sin, cos) = room.pose[2].sin_cos();
                for (x, y) in [(0.6, 0.42), (-0.6, 0.42), (-0.6, -0.42), (0.6, -0.42)] {
                    let corner = room.pose[1] + sin * x + cos * y;
                    assert!(
                        corner < wall,
                        "wall at {wall}, {rate} rad/s: {:?}",
                        room.pose
                    );
                }
            }
        }
    }
}

/// ZONE-01: the zone answers in the tick that receives the scan, although no odometry covers it yet.
#[test]
fn a_return_in_the_critical_zone_stops_without_waiting_for_odometry() {
    let mut room = Room::new((-3.0, 6.0), (-2.0, 2.0), config());
    let _ = room.start();
    let decision = room.tick(Some((0.3, 0.0)), false);
    assert_eq!(decision.action, Action::Pass, "{decision:?}");
    let mut beams = room.beams();
    // Straight ahead, 80 mm from the scanner: 7 mm before the front edge.
    beams[270] = Beam::Hit(80);
    let scans = [Reading::Value(Scan {
        scanner: 0,
        stamp: Instant::from_us(room.now_us - 20_000),
        beams: &beams,
    })];
    let inputs = Inputs {
        scans: &scans,
        command: room.command(0.3, 0.0),
        ..Inputs::default()
    };
    let decision = room.step(&inputs);
    assert_eq!(decision.action, Action::ProtectiveStop, "{decision:?}");
    assert_eq!(decision.reason, Reason::CriticalZone);
}
