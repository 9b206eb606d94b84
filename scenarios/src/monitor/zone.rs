//! ZONE: a return in the critical zone starts a stop in the tick that receives it.

use haltline::decision::Action;
use haltline_robots::{Robot, Scanner};

use super::usable::returned;
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

    pub(super) fn tick(&mut self, robot: &Robot, tick: &Tick<'_>, fresh_scans: &[usize]) {
        let found = fresh_scans
            .iter()
            .filter_map(|index| tick.inputs.scans.get(*index))
            .find_map(|scan| inside(robot, tick, scan));
        self.ledger.judged(found.is_some());
        let Some([x, y]) = found else {
            return;
        };
        if tick.decision.action < Action::ProtectiveStop {
            self.ledger.violated(
                tick.t_s,
                format!(
                    "a return at ({x:.3}, {y:.3}) m in the critical zone was answered with {:?}",
                    tick.decision.action
                ),
            );
        }
    }
}

/// First return of a scan inside the zone, in the body frame of now.
fn inside(robot: &Robot, tick: &Tick<'_>, scan: &RawScan) -> Option<[f64; 2]> {
    let scanner = robot.values.scanners.get(scan.scanner)?;
    let sweep_us = microseconds(scanner.scan_time_s);
    let count = scan.ranges_m.len();
    scan.ranges_m.iter().enumerate().find_map(|(beam, range)| {
        let range = returned(scanner, *range)?;
        // Far returns are not worth the sines.
        if range > robot.values.footprint.radius_m() + 2.0 {
            return None;
        }
        let heading = scanner.first_beam_rad() + scanner.increment_rad() * beam as f64;
        let mount = Pose::new(scanner.x_m, scanner.y_m, heading);
        let then = mount.apply([range, 0.0]);
        if masked(scanner, then) {
            return None;
        }
        let seen_from = (tick.pose_at)(beam_time_us(scan.begun_us, sweep_us, beam, count));
        let now = tick.pose.apply_inverse(seen_from.apply(then));
        in_zone(robot, then).then_some(())?;
        in_zone(robot, now).then_some(now)
    })
}

fn masked(scanner: &Scanner, [x, y]: [f64; 2]) -> bool {
    scanner
        .masks
        .iter()
        .any(|m| x >= m.x_min_m && x <= m.x_max_m && y >= m.y_min_m && y <= m.y_max_m)
}

fn in_zone(robot: &Robot, [x, y]: [f64; 2]) -> bool {
    let (outline, zone) = (&robot.values.footprint, &robot.values.zone);
    x < outline.front_m + zone.front_m - BORDER_M
        && x > -outline.rear_m - zone.side_m + BORDER_M
        && y < outline.left_m + zone.side_m - BORDER_M
        && y > -outline.right_m - zone.side_m + BORDER_M
}
