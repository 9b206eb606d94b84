//! `haltline-drives emulate|drive|measure`: an emulated robot, the loop that drives one, the bench
//! procedure.

use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use haltline_drives::clock::Clock;
use haltline_drives::control::{Control, Ending, Operator, Wish, shield};
use haltline_drives::drive::State;
use haltline_drives::emulator::process::{Process, print};
use haltline_drives::eye::Eye;
use haltline_drives::goal::navigate;
use haltline_drives::link;
use haltline_drives::measure::{self, Live};
use haltline_drives::robots::{Habits, Kind, corridor, course, follow};
use haltline_drives::trace::Trace;
use haltline_robots::Robot;
use haltline_scenarios::controller::Controller;

const USAGE: &str = "\
usage: haltline-drives emulate seekur-jr|pses-car [--port pty|tcp:ADDRESS] [--robot FILE]
                       [--hall AHEAD] [--watchdog-s S] [--ignore-watchdog] [--slow N]
       haltline-drives drive seekur-jr|pses-car --port PATH|tcp:ADDRESS --scan ADDRESS
                       [--robot FILE] [--goal X,Y[,DEG] | --speed MPS [--straight]]
                       [--for S] [--trace FILE]
                       [--persist] [--panic-moving] [--slow N]
       haltline-drives measure seekur-jr|pses-car --port PATH|tcp:ADDRESS [--robot FILE]
                       [--speed MPS]     nothing guards these motions: free floor, stop button

--slow N: both ends of a test live N times slower than the world; never with a real robot";

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let result = match words.first().map(String::as_str) {
        Some("emulate") => emulate(&words),
        Some("drive") => drive(&words),
        Some("measure") => bench(&words),
        _ => Err(bad(USAGE)),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Nobody may be left to read it.
            let _ = writeln!(io::stderr(), "haltline-drives: {error}");
            ExitCode::from(2)
        }
    }
}

fn bad(message: impl Into<String>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message.into())
}

fn option<'a>(words: &'a [String], name: &str) -> Option<&'a str> {
    let at = words.iter().position(|word| word == name)?;
    words.get(at + 1).map(String::as_str)
}

fn number(words: &[String], name: &str) -> io::Result<Option<f64>> {
    let Some(text) = option(words, name) else {
        return Ok(None);
    };
    let value = text.parse().ok().filter(|value: &f64| value.is_finite());
    match value {
        Some(value) => Ok(Some(value)),
        None => Err(bad(format!(
            "{name}: {text:?} is no number; write one such as 0.5"
        ))),
    }
}

fn clock(words: &[String]) -> io::Result<Clock> {
    let slowness = number(words, "--slow")?.unwrap_or(1.0);
    Ok(Clock::slowed(slowness.round().clamp(1.0, 100.0) as u32))
}

fn robot(words: &[String]) -> io::Result<(Kind, Robot)> {
    let name = words.get(1).map_or("", String::as_str);
    let kind = Kind::named(name).ok_or_else(|| {
        bad(format!(
            "no adapter for {name:?}; write one of {:?}\n{USAGE}",
            Kind::NAMES
        ))
    })?;
    let file = match option(words, "--robot") {
        Some(path) => Robot::load(path.as_ref()),
        None => Robot::embedded(kind.file()),
    };
    Ok((kind, file.map_err(|error| bad(error.to_string()))?))
}

fn emulate(words: &[String]) -> io::Result<()> {
    let (kind, file) = robot(words)?;
    let clock = clock(words)?;
    let world = match number(words, "--hall")? {
        Some(ahead) => corridor(ahead, 3.0, 3.0, None),
        None => course(kind).0,
    };
    let watchdog_s = number(words, "--watchdog-s")?;
    let ignores = words.iter().any(|word| word == "--ignore-watchdog");
    let habits = Habits {
        watchdog_s,
        ignores_watchdog: ignores,
        ..Habits::default()
    };
    let body = kind.emulated(&file, habits, clock.now());
    let port = option(words, "--port").unwrap_or("pty");
    let (mut process, addresses) = Process::new(body, &file, world, port, clock)?;
    let mut out = io::stdout();
    writeln!(out, "{} {}", addresses.port, addresses.scan)?;
    out.flush()?;
    let end = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&end))?;
    }
    process.run(&end, |report| {
        if print(report).is_err() {
            end.store(true, Ordering::Relaxed);
        }
    });
    Ok(())
}

fn drive(words: &[String]) -> io::Result<()> {
    let (kind, file) = robot(words)?;
    let port = option(words, "--port")
        .ok_or_else(|| bad(USAGE))?
        .to_owned();
    let scan = option(words, "--scan").ok_or_else(|| bad(USAGE))?;
    let mount = file.values.scanners.first().cloned();
    let mount = mount.ok_or_else(|| bad("the robot file has no scanner"))?;
    let mut trace = match option(words, "--trace") {
        Some(path) => Some(Trace::new(BufWriter::new(File::create(path)?), &mount)?),
        None => None,
    };
    let eye = Eye::new(Box::new(link::tcp(scan, link::CONNECT)?), mount);
    let clock = clock(words)?;
    let adapter = kind.adapter(&file, std::process::id(), clock.now());
    let opener = Box::new(move || link::open(&port, kind.baud()));
    let controller = match option(words, "--goal") {
        Some(text) => goal(&file, text)?,
        None => shield(&file)?,
    };
    let mut control = Control::new(&file, controller, adapter, opener, eye, clock)?;
    let operator = Operator::with_signals()?;
    operator.reset.store(true, Ordering::Relaxed);
    let speed = number(words, "--speed")?.unwrap_or(0.5);
    let end_s = number(words, "--for")?.unwrap_or(f64::INFINITY);
    let panics = words.iter().any(|word| word == "--panic-moving");
    let persists = words.iter().any(|word| word == "--persist");
    let straight = words.iter().any(|word| word == "--straight");
    let points = course(kind).1;
    let start = clock.now();
    let propose = |view: &haltline_drives::control::View| {
        let run_s = view.now.since(start).unwrap_or_default().as_us() as f64 * 1e-6;
        let fast = view.feedback.twist[0] > 0.15;
        assert!(!(panics && fast), "asked to panic in motion");
        let wanted = if straight {
            [speed, 0.0]
        } else {
            follow(kind, &points, view.feedback.pose, speed)
        };
        if run_s < end_s {
            Wish::Motion(view.now, wanted)
        } else {
            Wish::End
        }
    };
    let ending = control.run(&operator, propose, |tick| {
        if let Some(Err(error)) = trace.as_mut().map(|trace| trace.tick(tick)) {
            let _ = writeln!(io::stderr(), "the trace ends here: {error}");
            trace = None;
        }
        if persists && tick.state == State::Disabled {
            // An operator who switches the motors on again, whatever switched them off.
            operator.reset.store(true, Ordering::Relaxed);
        }
        // Whoever reads may have gone; the robot is more important.
        let _ = writeln!(io::stdout(), "{tick}");
    });
    let _ = writeln!(io::stdout(), "end: {ending:?} {:?}", control.account());
    match ending {
        Ending::Panicked(_) | Ending::Unreachable => Err(io::Error::other("ended badly")),
        Ending::Asked | Ending::Finished => Ok(()),
    }
}

fn goal(file: &Robot, text: &str) -> io::Result<Box<dyn Controller>> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(str::parse).collect();
    match numbers.as_deref() {
        Ok([x, y]) => navigate(file, [*x, *y], None),
        Ok([x, y, degrees]) => navigate(file, [*x, *y], Some(degrees.to_radians())),
        _ => Err(bad(format!(
            "--goal {text:?}: write metres as X,Y or X,Y,DEGREES"
        ))),
    }
}

fn bench(words: &[String]) -> io::Result<()> {
    let (kind, file) = robot(words)?;
    let port = option(words, "--port").ok_or_else(|| bad(USAGE))?;
    let speed = number(words, "--speed")?.unwrap_or(0.5);
    let clock = Clock::default();
    let adapter = kind.adapter(&file, std::process::id(), clock.now());
    let period = file.config.timing.period;
    let link = link::open(port, kind.baud())?;
    let mut live = Live::new(adapter, link, clock, period, kind == Kind::PsesCar);
    let outcome = measure::run(&file, &mut live, speed).map_err(io::Error::other)?;
    for figure in &outcome.figures {
        writeln!(io::stdout(), "{}: {figure}", figure.key)?;
    }
    for note in &outcome.notes {
        writeln!(io::stdout(), "{note}")?;
    }
    Ok(())
}
