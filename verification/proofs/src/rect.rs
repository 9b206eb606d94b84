//! The one test whether something touches a rectangle.

use haltline::geometry::frame::PointMm;
use haltline::geometry::rect::Rect;

fn any_point() -> PointMm {
    PointMm {
        x: kani::any(),
        y: kani::any(),
    }
}

fn any_rect() -> Rect {
    Rect {
        front: kani::any(),
        rear: kani::any(),
        left: kani::any(),
        right: kani::any(),
    }
}

/// In 64 bits, where nothing saturates; `wrong` shifts the front edge.
fn is_inside(rect: &Rect, point: PointMm, wrong: i64) -> bool {
    let wide = |value: i32| i64::from(value);
    wide(point.x) <= wide(rect.front) + wrong
        && -wide(point.x) <= wide(rect.rear)
        && wide(point.y) <= wide(rect.left)
        && -wide(point.y) <= wide(rect.right)
}

fn inside_is_contained(wrong: i64) {
    let (rect, point) = (any_rect(), any_point());
    let inside = is_inside(&rect, point, wrong);
    kani::cover!(inside);
    kani::cover!(!inside);
    assert!(!inside || rect.contains(point));
}

/// A point inside or on the edge of a rectangle is contained in it; every rectangle, every point.
//= spec/guard.md#guard-01
//= type=proof
//# The guard MUST refuse a motion when a known point lies in one of the inflated samples of its
//# tube.
#[kani::proof]
fn a_point_inside_is_contained() {
    inside_is_contained(0);
}

#[kani::proof]
#[kani::should_panic]
fn a_point_inside_is_contained_twin() {
    inside_is_contained(1);
}

fn end_inside_touches(wrong: i64) {
    let (rect, a, b) = (any_rect(), any_point(), any_point());
    let inside = is_inside(&rect, a, wrong) || is_inside(&rect, b, wrong);
    kani::cover!(inside);
    kani::assume(inside);
    assert!(rect.touches(a, b));
}

/// A segment with an end in a rectangle touches it; every rectangle, every segment, no panic.
//= spec/guard.md#guard-01
//= type=proof
//# The guard MUST refuse a motion when a known point lies in one of the inflated samples of its
//# tube.
#[kani::proof]
#[kani::solver(cadical)]
fn a_segment_with_an_end_inside_touches() {
    end_inside_touches(0);
}

#[kani::proof]
#[kani::should_panic]
fn a_segment_with_an_end_inside_touches_twin() {
    end_inside_touches(1);
}

fn growth_keeps(least: i32) {
    let (rect, point, margin) = (any_rect(), any_point(), kani::any::<i32>());
    kani::assume(margin >= least);
    let contained = rect.contains(point);
    kani::cover!(contained && margin > 1000);
    assert!(!contained || rect.grown(margin).contains(point));
}

/// What a rectangle contains, it contains when a margin grows: every rectangle, point and margin.
//= spec/guard.md#guard-17
//= type=proof
//# A refused motion MUST NOT become accepted by adding a known point, by turning a known cell
//# into an unknown one or by enlarging an error bound.
#[kani::proof]
fn a_larger_margin_contains_no_less() {
    growth_keeps(0);
}

#[kani::proof]
#[kani::should_panic]
fn a_larger_margin_contains_no_less_twin() {
    growth_keeps(-1);
}

fn distance_grows_outside(wrong: u64) {
    let (rect, point) = (any_rect(), any_point());
    kani::assume(rect.front >= 0 && rect.rear >= 0 && rect.left >= 0 && rect.right >= 0);
    let zero = rect.distance_squared(point) <= wrong;
    kani::cover!(zero);
    kani::cover!(!zero);
    assert!(zero == is_inside(&rect, point, 0));
}

/// The squared distance is zero exactly inside; every rectangle around the origin, every point.
//= spec/guard.md#guard-19
//= type=proof
//# In a static world, a known point outside footprint and critical zone but inside the inflation
//# of the place where the robot rests or rested last MUST block every motion that brings the
//# footprint nearer to it by more than rounding.
#[kani::proof]
#[kani::solver(cadical)]
fn distance_is_zero_exactly_inside() {
    distance_grows_outside(0);
}

#[kani::proof]
#[kani::should_panic]
fn distance_is_zero_exactly_inside_twin() {
    distance_grows_outside(1);
}
