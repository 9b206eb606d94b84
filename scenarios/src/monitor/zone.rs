//! ZONE: a return in the critical zone starts a stop in the tick that receives it.

use haltline::decision::Action;
use haltline_robots::{Robot, Scanner};

use super::usable::{returned, too_near};
use super::{Ledger, Tick};
use crate::math::{Pose, microseconds};
use crate::sensor::{RawScan, beam_time_us};

/// Returns nearer than this to the zone's border are left to the kernel's rounding and odometry.
const BORDER_M: f64 = 0.010;

pub(super) struct Zone {
    pub(super) ledger: Ledger,
}

impl Zone {
    pub(super) fn new() -> Self {
        Self {
            ledger: Ledger::new("ZONE"),
        }
    }

    /// Returns whether a return lies in the zone.
    pub(super) fn tick(&mut self, robot: &Robot, tick: &Tick<'_>, fresh_scans: &[usize]) -> bool {
        let scans = fresh_scans
            .iter()
            .filter_map(|index| tick.inputs.scans.get(*index));
        let nearest = scans
            .filter_map(|scan| nearest(robot, tick, scan))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let inside = nearest.filter(|(distance, _)| *distance < 0.0);
        self.ledger.judged(inside.is_some());
        let (Some((distance, [x, y])), true) =
            (nearest, tick.decision.action < Action::ProtectiveStop)
        else {
            return inside.is_some();
        };
        self.ledger.near(distance);
        if inside.is_some() && tick.decision.action < Action::ProtectiveStop {
            self.ledger.violated(
                tick.t_s,
                format!(
                    "a return at ({x:.3}, {y:.3}) m in the critical zone was answered with {:?}",
                    tick.decision.action
                ),
            );
        }
        inside.is_some()
    }
}

/// The return of a scan that lies farthest inside the zone or nearest to it: its signed distance and its place in
/// the body frame of now.
fn nearest(robot: &Robot, tick: &Tick<'_>, scan: &RawScan) -> Option<(f64, [f64; 2])> {
    let scanner = robot.values.scanners.get(scan.scanner)?;
    let sweep_us = microseconds(scanner.scan_time_s);
    let count = scan.ranges_m.len();
    let places = scan
        .ranges_m
        .iter()
        .enumerate()
        .filter_map(|(beam, reported)| {
            let range = returned(scanner, *reported)?;
            // Far returns are not worth the sines.
            if range > robot.values.footprint.radius_m() + 2.0 {
                return None;
            }
            let heading = scanner.first_beam_rad() + scanner.increment_rad() * beam as f64;
            let mount = Pose::new(scanner.x_m, scanner.y_m, heading);
            let then = mount.apply([range, 0.0]);
            if too_near(scanner, *reported) {
                // It may stand up to the scanner itself.
                return Some((-BORDER_M, then));
            }
            if masked(scanner, then) {
                return None;
            }
            let seen_from = (tick.pose_at)(beam_time_us(scan.begun_us, sweep_us, beam, count));
            let now = tick.pose.apply_inverse(seen_from.apply(then));
            Some((to_zone(robot, then).max(to_zone(robot, now)), now))
        });
    places.min_by(|a, b| a.0.total_cmp(&b.0))
}

pub(super) fn masked(scanner: &Scanner, [x, y]: [f64; 2]) -> bool {
    scanner
        .masks
        .iter()
        .any(|m| x >= m.x_min_m && x <= m.x_max_m && y >= m.y_min_m && y <= m.y_max_m)
}

/// Signed distance of a point to the zone without its border, metres; negative inside.
fn to_zone(robot: &Robot, [x, y]: [f64; 2]) -> f64 {
    let (outline, zone) = (&robot.values.footprint, &robot.values.zone);
    let beyond = [
        x - (outline.front_m + zone.front_m),
        -outline.rear_m - zone.side_m - x,
        y - (outline.left_m + zone.side_m),
        -outline.right_m - zone.side_m - y,
    ];
    beyond.into_iter().fold(f64::NEG_INFINITY, f64::max) + BORDER_M
}
