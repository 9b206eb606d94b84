//! Both adapters drive their emulators past an obstacle over a real terminal and a real socket.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]
mod common;

use std::time::Duration;

use common::{Driver, Emulator, log, pace, robot_file, slow_down, tail};

struct Course {
    robot: &'static str,
    file: &'static str,
    port: &'static str,
    speed: &'static str,
    /// Past the obstacle.
    far_m: f64,
}

const COURSES: [Course; 4] = [
    Course {
        robot: "seekur-jr",
        file: "seekur_jr",
        port: "pty",
        speed: "0.7",
        far_m: 5.2,
    },
    Course {
        robot: "seekur-jr",
        file: "seekur_jr",
        port: "tcp:127.0.0.1:0",
        speed: "0.7",
        far_m: 5.2,
    },
    Course {
        robot: "pses-car",
        file: "pses_car",
        port: "pty",
        speed: "0.5",
        far_m: 1.5,
    },
    Course {
        robot: "pses-car",
        file: "pses_car",
        port: "tcp:127.0.0.1:0",
        speed: "0.5",
        far_m: 1.5,
    },
];

/// A machine that runs other things, too, calls the loop late now and then; the tube pays for it.
const JITTER: (&str, &str) = ("jitter_s", "0.015");

/// Drives the course, slower if the machine does not keep the rhythm. A contact is never tried again.
fn run(course: &Course) -> String {
    loop {
        match drive(course) {
            Ok(said) => return said,
            Err(late) => assert!(slow_down(), "{late}"),
        }
    }
}

fn drive(course: &Course) -> Result<String, String> {
    let tag = format!("corridor-{}", &course.port[..3]);
    let file = robot_file(course.file, &tag, &[JITTER]);
    let file = file.to_str().unwrap();
    let mut emulator = Emulator::start(course.robot, course.port, &["--robot", file]);
    let log = log(&format!("{}-{tag}", course.robot));
    let trace = log.with_extension("csv");
    let options = [
        "--robot",
        file,
        "--speed",
        course.speed,
        "--persist",
        "--trace",
        trace.to_str().unwrap(),
    ];
    let mut driver = Driver::start(course.robot, &emulator, &options, &log);
    let place = format!("{} over {}", course.robot, course.port);
    let past = emulator.until(Duration::from_secs(60), |r| {
        r.contact || r.truth.pose[0] > course.far_m
    });
    let Some(past) = past else {
        return Err(format!("{place} never passes:\n{}", tail(&log)));
    };
    assert!(!past.contact, "{place} touches: {past:?}\n{}", tail(&log));
    // The way points lie behind the wall: only the guard stops it.
    let rests = |r: &haltline_drives::emulator::process::Report| {
        r.contact || r.truth.twist.iter().all(|value| value.abs() < 1e-3)
    };
    for _ in 0..40 {
        let rest = emulator
            .until(Duration::from_secs(30), rests)
            .expect("comes to rest");
        assert!(!rest.contact, "{place} touches: {rest:?}\n{}", tail(&log));
    }
    driver.signal("INT");
    assert!(
        driver.child.wait().unwrap().success(),
        "{place}:\n{}",
        tail(&log)
    );
    let end = emulator.report();
    assert!(end.clearance_m > 0.0);
    readable(&trace, end.truth.pose[0]);
    let [_, slowness] = pace();
    Ok(format!(
        "{place}: {:.2} m driven, least clearance {:.3} m, at 1/{slowness} of the speed",
        end.truth.pose[0], end.clearance_m
    ))
}

/// The trace has whole rows in order of time, and its increments add up to the way.
fn readable(trace: &std::path::Path, x_m: f64) {
    let text = std::fs::read_to_string(trace).unwrap();
    let mut lines = text.lines();
    let header = lines.next().unwrap();
    let beams: usize = header.split(' ').nth(2).unwrap().parse().unwrap();
    assert!(lines.next().unwrap().starts_with("# t_s,dx_m"));
    let (mut before, mut pose) = (-1.0, [0.0_f64; 3]);
    for line in lines {
        let fields: Vec<f64> = line
            .split(',')
            .map(|field| field.parse().unwrap())
            .collect();
        assert_eq!(fields.len(), beams + 4);
        assert!(fields[0] > before);
        before = fields[0];
        let (sin, cos) = pose[2].sin_cos();
        pose[0] += cos * fields[1] - sin * fields[2];
        pose[1] += sin * fields[1] + cos * fields[2];
        pose[2] += fields[3];
    }
    assert!((pose[0] - x_m).abs() < 0.05 * x_m, "{} of {x_m} m", pose[0]);
}

#[test]
fn both_robots_pass_the_obstacle_over_terminal_and_socket_without_contact() {
    std::thread::scope(|scope| {
        let runs: Vec<_> = COURSES
            .iter()
            .map(|course| scope.spawn(|| run(course)))
            .collect();
        for run in runs {
            println!("{}", run.join().unwrap());
        }
    });
}

/// The false twin: the same adapter and emulator without the kernel. The judge must see it.
#[test]
fn without_the_kernel_the_wall_is_hit() {
    use haltline::decision::{Action, Decision, Reason, StopStatus};
    use haltline::input::{Motion, Twist};
    use haltline::units::{AngularSpeed, Speed};
    use haltline_drives::clock::Clock;
    use haltline_drives::drive::State;
    use haltline_drives::link;
    use haltline_drives::robots::Kind;

    let mut emulator = Emulator::start("seekur-jr", "tcp:127.0.0.1:0", &["--hall", "1.6"]);
    let [_, slowness] = pace();
    let clock = Clock::slowed(slowness.parse().unwrap());
    let file = haltline_robots::Robot::embedded("seekur_jr").unwrap();
    let mut drive = Kind::SeekurJr.adapter(&file, 1, clock.now());
    let mut wire = link::open(&emulator.port, 0).unwrap();
    let mut next = clock.now();
    let mut contact = false;
    while !contact && clock.now().as_us() < 60_000_000 {
        let now = clock.now();
        let mut heard = Vec::new();
        wire.read(&mut heard).unwrap();
        drive.receive(&heard, now);
        drive.tick(now);
        if now >= next {
            next = now.plus(haltline::time::Duration::from_ms(40));
            if drive.state() == State::Disabled {
                drive.enable(now);
            }
            let speed = if drive.state() == State::Driving {
                600_000
            } else {
                0
            };
            let decision = Decision {
                action: Action::Pass,
                setpoint: Motion::Twist(Twist {
                    linear: Speed::from_um_per_s(speed),
                    angular: AngularSpeed::ZERO,
                }),
                reason: Reason::None,
                status: StopStatus::Running,
                expires: now.plus(haltline::time::Duration::from_ms(400)),
                verdict: None,
                factor_permille: 1000,
            };
            let _ = drive.send(&decision, now);
        }
        let mut room = [0; 256];
        let count = drive.outgoing(&mut room, now);
        let mut said = &room[..count];
        while !said.is_empty() {
            let written = wire.write(said).unwrap();
            said = &said[written..];
        }
        emulator.skip();
        contact = emulator.newest.is_some_and(|report| report.contact);
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(
        contact,
        "nobody stopped it, and it did not touch: {:?}",
        emulator.newest
    );
}
