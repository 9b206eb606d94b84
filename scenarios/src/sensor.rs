//! A laser scanner: each beam is cast from where the robot is at that beam's own time.

use haltline_robots::{Encoding, Robot, Scanner};

use crate::file::Scenario;
use crate::math::{Pose, microseconds, seconds};
use crate::noise::Noise;
use crate::raycast::{Order, Ray, cast_in_order};
use crate::world::World;

/// A sweep as the driver delivers it, with what only the simulator knows.
#[derive(Clone, Debug, PartialEq)]
pub struct RawScan {
    /// Index of the scanner.
    pub scanner: usize,
    /// Time of the first beam on the simulator's clock, microseconds.
    pub begun_us: u64,
    /// Stamp that the host sees (faults change it).
    pub stamp_us: u64,
    /// Ranges as the format writes them, metres.
    pub ranges_m: Vec<f32>,
    /// For each beam the body that it truly came back from, if its range is a valid one.
    pub bodies: Vec<Option<usize>>,
}

/// Errors and timing of a simulated scanner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScannerModel {
    /// Standard deviation of the range.
    pub sigma_m: f64,
    /// Systematic error.
    pub bias_m: f64,
    /// Time from the first to the last beam; zero without skew.
    pub sweep_us: u64,
    /// Time between scans.
    pub interval_us: u64,
    /// Time from the last beam to the host.
    pub delay_us: u64,
    /// Part of lost beams.
    pub dropout: f64,
    /// Shortest range.
    pub range_min_m: f64,
    /// Longest range.
    pub range_max_m: f64,
}

impl ScannerModel {
    /// The robot file's scanner with what the scenario changes.
    #[must_use]
    pub fn new(scanner: &Scanner, scenario: &Scenario) -> Self {
        let sensor = &scenario.sensor;
        let skewed = sensor.skew.unwrap_or(true);
        Self {
            sigma_m: sensor
                .noise_sigma_m
                .map_or(scanner.error_sigma_m, |v| v.get()),
            // Reading too long is the dangerous direction.
            bias_m: sensor
                .bias_m
                .map_or(scanner.error_systematic_m, |v| v.get()),
            sweep_us: if skewed {
                microseconds(scanner.scan_time_s)
            } else {
                0
            },
            interval_us: microseconds(1.0 / scanner.rate_hz).max(1),
            delay_us: microseconds(sensor.delay_s.map_or(0.005, |v| v.get())),
            dropout: sensor.dropout_fraction.get(),
            range_min_m: sensor.range_min_m.map_or(scanner.range_min_m, |v| v.get()),
            range_max_m: sensor.range_max_m.map_or(scanner.range_max_m, |v| v.get()),
        }
    }
}

/// All scanners of a robot.
#[derive(Clone, Debug)]
pub struct Sensors {
    scanners: Vec<(Scanner, ScannerModel)>,
    next_us: Vec<u64>,
    /// When scanners are turned on their mounts, and by how much.
    turned: Vec<(core::ops::Range<u64>, f64)>,
    noise: Noise,
}

impl Sensors {
    /// Scanners that begin their first sweep at time zero.
    #[must_use]
    pub fn new(robot: &Robot, scenario: &Scenario, noise: Noise) -> Self {
        let scanners: Vec<_> = robot
            .values
            .scanners
            .iter()
            .map(|scanner| (scanner.clone(), ScannerModel::new(scanner, scenario)))
            .collect();
        Self {
            next_us: vec![0; scanners.len()],
            scanners,
            turned: turned(scenario),
            noise,
        }
    }

    /// Time from the first to the last beam of a scanner.
    #[must_use]
    pub fn sweep_us(&self, scanner: usize) -> u64 {
        let found = self.scanners.get(scanner);
        found.map_or(0, |(_, model)| model.sweep_us)
    }

    /// Sweeps whose last beam left no later than `now_us`, each with its arrival time.
    ///
    /// `pose_at` gives the robot's true pose at any time up to `now_us`.
    pub fn sweep(
        &mut self,
        now_us: u64,
        world: &World,
        pose_at: &dyn Fn(u64) -> Pose,
    ) -> Vec<(u64, RawScan)> {
        let mut done = Vec::new();
        for (index, (scanner, model)) in self.scanners.iter().enumerate() {
            let Some(next) = self.next_us.get_mut(index) else {
                continue;
            };
            while *next + model.sweep_us <= now_us {
                let knocks = self.turned.iter();
                let knocks = knocks.filter(|(span, _)| span.contains(next));
                let mut scanner = scanner.clone();
                scanner.yaw_rad += knocks.map(|(_, turn)| turn).sum::<f64>();
                let scan = take(
                    index,
                    &scanner,
                    model,
                    *next,
                    world,
                    pose_at,
                    &mut self.noise,
                );
                done.push((*next + model.sweep_us + model.delay_us, scan));
                *next += model.interval_us;
            }
        }
        done
    }
}

/// The faults of a scenario that turn its scanners.
fn turned(scenario: &Scenario) -> Vec<(core::ops::Range<u64>, f64)> {
    let faults = scenario.fault.iter().map(toml::Spanned::get_ref);
    faults
        .filter_map(|fault| {
            let turn = fault.turn_deg?.get().to_radians();
            let until = fault.until_s.map(|until| microseconds(until.get()));
            let from = microseconds(fault.from_s.get());
            Some((from..until.unwrap_or(u64::MAX), turn))
        })
        .collect()
}

/// What an order of bodies forgives on top of every known motion, metres.
const SLACK_M: f64 = 0.01;

/// One sweep begun at `begun_us`.
fn take(
    index: usize,
    scanner: &Scanner,
    model: &ScannerModel,
    begun_us: u64,
    world: &World,
    pose_at: &dyn Fn(u64) -> Pose,
    noise: &mut Noise,
) -> RawScan {
    let beams = usize::from(scanner.beams);
    let mut ranges_m = Vec::with_capacity(beams);
    let mut bodies = Vec::with_capacity(beams);
    let begun = pose_at(begun_us).then(Pose::new(scanner.x_m, scanner.y_m, 0.0));
    let ended = pose_at(begun_us + model.sweep_us).then(Pose::new(scanner.x_m, scanner.y_m, 0.0));
    // The scanner's own way is short, so its ends bound it; twice over, and what the bodies move.
    let own_m = libm::hypot(ended.x - begun.x, ended.y - begun.y);
    let fastest = world.bodies().iter().map(crate::world::Body::top_speed);
    let others_m = fastest.fold(0.0, f64::max) * seconds(model.sweep_us);
    let slack_m = 2.0 * own_m + others_m + SLACK_M;
    let order = Order::new(world, seconds(begun_us), [begun.x, begun.y], slack_m);
    for beam in 0..beams {
        let time_us = beam_time_us(begun_us, model.sweep_us, beam, beams);
        let heading = scanner.first_beam_rad() + scanner.increment_rad() * beam as f64;
        let mount = Pose::new(scanner.x_m, scanner.y_m, heading);
        let from = pose_at(time_us).then(mount);
        let ray = Ray::new([from.x, from.y], from.theta);
        let hit = cast_in_order(world, seconds(time_us), &ray, model.range_max_m, &order);
        // Drawn for every beam, so that one lost beam does not shift the noise of all others.
        let error = model.bias_m + model.sigma_m * noise.normal();
        let lost = noise.unit() < model.dropout;
        let (range, body) = match hit {
            _ if lost => (lost_range(scanner.encoding), None),
            None => (no_return(scanner.encoding), None),
            Some(hit) => {
                let range = (hit.range + error).max(0.001);
                if range < model.range_min_m && scanner.encoding == Encoding::Rep117 {
                    (f32::NEG_INFINITY, Some(hit.body))
                } else {
                    (range as f32, Some(hit.body))
                }
            }
        };
        ranges_m.push(range);
        bodies.push(body);
    }
    RawScan {
        scanner: index,
        begun_us,
        stamp_us: begun_us,
        ranges_m,
        bodies,
    }
}

/// Time of one beam of a sweep.
#[must_use]
pub fn beam_time_us(begun_us: u64, sweep_us: u64, beam: usize, beams: usize) -> u64 {
    begun_us + sweep_us * beam as u64 / (beams.max(2) as u64 - 1)
}

/// What the format writes for a beam that came back from nowhere.
#[must_use]
pub fn no_return(encoding: Encoding) -> f32 {
    match encoding {
        Encoding::Rep117 => f32::INFINITY,
        Encoding::ZeroIsNone | Encoding::ZeroIsInvalid => 0.0,
    }
}

/// What the format writes for a beam that was lost.
#[must_use]
pub fn lost_range(encoding: Encoding) -> f32 {
    match encoding {
        Encoding::Rep117 | Encoding::ZeroIsNone => f32::NAN,
        Encoding::ZeroIsInvalid => 0.0,
    }
}

#[cfg(test)]
mod tests;
