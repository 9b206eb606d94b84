//! BRAKE fires on a ramp that is missing, too soft, endless or bent.

use super::*;

fn twist(v: f64, omega: f64) -> DecisionRecord {
    DecisionRecord {
        set_point: SetPoint::Twist { v, omega },
        ..decision(Action::Brake, 0.0)
    }
}

/// A motion at 0.04 m/s and 0.02 rad/s, then these braking set points, one each period.
fn braked(ramp: &[(f64, f64)]) -> Vec<String> {
    let robot = robot();
    let mut bench = Bench::running(&robot);
    for v in [0.02, 0.03, 0.04] {
        let mut pass = decision(Action::Pass, 0.0);
        pass.set_point = SetPoint::Twist { v, omega: v / 2.0 };
        bench.tick(pass, |_| {});
    }
    for (v, omega) in ramp {
        bench.tick(twist(*v, *omega), |_| {});
    }
    bench.fired()
}

#[test]
fn a_ramp_along_the_arc_is_not_objected_to() {
    // At 0.5 m/s², 42 ms (period and jitter) take off 21 mm/s, every period 20 more.
    assert_eq!(braked(&[(0.019, 0.0095), (0.0, 0.0), (0.0, 0.0)]), [""; 0]);
    assert_eq!(braked(&[(0.0, 0.0)]), [""; 0]);
}

#[test]
fn brake_fires_on_each_rule() {
    for (ramp, rule) in [
        (&[(0.04, 0.02)][..], "BRAKE-01: it goes on"),
        (
            &[(0.0205, 0.01025)],
            "BRAKE-05: softer than the sure deceleration",
        ),
        (
            &[(0.019, 0.0095), (0.015, 0.0075)],
            "BRAKE-05: too soft later on",
        ),
        (
            &[(0.015, 0.0075), (0.001, 0.0005), (0.001, 0.0005)],
            "BRAKE-07: never at rest",
        ),
        (&[(0.015, 0.0095)], "BRAKE-03: off the arc"),
        (&[(0.0, 0.009)], "BRAKE-03: turns on the spot"),
    ] {
        assert_eq!(braked(ramp), ["BRAKE"], "{rule}");
    }
}

#[test]
fn brake_fires_when_the_wheels_turn_while_braking() {
    let robot = haltline_robots::Robot::embedded("pses_car").unwrap();
    let arc = |action, v, curvature| DecisionRecord {
        set_point: SetPoint::Arc { v, curvature },
        ..decision(action, 0.0)
    };
    let judged = |curvature: f64| {
        let mut monitor = super::super::brake::Brake::new();
        let still = |_| Pose::default();
        for (k, decision) in [
            arc(Action::Pass, 0.3, 0.5),
            arc(Action::Brake, 0.2, curvature),
        ]
        .iter()
        .enumerate()
        {
            let now_us = 1_000_000 + 20_000 * k as u64;
            let given = inputs(now_us);
            let place = (Pose::default(), true);
            let tick = Tick::new((1.0, now_us), &given, decision, &still, place);
            monitor.tick(&robot, &tick);
        }
        monitor.ledger.report.violation_count
    };
    assert_eq!(judged(0.5), 0);
    assert_eq!(judged(0.4), 1);
}

#[test]
fn a_ramp_that_began_with_the_wish_to_stand_is_one_ramp() {
    let still = |inputs: &mut TickInputs| {
        if let Some(command) = &mut inputs.command {
            command.motion = SetPoint::Twist { v: 0.0, omega: 0.0 };
        }
    };
    // The wish comes with the second tick, a refusal with the third: 42 ms, then a period more.
    for (then, fires) in [(0.039, false), (0.045, true)] {
        let robot = robot();
        let mut bench = Bench::running(&robot);
        for v in [0.02, 0.04, 0.06, 0.08] {
            bench.tick(decision(Action::Pass, v), |_| {});
        }
        bench.tick(decision(Action::Pass, 0.059), still);
        let mut refused = decision(Action::Brake, 0.0);
        refused.set_point = SetPoint::Twist {
            v: then,
            omega: 0.0,
        };
        bench.tick(refused, still);
        assert_eq!(bench.fired().contains(&"BRAKE".to_owned()), fires, "{then}");
    }
}

#[test]
fn a_ramp_does_not_go_on_while_the_clock_makes_up_for_a_step_back() {
    let robot = robot();
    // Set points at these times, us: the clock steps back by half a second after the second tick.
    let judged = |ticks: &[(u64, f64)]| {
        let mut monitor = super::super::brake::Brake::new();
        for (now_us, v) in ticks {
            let action = if *v > 0.05 {
                Action::Pass
            } else {
                Action::Brake
            };
            let mut sent = twist(*v, 0.0);
            (sent.action, sent.expires_us) = (action, now_us + 42_000);
            let (given, still) = (inputs(*now_us), |_| Pose::default());
            let tick = Tick::new(
                (1.0, *now_us),
                &given,
                &sent,
                &still,
                (Pose::default(), true),
            );
            monitor.tick(&robot, &tick);
        }
        monitor.ledger.report.violation_count
    };
    let back = [
        (1_000_000, 0.06),
        (1_040_000, 0.039),
        (540_000, 0.039),
        (580_000, 0.039),
    ];
    assert_eq!(judged(&back), 0);
    // What the ramp had left when the clock stepped back is all it has left once the clock has caught up.
    let caught_up = |v: f64| [&back[..], &[(1_080_000, v)]].concat();
    assert_eq!(judged(&caught_up(0.019)), 0);
    assert_eq!(judged(&caught_up(0.039)), 1);
}
