//! Which inputs are usable, judged without the kernel's help.

use haltline_robots::{Encoding, Robot, Scanner};

use crate::controller::TickInputs;
use crate::odometry::RawOdometry;
use crate::proposer::RawCommand;
use crate::sensor::RawScan;

/// Stamps of the newest usable values, on the host's clock.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Newest {
    pub(super) scans: Vec<Option<u64>>,
    pub(super) odometry: Option<u64>,
    pub(super) command: Option<u64>,
}

impl Newest {
    pub(super) fn new(robot: &Robot) -> Self {
        Self {
            scans: vec![None; robot.values.scanners.len()],
            odometry: None,
            command: None,
        }
    }

    /// Takes in a tick's inputs; returns the indices of its scans that became the newest.
    pub(super) fn take_in(
        &mut self,
        robot: &Robot,
        inputs: &TickInputs,
        now_us: u64,
    ) -> Vec<usize> {
        let mut fresh = Vec::new();
        for (index, scan) in inputs.scans.iter().enumerate() {
            let usable = scan_usable(robot, scan) && scan.stamp_us <= now_us;
            if let Some(newest) = self.scans.get_mut(scan.scanner)
                && usable
                && newest.is_none_or(|stamp| scan.stamp_us > stamp)
            {
                *newest = Some(scan.stamp_us);
                fresh.push(index);
            }
        }
        if let Some(sample) = inputs.odometry.filter(odometry_finite) {
            raise(&mut self.odometry, sample.stamp_us, now_us);
        }
        if let Some(command) = inputs.command.filter(command_finite) {
            raise(&mut self.command, command.stamp_us, now_us);
        }
        if inputs.order_us.is_some_and(|stamp| stamp <= now_us) {
            // A route is wanted anew in every tick that hands it in.
            self.command = Some(now_us);
        }
        fresh
    }
}

fn raise(newest: &mut Option<u64>, stamp_us: u64, now_us: u64) {
    if stamp_us <= now_us && newest.is_none_or(|before| stamp_us > before) {
        *newest = Some(stamp_us);
    }
}

/// Whether a scan has the right size and no more invalid beams, in all and side by side, than allowed.
pub(super) fn scan_usable(robot: &Robot, scan: &RawScan) -> bool {
    let Some(scanner) = robot.values.scanners.get(scan.scanner) else {
        return false;
    };
    if scan.ranges_m.len() != usize::from(scanner.beams) {
        return false;
    }
    let invalid = |range: &&f32| beam_invalid(scanner, **range);
    let count = scan.ranges_m.iter().filter(invalid).count();
    let runs = scan.ranges_m.split(|range| !beam_invalid(scanner, *range));
    let widest = runs.map(<[f32]>::len).max().unwrap_or(0);
    count as f64 <= scanner.invalid_fraction_max * scan.ranges_m.len() as f64
        && widest as f64 * scanner.increment_rad().abs() <= scanner.invalid_gap_max_rad + 1e-6
}

pub(super) fn beam_invalid(scanner: &Scanner, range: f32) -> bool {
    match scanner.encoding {
        Encoding::Rep117 if range.is_infinite() => false,
        Encoding::ZeroIsInvalid if range == 0.0 => true,
        _ => !range.is_finite() || range < 0.0,
    }
}

/// Whether something stands nearer than the least range, nobody knows where.
pub(super) fn too_near(scanner: &Scanner, range: f32) -> bool {
    let rep117 = scanner.encoding == Encoding::Rep117;
    (rep117 && (range == f32::NEG_INFINITY || range == 0.0))
        || (range > 0.0 && f64::from(range) < scanner.range_min_m - 1e-6)
}

/// Distance of a return: none for no-return and invalid beams, the least range if too near.
pub(super) fn returned(scanner: &Scanner, range: f32) -> Option<f64> {
    if scanner.encoding == Encoding::Rep117 && (range == f32::NEG_INFINITY || range == 0.0) {
        return Some(scanner.range_min_m);
    }
    let range = f64::from(range);
    (range.is_finite() && range > 0.0 && range <= scanner.range_max_m)
        .then(|| range.max(scanner.range_min_m))
}

pub(super) fn odometry_finite(sample: &RawOdometry) -> bool {
    let numbers = sample.pose.iter().chain(&sample.twist);
    numbers
        .chain(&sample.curvature_per_m)
        .all(|v| v.is_finite())
}

pub(super) fn command_finite(command: &RawCommand) -> bool {
    command.motion.is_finite()
}
