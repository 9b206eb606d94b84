//! The host dies: what the robot's own watchdog makes of it.

use haltline::time::Duration;

use super::bench::Bench;
use super::checks::{Outcome, fail, started};
use super::rig::Rig;
use super::twins::Twin;

/// Slower than this is rest, m/s.
const RESTS: f64 = 1e-3;

/// Not a word any more, in the middle of a motion: dead-man time plus v / b_silent, and no longer.
pub(super) fn host_death(bench: &dyn Bench, twin: Option<Twin>) -> Outcome {
    let mut rig = Rig::new(bench, twin);
    started(&mut rig, bench)?;
    let heard = rig.robot.last_heard().0;
    let v = rig.robot.truth().twist[0].abs();
    let watchdog_s = bench.watchdog().as_us() as f64 * 1e-6;
    let bound_s = watchdog_s + v / bench.silent_braking() + 0.01;
    for _ in 0..20_000 {
        rig.listen(Duration::from_ms(1));
        let silent_s = rig.now.since(heard).unwrap_or_default().as_us() as f64 * 1e-6;
        if rig.robot.truth().twist[0].abs() < RESTS {
            return Ok(format!(
                "from {v:.2} m/s at rest after {silent_s:.3} s, bound {bound_s:.3} s"
            ));
        }
        if silent_s > bound_s {
            let seen = format!("still {:?} after {silent_s:.3} s", rig.robot.truth().twist);
            return Err(fail("DRIVE-14", seen));
        }
    }
    Err(fail("DRIVE-14", "never rests".to_owned()))
}
