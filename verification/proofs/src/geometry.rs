//! Rounding of products, views and angles.

use haltline::arith::{add, magnitude, narrow, to_i32};
use haltline::geometry::frame::{BodyView, PointMm, VIEW_MM, rounded_q30};
use haltline::units::BinaryAngle;

fn nearest(slack: i64) {
    let product: i64 = kani::any();
    // What the callers can reach: 2³⁰ times 2³⁰.
    kani::assume(product >= -(1 << 60) && product <= 1 << 60);
    let rounded = i64::from(rounded_q30(product));
    let error = (rounded << 30) - product;
    kani::cover!(error == -(1 << 29) + 1);
    assert!(error >= -(1 << 29) && error <= (1 << 29) - slack);
}

/// A coordinate of the recurrence is rounded by at most half a count; every product up to 2⁶⁰.
//= spec/guard.md#guard-21
//= type=proof
//# Every rounding in the computation of a tube MUST enlarge the tube or be covered by the
//# rounding term of its budget.
#[kani::proof]
fn products_round_to_nearest() {
    nearest(0);
}

#[kani::proof]
#[kani::should_panic]
fn products_round_to_nearest_twin() {
    nearest(1);
}

fn clamps(fault: i64) {
    let wide: i64 = kani::any();
    let narrowed = i64::from(narrow(wide));
    kani::cover!(narrowed != wide);
    assert!(narrowed == wide || wide > i64::from(i32::MAX) || wide < i64::from(i32::MIN));
    assert!(narrowed.abs() <= wide.saturating_abs().saturating_sub(fault) || narrowed == 0);
    assert!((narrowed < 0) == (wide < 0));
    let large: u64 = kani::any();
    let limited = to_i32(large);
    assert!(limited >= 0 && (limited == i32::MAX || u64::from(limited.unsigned_abs()) == large));
    let (a, b) = (kani::any::<u64>(), kani::any::<u64>());
    assert!(add(a, b) >= a && add(a, b) >= b);
    let value: i32 = kani::any();
    assert!(magnitude(value) == u64::from(value.unsigned_abs()));
}

/// Narrowing keeps sign and order and never wraps; every 64-bit value.
//= spec/guard.md#guard-21
//= type=proof
//# Every rounding in the computation of a tube MUST enlarge the tube or be covered by the
//# rounding term of its budget.
#[kani::proof]
fn narrowing_saturates() {
    clamps(0);
}

#[kani::proof]
#[kani::should_panic]
fn narrowing_saturates_twin() {
    clamps(1);
}

fn horizon(fault: i32) {
    let (x, y): (i32, i32) = (kani::any(), kani::any());
    // Heading and position fixed: the products are then cheap, and the horizon does not depend on them.
    let view = BodyView::new(0, 0, BinaryAngle::ZERO);
    let seen = view.see(PointMm { x, y });
    let far = |value: i32| value > VIEW_MM || value < -VIEW_MM;
    kani::cover!(seen.is_some());
    assert!(seen.is_some() != (far(x) || far(y)));
    if let Some(point) = seen {
        assert!(point.x == x + fault && point.y == y);
    }
}

/// Points beyond the horizon are told apart and never folded back; every point, heading zero.
//= spec/guard.md#guard-18
//= type=proof
//# The guard MUST refuse a motion whose tube needs more samples, a longer path or larger
//# coordinates than it can represent.
#[kani::proof]
fn far_points_are_never_folded_back() {
    horizon(0);
}

#[kani::proof]
#[kani::should_panic]
fn far_points_are_never_folded_back_twin() {
    horizon(1);
}

fn turns(fault: i32) {
    let (a, b): (u32, u32) = (kani::any(), kani::any());
    let (from, to) = (BinaryAngle::from_counts(a), BinaryAngle::from_counts(b));
    let turn = to.minus(from);
    kani::cover!(turn < -5);
    let back = from.plus(BinaryAngle::from_counts(turn.cast_unsigned()));
    assert!(back == to);
    assert!(to.minus(from).wrapping_neg() == from.minus(to).wrapping_add(fault));
}

/// Differences of angles wrap exactly; every pair of angles.
//= spec/time.md#time-02
//= type=proof
//# A tick MUST NOT panic, allocate or recurse.
#[kani::proof]
fn angles_wrap_exactly() {
    turns(0);
}

#[kani::proof]
#[kani::should_panic]
fn angles_wrap_exactly_twin() {
    turns(1);
}
