//! Turns in microradians and of steps, over all angles.

use std::f64::consts::TAU;

use haltline::guard::tube::half_turn_counts;
use haltline::odometry::turn_urad;

use super::{FAIL_FAST, parallel};
use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

const FILE: &str = "verification/src/enumerate/angles.rs";
const TURN: f64 = 4_294_967_296.0;

pub(super) fn all() -> [Enumeration; 2] {
    [
        Enumeration {
            id: "angles::turns_round_up",
            means: Means::Enumerated,
            claim: "A turn in microradians is never less than the angle, and at most 1.01 more plus 1.2e-7 of it.",
            requirements: &["MEMORY-04"],
            domain: "all 2^32 differences of binary angles",
            file: FILE,
            run: turns,
        },
        Enumeration {
            id: "angles::half_turn_of_a_step",
            means: Means::Enumerated,
            claim: "Half the turn of a step is within 1.4 counts of 2^-32 turn of the exact one.",
            requirements: &["GUARD-21"],
            domain: "all turns of a step up to 5 degrees, in nanoradians",
            file: FILE,
            run: half_turns,
        },
    ]
}

fn turns(twin: bool) -> Result<u64, String> {
    let slack = if twin { 0.5 } else { 1.01 };
    parallel(0..1 << 32, |counts| {
        let signed = (counts as u32).cast_signed();
        let exact = f64::from(signed).abs() / TURN * TAU * 1e6;
        let found = turn_urad(signed) as f64;
        let good = found >= exact - 1e-6 && found <= exact * (1.0 + 1.2e-7) + slack;
        good.then_some(())
            .ok_or_else(|| format!("{signed}: {found} for {exact}"))
    })
}

fn half_turns(twin: bool) -> Result<u64, String> {
    let most = if twin { 0.9 } else { 1.4 };
    // A step of 1000 um turns by the curvature in nanoradians.
    let range = 87_266_464_i64;
    parallel(0..2 * range as u64 + 1, |index| {
        let turn = index as i64 - range;
        let curvature = i32::try_from(turn).map_err(|_| FAIL_FAST.to_owned())?;
        let found = half_turn_counts(curvature, 1000).as_counts().cast_signed();
        let exact = turn as f64 * 1e-9 / 2.0 / TAU * TURN;
        let error = (f64::from(found) - exact).abs();
        (error <= most)
            .then_some(())
            .ok_or_else(|| format!("{turn} nrad: {error} counts"))
    })
}
