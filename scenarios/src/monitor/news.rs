//! The claim's second half: a new return that touches the tube starts the braking in the tick that can use its scan.
//!
//! Judged by the least that any tube holds, without a margin: the accepted motion, held for control period and latency,
//! then braked along its arc as hard as the drive surely brakes.

use haltline_robots::{Ramps, Robot};

use super::usable::{returned, too_near};
use super::zone::masked;
use super::{Tick, covers};
use crate::drive::SetPoint;
use crate::math::{Pose, microseconds};
use crate::sensor::{RawScan, beam_time_us};

/// Returns nearer than this to the outline of what is swept are left to rounding and odometry, metres.
const BORDER_M: f64 = 0.03;

/// Longest way, metres, or turn, radians, between two poses that are looked at.
const STEP: f64 = 0.02;

pub(super) struct News {
    /// Of each scanner the newest usable scan that no odometry has covered so far.
    waiting: Vec<Option<RawScan>>,
}

impl News {
    pub(super) fn new(scanners: usize) -> Self {
        Self {
            waiting: vec![None; scanners],
        }
    }

    /// What is wrong with a tick, if anything is.
    pub(super) fn tick(
        &mut self,
        robot: &Robot,
        tick: &Tick<'_>,
        fresh_scans: &[usize],
    ) -> Option<String> {
        for scan in fresh_scans.iter().filter_map(|i| tick.inputs.scans.get(*i)) {
            if let Some(slot) = self.waiting.get_mut(scan.scanner) {
                *slot = Some(scan.clone());
            }
        }
        let usable: Vec<RawScan> = self
            .waiting
            .iter_mut()
            .filter_map(|slot| slot.take_if(|scan| is_covered(robot, tick, scan)))
            .collect();
        if !tick.decision.moves() || !tick.assumptions_hold {
            return None;
        }
        let way = way(robot, tick.decision.set_point);
        let struck = usable
            .iter()
            .find_map(|scan| struck(robot, tick, scan, &way));
        struck.map(|[x, y]| {
            let action = tick.decision.action;
            format!("a new return at ({x:.3}, {y:.3}) m lies on the way and was answered with {action:?}")
        })
    }
}

/// Whether odometry covers the last beam: before that the kernel does not use a scan.
fn is_covered(robot: &Robot, tick: &Tick<'_>, scan: &RawScan) -> bool {
    let Some(scanner) = robot.values.scanners.get(scan.scanner) else {
        return false;
    };
    let ends_us = scan.stamp_us + microseconds(scanner.scan_time_s);
    tick.newest.odometry.is_some_and(|newest| newest >= ends_us)
}

/// Poses of the robot on its way to rest, seen from where it is now.
fn way(robot: &Robot, set_point: SetPoint) -> Vec<Pose> {
    let values = &robot.values;
    let (v, omega) = match set_point {
        SetPoint::Twist { v, omega } => (v, omega),
        SetPoint::Arc { v, curvature } => (v, v * curvature),
    };
    let hold_s = values.timing.period_s + values.timing.actuation_latency_s;
    // Separate ramps leave the arc.
    let joint = matches!(set_point, SetPoint::Arc { .. }) || values.limits.ramps == Ramps::Together;
    let brake_s = if joint && v != 0.0 {
        v.abs() / values.limits.braking_mps2 / 2.0
    } else {
        0.0
    };
    let all_s = hold_s + brake_s;
    let steps = (v.abs().max(omega.abs()) * all_s / STEP).ceil().max(1.0);
    (1..=steps as usize)
        .map(|step| Pose::default().advance(v, omega, all_s * step as f64 / steps))
        .collect()
}

/// A return of a scan, seen from where the robot is now, that one of these poses covers.
fn struck(robot: &Robot, tick: &Tick<'_>, scan: &RawScan, way: &[Pose]) -> Option<[f64; 2]> {
    let scanner = robot.values.scanners.get(scan.scanner)?;
    let sweep_us = microseconds(scanner.scan_time_s);
    let count = scan.ranges_m.len();
    let farthest = way.last().map_or(0.0, |pose| pose.x.hypot(pose.y));
    let reach_m = 2.0 * robot.values.footprint.radius_m() + farthest + 0.5;
    let mut beams = scan.ranges_m.iter().enumerate();
    beams.find_map(|(beam, reported)| {
        let range_m = returned(scanner, *reported).filter(|range_m| *range_m < reach_m)?;
        let heading = scanner.first_beam_rad() + scanner.increment_rad() * beam as f64;
        let mount = Pose::new(scanner.x_m, scanner.y_m, heading);
        let then = mount.apply([range_m, 0.0]);
        if too_near(scanner, *reported) || masked(scanner, then) {
            return None;
        }
        let seen_from = (tick.pose_at)(beam_time_us(scan.begun_us, sweep_us, beam, count));
        let now = tick.pose.apply_inverse(seen_from.apply(then));
        let is_on_the_way = |pose: &Pose| covers(robot, pose.apply_inverse(now), BORDER_M);
        way.iter().any(is_on_the_way).then_some(now)
    })
}
