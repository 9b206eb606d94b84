//! The loop's own deadline: a tick that comes late is counted and stops the robot.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]
mod common;

use std::sync::atomic::Ordering;
use std::time::Duration;

use common::{Emulator, pace, robot_file, slow_down};
use haltline::decision::{Reason, StopStatus};
use haltline_drives::clock::Clock;
use haltline_drives::control::{Account, Control, Ending, Operator, View, Wish, shield};
use haltline_drives::drive::Fault;
use haltline_drives::eye::Eye;
use haltline_drives::link;
use haltline_drives::robots::Kind;
use haltline_robots::Robot;

/// What a tick showed.
struct Seen {
    account: Account,
    status: StopStatus,
    reason: Reason,
    fault: Option<Fault>,
}

/// Drives, lets the planner stand still for 0.2 s in motion, and goes on until the robot rests.
fn stalled(file: &Robot, emulator: &Emulator) -> (Vec<Seen>, Option<usize>) {
    let [_, slowness] = pace();
    let slowness: u32 = slowness.parse().unwrap();
    let clock = Clock::slowed(slowness);
    let adapter = Kind::SeekurJr.adapter(file, 1, clock.now());
    let port = emulator.port.clone();
    let opener = Box::new(move || link::open(&port, 0));
    let mount = file.values.scanners[0].clone();
    let eye = Eye::new(
        Box::new(link::tcp(&emulator.scan, link::CONNECT).unwrap()),
        mount,
    );
    let mut control =
        Control::new(file, shield(file).unwrap(), adapter, opener, eye, clock).unwrap();
    let operator = Operator::default();
    operator.reset.store(true, Ordering::Relaxed);
    let seen = std::cell::RefCell::new(Vec::<Seen>::new());
    let mut stall = None;
    let propose = |view: &View| {
        let (v, ticks) = (view.feedback.twist[0], seen.borrow().len());
        if stall.is_none() && v > 0.3 {
            stall = Some(ticks);
            std::thread::sleep(Duration::from_millis(200) * slowness);
        }
        let after = stall.is_some_and(|at| ticks > at + 5);
        let over = (after && v.abs() < 1e-3) || view.now.as_us() > 20_000_000;
        if over {
            Wish::End
        } else {
            Wish::Motion(view.now, [0.5, 0.0])
        }
    };
    let ending = control.run(&operator, propose, |tick| {
        seen.borrow_mut().push(Seen {
            account: tick.account,
            status: tick.decision.status,
            reason: tick.decision.reason,
            fault: tick.fault.map(|error| error.fault),
        });
    });
    assert!(matches!(ending, Ending::Finished), "{ending:?}");
    (seen.into_inner(), stall)
}

//= spec/drive.md#drive-12
//= type=test
//# The drive loop MUST count a tick that comes later than control period plus jitter after the one before, and stop for it.
#[test]
fn a_late_tick_is_counted_and_stops() {
    let path = robot_file("seekur_jr", "deadline", &[("jitter_s", "0.030")]);
    let file = Robot::load(&path).unwrap();
    let (seen, stall) = loop {
        let options = ["--robot", path.to_str().unwrap(), "--hall", "12"];
        let emulator = Emulator::start("seekur-jr", "tcp:127.0.0.1:0", &options);
        let (seen, stall) = stalled(&file, &emulator);
        if let Some(stall) = stall {
            break (seen, stall);
        }
        assert!(slow_down(), "never moves");
    };
    // The decision of the tick that stood still had expired before it could be sent.
    assert_eq!(seen[stall].fault, Some(Fault::Expired));
    // The next one comes late: counted, and a protective stop.
    let late = &seen[stall + 1];
    assert_eq!(late.account.missed, seen[stall].account.missed + 1);
    assert_eq!(late.status, StopStatus::Protective, "{:?}", late.reason);
    assert!(late.account.latest_us > 100_000);
    // And it stays one until the robot rests: the planner wanted to go all the time.
    let held = seen[stall + 1..].iter().take(5);
    assert!(
        held.into_iter()
            .all(|tick| tick.status != StopStatus::Running)
    );
}
