//! Failures of other stacks as tests: the same input, and our kernel must stop or answer correctly.
//!
//! Each test names the report it comes from, works out what the naive answer is, and shows that this answer is wrong.
//! Numbers are issues of `ros-navigation/navigation2` unless another project is named.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

#[path = "../../../kernel/tests/common/mod.rs"]
mod room;

mod commands;
mod drives;
mod geometry;
mod readings;
mod simulated;

use haltline::decision::{Action, Decision};
use haltline::input::{Beam, Motion};
use room::Room;

/// Forward speed of a decision, m/s.
fn speed(decision: &Decision) -> f64 {
    match decision.setpoint {
        Motion::Twist(twist) => f64::from(twist.linear.as_um_per_s()) * 1e-6,
        other => panic!("a differential drive gets twists: {other:?}"),
    }
}

/// A room of 15 m x 4 m in which the robot drives ahead at `v`.
fn driving(v: f64) -> Room {
    let mut room = Room::new((-3.0, 12.0), (-2.0, 2.0), room::config());
    let _ = room.start();
    for _ in 0..80 {
        let decision = room.tick(Some((v, 0.0)), false);
        assert!(decision.action < Action::Brake, "{decision:?}");
    }
    assert!((room.twist[0] - v).abs() < 0.02, "{:?}", room.twist);
    room
}

/// A tick with these beams and the wish to go on as before.
fn with_beams(room: &mut Room, beams: &[Beam], v: f64) -> Decision {
    room.told(beams, 20_000, Some((v, 0.0)), false)
}
