//! Known space: its window and its age.

use haltline::geometry::frame::PointMm;
use haltline::guard::seen::{CELLS, Seen};
use haltline::time::{Duration, Instant};

use super::parallel;
use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

const FILE: &str = "verification/src/enumerate/seen.rs";
const REACH: i64 = 5_000;
const SIDE: u64 = 2 * REACH as u64 + 1;

pub(super) fn all() -> [Enumeration; 2] {
    [
        Enumeration {
            id: "seen::outside_the_window_is_unknown",
            means: Means::Enumerated,
            claim: "Nothing outside the window is known.",
            requirements: &["MEMORY-10"],
            domain: "every millimetre within 5 m along both axes, everything inside known",
            file: FILE,
            run: outside,
        },
        Enumeration {
            id: "seen::old_space_is_unknown",
            means: Means::Enumerated,
            claim: "Space not seen for as long as the limit is unknown.",
            requirements: &["MEMORY-08"],
            domain: "ages 0 to 999 us by limits 1 to 1000 us, space seen once",
            file: FILE,
            run: old,
        },
    ]
}

fn all_known() -> Seen {
    let mut seen = Seen::default();
    seen.mark(&[u128::MAX; CELLS]);
    seen
}

fn outside(twin: bool) -> Result<u64, String> {
    let seen = all_known();
    let edge = 4_096 - i32::from(twin);
    parallel(0..SIDE * SIDE, |index| {
        let at = |value: u64| (value.cast_signed() - REACH) as i32;
        let point = PointMm {
            x: at(index % SIDE),
            y: at(index / SIDE),
        };
        let inside = |mm: i32| (-4_096..edge).contains(&mm);
        (seen.is_known(point) == (inside(point.x) && inside(point.y)))
            .then_some(())
            .ok_or_else(|| format!("{point:?}"))
    })
}

fn old(twin: bool) -> Result<u64, String> {
    let known = all_known();
    parallel(0..1_000_000, |index| {
        let (age, limit) = (index % 1_000, index / 1_000 + 1);
        let mut seen = known;
        seen.expire(Instant::from_us(age), Duration::from_us(limit));
        let is_known = seen.is_known(PointMm { x: 100, y: -100 });
        (!is_known || age + u64::from(twin) < limit)
            .then_some(())
            .ok_or_else(|| format!("known at {age} us with a limit of {limit} us"))
    })
}
