//! Every monitor fires when it should, and only then.

mod brake;
mod excused;
mod navigate;

use super::*;
use crate::math::Pose;
use crate::odometry::RawOdometry;
use crate::proposer::RawCommand;
use crate::sensor::RawScan;
use crate::testing::robot;
use crate::world::{Body, Course, Shape, Trigger};

const PERIOD_US: u64 = 40_000;

/// A bench that feeds ticks with good inputs unless a test spoils them.
struct Bench<'r> {
    monitors: Monitors<'r>,
    now_us: u64,
    rested: bool,
}

fn world() -> World {
    World::new(vec![Body {
        name: "box".to_owned(),
        shape: Shape::Circle(0.2),
        home: Pose::new(5.0, 0.0, 0.0),
        invisible: false,
        trigger: Trigger::At(0.0),
        course: Course::Still,
    }])
}

fn decision(action: Action, v: f64) -> DecisionRecord {
    DecisionRecord {
        action,
        reason: Reason::None,
        status: match action {
            Action::ProtectiveStop => StopStatus::Protective,
            Action::EmergencyStop => StopStatus::Latched,
            _ => StopStatus::Running,
        },
        set_point: SetPoint::Twist { v, omega: 0.0 },
        expires_us: 0,
        point_m: None,
        wants_rest: false,
    }
}

fn inputs(now_us: u64) -> TickInputs {
    TickInputs {
        scans: vec![RawScan {
            scanner: 0,
            begun_us: now_us - 20_000,
            stamp_us: now_us - 20_000,
            ranges_m: vec![5.0; 541],
            bodies: vec![Some(0); 541],
        }],
        odometry: Some(RawOdometry {
            stamp_us: now_us,
            pose: [0.0; 3],
            twist: [0.0; 2],
            curvature_per_m: None,
        }),
        command: Some(RawCommand {
            stamp_us: now_us,
            motion: SetPoint::Twist { v: 0.5, omega: 0.0 },
        }),
        order_us: None,
        emergency_stop: false,
        reset_us: None,
    }
}

impl<'r> Bench<'r> {
    /// A bench whose robot was reset and released, and has had one good tick.
    fn running(robot: &'r Robot) -> Self {
        let mut bench = Self {
            monitors: Monitors::new(robot, &world()),
            now_us: 1_000_000,
            rested: true,
        };
        bench.tick(decision(Action::EmergencyStop, 0.0), |_| {});
        bench.tick(decision(Action::Brake, 0.0), |inputs| {
            inputs.reset_us = Some(1)
        });
        bench.tick(decision(Action::Pass, 0.01), |_| {});
        bench
    }

    fn tick(&mut self, decision: DecisionRecord, spoil: impl FnOnce(&mut TickInputs)) {
        self.now_us += PERIOD_US;
        self.tick_now(decision, spoil);
    }

    fn tick_now(&mut self, mut decision: DecisionRecord, spoil: impl FnOnce(&mut TickInputs)) {
        let mut inputs = inputs(self.now_us);
        spoil(&mut inputs);
        if decision.expires_us == 0 {
            decision.expires_us = self.now_us + 42_000;
        }
        let t_s = self.now_us as f64 * 1e-6;
        let still = |_| Pose::default();
        let place = (Pose::default(), self.rested);
        self.monitors.tick(Tick::new(
            (t_s, self.now_us),
            &inputs,
            &decision,
            &still,
            place,
        ));
    }

    /// Ids of the monitors that complained.
    fn fired(self) -> Vec<String> {
        let reports = self.monitors.finish().into_iter();
        reports
            .filter(|r| r.violation_count > 0)
            .map(|r| r.id)
            .collect()
    }
}

/// A contact with the only body that was not there before.
fn touch(t_s: f64) -> Touch {
    Touch {
        t_s,
        body: 0,
        pose: Pose::default(),
        stood: false,
    }
}

#[test]
fn good_ticks_are_not_objected_to() {
    let robot = robot();
    let mut bench = Bench::running(&robot);
    bench.tick(decision(Action::Pass, 0.03), |_| {});
    bench.tick(decision(Action::Slow, 0.04), |_| {});
    bench.tick(decision(Action::Brake, 0.01), |_| {});
    assert_eq!(bench.fired(), Vec::<String>::new());
}

#[test]
fn claim_fires_for_a_known_body_and_for_unseen_space() {
    let robot = robot();
    let touch = touch(2.0);
    let mut known = Bench::running(&robot);
    let _ = known.monitors.touch(touch, &[]);
    assert_eq!(known.fired(), ["CLAIM"]);
    let mut unseen = Monitors::new(&robot, &world());
    let _ = unseen.touch(touch, &[]);
    assert_eq!(unseen.finish()[0].violation_count, 1);
}

#[test]
fn claim_accepts_a_named_assumption_for_this_body_only() {
    let robot = robot();
    let excuse = |body, from_s| Broken {
        id: "A-OBSTACLE",
        what: String::new(),
        body,
        from_s,
    };
    let fires = |broken: Broken| {
        let mut bench = Bench::running(&robot);
        let _ = bench.monitors.touch(touch(2.0), &[broken]);
        !bench.fired().is_empty()
    };
    assert!(!fires(excuse(None, 0.0)));
    assert!(!fires(excuse(Some(0), 0.0)));
    assert!(fires(excuse(Some(1), 0.0)), "another body's excuse");
    assert!(fires(excuse(None, 3.0)), "an assumption broken later");
}

#[test]
fn limit_fires_on_speed_reverse_step_and_nan() {
    let robot = robot();
    for (v, why) in [
        (1.3, "too fast"),
        (-0.1, "reverse"),
        (0.2, "step"),
        (f64::NAN, "NaN"),
    ] {
        let mut bench = Bench::running(&robot);
        bench.tick(decision(Action::Pass, v), |_| {});
        assert!(bench.fired().contains(&"LIMIT".to_owned()), "{why}");
    }
}

#[test]
fn zone_fires_when_a_return_in_the_zone_is_only_braked_for() {
    let robot = robot();
    // Beam 270 looks straight ahead from x = 0.527: 0.1 m further is x = 0.627, in the zone.
    let near = |inputs: &mut TickInputs| inputs.scans[0].ranges_m[270] = 0.1;
    let mut bench = Bench::running(&robot);
    bench.tick(decision(Action::Brake, 0.0), near);
    assert_eq!(bench.fired(), ["ZONE"]);
    let mut bench = Bench::running(&robot);
    bench.tick(decision(Action::ProtectiveStop, 0.0), near);
    assert_eq!(bench.fired(), Vec::<String>::new());
    let mut bench = Bench::running(&robot);
    bench.tick(decision(Action::Pass, 0.02), |inputs| {
        inputs.scans[0].ranges_m[270] = 0.2;
    });
    assert_eq!(bench.fired(), Vec::<String>::new(), "0.727 m is outside");
}

#[test]
fn fresh_fires_on_each_stale_channel() {
    let robot = robot();
    let spoilers: [fn(&mut TickInputs); 5] = [
        |inputs| inputs.scans.clear(),
        |inputs| inputs.odometry = None,
        |inputs| inputs.command = None,
        |inputs| inputs.scans[0].stamp_us += 1_000_000,
        |inputs| inputs.scans[0].stamp_us = 5,
    ];
    for spoil in spoilers {
        let mut bench = Bench::running(&robot);
        for _ in 0..8 {
            bench.tick(decision(Action::Pass, 0.01), spoil);
        }
        assert_eq!(bench.fired(), ["FRESH"]);
    }
}

#[test]
fn silent_fires_on_long_expiry_and_late_ticks() {
    let robot = robot();
    let mut bench = Bench::running(&robot);
    let lasting = DecisionRecord {
        expires_us: bench.now_us + PERIOD_US + 43_000,
        ..decision(Action::Pass, 0.02)
    };
    bench.tick(lasting, |_| {});
    assert_eq!(bench.fired(), ["SILENT"]);
    let mut late = Bench::running(&robot);
    late.now_us += 30_000;
    late.tick(decision(Action::Brake, 0.0), |_| {});
    assert_eq!(late.fired(), ["SILENT"]);
    let mut repeated = Bench::running(&robot);
    repeated.tick_now(decision(Action::Brake, 0.0), |_| {});
    assert_eq!(repeated.fired(), ["SILENT"]);
}

#[test]
fn latch_fires_before_reset_on_replay_and_on_growth() {
    let robot = robot();
    let mut unreset = Bench {
        monitors: Monitors::new(&robot, &world()),
        now_us: 1_000_000,
        rested: true,
    };
    unreset.tick(decision(Action::Brake, 0.0), |_| {});
    assert_eq!(unreset.fired(), ["LATCH"], "nobody gave a reset");

    let mut replay = Bench::running(&robot);
    let old = replay.now_us;
    replay.tick(decision(Action::ProtectiveStop, 0.0), |_| {});
    replay.tick(decision(Action::Brake, 0.0), |inputs| inputs.command = None);
    replay.tick(decision(Action::Pass, 0.01), |inputs| {
        inputs.command = Some(RawCommand {
            stamp_us: old,
            motion: SetPoint::Twist { v: 0.5, omega: 0.0 },
        });
    });
    assert_eq!(
        replay.fired(),
        ["LATCH"],
        "the command is older than the release"
    );

    let mut growth = Bench::running(&robot);
    growth.tick(decision(Action::ProtectiveStop, 0.02), |_| {});
    assert_eq!(
        growth.fired(),
        ["BRAKE", "LATCH"],
        "a stop may not speed up"
    );

    let mut line = Bench::running(&robot);
    line.tick(decision(Action::Brake, 0.0), |inputs| {
        inputs.emergency_stop = true
    });
    assert_eq!(line.fired(), ["LATCH"], "the line latches at once");
}

#[test]
fn latch_fires_when_a_protective_stop_is_released_too_early() {
    let robot = robot();
    let released = |ticks: usize, rested: bool, spoil: fn(&mut TickInputs)| {
        let mut bench = Bench::running(&robot);
        for tick in 0..ticks {
            bench.tick(decision(Action::ProtectiveStop, 0.0), |inputs| {
                if tick == 8 {
                    spoil(inputs);
                }
            });
        }
        bench.rested = rested;
        bench.tick(decision(Action::Brake, 0.0), |_| {});
        bench.fired()
    };
    // The clear time is half a second, a tick is 40 ms.
    assert_eq!(released(13, true, |_| {}), Vec::<String>::new());
    assert_eq!(released(12, true, |_| {}), ["LATCH"], "too early");
    assert_eq!(released(13, false, |_| {}), ["LATCH"], "in motion");
    let unusable: fn(&mut TickInputs) = |inputs| inputs.scans[0].ranges_m.truncate(100);
    assert_eq!(
        released(20, true, unusable),
        ["LATCH"],
        "the cause came back"
    );
    assert_eq!(released(21, true, unusable), Vec::<String>::new());
}

#[test]
fn input_fires_when_the_unusable_is_passed_over() {
    let robot = robot();
    let spoilers: [fn(&mut TickInputs); 5] = [
        // A run of 12 degrees, fewer than the part that may be invalid.
        |inputs| inputs.scans[0].ranges_m[100..124].fill(f32::NAN),
        |inputs| inputs.scans[0].ranges_m.fill(f32::NAN),
        |inputs| inputs.scans[0].ranges_m.truncate(100),
        |inputs| {
            if let Some(odometry) = &mut inputs.odometry {
                odometry.pose[1] = f64::NAN;
            }
        },
        |inputs| {
            if let Some(command) = &mut inputs.command {
                command.motion = SetPoint::Twist {
                    v: f64::INFINITY,
                    omega: 0.0,
                };
            }
        },
    ];
    for spoil in spoilers {
        let mut bench = Bench::running(&robot);
        bench.tick(decision(Action::Pass, 0.01), spoil);
        assert_eq!(bench.fired()[0..], ["INPUT"]);
    }
}
