//! Wall times of this machine: how long a tick of the kernel takes. A measurement, not a claim.

use haltline::convert;
use haltline::input::{Beam, Command, Inputs, Motion, Reading, Scan};
use haltline::time::{Duration, Instant};
use haltline_robots::{BEAMS, Kinematics, MEMORY, Robot, SCANNERS};
use serde::Serialize;
use std::time::Instant as WallClock;

/// Ticks measured.
const TICKS: usize = 500;
/// Half the side of the square room in which the robot stands while it is measured, metres.
const ROOM_M: f64 = 4.0;
/// What it is asked to drive, m/s.
const CREEP_MPS: f64 = 0.05;

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

/// Measures ticks of a robot that creeps through a room and does what it is told.
#[must_use]
pub fn ticks(robot: &Robot) -> Option<TickTimes> {
    let mut kernel = Box::new(haltline::Kernel::<SCANNERS, BEAMS, MEMORY>::new(robot.config).ok()?);
    let period_s = robot.values.timing.period_s;
    let mut now = Instant::default().plus(Duration::from_ms(3_600_000));
    let mut motion = [0.0, 0.0];
    let mut pose = [0.0; 3];
    let mut times = Vec::with_capacity(TICKS);
    for tick in 0..TICKS {
        now = now.plus(robot.config.timing.period);
        pose[0] += motion[0] * period_s;
        let sweeps = sweeps(robot, tick);
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
            odometry: convert::odometry(now, pose, motion, Some(0.0)),
            command: command(robot, now),
            emergency_stop: false,
            reset: (tick < TICKS / 5).then_some(now),
        };
        let start = WallClock::now();
        let decision = kernel.step(&inputs, now);
        times.push(start.elapsed().as_secs_f64() * 1e6);
        motion = [speed_mps(&decision.setpoint), 0.0];
    }
    Some(TickTimes::of(times))
}

impl TickTimes {
    fn of(mut times_us: Vec<f64>) -> Self {
        times_us.sort_by(f64::total_cmp);
        let at = |part: f64| {
            let index = (part * times_us.len().saturating_sub(1) as f64).round() as usize;
            times_us.get(index).copied().unwrap_or(0.0)
        };
        Self {
            ticks: times_us.len(),
            median_us: at(0.5),
            p99_us: at(0.99),
            max_us: at(1.0),
        }
    }
}

fn command(robot: &Robot, now: Instant) -> Reading<Command> {
    match robot.values.kinematics {
        Kinematics::Differential => convert::twist_command(now, CREEP_MPS, 0.0),
        Kinematics::Ackermann(_) => convert::arc_command(now, CREEP_MPS, 0.0),
    }
}

fn speed_mps(setpoint: &Motion) -> f64 {
    let linear = match setpoint {
        Motion::Twist(twist) => twist.linear,
        Motion::Arc { linear, .. } => *linear,
    };
    f64::from(linear.as_um_per_s()) / 1e6
}

/// What the scanners see in the middle of the room, with a millimetre of ripple that differs from
/// tick to tick: no real scanner repeats itself while the robot moves.
fn sweeps(robot: &Robot, tick: usize) -> Vec<Vec<Beam>> {
    let setups = robot.config.scanners.iter().flatten();
    robot
        .values
        .scanners
        .iter()
        .zip(setups)
        .map(|(scanner, setup)| {
            (0..scanner.beams)
                .map(|index| {
                    let angle =
                        scanner.first_beam_rad() + f64::from(index) * scanner.increment_rad();
                    let (sin, cos) = angle.sin_cos();
                    let wall = (ROOM_M / cos.abs().max(1e-9)).min(ROOM_M / sin.abs().max(1e-9));
                    let ripple = ((usize::from(index) + tick) % 3) as f64 * 1e-3;
                    let range = (wall + ripple) as f32;
                    convert::beam(
                        range,
                        scanner.encoding.into(),
                        setup.range_min,
                        setup.range_max,
                    )
                })
                .collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_figures_are_ordered_and_count_every_tick() {
        let times = TickTimes::of((0..200).rev().map(f64::from).collect());
        assert_eq!(times.ticks, 200);
        assert!(times.median_us <= times.p99_us && times.p99_us <= times.max_us);
        assert!((times.max_us - 199.0).abs() < 1e-9);
    }
}
