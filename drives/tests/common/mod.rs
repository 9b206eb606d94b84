//! Emulators and drivers as processes of their own.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    dead_code
)]

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use haltline_drives::emulator::process::Report;

const PROGRAM: &str = env!("CARGO_BIN_EXE_haltline-drives");

/// How many times slower than the world emulators and drivers live: the machine may be busy with other
/// things, and calls a loop of 20 ms late then. What is judged is judged in their time.
static SLOWNESS: AtomicU32 = AtomicU32::new(1);

/// The option that both ends get.
pub fn pace() -> [String; 2] {
    [
        "--slow".to_owned(),
        SLOWNESS.load(Ordering::Relaxed).to_string(),
    ]
}

/// The machine did not keep the rhythm: from now on everything goes at half the speed. `false` if it
/// would be slower than an eighth.
pub fn slow_down() -> bool {
    let slower = |slowness| (slowness < 8).then_some(slowness * 2);
    SLOWNESS
        .fetch_update(Ordering::Relaxed, Ordering::Relaxed, slower)
        .is_ok()
}

/// A robot file of the project with some keys changed, written where tests may write.
pub fn robot_file(name: &str, tag: &str, changes: &[(&str, &str)]) -> PathBuf {
    let (_, text) = haltline_robots::EMBEDDED
        .iter()
        .find(|(known, _)| *known == name)
        .unwrap();
    let mut used = 0;
    let lines: Vec<String> = text
        .lines()
        .map(|line| {
            let key = line.split(" = ").next().unwrap();
            match changes.iter().find(|(changed, _)| *changed == key) {
                Some((key, value)) => {
                    used += 1;
                    format!("{key} = {value}")
                }
                None => line.to_owned(),
            }
        })
        .collect();
    assert!(
        used >= changes.len(),
        "a key of {changes:?} does not exist in {name}"
    );
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join(format!("{name}-{tag}.toml"));
    std::fs::write(&path, lines.join("\n")).unwrap();
    path
}

/// An emulated robot in its own process; killed when dropped.
pub struct Emulator {
    child: Child,
    pub port: String,
    pub scan: String,
    reports: Receiver<Report>,
    pub newest: Option<Report>,
}

impl Emulator {
    pub fn start(robot: &str, port: &str, options: &[&str]) -> Self {
        let mut child = Command::new(PROGRAM)
            .args(["emulate", robot, "--port", port])
            .args(options)
            .args(pace())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let first = lines.next().expect("addresses").unwrap();
        let (port, scan) = first.split_once(' ').unwrap();
        let (sender, reports) = channel();
        std::thread::spawn(move || {
            for line in lines.map_while(Result::ok) {
                let Some(report) = Report::parse(&line) else {
                    continue;
                };
                if sender.send(report).is_err() {
                    return;
                }
            }
        });
        Self {
            child,
            port: port.to_owned(),
            scan: scan.to_owned(),
            reports,
            newest: None,
        }
    }

    /// The next report; panics if the emulator is silent for a minute.
    pub fn report(&mut self) -> Report {
        let report = self
            .reports
            .recv_timeout(Duration::from_secs(60))
            .expect("a report");
        self.newest = Some(report);
        report
    }

    /// Reads reports until one fits; `None` after `most` of the robot's time.
    pub fn until(&mut self, most: Duration, fits: impl Fn(&Report) -> bool) -> Option<Report> {
        let start_s = self.newest.map_or(0.0, |report| report.time_s);
        let end_s = start_s + most.as_secs_f64();
        while self.newest.is_none_or(|newest| newest.time_s < end_s) {
            let report = self.report();
            if fits(&report) {
                return Some(report);
            }
        }
        None
    }

    /// Throws away what was reported until now.
    pub fn skip(&mut self) {
        while let Ok(report) = self.reports.try_recv() {
            self.newest = Some(report);
        }
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A driver in its own process; killed when dropped.
pub struct Driver {
    pub child: Child,
}

impl Driver {
    pub fn start(robot: &str, emulator: &Emulator, options: &[&str], log: &Path) -> Self {
        let log = std::fs::File::create(log).unwrap();
        let child = Command::new(PROGRAM)
            .args([
                "drive",
                robot,
                "--port",
                &emulator.port,
                "--scan",
                &emulator.scan,
            ])
            .args(options)
            .args(pace())
            .stdout(log.try_clone().unwrap())
            .stderr(log)
            .spawn()
            .unwrap();
        Self { child }
    }

    /// SIGKILL: nothing of the process runs any more.
    pub fn kill(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    /// A signal by name, to this process only.
    pub fn signal(&self, name: &str) {
        let id = self.child.id().to_string();
        assert!(
            Command::new("kill")
                .args([&format!("-{name}"), &id])
                .status()
                .unwrap()
                .success()
        );
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub fn log(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.log"))
}

/// The end of a log, for messages.
pub fn tail(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let lines: Vec<&str> = text.lines().collect();
    lines[lines.len().saturating_sub(24)..].join("\n")
}
