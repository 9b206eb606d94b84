//! Saturation, sign and scale, feedback: the whole range of motions.

use haltline::time::Duration;

use super::bench::Bench;
use super::checks::{Outcome, fail};
use super::rig::Rig;
use super::twins::Twin;

pub(super) fn saturation(bench: &dyn Bench, twin: Option<Twin>) -> Outcome {
    let [v_max, _, turn_max] = bench.limits();
    let [v_quantum, turn_quantum] = bench.quantum();
    let mut rig = Rig::new(bench, twin);
    if !rig.start() {
        return Err(fail("DRIVE-06", "never came to drive".to_owned()));
    }
    let factors = [1.0, 1.3, 2.0, 7.0, 40.0];
    let mut cases = 0;
    for factor in factors {
        for share in [-1.0, -0.4, 0.0, 0.4, 1.0] {
            let (v, turn) = (v_max * factor, turn_max * share);
            let turn = if bench.is_arc() { turn } else { turn * factor };
            let since = rig.now;
            rig.decide(v, turn, Duration::from_us(bench.period().as_us() * 3));
            let Some(told) = rig.told_since(since).last() else {
                return Err(fail("DRIVE-06", "nothing said".to_owned()));
            };
            let wanted = if bench.is_arc() {
                turn
            } else {
                turn / v * told.linear
            };
            let slack = turn_quantum + v_quantum * (turn / v).abs() + 1e-9;
            let fits = told.linear > 0.0
                && told.linear <= v_max + 1e-9
                && (told.turn - wanted).abs() <= slack;
            if !fits {
                return Err(fail("DRIVE-06", format!("{v} {turn} becomes {told:?}")));
            }
            cases += 1;
        }
    }
    Ok(format!("{cases} motions up to 40 times too fast"))
}

pub(super) fn scale(bench: &dyn Bench, twin: Option<Twin>) -> Outcome {
    let [ahead, back, turn_max] = bench.limits();
    let [v_quantum, turn_quantum] = bench.quantum();
    let mut rig = Rig::new(bench, twin);
    if !rig.start() {
        return Err(fail("DRIVE-07", "never came to drive".to_owned()));
    }
    let mut cases = 0;
    for v_step in -20..=20 {
        let v = f64::from(v_step) / 20.0 * if v_step < 0 { back } else { ahead };
        if v_step == 0 {
            // Whoever cannot measure a direction does not change it in motion.
            rig.decide(0.0, 0.0, Duration::from_ms(4000));
        }
        for turn_step in [-10, -7, -4, -1, 0, 1, 4, 7, 10] {
            let turn = f64::from(turn_step) / 10.0 * turn_max;
            let since = rig.now;
            rig.decide(v, turn, Duration::from_us(bench.period().as_us() * 2));
            let Some(told) = rig.told_since(since).last() else {
                return Err(fail("DRIVE-07", "nothing said".to_owned()));
            };
            // A car that is faster than its set point is told to brake.
            let brakes = told.brake > 0;
            let v_error = told.linear - v;
            let turn_error = told.turn - turn;
            let wrong_sign = told.linear * v < 0.0 || told.turn * turn < -1e-3;
            let too_fast = told.linear.abs() > v.abs() + v_quantum + 1e-9;
            let off = (v_error.abs() > v_quantum + 1e-9 && !brakes)
                || turn_error.abs() > turn_quantum + 1e-9;
            if wrong_sign || off || too_fast {
                let requirement = if wrong_sign { "DRIVE-07" } else { "DRIVE-08" };
                return Err(fail(requirement, format!("{v} {turn} becomes {told:?}")));
            }
            cases += 1;
        }
    }
    Ok(format!("{cases} motions over the whole range"))
}

pub(super) fn feedback(bench: &dyn Bench, twin: Option<Twin>) -> Outcome {
    let [ahead, back, turn_max] = bench.limits();
    let mut worst: f64 = 0.0;
    for (v, turn) in [
        (0.6, 0.5),
        (0.6, -0.5),
        (-0.8, 0.5),
        (-0.8, -0.5),
        (0.4, 0.0),
    ] {
        let mut rig = Rig::new(bench, twin);
        let v = v * if v < 0.0 { back } else { ahead };
        if !rig.cruise(v, turn * turn_max) {
            return Err(fail("DRIVE-07", "never came to drive".to_owned()));
        }
        rig.decide(v, turn * turn_max, Duration::from_ms(1500));
        let truth = rig.robot.truth();
        let Some(feedback) = rig.feedback else {
            return Err(fail("DRIVE-07", "no feedback".to_owned()));
        };
        let speed = feedback.twist[0] - truth.twist[0];
        let rate = feedback.twist[1] - truth.twist[1];
        let age = rig.now.since(feedback.stamp).unwrap_or_default().as_us() as f64 * 1e-6;
        let [x, y, _] = truth.pose;
        let away = (feedback.pose[0] - x).hypot(feedback.pose[1] - y) - age * v.abs();
        // Two seconds of even acceleration and 2.1 s at full speed.
        let path = v.abs() * 3.1;
        worst = worst.max(away / path);
        if speed.abs() > 0.03 || rate.abs() > 0.03 || away > 0.03 * path + 0.03 {
            let seen = format!(
                "truth {truth:?}, told {:?} {:?}",
                feedback.pose, feedback.twist
            );
            return Err(fail("DRIVE-07", seen));
        }
        if truth.twist[0] * v < 0.0 || (truth.twist[1] * turn * v < 0.0 && bench.is_arc()) {
            return Err(fail("DRIVE-07", format!("drives the other way: {truth:?}")));
        }
    }
    Ok(format!(
        "worst position error {:.1} % of the path",
        worst * 100.0
    ))
}
