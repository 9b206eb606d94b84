//! Sines, rotations and turns over all angles.

use std::f64::consts::TAU;

use haltline::geometry::frame::Rotation;
use haltline::geometry::trig::{BEARING_ERROR, SIN_ERROR, bearing, sin_cos};
use haltline::guard::tube::half_turn_counts;
use haltline::odometry::turn_urad;
use haltline::units::BinaryAngle;

use super::{FAIL_FAST, parallel};
use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

const FILE: &str = "verification/src/enumerate/angles.rs";
const TURN: f64 = 4_294_967_296.0;

pub(super) fn all() -> [Enumeration; 5] {
    [
        Enumeration {
            id: "angles::sine_and_cosine",
            means: Means::Enumerated,
            claim: "Sine and cosine are within 440 counts of 2^-30 of the exact value.",
            requirements: &["GUARD-21"],
            domain: "all 2^32 binary angles, against the sine of the C library",
            file: FILE,
            run: sines,
        },
        Enumeration {
            id: "angles::rotation_fits",
            means: Means::Enumerated,
            claim: "A rotation's components are within 0.514 counts of 2^-15, and with offsets up to 46340 no product sum leaves 32 bits.",
            requirements: &["GUARD-18", "GUARD-21"],
            domain: "all 2^32 binary angles; |cos| + |sin| <= 46341",
            file: FILE,
            run: rotations,
        },
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
            id: "angles::bearing",
            means: Means::Enumerated,
            claim: "The direction of a vector is within 1000 counts of 2^-32 turn of the exact one.",
            requirements: &["MEMORY-02"],
            domain: "all 2^24 + 1 ratios of the table's domain, in all eight octants",
            file: FILE,
            run: bearings,
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

fn sines(twin: bool) -> Result<u64, String> {
    let most = if twin { 300.0 } else { f64::from(SIN_ERROR) };
    parallel(0..1 << 32, |counts| {
        let (sin, cos) = sin_cos(BinaryAngle::from_counts(counts as u32));
        let (exact_sin, exact_cos) = (counts as f64 / TURN * TAU).sin_cos();
        let scale = 1_073_741_824.0;
        let error = (f64::from(sin) - exact_sin * scale)
            .abs()
            .max((f64::from(cos) - exact_cos * scale).abs());
        (error <= most)
            .then_some(())
            .ok_or_else(|| format!("angle {counts}: error {error}"))
    })
}

fn rotations(twin: bool) -> Result<u64, String> {
    let most = if twin { 46_340 } else { 46_341 };
    parallel(0..1 << 32, |counts| {
        let angle = BinaryAngle::from_counts(counts as u32);
        let turned = Rotation::new(angle);
        let (sin, cos) = sin_cos(angle);
        let off = |part: i32, fine: i32| (i64::from(part) * 32_768 - i64::from(fine)).abs();
        let near = off(turned.sin, sin) <= 16_384 && off(turned.cos, cos) <= 16_384;
        let sum = turned.sin.abs() + turned.cos.abs();
        let fits = sum <= most && i64::from(sum) * 46_340 < 1 << 31;
        (near && fits)
            .then_some(())
            .ok_or_else(|| format!("angle {counts}: {turned:?}"))
    })
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

fn bearings(twin: bool) -> Result<u64, String> {
    let most = if twin {
        300.0
    } else {
        f64::from(BEARING_ERROR)
    };
    parallel(0..(1 << 24) + 1, |ratio| {
        let (large, small) = (1 << 24, ratio as i32);
        for (x, y) in [(large, small), (small, large)] {
            for (x, y) in [(x, y), (-x, y), (x, -y), (-x, -y)] {
                let exact = f64::from(y).atan2(f64::from(x)) / TAU * TURN;
                let found = f64::from(bearing(x, y).as_counts());
                let error = (found - exact).rem_euclid(TURN);
                let error = error.min(TURN - error);
                if error > most {
                    return Err(format!("({x}, {y}): {error} counts"));
                }
            }
        }
        Ok(())
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
