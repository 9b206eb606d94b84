//! What arrives from a planner, or does not.

use crate::{driving, speed};
use haltline::decision::{Action, Reason};
use haltline::input::Motion;

/// #4555: the monitor runs only when a command arrives, so a silent planner leaves the last command in force.
#[test]
fn a_silent_planner_stops_the_robot() {
    let mut room = driving(0.5);
    let naive = room.twist[0];
    let mut last = None;
    for _ in 0..60 {
        last = Some(room.tick(None, false));
    }
    assert!(naive > 0.4, "the last command was fast");
    assert!(speed(&last.unwrap()).abs() < 1e-9 && room.twist[0].abs() < 1e-9);
}

/// #3627, #3658: a NaN command is ignored, and the base keeps its last one.
#[test]
fn a_command_that_is_no_number_brakes_in_the_same_tick() {
    for (v, w) in [
        (f64::NAN, 0.0),
        (0.5, f64::NAN),
        (f64::INFINITY, 0.0),
        (0.5, f64::NEG_INFINITY),
    ] {
        let mut room = driving(0.5);
        let naive = room.twist[0];
        let decision = room.tick(Some((v, w)), false);
        assert!(decision.action >= Action::Brake, "{v} {w}: {decision:?}");
        assert!(speed(&decision) < naive - 0.01, "{v} {w}: {decision:?}");
    }
}

/// #5273: a failed controller may not publish a zero, and nobody else does.
#[test]
fn a_failing_planner_ends_at_exactly_zero() {
    let mut room = driving(0.5);
    for _ in 0..60 {
        let _ = room.tick(Some((f64::NAN, f64::NAN)), false);
    }
    assert!(room.twist[0].abs() < 1e-9, "{:?}", room.twist);
}

/// Velocity polygons: a speed that none of them covers keeps the polygon of the speed before.
#[test]
fn a_speed_beyond_all_limits_is_never_passed_on() {
    let mut room = driving(0.5);
    for wish in [(5.0, 0.0), (0.5, 9.0), (-0.5, 0.0)] {
        let decision = room.tick(Some((wish.0, wish.1)), false);
        assert!(decision.action >= Action::Slow, "{wish:?}: {decision:?}");
        let Motion::Twist(sent) = decision.setpoint else {
            panic!("{decision:?}");
        };
        // One tick's acceleration beyond what it was, and inside the limits of 1.2 m/s and 1.39 rad/s.
        assert!(
            (0..=540_000).contains(&sent.linear.as_um_per_s()),
            "{decision:?}"
        );
        assert!(sent.angular.as_urad_per_s().abs() <= 45_000, "{decision:?}");
        assert!(matches!(
            decision.reason,
            Reason::LimitExceeded | Reason::ReverseNotAllowed
        ));
    }
}

/// #5712: missed deadlines are reported and not acted on.
#[test]
fn a_late_tick_stops() {
    let mut room = driving(0.5);
    room.now_us += 60_000;
    let decision = room.tick(Some((0.5, 0.0)), false);
    assert_eq!(decision.reason, Reason::TickLate, "{decision:?}");
    assert!(decision.action >= Action::Brake);
}
