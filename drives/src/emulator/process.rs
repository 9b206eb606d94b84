//! An emulated robot as a process of its own: a wire, a scanner's socket, and the truth on its
//! standard output.

use std::io::{self, Write};
use std::net::TcpListener;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration as Wall;

use haltline::time::Instant;
use haltline_robots::Robot as File;
use haltline_scenarios::contact::Judge;
use haltline_scenarios::math::Pose;
use haltline_scenarios::world::World;

use super::scanner::Scanner;
use super::{Robot, Truth};
use crate::clock::Clock;
use crate::link::{self, Link, accepted, listen};

/// Time between two reports.
const REPORT_EVERY: haltline::time::Duration = haltline::time::Duration::from_ms(10);

/// The wire to the host.
enum Wire {
    /// A pseudo-terminal; its path never changes.
    Terminal(Box<dyn Link>),
    /// A server; one host at a time, as the real ones: a second is turned away.
    Server(TcpListener, Option<Box<dyn Link>>),
}

/// Where the emulator can be reached.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Addresses {
    /// What to write as a port: `tcp:..` or a path.
    pub port: String,
    /// Socket address of the scanner.
    pub scan: String,
}

/// A running emulator.
pub struct Process {
    robot: Box<dyn Robot>,
    scanner: Scanner,
    world: World,
    judge: Judge,
    wire: Wire,
    scan_server: TcpListener,
    scan_host: Option<Box<dyn Link>>,
    scan_unsent: Vec<u8>,
    unsent: Vec<u8>,
    clock: Clock,
    /// Least distance so far to anything, metres, and whether it was zero while moving.
    clearance_m: f64,
    contact: bool,
}

/// One line of the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Time since the start, seconds.
    pub time_s: f64,
    /// Where it is.
    pub truth: Truth,
    /// Since when it has heard nothing, seconds.
    pub unheard_s: f64,
    /// Where it was and how fast when it last heard something.
    pub heard_at: Truth,
    /// Least distance to anything so far, metres.
    pub clearance_m: f64,
    /// It has touched something while it moved.
    pub contact: bool,
}

impl Report {
    /// As one line of text: fourteen numbers.
    #[must_use]
    pub fn line(&self) -> String {
        let words = |truth: &Truth| {
            let [x, y, theta] = truth.pose;
            let [v, w] = truth.twist;
            format!("{x:.5} {y:.5} {theta:.5} {v:.5} {w:.5}")
        };
        format!(
            "{:.4} {} {:.4} {} {:.5} {}",
            self.time_s,
            words(&self.truth),
            self.unheard_s,
            words(&self.heard_at),
            self.clearance_m,
            u8::from(self.contact),
        )
    }

    /// Reads a line of [`Report::line`].
    #[must_use]
    pub fn parse(line: &str) -> Option<Self> {
        let numbers: Vec<f64> = line
            .split(' ')
            .map(str::parse)
            .collect::<Result<_, _>>()
            .ok()?;
        let truth = |from: usize| -> Option<Truth> {
            let &[x, y, theta, v, w] = numbers.get(from..from + 5)? else {
                return None;
            };
            Some(Truth {
                pose: [x, y, theta],
                twist: [v, w],
            })
        };
        (numbers.len() == 14).then_some(())?;
        Some(Self {
            time_s: *numbers.first()?,
            truth: truth(1)?,
            unheard_s: *numbers.get(6)?,
            heard_at: truth(7)?,
            clearance_m: *numbers.get(12)?,
            contact: *numbers.get(13)? > 0.5,
        })
    }
}

impl Process {
    /// Opens the wires: `pty`, or `tcp:ADDRESS` (port 0 takes any).
    ///
    /// # Errors
    /// A wire cannot be opened, or the robot file has no scanner.
    pub fn new(
        robot: Box<dyn Robot>,
        file: &File,
        world: World,
        port: &str,
        clock: Clock,
    ) -> io::Result<(Self, Addresses)> {
        let mount = file.values.scanners.first().cloned().ok_or_else(|| {
            io::Error::new(io::ErrorKind::InvalidInput, "the robot file has no scanner")
        })?;
        let (wire, port) = match port.strip_prefix("tcp:") {
            Some(address) => {
                let server = listen(address)?;
                let port = format!("tcp:{}", server.local_addr()?);
                (Wire::Server(server, None), port)
            }
            None => {
                let (terminal, path) = link::pseudo_terminal()?;
                (Wire::Terminal(Box::new(terminal)), path)
            }
        };
        let scan_server = listen("127.0.0.1:0")?;
        let scan = scan_server.local_addr()?.to_string();
        let judge = Judge::new(&file.values.footprint, &world);
        let scanner = Scanner::new(mount, clock.now());
        let process = Self {
            robot,
            scanner,
            world,
            judge,
            wire,
            scan_server,
            scan_host: None,
            scan_unsent: Vec::new(),
            unsent: Vec::new(),
            clock,
            clearance_m: f64::INFINITY,
            contact: false,
        };
        Ok((process, Addresses { port, scan }))
    }

    /// Runs until `end` is set; hands `report` a line for every 10 ms of the robot's life.
    ///
    /// A machine that calls this late makes the robot hear late; what is reported is still true to
    /// the time it names.
    pub fn run(&mut self, end: &AtomicBool, mut report: impl FnMut(&Report)) {
        let mut next_report = self.clock.now();
        while !end.load(Ordering::Relaxed) {
            let now = self.clock.now();
            while next_report <= now {
                self.robot.step(next_report);
                self.judge(next_report);
                report(&self.report(next_report));
                next_report = next_report.plus(REPORT_EVERY);
            }
            self.exchange(now);
            self.look(now);
            std::thread::sleep(Wall::from_millis(1));
        }
    }

    fn exchange(&mut self, now: Instant) {
        self.robot.step(now);
        let said = self.robot.outgoing();
        let host = match &mut self.wire {
            Wire::Terminal(link) => Some(link),
            Wire::Server(server, host) => {
                if let Ok((stream, _)) = server.accept()
                    && host.is_none()
                {
                    *host = accepted(stream)
                        .ok()
                        .map(|link| Box::new(link) as Box<dyn Link>);
                    self.unsent.clear();
                    self.robot.reopened();
                }
                host.as_mut()
            }
        };
        let Some(host) = host else { return };
        let mut heard = Vec::new();
        // A terminal that nobody has opened is an error to read and no reason to end.
        let gone = host.read(&mut heard).is_err();
        if !heard.is_empty() {
            self.robot.receive(&heard, now);
        }
        self.unsent.extend_from_slice(&said);
        if gone || self.unsent.len() > 65_536 {
            self.unsent.clear();
        }
        if let Ok(count) = host.write(&self.unsent) {
            self.unsent.drain(..count);
        }
        if let (Wire::Server(_, host), true) = (&mut self.wire, gone) {
            *host = None;
        }
    }

    fn look(&mut self, now: Instant) {
        if let Ok((stream, _)) = self.scan_server.accept()
            && self.scan_host.is_none()
        {
            let link = accepted(stream).ok();
            self.scan_host = link.map(|link| Box::new(link) as Box<dyn Link>);
            self.scanner.disconnected();
            self.scan_unsent.clear();
        }
        let time_s = now.as_us() as f64 * 1e-6;
        let truth = self.robot.truth();
        self.scanner.step(&self.world, &truth, now, time_s);
        self.scan_unsent.extend(self.scanner.outgoing());
        let Some(host) = &mut self.scan_host else {
            return self.scan_unsent.clear();
        };
        let mut heard = Vec::new();
        let gone = host.read(&mut heard).is_err();
        self.scanner.receive(&heard);
        let written = host.write(&self.scan_unsent);
        match written {
            Ok(count) if !gone => drop(self.scan_unsent.drain(..count)),
            _ => {
                self.scan_host = None;
                self.scanner.disconnected();
            }
        }
    }

    fn judge(&mut self, now: Instant) {
        let truth = self.robot.truth();
        let [x, y, theta] = truth.pose;
        let time_s = now.as_us() as f64 * 1e-6;
        let distances = self
            .judge
            .distances(&self.world, &Pose::new(x, y, theta), time_s);
        let least = distances.into_iter().fold(f64::INFINITY, f64::min);
        self.clearance_m = self.clearance_m.min(least);
        let moving = truth.twist.iter().any(|value| value.abs() > 1e-3);
        self.contact |= least <= 0.0 && moving;
    }

    fn report(&self, now: Instant) -> Report {
        let (heard, heard_at) = self.robot.last_heard();
        Report {
            time_s: now.as_us() as f64 * 1e-6,
            truth: self.robot.truth(),
            unheard_s: now.since(heard).unwrap_or_default().as_us() as f64 * 1e-6,
            heard_at,
            clearance_m: self.clearance_m,
            contact: self.contact,
        }
    }
}

/// Writes reports to standard output until nobody reads them.
///
/// # Errors
/// Nobody reads.
pub fn print(report: &Report) -> io::Result<()> {
    let mut out = io::stdout().lock();
    writeln!(out, "{}", report.line())?;
    out.flush()
}
