//! `haltline emulate`: a robot without the robot, for the first steps of an integration.

use crate::args::EmulateArgs;
use crate::failure::{Exit, Failure};
use haltline_drives::clock::Clock;
use haltline_drives::emulator::process::Process;
use haltline_drives::robots::{Habits, Kind, corridor, course};
use haltline_robots::Robot;
use signal_hook::consts::{SIGINT, SIGTERM};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Half the width of a hall and the room behind the robot, m.
const HALL_M: f64 = 3.0;
/// Time between two lines of the log, s.
const LINE_S: f64 = 1.0;

/// Runs the emulated robot until it is ended.
///
/// # Errors
/// Unknown robot, unusable robot file or port.
pub fn emulate(args: &EmulateArgs) -> Result<Exit, Failure> {
    let kind = Kind::named(&args.robot).ok_or_else(|| {
        Failure::input(format!(
            "there is no emulator for {:?}; write {}",
            args.robot,
            Kind::NAMES.join(" or ")
        ))
    })?;
    let robot = match &args.file {
        Some(path) => Robot::load(path),
        None => Robot::embedded(kind.file()),
    };
    let robot = robot.map_err(|error| Failure::input(error.to_string()))?;
    if !kind.fits(&robot) {
        return Err(Failure::input(format!(
            "--file: {} is another kind of robot",
            robot.name
        )));
    }
    if args.port != "pty" && !args.port.starts_with("tcp:") {
        return Err(Failure::input(format!(
            "--port {:?}: write pty, or tcp:HOST:PORT (port 0: any)",
            args.port
        )));
    }
    let clock = Clock::default();
    let world = match args.hall_m {
        Some(ahead) => corridor(ahead, HALL_M, HALL_M, None),
        None => course(kind).0,
    };
    let habits = Habits {
        skid: args.skid.unwrap_or(1.0),
        ..Habits::default()
    };
    let body = kind.emulated(&robot, habits, clock.now());
    let (mut process, addresses) = Process::new(body, &robot, world, &args.port, clock)
        .map_err(|error| Failure::input(format!("--port {}: {error}", args.port)))?;
    let file = args.file.as_ref().map_or_else(
        || format!("robots/{}.toml", kind.file()),
        |path| path.display().to_string(),
    );
    say!("port {}  scanner {}", addresses.port, addresses.scan);
    say!(
        "drive it from another terminal:\n  haltline drive {file} --port {} --scan-from {} --goal 2,0\nCtrl-C ends",
        addresses.port,
        addresses.scan
    );
    let end = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&end))
            .map_err(|error| Failure::not_checkable(error.to_string()))?;
    }
    let mut said_s = f64::NEG_INFINITY;
    let mut touched = false;
    process.run(&end, |report| {
        touched |= report.contact;
        if report.time_s - said_s >= LINE_S || report.contact {
            said_s = report.time_s;
            let [x, y, theta] = report.truth.pose;
            say!(
                "{:8.1} s  ({x:+.3}, {y:+.3}) m {:+.1} deg  {:+.3} m/s  {:.3} m from anything at the least{}",
                report.time_s,
                theta.to_degrees(),
                report.truth.twist[0],
                report.clearance_m,
                if report.contact { "  TOUCHES" } else { "" }
            );
        }
    });
    end.store(true, Ordering::Relaxed);
    say!(
        "ended; {}",
        if touched {
            "the robot TOUCHED something"
        } else {
            "the robot touched nothing"
        }
    );
    Ok(Exit::Holds)
}
