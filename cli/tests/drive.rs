//! `haltline drive`, `emulate` and `measure` as a person uses them: two programs, a wire between them.

// A test that cannot get its files or start the command fails here, which is what `expect` is for.
#![allow(clippy::expect_used)]

mod common;

use common::{expect_exit, folder, haltline, root, stderr, stdout, write};
use std::io::{BufRead, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// The Seekur Jr with a host that is slow and often late: a machine that runs other tests, too. The
/// guard keeps the room for all of that.
fn patient_robot(folder: &Path) -> String {
    let patience = [
        ("period_s", "0.100"),
        ("jitter_s", "0.090"),
        ("scan_age_max_s", "0.400"),
        ("odometry_age_max_s", "0.400"),
        ("command_age_max_s", "0.600"),
        ("tracking_window_s", "1.0"),
    ];
    let text = std::fs::read_to_string(root().join("robots/seekur_jr.toml")).expect("robot file");
    let mut changed = 0;
    let lines: Vec<String> = text
        .lines()
        .map(|line| {
            let key = line.split(" = ").next().unwrap_or_default();
            let Some((_, value)) = patience.iter().find(|(known, _)| *known == key) else {
                return line.to_owned();
            };
            changed += 1;
            format!("{key} = {value}")
        })
        .collect();
    assert_eq!(changed, patience.len(), "a key is gone");
    write(folder, "robot.toml", &lines.join("\n"))
}

/// An emulator in its own process; ended by a signal, killed when dropped.
struct Emulator {
    child: Child,
    out: BufReader<std::process::ChildStdout>,
    port: String,
    scan: String,
}

impl Emulator {
    fn start(robot: &str, port: &str, hall_m: &str) -> Self {
        let args = [
            "emulate",
            "seekur-jr",
            "--file",
            robot,
            "--port",
            port,
            "--hall",
            hall_m,
        ];
        let mut child = Command::new(env!("CARGO_BIN_EXE_haltline"))
            .args(args)
            .current_dir(root())
            .stdout(Stdio::piped())
            .spawn()
            .expect("starts");
        let mut out = BufReader::new(child.stdout.take().expect("piped"));
        let mut line = String::new();
        out.read_line(&mut line).expect("addresses");
        let words: Vec<&str> = line.split_whitespace().collect();
        let (port, scan) = (words[1].to_owned(), words[3].to_owned());
        Self {
            child,
            out,
            port,
            scan,
        }
    }

    /// Ends it; all it said.
    fn end(mut self) -> String {
        let id = self.child.id().to_string();
        let told = Command::new("kill")
            .args(["-TERM", &id])
            .status()
            .expect("kill");
        assert!(told.success());
        let mut text = String::new();
        std::io::Read::read_to_string(&mut self.out, &mut text).expect("text");
        text
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn goal_over(port: &str) {
    let out = folder(&format!("drive_goal_{}", &port[..3]));
    let robot = patient_robot(&out);
    let trace = out.join("drive.csv").display().to_string();
    // A machine that stood still for a moment may have stopped the robot for good: try again.
    assert!(
        (0..5).any(|_| arrives(port, &robot, &trace)),
        "five drives did not arrive"
    );
    let replayed = out.join("replay").display().to_string();
    let again = [
        "replay", "--format", "sena", &trace, "--robot", &robot, "--out", &replayed,
    ];
    expect_exit(&haltline(&again), 0);
}

/// One drive, which touches nothing and ends at the goal, or in a stop that only an operator releases.
fn arrives(port: &str, robot: &str, trace: &str) -> bool {
    let emulator = Emulator::start(robot, port, "12");
    let output = haltline(&[
        "drive",
        robot,
        "--port",
        &emulator.port,
        "--scan-from",
        &emulator.scan,
        "--goal",
        "2.5,0.3,30",
        "--for",
        "90",
        "--trace",
        trace,
    ]);
    expect_exit(&output, 0);
    let emulated = emulator.end();
    assert!(emulated.contains("touched nothing"), "{emulated}");
    let text = stdout(&output);
    let arrived = text.contains("arrived");
    println!("arrived: {arrived}");
    arrived
}

#[test]
fn the_kernel_drives_to_a_goal_over_a_socket() {
    goal_over("tcp:127.0.0.1:0");
}

#[test]
fn the_kernel_drives_to_a_goal_over_a_terminal() {
    goal_over("pty");
}

/// Commands straight at a wall, written by hand; the input ends after `driven` of them.
fn shielded(
    robot: &str,
    emulator: &Emulator,
    lines: impl Fn(usize) -> Option<&'static str>,
) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_haltline"))
        .args([
            "drive",
            robot,
            "--port",
            &emulator.port,
            "--scan-from",
            &emulator.scan,
            "--shield",
        ])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let mut input = child.stdin.take().expect("piped");
    for number in 0.. {
        let Some(line) = lines(number) else { break };
        if writeln!(input, "{line}").is_err() {
            break;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    drop(input);
    child.wait_with_output().expect("ends")
}

#[test]
fn a_reckless_planner_is_stopped_before_the_wall() {
    let out = folder("drive_shield");
    let robot = patient_robot(&out);
    let emulator = Emulator::start(&robot, "tcp:127.0.0.1:0", "3");
    let start = Instant::now();
    let output = shielded(&robot, &emulator, |number| match number {
        20 => Some("fast please"),
        _ if start.elapsed() < Duration::from_secs(14) => Some("0.6 0.0"),
        _ => None,
    });
    expect_exit(&output, 0);
    let emulated = emulator.end();
    assert!(emulated.contains("touched nothing"), "{emulated}");
    assert!(
        stdout(&output).contains("GuardBlocked"),
        "{}",
        stdout(&output)
    );
    assert!(stderr(&output).contains("standard input:21: \"fast please\" is no command"));
}

/// Reads until a line has these words.
fn wait_for(text: &mut impl BufRead, words: &str) {
    let mut line = String::new();
    while !line.contains(words) {
        line.clear();
        assert!(
            text.read_line(&mut line).expect("text") > 0,
            "it ended before `{words}`"
        );
    }
}

/// Two hosts on one line would mix their bytes: the second is told who is to blame.
#[test]
fn a_port_that_another_program_holds_is_an_error() {
    let out = folder("drive_busy");
    let robot = patient_robot(&out);
    let emulator = Emulator::start(&robot, "pty", "12");
    let mut first = Command::new(env!("CARGO_BIN_EXE_haltline"))
        .args(["drive", &robot, "--port", &emulator.port])
        .args(["--scan-from", &emulator.scan, "--shield"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("starts");
    let mut said = BufReader::new(first.stdout.take().expect("piped"));
    wait_for(&mut said, "driving");
    let args = ["drive", &robot, "--port", &emulator.port];
    let output = haltline(&[&args[..], &["--scan-from", &emulator.scan, "--shield"]].concat());
    expect_exit(&output, 2);
    assert!(stderr(&output).contains("another program holds it"));
    drop(first.stdin.take());
    std::io::Read::read_to_string(&mut said, &mut String::new()).expect("the rest");
    assert!(first.wait().expect("ends").success());
    assert!(emulator.end().contains("touched nothing"));
}

/// After a loss nothing moves until somebody says so; what to do is told.
#[test]
fn a_robot_that_was_lost_and_found_waits_for_a_reset() {
    let out = folder("drive_lost");
    let robot = patient_robot(&out);
    let emulator = Emulator::start(&robot, "tcp:127.0.0.1:0", "12");
    let port = emulator.port.clone();
    let mut child = Command::new(env!("CARGO_BIN_EXE_haltline"))
        .args(["drive", &robot, "--port", &port])
        .args(["--scan-from", &emulator.scan, "--goal", "1,0"])
        .args(["--for", "120"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let mut input = child.stdin.take().expect("piped");
    let mut err = BufReader::new(child.stderr.take().expect("piped"));
    let mut out = BufReader::new(child.stdout.take().expect("piped"));
    let reader = std::thread::spawn(move || {
        let mut text = String::new();
        std::io::Read::read_to_string(&mut out, &mut text).expect("text");
        text
    });
    let id = emulator.child.id().to_string();
    let tell = |signal: &str| {
        let told = Command::new("kill").args([signal, &id]).status();
        assert!(told.expect("kill").success());
    };
    std::thread::sleep(Duration::from_millis(1500));
    // The robot is silent for longer than the link may be.
    tell("-STOP");
    wait_for(&mut err, "silent");
    std::thread::sleep(Duration::from_millis(3000));
    tell("-CONT");
    wait_for(&mut err, "write reset and Enter");
    // Nobody may be left to read the rest.
    let rest = std::thread::spawn(move || {
        let mut text = String::new();
        std::io::Read::read_to_string(&mut err, &mut text).expect("text");
    });
    while child.try_wait().expect("wait").is_none() {
        // Whoever was late may have to be reset more than once.
        let _ = writeln!(input, "reset");
        std::thread::sleep(Duration::from_millis(1000));
    }
    let text = reader.join().expect("reads");
    rest.join().expect("reads");
    assert!(text.contains("arrived"), "{text}");
    assert!(emulator.end().contains("touched nothing"));
}

/// The other robot behind the port: it is never moved, and the user is told what to look at.
#[test]
fn a_robot_that_speaks_otherwise_is_not_driven() {
    let out = folder("drive_wrong");
    let robot = patient_robot(&out);
    let emulator = Emulator::start(&robot, "tcp:127.0.0.1:0", "12");
    let mut args = vec!["drive", "robots/pses_car.toml", "--port", &emulator.port];
    args.extend(["--scan-from", &emulator.scan, "--goal", "1,0", "--for", "2"]);
    let output = haltline(&args);
    expect_exit(&output, 3);
    let said = stderr(&output);
    assert!(
        said.contains("answer to !DRV F 0  0: no answer in time"),
        "{said}"
    );
    assert!(said.contains("no robot of this kind answered"), "{said}");
    assert!(emulator.end().contains("touched nothing"));
}

#[test]
fn what_cannot_be_driven_is_an_error_that_says_what_to_write() {
    let robot = "robots/seekur_jr.toml";
    let nowhere = "tcp:127.0.0.1:1";
    let cases: [(&[&str], &str); 12] = [
        (
            &[
                "drive",
                robot,
                "--port",
                nowhere,
                "--scan-from",
                "127.0.0.1:1",
            ],
            "--goal",
        ),
        (
            &[
                "drive",
                robot,
                "--port",
                nowhere,
                "--scan-from",
                "127.0.0.1:1",
                "--shield",
            ],
            "--scan-from 127.0.0.1:1",
        ),
        (
            &[
                "drive",
                robot,
                "--port",
                nowhere,
                "--scan-from",
                "127.0.0.1:1",
                "--goal",
                "1",
            ],
            "write metres",
        ),
        (
            &[
                "drive",
                robot,
                "--port",
                nowhere,
                "--scan-from",
                "127.0.0.1:1",
                "--goal",
                "1,nan",
            ],
            "write metres",
        ),
        (
            &[
                "drive",
                "robots/jackal.toml",
                "--port",
                nowhere,
                "--scan-from",
                "127.0.0.1:1",
                "--shield",
            ],
            "--adapter",
        ),
        (
            &[
                "drive",
                robot,
                "--adapter",
                "tank",
                "--port",
                nowhere,
                "--scan-from",
                "127.0.0.1:1",
                "--shield",
            ],
            "no such adapter",
        ),
        (
            &[
                "drive",
                robot,
                "--adapter",
                "pses-car",
                "--port",
                nowhere,
                "--scan-from",
                "127.0.0.1:1",
                "--shield",
            ],
            "kinematics",
        ),
        (
            &["measure", robot, "--port", nowhere],
            "--i-have-cleared-the-floor",
        ),
        (&["emulate", "tank"], "seekur-jr or pses-car"),
        (
            &["emulate", "seekur-jr", "--port", "com1"],
            "pty, or tcp:HOST:PORT",
        ),
        (&["emulate", "seekur-jr", "--hall", "-3"], "above 0"),
        (&["emulate", "seekur-jr", "--skid", "0"], "at most 1"),
    ];
    for (args, expected) in cases {
        let output = haltline(args);
        expect_exit(&output, 2);
        assert!(
            stderr(&output).contains(expected),
            "{args:?}: {}",
            stderr(&output)
        );
    }
    let speed = [
        "measure",
        robot,
        "--port",
        nowhere,
        "--i-have-cleared-the-floor",
        "--speed",
        "9",
    ];
    let output = haltline(&speed);
    expect_exit(&output, 2);
    assert!(
        stderr(&output).contains("up to the robot's"),
        "{}",
        stderr(&output)
    );
}
