//! Ends of intervals that a changed operator would move: found by small changes that no other test noticed.

#![allow(
    clippy::unwrap_used,
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation,
    missing_docs
)]

mod common;

use common::{Room, config};
use haltline::geometry::frame::{BodyView, PointMm, VIEW_MM};
use haltline::guard::seen::{CELL_MM, CELLS, COVER_MM, Seen};
use haltline::input::{Odometry, Pose};
use haltline::odometry::Track;
use haltline::time::Instant;
use haltline::units::BinaryAngle;

#[test]
fn a_track_of_one_sample_knows_the_pose_at_its_stamp_and_no_other() {
    let at = Instant::from_us;
    let mut track = Track::default();
    let _ = track.push(Odometry {
        stamp: at(1_000_000),
        pose: Pose::default(),
        ..Odometry::default()
    });
    assert!(track.pose_at(at(1_000_000)).is_some());
    assert!(track.pose_at(at(999_999)).is_none());
    assert!(track.pose_at(at(1_000_001)).is_none());
}

#[test]
fn a_body_sees_to_the_end_of_its_view_and_no_farther() {
    let view = BodyView::new(0, 0, BinaryAngle::ZERO);
    for sign in [-1, 1] {
        for (far, seen) in [(VIEW_MM, true), (VIEW_MM + 1, false)] {
            let (x, y) = (sign * far, 0);
            assert_eq!(view.see(PointMm { x, y }).is_some(), seen, "{x}");
            assert_eq!(view.see(PointMm { x: y, y: x }).is_some(), seen, "{x}");
        }
    }
}

#[test]
fn what_memory_covers_lies_in_the_window_wherever_the_robot_drives() {
    let edge = i32::try_from(CELLS).unwrap() * CELL_MM;
    for (dx, dy) in [(7, 0), (-7, 3), (5, -11), (-13, -7)] {
        let mut seen = Seen::default();
        for step in 0..2_000 {
            let robot = PointMm {
                x: dx * step,
                y: dy * step,
            };
            seen.follow(robot);
            let corner = seen.corner_mm();
            for (at, low) in [(robot.x, corner.x), (robot.y, corner.y)] {
                assert!(at - COVER_MM >= low, "{robot:?} {corner:?}");
                assert!(at + COVER_MM < low + edge, "{robot:?} {corner:?}");
            }
        }
    }
}

/// GUARD-05: while it turns on the spot, the drive may creep by its speed tolerance until the stop is over.
#[test]
fn a_turn_on_the_spot_is_inflated_by_how_far_the_drive_may_creep() {
    let mut room = Room::new((-6.0, 6.0), (-6.0, 6.0), config());
    let _ = room.start();
    for _ in 0..20 {
        let decision = room.tick(Some((0.0, 0.4)), false);
        let verdict = decision.verdict.unwrap();
        assert_eq!(verdict.refusal, None, "{decision:?}");
        // A hundredth of a metre per second.
        let creep_um = verdict.stopping_time.as_us() / 100;
        let spread_um = u64::try_from(verdict.budget.spread.as_um()).unwrap();
        assert!(spread_um + 1 >= creep_um, "{spread_um} um of {creep_um} um");
    }
}
