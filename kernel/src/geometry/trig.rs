//! Sine, cosine and arc tangent from tables, for every binary angle.
//!
//! No transcendental function runs in the kernel: the tables are computed at
//! compile time and checked over their whole domain by tests.

// Table construction runs at compile time, in floats; the casts below are
// exact or bounded by construction and checked by the tests.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss
)]

use crate::units::BinaryAngle;

/// Fractional bits of [`sin_cos`].
pub const SIN_BITS: u32 = 30;
/// Largest error of [`sin_cos`] in counts of 2⁻³⁰ (4.1e-7), tested over the whole domain.
pub const SIN_ERROR: i32 = 440;
/// Largest error of [`bearing`] in counts of 2⁻³² turn (1.5e-6 rad), tested.
pub const BEARING_ERROR: u32 = 1000;

const QUARTER: usize = 1024;
const SIN_TABLE: [i32; QUARTER + 1] = sine_table();
const OCTANT: usize = 256;
const ATAN_TABLE: [u32; OCTANT + 1] = arc_tangent_table();

/// `(sin, cos)` of `angle` with 30 fractional bits.
///
/// # Bound
/// O(1); error at most [`SIN_ERROR`].
#[must_use]
pub fn sin_cos(angle: BinaryAngle) -> (i32, i32) {
    (
        sine(angle.as_counts()),
        sine(angle.as_counts().wrapping_add(1 << 30)),
    )
}

fn sine(counts: u32) -> i32 {
    let within = counts & 0x3fff_ffff;
    let magnitude = match counts >> 30 {
        0 | 2 => quarter_sine(within),
        _ => quarter_sine((1_u32 << 30).saturating_sub(within)),
    };
    if counts >> 31 == 0 {
        magnitude
    } else {
        magnitude.saturating_neg()
    }
}

/// Sine on the first quadrant; `within` in `0..=2^30`.
fn quarter_sine(within: u32) -> i32 {
    let index = (within >> 20) as usize;
    let fraction = i64::from(within & 0xf_ffff);
    let low = SIN_TABLE.get(index).copied().unwrap_or(1 << 30);
    let high = SIN_TABLE
        .get(index.saturating_add(1))
        .copied()
        .unwrap_or(1 << 30);
    let rise = i64::from(high.saturating_sub(low));
    low.saturating_add((rise.saturating_mul(fraction) >> 20) as i32)
}

/// Direction of the vector `(x, y)`; the zero vector has direction zero.
///
/// # Bound
/// O(1), one division; error at most [`BEARING_ERROR`] for components up to 2³¹.
#[must_use]
pub fn bearing(x: i32, y: i32) -> BinaryAngle {
    let (ax, ay) = (u64::from(x.unsigned_abs()), u64::from(y.unsigned_abs()));
    let (small, large) = if ax < ay { (ax, ay) } else { (ay, ax) };
    // `large` is zero only for the zero vector.
    let ratio = (small << 24).checked_div(large).unwrap_or(0);
    let octant = octant_arc_tangent(ratio as u32);
    let quadrant = if ax < ay {
        (1_u32 << 30).wrapping_sub(octant)
    } else {
        octant
    };
    let half = if x < 0 {
        (1_u32 << 31).wrapping_sub(quadrant)
    } else {
        quadrant
    };
    BinaryAngle::from_counts(if y < 0 { half.wrapping_neg() } else { half })
}

/// Arc tangent of `ratio / 2^24`, ratio in `0..=2^24`, in counts.
fn octant_arc_tangent(ratio: u32) -> u32 {
    let index = (ratio >> 16) as usize;
    let fraction = u64::from(ratio & 0xffff);
    let low = ATAN_TABLE.get(index).copied().unwrap_or(1 << 29);
    let high = ATAN_TABLE
        .get(index.saturating_add(1))
        .copied()
        .unwrap_or(1 << 29);
    let rise = u64::from(high.saturating_sub(low));
    low.saturating_add((rise.saturating_mul(fraction) >> 16) as u32)
}

#[allow(clippy::indexing_slicing, clippy::arithmetic_side_effects)]
const fn sine_table() -> [i32; QUARTER + 1] {
    let mut table = [0; QUARTER + 1];
    let mut index = 0;
    while index <= QUARTER {
        let x = core::f64::consts::FRAC_PI_2 * (index as f64) / (QUARTER as f64);
        let (mut term, mut sum, mut order) = (x, x, 1.0);
        while order < 24.0 {
            term *= -x * x / ((order + 1.0) * (order + 2.0));
            sum += term;
            order += 2.0;
        }
        table[index] = (sum * 1_073_741_824.0 + 0.5) as i32;
        index += 1;
    }
    table
}

#[allow(clippy::indexing_slicing, clippy::arithmetic_side_effects)]
const fn arc_tangent_table() -> [u32; OCTANT + 1] {
    let mut table = [0; OCTANT + 1];
    let mut index = 0;
    while index <= OCTANT {
        let ratio = (index as f64) / (OCTANT as f64);
        // Two halvings of the angle make the series converge quickly.
        let x = half_tangent(half_tangent(ratio));
        let (mut power, mut sum, mut order) = (x, x, 1.0);
        while order < 40.0 {
            power *= -x * x;
            order += 2.0;
            sum += power / order;
        }
        let turns = 4.0 * sum / core::f64::consts::TAU;
        table[index] = (turns * 4_294_967_296.0 + 0.5) as u32;
        index += 1;
    }
    table
}

/// tan(a/2) from tan(a).
#[allow(clippy::arithmetic_side_effects)]
const fn half_tangent(tangent: f64) -> f64 {
    let square = 1.0 + tangent * tangent;
    let mut root = square;
    let mut step = 0;
    while step < 40 {
        root = 0.5 * (root + square / root);
        step += 1;
    }
    tangent / (1.0 + root)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every 2⁻²⁰ turn and its neighbours; the ignored test below walks all 2³².
    fn worst_sine_error(step: usize) -> f64 {
        (0..=u32::MAX)
            .step_by(step)
            .map(|counts| {
                let exact = (f64::from(counts) / 4_294_967_296.0 * core::f64::consts::TAU).sin();
                (f64::from(sine(counts)) - exact * 1_073_741_824.0).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn sine_is_within_its_declared_error() {
        let worst = worst_sine_error(977);
        assert!(worst <= f64::from(SIN_ERROR), "worst {worst}");
        // The bound is not idle: it is within a factor of two of what happens.
        assert!(worst * 2.0 > f64::from(SIN_ERROR), "worst {worst}");
    }

    #[test]
    #[ignore = "enumerates all 2^32 angles; run by the long checks"]
    fn sine_is_within_its_declared_error_everywhere() {
        assert!(worst_sine_error(1) <= f64::from(SIN_ERROR));
    }

    #[test]
    fn bearing_is_within_its_declared_error() {
        let mut worst = 0_u32;
        for x in (-4000..=4000).step_by(37) {
            for y in (-4000..=4000).step_by(41) {
                if x == 0 && y == 0 {
                    continue;
                }
                let exact = f64::from(y).atan2(f64::from(x)) / core::f64::consts::TAU;
                let counts = (exact * 4_294_967_296.0).rem_euclid(4_294_967_296.0) as u64 as u32;
                let error = bearing(x, y)
                    .minus(BinaryAngle::from_counts(counts))
                    .unsigned_abs();
                worst = worst.max(error);
            }
        }
        assert!(worst <= BEARING_ERROR, "worst {worst}");
        assert!(worst * 2 > BEARING_ERROR, "worst {worst}");
    }

    #[test]
    fn bearing_of_nothing_is_zero() {
        assert_eq!(bearing(0, 0), BinaryAngle::ZERO);
    }
}
