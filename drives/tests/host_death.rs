//! The controlling process dies in motion: by SIGKILL, Ctrl-C, SIGTERM, panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]
mod common;

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use common::{Driver, Emulator, log, robot_file, tail};
use haltline_drives::emulator::process::Report;

/// Kills in motion of each robot; one that stands already before the wall does not count.
const KILLS: usize = 50;
/// At a time; the machine has to keep the rhythm of all of them.
const WORKERS: usize = 5;
/// Reports come every 10 ms; scheduling of a loaded machine.
const SLACK_S: f64 = 0.06;

struct Case {
    robot: &'static str,
    port: &'static str,
    file: PathBuf,
    watchdog_s: f64,
    silent_braking: f64,
    speed: &'static str,
    ahead: &'static str,
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
/// again and again. That is no failure of what is tested here, so it may try five times.
fn moving(case: &Case, tag: &str, delay: Duration, more: &[&str]) -> (Emulator, Driver, PathBuf) {
    let log = log(&format!("{}-{tag}", case.robot));
    for _ in 0..5 {
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
    }
    panic!("{tag}: never moves:\n{}", tail(&log));
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
}

/// Follows the robot until it rests, or until it should long have.
fn silence(case: &Case, emulator: &mut Emulator) -> Option<Silence> {
    emulator.skip();
    let last = emulator.newest.unwrap();
    let mut fastest = last.heard_twist[0].abs().max(last.truth.twist[0].abs());
    // Where it was when it last heard something.
    let before_m = last.unheard_s * last.truth.twist[0].abs();
    let place = last.truth.pose;
    loop {
        let report = emulator.report();
        if report.unheard_s > 0.03 {
            fastest = fastest.max(report.truth.twist[0].abs());
        }
        let bound_s = case.watchdog_s + fastest / case.silent_braking + SLACK_S;
        if stands(&report) {
            let [x, y, _] = report.truth.pose;
            let rolled = fastest * fastest / (2.0 * case.silent_braking);
            return Some(Silence {
                rest_s: report.unheard_s,
                bound_s,
                way_m: (x - place[0]).hypot(y - place[1]) + before_m,
                most_m: fastest * (case.watchdog_s + SLACK_S) + rolled,
                contact: report.contact,
            });
        }
        if report.unheard_s > bound_s + 0.5 {
            return None;
        }
    }
}

fn kill_many(case: &Case) -> (usize, f64, f64) {
    let (next, worst) = (
        AtomicUsize::new(0),
        std::sync::Mutex::new((0_usize, 0.0_f64, 0.0_f64)),
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
                    let mut worst = worst.lock().unwrap();
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
        let (in_motion, worst, way) = kill_many(&case);
        println!(
            "{}: {in_motion} kills in motion: latest rest at {:.0} % and longest way at {:.0} % of the bound",
            case.robot,
            worst * 100.0,
            way * 100.0
        );
        assert!(in_motion >= KILLS);
    }
}

/// The false twin: a robot whose watchdog does not stop it.
#[test]
fn a_robot_without_watchdog_is_caught() {
    let _machine = machine();
    let case = seekur("pty");
    // The adapter refuses to enable a robot that tells that it has none; this one lies.
    let (mut emulator, mut driver, _) =
        moving(&case, "no-watchdog", Duration::ZERO, &["--ignore-watchdog"]);
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
    let mut emulator = Emulator::start(
        case.robot,
        case.port,
        &["--robot", file, "--hall", case.ahead],
    );
    let log = log(&format!("{}-{tag}", case.robot));
    let options = [
        "--robot",
        file,
        "--speed",
        case.speed,
        "--straight",
        "--panic-moving",
    ];
    let driver = Driver::start(case.robot, &emulator, &options, &log);
    let fast = emulator.until(Duration::from_secs(20), |r| r.truth.twist[0] > 0.1);
    assert!(fast.is_some(), "{tag}: never moves:\n{}", tail(&log));
    (emulator, driver, log)
}
