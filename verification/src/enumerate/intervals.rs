//! Bounds of trigonometric functions by intervals with outward rounding: mathematics, not code.
//!
//! The domain is cut until every piece is decided. Sine is bounded by its alternating series, of
//! which two neighbouring partial sums lie on either side.

use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

const FILE: &str = "verification/src/enumerate/intervals.rs";
/// Five degrees, the largest turn of a step, rounded up.
const STEP_TURN: f64 = 0.087_267;

pub(super) fn all() -> [Enumeration; 1] {
    [Enumeration {
        id: "intervals::sine_below",
        means: Means::Intervals,
        claim: "sin x is at least x - x^3/6: a chord is shorter than its arc by no more than s th^2/24.",
        requirements: &["GUARD-21"],
        domain: "x from 0 to 2.5 degrees, half the largest turn of a step",
        file: FILE,
        run: chord,
    }]
}

/// A closed interval.
#[derive(Clone, Copy, Debug)]
struct Interval {
    low: f64,
    high: f64,
}

impl Interval {
    const fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    fn outward(low: f64, high: f64) -> Self {
        Self::new(low.next_down(), high.next_up())
    }

    fn minus(self, other: Self) -> Self {
        Self::outward(self.low - other.high, self.high - other.low)
    }

    /// Product of intervals that are not negative.
    fn times(self, other: Self) -> Self {
        Self::outward(self.low * other.low, self.high * other.high)
    }

    fn over(self, divisor: f64) -> Self {
        Self::outward(self.low / divisor, self.high / divisor)
    }
}

/// Cuts `x` until `decided` says yes or no; the number of pieces.
fn cut(x: Interval, decided: &dyn Fn(Interval) -> Option<bool>) -> Result<u64, String> {
    let mut open = vec![x];
    let mut pieces = 0;
    while let Some(piece) = open.pop() {
        pieces += 1;
        match decided(piece) {
            Some(true) => {}
            Some(false) => return Err(format!("fails on {piece:?}")),
            None if piece.high - piece.low < 1e-7 || pieces > 10_000_000 => {
                return Err(format!("not decided on {piece:?}"));
            }
            None => {
                let middle = f64::midpoint(piece.low, piece.high);
                open.push(Interval::new(piece.low, middle));
                open.push(Interval::new(middle, piece.high));
            }
        }
    }
    Ok(pieces)
}

fn chord(twin: bool) -> Result<u64, String> {
    // sin x >= x - x^3/6 + x^5/120 - x^7/5040. With a cubic term of 1/6 what is left over is
    // x^5 (1/120 - x^2/5040); the twin asks for 1/7, which leaves -x^3/42 besides.
    let fifth = Interval::new(1.0, 1.0).over(120.0);
    cut(Interval::new(0.0, STEP_TURN / 2.0), &|x| {
        let square = x.times(x);
        let rest = fifth.minus(square.over(5040.0));
        let whole = if twin {
            square.times(rest).minus(Interval::new(1.0, 1.0).over(42.0))
        } else {
            rest
        };
        if whole.low >= 0.0 {
            Some(true)
        } else if whole.high < 0.0 {
            Some(false)
        } else {
            None
        }
    })
}
