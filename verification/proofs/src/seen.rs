//! Known space: indices, borders, forgetting.

use haltline::geometry::frame::PointMm;
use haltline::guard::seen::{CELLS, Rows, Seen};
use haltline::time::{Duration, Instant};

fn any_point() -> PointMm {
    PointMm {
        x: kani::any(),
        y: kani::any(),
    }
}

fn all_known() -> Seen {
    let mut seen = Seen::default();
    let rows: Rows = [u128::MAX; CELLS];
    seen.mark(&rows);
    seen
}

fn outside_is_unknown(reach: i32) {
    let seen = all_known();
    let point = any_point();
    let known = seen.is_known(point);
    kani::cover!(known);
    kani::cover!(!known);
    let inside = |mm: i32| mm >= -4_096 && mm < reach;
    assert!(!known || (inside(point.x) && inside(point.y)));
}

/// Nothing outside the window is known, and no index leaves it; every point.
//= spec/memory.md#memory-10
//= type=proof
//# Space outside the window of the memory MUST be unknown.
#[kani::proof]
#[kani::unwind(130)]
fn outside_the_window_is_unknown() {
    outside_is_unknown(4_096);
}

#[kani::proof]
#[kani::unwind(130)]
#[kani::should_panic]
fn outside_the_window_is_unknown_twin() {
    outside_is_unknown(4_095);
}

fn old_space_goes(fault: u64) {
    let mut seen = all_known();
    let (now, limit): (u64, u64) = (kani::any(), kani::any());
    kani::assume(limit > 0);
    seen.expire(Instant::from_us(now), Duration::from_us(limit));
    let point = PointMm { x: 100, y: -100 };
    let known = seen.is_known(point);
    kani::cover!(known && now > 0);
    kani::cover!(!known);
    // Everything was seen at time zero.
    assert!(!known || now < limit - fault.min(limit));
}

/// Space not seen for longer than the limit is unknown; every time and limit.
//= spec/memory.md#memory-08
//= type=proof
//# Space not seen for longer than `age_max` MUST be unknown.
#[kani::proof]
#[kani::unwind(130)]
fn old_space_is_unknown() {
    old_space_goes(0);
}

#[kani::proof]
#[kani::unwind(130)]
#[kani::should_panic]
fn old_space_is_unknown_twin() {
    old_space_goes(1);
}
