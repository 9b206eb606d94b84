//! `haltline drive`: the kernel between a planner and a real robot, or an emulated one.

mod status;
mod wishes;

use crate::args::DriveArgs;
use crate::failure::{Exit, Failure};
use haltline_drives::clock::Clock;
use haltline_drives::control::{Control, Ending, Operator, View, Wish, shield};
use haltline_drives::drive::State;
use haltline_drives::eye::Eye;
use haltline_drives::goal::navigate;
use haltline_drives::link;
use haltline_drives::robots::Kind;
use haltline_drives::trace::Trace;
use haltline_robots::Robot;
use haltline_scenarios::controller::Controller;
use status::Status;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;
use wishes::Wishes;

/// How long a scanner that was lost may take to accept a connection again.
const LOOK_AGAIN: Duration = Duration::from_millis(100);

/// Connects to the robot and drives until the goal is reached, the commands end, or somebody ends it.
///
/// # Errors
/// Unusable robot file, goal, port or scanner; a robot that could not be told to stop.
pub fn drive(args: &DriveArgs) -> Result<Exit, Failure> {
    let (kind, robot) = robot(&args.robot, args.adapter.as_deref())?;
    let mount = robot.values.scanners.first().cloned().ok_or_else(|| {
        Failure::input(format!(
            "{}: has no [[scanner]]; nothing would be seen",
            args.robot.display()
        ))
    })?;
    let controller = controller(&robot, args.goal.as_deref())?;
    let mut trace = match &args.trace {
        Some(path) => {
            let file = File::create(path).map_err(|error| Failure::write(path, &error))?;
            let trace = Trace::new(BufWriter::new(file), &mount);
            Some(trace.map_err(|error| Failure::write(path, &error))?)
        }
        None => None,
    };
    let scans = link::tcp(&args.scan_from, link::CONNECT).map_err(|error| {
        Failure::input(format!(
            "--scan-from {}: {error}; write HOST:PORT of a scanner that speaks CoLa ASCII (SICK LMS1xx: port 2111)",
            args.scan_from
        ))
    })?;
    let clock = Clock::default();
    let skid = args.skid.unwrap_or(1.0);
    let adapter = kind.skidding_adapter(&robot, skid, std::process::id(), clock.now());
    let (port, baud) = (args.port.clone(), args.baud.unwrap_or(kind.baud()));
    let opener = Box::new(move || link::open(&port, baud));
    let eye = Eye::new(Box::new(scans), mount);
    let scan_from = args.scan_from.clone();
    let scan_opener = Box::new(move || {
        let link = link::tcp(&scan_from, LOOK_AGAIN)?;
        Ok(Box::new(link) as Box<dyn link::Link>)
    });
    let mut control = Control::new(&robot, controller, adapter, opener, eye, clock)
        .map_err(|error| Failure::input(error.to_string()))?
        .with_scanner_opener(scan_opener);
    let operator =
        Operator::with_signals().map_err(|error| Failure::not_checkable(error.to_string()))?;
    // Whoever starts the command has looked around the robot: that is the first reset.
    operator.reset.store(true, Ordering::Relaxed);
    let wishes = Wishes::read(clock, Arc::clone(&operator.reset), args.shield);
    let start = clock.now();
    let propose = |view: &View| {
        let run_s = view.now.since(start).unwrap_or_default().as_us() as f64 * 1e-6;
        if args.for_s.is_some_and(|most| run_s >= most) || has_arrived(view) {
            return Wish::End;
        }
        wishes.newest()
    };
    let mut status = Status::new();
    let ending = control.run(&operator, propose, |tick| {
        if let Some(Err(error)) = trace.as_mut().map(|trace| trace.tick(tick)) {
            status.say(&format!("the trace ends here: {error}"));
            trace = None;
        }
        status.tick(tick);
    });
    status.end();
    ended(&ending, &control, args)
}

/// Whether the kernel's own route is at its end and the robot rests there.
fn has_arrived(view: &View) -> bool {
    let arrived = view
        .said
        .as_ref()
        .is_some_and(|said| said.progress.kind == "arrived");
    arrived && view.feedback.twist.iter().all(|rate| rate.abs() < 1e-3)
}

fn ended(ending: &Ending, control: &Control, args: &DriveArgs) -> Result<Exit, Failure> {
    let account = control.account();
    say!(
        "{} ticks, {} missed their deadline (latest {:.1} ms), {} reconnections, {} faults of the drive",
        account.ticks,
        account.missed,
        account.latest_us as f64 * 1e-3,
        account.reconnections,
        account.faults
    );
    if let Some(path) = &args.trace {
        say!(
            "wrote {}; look at it with: haltline replay --format sena {} --robot {} --out out/replay",
            path.display(),
            path.display(),
            args.robot.display()
        );
    }
    if !control.was_open() && !matches!(ending, Ending::Panicked(_)) {
        return Err(Failure::not_checkable(format!(
            "--port {}: no robot of this kind answered; nothing was moved",
            args.port
        )));
    }
    match ending {
        Ending::Asked => say!("ended by the operator; the robot was ramped to rest"),
        Ending::Finished => say!("ended; the robot was ramped to rest"),
        Ending::Panicked(_) => {
            return Err(failed("the program failed; the robot was ramped to rest"));
        }
        Ending::Unreachable => {
            return Err(failed(
                "the robot could not be reached any more; only its own watchdog stops it",
            ));
        }
    }
    Ok(Exit::Holds)
}

fn failed(message: &str) -> Failure {
    Failure {
        exit: Exit::ClaimFailed,
        message: message.to_owned(),
    }
}

/// The robot of a file, and its adapter: the named one, or the one its name stands for.
///
/// # Errors
/// The file is unusable, or nobody says which adapter it needs.
pub fn robot(file: &Path, adapter: Option<&str>) -> Result<(Kind, Robot), Failure> {
    let robot = Robot::load(file).map_err(|error| Failure::input(error.to_string()))?;
    let known = adapter.map_or_else(|| Kind::of(&robot), Kind::named);
    let kind = known.ok_or_else(|| {
        let place = match adapter {
            Some(given) => format!("--adapter {given:?}: there is no such adapter"),
            None => format!(
                "{}: nobody knows which adapter {:?} needs",
                file.display(),
                robot.name
            ),
        };
        Failure::input(format!(
            "{place}; write --adapter {}",
            Kind::NAMES.join(" or --adapter ")
        ))
    })?;
    if !kind.fits(&robot) {
        return Err(Failure::input(format!(
            "{}: the adapter for {} cannot steer this kind of robot: see `kinematics`",
            file.display(),
            kind.file()
        )));
    }
    Ok((kind, robot))
}

fn controller(robot: &Robot, goal: Option<&str>) -> Result<Box<dyn Controller>, Failure> {
    let built = match goal {
        Some(text) => {
            let ([x, y], heading) = place(text)?;
            navigate(robot, [x, y], heading.map(f64::to_radians))
        }
        None => shield(robot),
    };
    built.map_err(|error: io::Error| Failure::input(error.to_string()))
}

/// `X,Y` or `X,Y,DEGREES`.
fn place(text: &str) -> Result<([f64; 2], Option<f64>), Failure> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(all) if all.iter().any(|number| !number.is_finite()) => {}
        Ok([x, y]) => return Ok(([*x, *y], None)),
        Ok([x, y, degrees]) => return Ok(([*x, *y], Some(*degrees))),
        _ => {}
    }
    Err(Failure::input(format!(
        "--goal {text:?}: write metres ahead and to the left of where the robot stands, and if wanted \
         degrees: 4,0 or 4,0.5,90"
    )))
}

/// Whether the adapter has connected and the motors are on, for status lines.
fn state(state: State) -> String {
    format!("{state:?}").to_lowercase()
}
