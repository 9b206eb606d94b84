//! Segments against rectangles, on a grid on which everything is exact.

use haltline::geometry::frame::PointMm;
use haltline::geometry::rect::Rect;

use super::parallel;
use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

const FILE: &str = "verification/src/enumerate/shapes.rs";

pub(super) fn all() -> [Enumeration; 2] {
    [
        Enumeration {
            id: "shapes::segment_touches_exactly",
            means: Means::Enumerated,
            claim: "A segment is reported exactly when it has a point in common with the rectangle.",
            requirements: &["GUARD-01", "GUARD-14"],
            domain: "rectangles with edges 0 to 2 from the origin, segments with ends within 6, against exact clipping",
            file: FILE,
            run: touches,
        },
        Enumeration {
            id: "shapes::growth_is_monotone",
            means: Means::Enumerated,
            claim: "A segment that touches a rectangle touches it when a margin grows, and its distance does not grow by more than the rounding of one unit.",
            requirements: &["GUARD-17"],
            domain: "the same rectangles and segments, margins 0 to 3",
            file: FILE,
            run: grows,
        },
    ]
}

const REACH: i64 = 6;
const SIDE: u64 = 2 * REACH as u64 + 1;
const CASES: u64 = 81 * SIDE * SIDE * SIDE * SIDE;

fn case(index: u64) -> (Rect, PointMm, PointMm) {
    let edge = |shift: u64| (index / shift % 3) as i32;
    let rect = Rect {
        front: edge(1),
        rear: edge(3),
        left: edge(9),
        right: edge(27),
    };
    let rest = index / 81;
    let at = |shift: u64| (rest / shift % SIDE) as i32 - REACH as i32;
    let point = |shift: u64| PointMm {
        x: at(shift),
        y: at(shift * SIDE),
    };
    (rect, point(1), point(SIDE * SIDE))
}

/// Whether some t of [0, 1] brings a + t (b - a) into the rectangle: fractions kept exact.
fn clipped(rect: &Rect, a: PointMm, b: PointMm) -> bool {
    // The interval of t as two fractions with positive denominators.
    let (mut low, mut high) = ((0_i64, 1_i64), (1_i64, 1_i64));
    let wide = i64::from;
    for (from, to, least, most) in [
        (a.x, b.x, -rect.rear, rect.front),
        (a.y, b.y, -rect.right, rect.left),
    ] {
        let step = wide(to) - wide(from);
        for (slope, room) in [
            (step, wide(most) - wide(from)),
            (-step, wide(from) - wide(least)),
        ] {
            // slope t <= room
            match slope {
                0 if room < 0 => return false,
                0 => {}
                slope if slope > 0 => {
                    if room * high.1 < high.0 * slope {
                        high = (room, slope);
                    }
                }
                slope => {
                    if -room * low.1 > low.0 * -slope {
                        low = (-room, -slope);
                    }
                }
            }
        }
    }
    low.0 * high.1 <= high.0 * low.1
}

fn touches(twin: bool) -> Result<u64, String> {
    parallel(0..CASES, |index| {
        let (rect, a, b) = case(index);
        let shifted = Rect {
            front: rect.front + i32::from(twin),
            ..rect
        };
        (rect.touches(a, b) == clipped(&shifted, a, b))
            .then_some(())
            .ok_or_else(|| format!("{rect:?} {a:?} {b:?}"))
    })
}

fn grows(twin: bool) -> Result<u64, String> {
    parallel(0..CASES, |index| {
        let (rect, a, b) = case(index);
        let (touching, distance) = (rect.touches(a, b), rect.segment_distance_squared(a, b));
        for margin in 0..=3 {
            let grown = rect.grown(if twin { -margin } else { margin });
            let kept = !touching || grown.touches(a, b);
            let nearer = grown.segment_distance_squared(a, b).isqrt() <= distance.isqrt() + 1;
            if !kept || !nearer {
                return Err(format!("{rect:?} {a:?} {b:?}, margin {margin}"));
            }
        }
        Ok(())
    })
}
