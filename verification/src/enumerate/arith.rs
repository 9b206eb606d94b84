//! Quotients and roots that bound something round up.

use haltline::arith::{div_up, mul_div_up, sqrt_up};

use super::parallel;
use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

const FILE: &str = "verification/src/enumerate/arith.rs";

pub(super) fn all() -> [Enumeration; 2] {
    [
        Enumeration {
            id: "braking::division_rounds_up",
            means: Means::Enumerated,
            claim: "A quotient that bounds something is the least whole number not below the exact one.",
            requirements: &["GUARD-21"],
            domain: "all 16-bit dividends by all 16-bit divisors but zero",
            file: FILE,
            run: divisions,
        },
        Enumeration {
            id: "braking::root_rounds_up",
            means: Means::Enumerated,
            claim: "A root that bounds something is the least whole number whose square is not below.",
            requirements: &["GUARD-07", "GUARD-21"],
            domain: "all 32-bit numbers",
            file: FILE,
            run: roots,
        },
    ]
}

fn divisions(twin: bool) -> Result<u64, String> {
    parallel(0..65_536 * 65_535, |index| {
        let (a, d) = (index / 65_535, index % 65_535 + 1);
        let found = div_up(a, d);
        let least = found * d >= a && (found == 0 || (found - 1) * d < a);
        let product = mul_div_up(a, 1, d) == found;
        (least && product && !(twin && a % d == 1 && a > d))
            .then_some(())
            .ok_or_else(|| format!("{a} / {d} gave {found}"))
    })
}

fn roots(twin: bool) -> Result<u64, String> {
    parallel(0..1 << 32, |value| {
        let root = sqrt_up(value) - u64::from(twin && value > 9);
        let least = root * root >= value && (root == 0 || (root - 1) * (root - 1) < value);
        least
            .then_some(())
            .ok_or_else(|| format!("root of {value} gave {root}"))
    })
}
