//! The controlling process dies in motion: by SIGKILL, Ctrl-C, SIGTERM, panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]
mod common;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use common::{Driver, Emulator, log, robot_file, slow_down, tail};
use haltline_drives::emulator::process::Report;

/// Kills in motion of each robot; one that stands already before the wall does not count.
const KILLS: usize = 50;
/// At a time; the machine has to keep the rhythm of all of them.
const WORKERS: usize = 5;
/// Reports come every 10 ms of the robot's time; the rest is its dynamics step and rounding.
const SLACK_S: f64 = 0.015;

struct Case {
    robot: &'static str,
    port: &'static str,
    file: PathBuf,
    watchdog_s: f64,
    silent_braking: f64,
    speed: &'static str,
    ahead: &'static str,
}

/// The tube that the kernel accepted in the last tick before the host died, from the driver's log.
#[derive(Debug)]
struct Tube {
    /// Odometry at that tick: m, m, rad.
    from: [f64; 3],
    /// Longest path to rest, m.
    path_m: f64,
    /// How far the outline may be beside that path, m.
    margin_m: f64,
}

impl Tube {
    /// Of the last tick that was written whole, if its motion was accepted.
    fn last(log: &Path) -> Option<Self> {
        let text = std::fs::read_to_string(log).unwrap();
        let blocks: Vec<&str> = text.split("drive     ").collect();
        // The last block may have been cut by the kill.
        let whole = |block: &&&str| block.contains("\ndeadlines ") && block.ends_with('\n');
        let block = blocks.iter().rev().find(whole)?;
        let numbers = |name: &str| -> Option<Vec<f64>> {
            let line = block.lines().find(|line| line.starts_with(name))?;
            let words = line.split(|c: char| c.is_whitespace() || c == ',');
            Some(words.filter_map(|word| word.parse().ok()).collect())
        };
        let (tube, pose) = (numbers("tube ")?, numbers("pose ")?);
        Some(Self {
            from: [pose[0], pose[1], pose[2].to_radians()],
            path_m: tube[0],
            margin_m: tube[2],
        })
    }

    /// Whether a robot that drove straight on and rests here has stayed in it.
    fn holds(&self, rest: [f64; 3]) -> bool {
        let (dx, dy) = (rest[0] - self.from[0], rest[1] - self.from[1]);
        let (sin, cos) = self.from[2].sin_cos();
        let (along, across) = (cos * dx + sin * dy, cos * dy - sin * dx);
        along <= self.path_m + self.margin_m && across.abs() <= self.margin_m
    }
}

fn seekur(port: &'static str) -> Case {
    seekur_with(port, "0.5", 0.5)
}

fn seekur_with(port: &'static str, watchdog: &str, watchdog_s: f64) -> Case {
    Case {
        robot: "seekur-jr",
        port,
        file: robot_file(
            "seekur_jr",
            &format!("death-{}-{watchdog}", &port[..3]),
            &[
                ("watchdog_s", watchdog),
                ("cover_host_death", "true"),
                ("jitter_s", "0.020"),
            ],
        ),
        watchdog_s,
        silent_braking: 0.3,
        speed: "0.5",
        ahead: "3.0",
    }
}

fn car() -> Case {
    car_with("0.2", 0.2)
}

fn car_with(watchdog: &str, watchdog_s: f64) -> Case {
    Case {
        robot: "pses-car",
        port: "tcp:127.0.0.1:0",
        file: robot_file(
            "pses_car",
            &format!("death-{watchdog}"),
            &[
                ("watchdog_s", watchdog),
                ("cover_host_death", "true"),
                ("jitter_s", "0.015"),
            ],
        ),
        watchdog_s,
        silent_braking: 0.3,
        speed: "0.4",
        ahead: "2.6",
    }
}

fn stands(report: &Report) -> bool {
    report.truth.twist.iter().all(|value| value.abs() < 1e-3)
}

/// Drives, waits until the robot is fast and then `delay`, and hands over both.
///
/// A machine that is busy with other things may call the loop so late that the robot is stopped
/// again and again. That is no failure of what is tested here, so it may try again, more slowly.
fn moving(case: &Case, tag: &str, delay: Duration, more: &[&str]) -> (Emulator, Driver, PathBuf) {
    let log = log(&format!("{}-{tag}", case.robot));
    loop {
        let file = case.file.to_str().unwrap();
        let options = [&["--robot", file, "--hall", case.ahead], more].concat();
        let mut emulator = Emulator::start(case.robot, case.port, &options);
        let options = ["--robot", file, "--speed", case.speed, "--straight"];
        let driver = Driver::start(case.robot, &emulator, &options, &log);
        let fast = emulator.until(Duration::from_secs(15), |r| r.truth.twist[0] > 0.15);
        if let Some(fast) = fast {
            let end_s = fast.time_s + delay.as_secs_f64();
            emulator.until(Duration::from_secs(5), |r| r.time_s > end_s);
            return (emulator, driver, log);
        }
        assert!(slow_down(), "{tag}: never moves:\n{}", tail(&log));
    }
}

/// One test at a time: each needs the rhythm of a machine that is not too busy.
static MACHINE: std::sync::Mutex<()> = std::sync::Mutex::new(());

fn machine() -> std::sync::MutexGuard<'static, ()> {
    MACHINE
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// What happened after the host fell silent.
struct Silence {
    rest_s: f64,
    bound_s: f64,
    /// Way since the last word, and the most the contract allows.
    way_m: f64,
    most_m: f64,
    contact: bool,
    rest: [f64; 3],
}

/// Follows the robot until it rests, or until it should long have.
fn silence(case: &Case, emulator: &mut Emulator) -> Option<Silence> {
    let (mut fastest, mut unheard_s) = (0.0_f64, f64::INFINITY);
    loop {
        let report = emulator.report();
        if report.unheard_s < unheard_s {
            // It has heard something since, from a wire or a queue on the way.
            fastest = report.heard_at.twist[0].abs();
        }
        unheard_s = report.unheard_s;
        fastest = fastest.max(report.truth.twist[0].abs());
        let bound_s = case.watchdog_s + fastest / case.silent_braking + SLACK_S;
        if stands(&report) {
            let [x, y, _] = report.truth.pose;
            let [x0, y0, _] = report.heard_at.pose;
            let rolled = fastest * fastest / (2.0 * case.silent_braking);
            return Some(Silence {
                rest_s: report.unheard_s,
                bound_s,
                way_m: (x - x0).hypot(y - y0),
                most_m: fastest * (case.watchdog_s + SLACK_S) + rolled,
                contact: report.contact,
                rest: report.truth.pose,
            });
        }
        if report.unheard_s > bound_s + 0.5 {
            return None;
        }
    }
}

fn kill_many(case: &Case) -> (usize, f64, f64, [usize; 2]) {
    let (next, worst) = (
        AtomicUsize::new(0),
        std::sync::Mutex::new((0_usize, 0.0_f64, 0.0_f64, [0_usize; 2])),
    );
    std::thread::scope(|scope| {
        for _ in 0..WORKERS {
            scope.spawn(|| {
                loop {
                    let round = next.fetch_add(1, Ordering::Relaxed);
                    if worst.lock().unwrap().0 >= KILLS {
                        return;
                    }
                    let delay = Duration::from_millis((round as u64 * 37) % 900);
                    let tag = format!("kill-{round}");
                    let (mut emulator, mut driver, log) = moving(case, &tag, delay, &[]);
                    emulator.skip();
                    let at_kill = emulator.newest.unwrap();
                    driver.kill();
                    let seen = silence(case, &mut emulator)
                        .unwrap_or_else(|| panic!("{tag}: rolls on: {:?}", emulator.newest));
                    assert!(!seen.contact, "{tag}: touches the wall\n{}", tail(&log));
                    assert!(
                        seen.rest_s <= seen.bound_s,
                        "{tag}: rests after {} s, bound {} s",
                        seen.rest_s,
                        seen.bound_s
                    );
                    assert!(
                        seen.way_m <= seen.most_m,
                        "{tag}: rolls {} m, the contract says {} m",
                        seen.way_m,
                        seen.most_m
                    );
                    let tube = Tube::last(&log);
                    let mut worst = worst.lock().unwrap();
                    if let Some(tube) = &tube {
                        let [judged, inside] = &mut worst.3;
                        *judged += 1;
                        *inside += usize::from(tube.holds(seen.rest));
                    }
                    worst.0 += usize::from(!stands(&at_kill));
                    worst.1 = worst.1.max(seen.rest_s / seen.bound_s);
                    worst.2 = worst.2.max(seen.way_m / seen.most_m);
                }
            });
        }
    });
    worst.into_inner().unwrap()
}

//= spec/drive.md#drive-14
//= type=test
//# When the controlling process is killed, the robot MUST rest no later than its dead-man time plus `v / b_silent` after it last heard a set point.
#[test]
fn a_hundred_kills_in_motion_end_at_rest_in_time_and_without_contact() {
    let _machine = machine();
    for case in [seekur("tcp:127.0.0.1:0"), car()] {
        let (in_motion, worst, way, [judged, inside]) = kill_many(&case);
        println!(
            "{}: {in_motion} kills in motion: latest rest at {:.0} % and longest way at {:.0} % of the bound; \
             {inside} of {judged} inside the accepted tube",
            case.robot,
            worst * 100.0,
            way * 100.0
        );
        assert!(in_motion >= KILLS && judged >= KILLS * 8 / 10);
        assert_eq!(inside, judged, "{}: outside the accepted tube", case.robot);
    }
}

/// The false twin of the tube: when the robot file does not ask to cover the host's death, the tube
/// ends before the robot rests.
#[test]
fn a_tube_that_does_not_cover_the_death_of_the_host_is_left() {
    let _machine = machine();
    let mut case = seekur("tcp:127.0.0.1:0");
    case.file = robot_file(
        "seekur_jr",
        "death-uncovered",
        &[("watchdog_s", "0.5"), ("jitter_s", "0.020")],
    );
    let mut left = 0;
    for round in 0..3 {
        let tag = format!("uncovered-{round}");
        let (mut emulator, mut driver, log) = moving(&case, &tag, Duration::from_millis(600), &[]);
        emulator.skip();
        driver.kill();
        let seen = silence(&case, &mut emulator).unwrap();
        left += usize::from(Tube::last(&log).is_some_and(|tube| !tube.holds(seen.rest)));
    }
    assert!(left > 0, "no kill left the tube: the measure shows nothing");
}

/// The false twin: a robot whose watchdog does not stop it.
#[test]
fn a_robot_without_watchdog_is_caught() {
    let _machine = machine();
    let case = seekur("pty");
    // The adapter refuses to enable a robot that tells that it has none; this one lies.
    let (mut emulator, mut driver, _) =
        moving(&case, "no-watchdog", Duration::ZERO, &["--ignore-watchdog"]);
    emulator.skip();
    driver.kill();
    let silence = silence(&case, &mut emulator);
    assert!(silence.is_none_or(|seen| seen.contact || seen.rest_s > seen.bound_s));
}

/// An adapter does not enable a robot whose watchdog is off or longer than its file says.
//= spec/drive.md#drive-10
//= type=test
//# An adapter MUST read back the dead-man time of its drive and refuse to enable it when it is off or longer than the robot file says.
#[test]
fn a_robot_that_tells_a_longer_watchdog_is_not_driven() {
    let _machine = machine();
    let case = seekur("pty");
    let file = case.file.to_str().unwrap();
    let options = ["--robot", file, "--hall", "4", "--watchdog-s", "2"];
    let mut emulator = Emulator::start(case.robot, case.port, &options);
    let log = log("long-watchdog");
    let mut driver = Driver::start(
        case.robot,
        &emulator,
        &["--robot", file, "--straight", "--for", "3"],
        &log,
    );
    assert!(driver.child.wait().unwrap().success());
    let end = emulator.report();
    assert!(stands(&end) && end.truth.pose[0].abs() < 1e-6, "{end:?}");
    let said = std::fs::read_to_string(&log).unwrap();
    assert!(
        said.contains("dead-man time is 2000 ms, the robot file allows 500 ms"),
        "{}",
        tail(&log)
    );
}

//= spec/drive.md#drive-13
//= type=test
//# Ctrl-C, a request to terminate and a panic MUST end the drive with a ramp to rest on the wire.
#[test]
fn signals_and_panics_end_in_a_ramp_and_a_good_bye() {
    let _machine = machine();
    // Long enough that a busy machine does not end them by the watchdog instead.
    for case in [seekur_with("pty", "1.5", 1.5), car_with("1.0", 1.0)] {
        for way in ["INT", "TERM", "panic"] {
            let tag = format!("ends-by-{way}");
            let (mut emulator, mut driver, log) = if way == "panic" {
                panicking(&case, &tag)
            } else {
                moving(&case, &tag, Duration::from_millis(200), &[])
            };
            emulator.skip();
            if way != "panic" {
                driver.signal(way);
            }
            let start = emulator.report();
            let v = start.truth.twist[0];
            let rest = emulator
                .until(Duration::from_secs(6), stands)
                .expect("rests");
            // Braked by the host and not by the watchdog: it was spoken to until the end.
            assert!(
                rest.unheard_s < case.watchdog_s,
                "{tag}: {rest:?}\n{}",
                tail(&log)
            );
            let took = rest.time_s - start.time_s;
            assert!(
                took < v / 0.5 + 1.5,
                "{tag}: rests after {took} s from {v} m/s"
            );
            assert!(!rest.contact);
            let success = driver.child.wait().unwrap().success();
            assert_eq!(success, way != "panic", "{tag}:\n{}", tail(&log));
        }
    }
}

fn panicking(case: &Case, tag: &str) -> (Emulator, Driver, PathBuf) {
    let file = case.file.to_str().unwrap();
    let log = log(&format!("{}-{tag}", case.robot));
    loop {
        let options = ["--robot", file, "--hall", case.ahead];
        let mut emulator = Emulator::start(case.robot, case.port, &options);
        let options = [
            "--robot",
            file,
            "--speed",
            case.speed,
            "--straight",
            "--panic-moving",
        ];
        let driver = Driver::start(case.robot, &emulator, &options, &log);
        let fast = emulator.until(Duration::from_secs(15), |r| r.truth.twist[0] > 0.1);
        if fast.is_some() {
            return (emulator, driver, log);
        }
        assert!(slow_down(), "{tag}: never moves:\n{}", tail(&log));
    }
}
