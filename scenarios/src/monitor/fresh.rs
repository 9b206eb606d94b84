//! FRESH: no motion is let through on a scan, odometry or command older than its limit.

use haltline_robots::Robot;

use super::{Ledger, Tick};

pub(super) struct Fresh {
    pub(super) ledger: Ledger,
}

impl Fresh {
    pub(super) fn new() -> Self {
        Self {
            ledger: Ledger::new("FRESH"),
        }
    }

    pub(super) fn tick(&mut self, robot: &Robot, tick: &Tick<'_>) {
        let timing = &robot.values.timing;
        let newest = &tick.newest;
        let scans = newest
            .scans
            .iter()
            .map(|stamp| ("scan", *stamp, timing.scan_age_max_s));
        let others = [
            ("odometry", newest.odometry, timing.odometry_age_max_s),
            ("command", newest.command, timing.command_age_max_s),
        ];
        let channels: Vec<_> = scans.chain(others).collect();
        let left = channels.iter().filter_map(|(_, stamp, limit_s)| {
            let age_us = tick.now_us.checked_sub((*stamp)?)?;
            Some(limit_s - age_us as f64 * 1e-6)
        });
        if let Some(left) = left.reduce(f64::min)
            && tick.decision.moves()
        {
            self.ledger.near(left);
        }
        let stale: Vec<String> = channels
            .into_iter()
            .filter_map(|(what, stamp, limit_s)| complaint(what, stamp, limit_s, tick.now_us))
            .collect();
        self.ledger.judged(!stale.is_empty());
        if tick.decision.moves() {
            for what in stale {
                self.ledger
                    .violated(tick.t_s, format!("motion was let through although {what}"));
            }
        }
    }
}

fn complaint(what: &str, stamp_us: Option<u64>, limit_s: f64, now_us: u64) -> Option<String> {
    let Some(stamp_us) = stamp_us else {
        return Some(format!("no usable {what} ever arrived"));
    };
    let Some(age_us) = now_us.checked_sub(stamp_us) else {
        return Some(format!("the newest {what} lies in the future"));
    };
    let age_s = age_us as f64 * 1e-6;
    // The robot file's times are rounded to whole microseconds.
    (age_s > limit_s + 1e-6).then(|| format!("the newest {what} is {age_s:.3} s old"))
}
