//! Saturating integer arithmetic for bounds that may only grow.
//!
//! The safety core computes upper bounds of lengths, times and angles. Every
//! operation here saturates upwards, so a value too large to represent is still
//! an upper bound; the callers refuse whatever exceeds their declared range.

/// One million: micro-units per unit.
pub const MICRO: u64 = 1_000_000;

/// `a + b`, saturating.
#[must_use]
pub const fn add(a: u64, b: u64) -> u64 {
    a.saturating_add(b)
}

/// Ceiling of `a / divisor`; `u64::MAX` for division by zero.
#[must_use]
pub const fn div_up(a: u64, divisor: u64) -> u64 {
    match a.checked_div(divisor) {
        None => u64::MAX,
        Some(quotient) => match a.checked_rem(divisor) {
            Some(0) | None => quotient,
            Some(_) => quotient.saturating_add(1),
        },
    }
}

/// Ceiling of `a * b / divisor`; saturates, so that the result is never too small.
///
/// A product that does not fit saturates before the division: callers keep
/// `u64::MAX / divisor` above everything they accept.
#[must_use]
pub const fn mul_div_up(a: u64, b: u64, divisor: u64) -> u64 {
    div_up(a.saturating_mul(b), divisor)
}

/// Ceiling of `a * b / 10⁶`: the product of two micro-quantities in micro-units.
#[must_use]
pub const fn mul_micro_up(a: u64, b: u64) -> u64 {
    mul_div_up(a, b, MICRO)
}

/// Magnitude of `value` as `u64`.
#[must_use]
pub fn magnitude(value: i32) -> u64 {
    u64::from(value.unsigned_abs())
}

/// `value` as `i32`, saturating: used where the caller's range check comes later.
#[must_use]
pub fn to_i32(value: u64) -> i32 {
    i32::try_from(value).unwrap_or(i32::MAX)
}

/// Clamps a wide signed value into `i32`.
#[must_use]
pub fn narrow(value: i64) -> i32 {
    match i32::try_from(value) {
        Ok(value) => value,
        Err(_) if value < 0 => i32::MIN,
        Err(_) => i32::MAX,
    }
}

/// Ceiling of the square root.
#[must_use]
pub const fn sqrt_up(value: u64) -> u64 {
    let root = value.isqrt();
    if root.saturating_mul(root) < value {
        root.saturating_add(1)
    } else {
        root
    }
}
