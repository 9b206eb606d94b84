//! Sines, rotations and directions over all angles.

use std::f64::consts::TAU;

use haltline::geometry::frame::Rotation;
use haltline::geometry::trig::{BEARING_ERROR, SIN_ERROR, bearing, sin_cos};
use haltline::units::BinaryAngle;

use super::parallel;
use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

const FILE: &str = "verification/src/enumerate/trig.rs";
const TURN: f64 = 4_294_967_296.0;

pub(super) fn all() -> [Enumeration; 3] {
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
            id: "angles::bearing",
            means: Means::Enumerated,
            claim: "The direction of a vector is within 1000 counts of 2^-32 turn of the exact one.",
            requirements: &["MEMORY-02"],
            domain: "all 2^24 + 1 ratios of the table's domain, in all eight octants",
            file: FILE,
            run: bearings,
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
