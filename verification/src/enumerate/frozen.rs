//! Scans that repeat bit by bit: every way in which they may come and go while the robot drives.

use haltline::decision::StopStatus;
use haltline::input::Beam;

use std::sync::atomic::{AtomicU64, Ordering};

use super::kernel::{Event, Play};
use super::parallel_each;
use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

/// Scans after the start; each repeats the one before or differs from it.
const SCANS: u32 = 13;
/// What the robot may drive while its scans repeat, um.
const TRAVEL_UM: i64 = 60_000;

pub(super) fn all() -> [Enumeration; 1] {
    [Enumeration {
        id: "kernel::frozen_scans_stop",
        means: Means::StateSpace,
        claim: "Scans that have repeated bit by bit while the robot drove more than 60 mm stop it in the same tick.",
        requirements: &["FRESH-07"],
        domain: "all sequences of 13 scans with a return, each like the one before or not, from a running robot, on Kernel::step",
        file: "verification/src/enumerate/frozen.rs",
        run,
    }]
}

fn run(twin: bool) -> Result<u64, String> {
    let start = Play::running()?;
    let stops = AtomicU64::new(0);
    parallel_each(1 << SCANS, |repeats| {
        let mut play = start.clone();
        let (mut mark, mut since_um) = (5_000, play.odometry.pose.x_um);
        let most = if twin { TRAVEL_UM / 2 } else { TRAVEL_UM };
        for scan in 0..SCANS {
            let changed = scan == 0 || (repeats >> scan) & 1 == 0;
            mark += u16::from(changed);
            play.behind = Beam::Hit(mark);
            play.tick(Event::Fresh, false)?;
            let at_um = play.odometry.pose.x_um;
            if changed {
                since_um = at_um;
            } else if at_um - since_um > most {
                stops.fetch_add(1, Ordering::Relaxed);
                if play.status == StopStatus::Running {
                    return Err(format!(
                        "scans {repeats:b}: {} um driven on one scan, and it runs",
                        at_um - since_um
                    ));
                }
            }
        }
        Ok(())
    })?;
    match stops.into_inner() {
        0 => Err("no sequence was long enough".into()),
        _ => Ok(u64::from(SCANS) << SCANS),
    }
}
