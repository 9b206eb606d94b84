//! Wall times of this machine: how long a tick of the kernel takes. A measurement, not a claim.

use haltline::convert;
use haltline::input::{Beam, Inputs, Reading, Scan};
use haltline::time::{Duration, Instant};
use haltline_robots::{BEAMS, MEMORY, Robot, SCANNERS, Scanner};
use serde::Serialize;
use std::time::Instant as WallClock;

/// Ticks measured.
const TICKS: usize = 500;
/// Half the side of the square room in which the robot stands while it is measured, metres.
const ROOM_M: f64 = 4.0;

/// `timing.json`; the only output that differs between two runs.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Timing {
    /// What these figures are.
    pub note: &'static str,
    /// Contract, seconds.
    pub contract_s: f64,
    /// All scenarios, seconds.
    pub scenarios_s: f64,
    /// Runs per second of wall time.
    pub runs_per_s: f64,
    /// Ticks of the kernel, microseconds; absent if the kernel refuses the robot.
    pub tick: Option<TickTimes>,
}

/// Wall times of kernel ticks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TickTimes {
    /// Number of ticks.
    pub ticks: usize,
    /// Half of them were faster, microseconds.
    pub median_us: f64,
    /// 99 of 100 were faster, microseconds.
    pub p99_us: f64,
    /// The slowest, microseconds.
    pub max_us: f64,
}

/// Measures ticks of a robot that drives slowly through a square room.
#[must_use]
pub fn ticks(robot: &Robot) -> Option<TickTimes> {
    let mut kernel = Box::new(haltline::Kernel::<SCANNERS, BEAMS, MEMORY>::new(robot.config).ok()?);
    let period = robot.config.timing.period;
    let sweeps: Vec<Vec<Beam>> = robot
        .values
        .scanners
        .iter()
        .map(|s| room(robot, s))
        .collect();
    let mut now = Instant::default().plus(Duration::from_ms(3_600_000));
    let mut times = Vec::with_capacity(TICKS);
    for tick in 0..TICKS {
        now = now.plus(period);
        let scans: Vec<Reading<Scan<'_>>> = sweeps
            .iter()
            .zip(robot.config.scanners.iter().flatten())
            .enumerate()
            .map(|(scanner, (beams, setup))| {
                Reading::Value(Scan {
                    scanner,
                    stamp: now.minus(setup.scan_duration),
                    beams,
                })
            })
            .collect();
        let inputs = Inputs {
            scans: &scans,
            odometry: convert::odometry(now, [0.0; 3], [0.0; 2], Some(0.0)),
            command: convert::twist_command(now, 0.3, 0.1),
            emergency_stop: false,
            reset: (tick < TICKS / 10).then_some(now),
        };
        let start = WallClock::now();
        let decision = kernel.step(&inputs, now);
        times.push(start.elapsed().as_secs_f64() * 1e6);
        let _ = std::hint::black_box(decision);
    }
    times.sort_by(f64::total_cmp);
    let at = |part: f64| {
        let index = (part * (times.len() - 1) as f64).round() as usize;
        times.get(index).copied().unwrap_or(0.0)
    };
    Some(TickTimes {
        ticks: TICKS,
        median_us: at(0.5),
        p99_us: at(0.99),
        max_us: at(1.0),
    })
}

/// What a scanner sees in the middle of the room.
fn room(robot: &Robot, scanner: &Scanner) -> Vec<Beam> {
    let limits = robot
        .config
        .scanners
        .iter()
        .flatten()
        .next()
        .map_or_else(Default::default, |s| (s.range_min, s.range_max));
    (0..scanner.beams)
        .map(|index| {
            let angle = scanner.first_beam_rad() + f64::from(index) * scanner.increment_rad();
            let (sin, cos) = angle.sin_cos();
            let range = (ROOM_M / cos.abs().max(1e-9)).min(ROOM_M / sin.abs().max(1e-9));
            convert::beam(range as f32, scanner.encoding.into(), limits.0, limits.1)
        })
        .collect()
}
