//! When a remembered point goes.

use haltline::guard::memory::misses_after;
use haltline::guard::sweep::Sight;

fn any_sight() -> Sight {
    match kani::any::<u8>() {
        0 => Sight::OutOfView,
        1 => Sight::Unclear,
        2 => Sight::Confirmed,
        _ => Sight::LookedPast,
    }
}

fn forgets_by_rule(fault: u8) {
    let (sight, misses, needed) = (any_sight(), kani::any::<u8>(), kani::any::<u8>());
    let after = misses_after(sight, misses, needed);
    kani::cover!(after.is_none() && sight == Sight::LookedPast);
    match after {
        None => assert!(
            sight == Sight::Confirmed
                || (sight == Sight::LookedPast
                    && misses.saturating_add(1) >= needed.saturating_add(fault))
        ),
        // Only a scan that looks past counts; an unclear one starts the count anew.
        Some(count) => assert!(
            count <= misses || (sight == Sight::LookedPast && count == misses.saturating_add(1))
        ),
    }
    assert!(sight != Sight::Unclear || after == Some(0));
    assert!(sight != Sight::OutOfView || after == Some(misses));
}

/// A point goes only when it is shown again or when the last of enough consecutive scans looks past
/// it; every count and every number of scans.
//= spec/memory.md#memory-02
//= type=proof
//# A remembered hit MUST NOT be cleared before the configured number of consecutive scans had at
//# least one beam through its error disc and all of these beams pass beyond it.
#[kani::proof]
fn a_point_goes_only_by_the_rule() {
    forgets_by_rule(0);
}

#[kani::proof]
#[kani::should_panic]
fn a_point_goes_only_by_the_rule_twin() {
    forgets_by_rule(1);
}
