//! Stopping distances, ramps and rounding of divisions over whole ranges.

use haltline::arith::{div_up, mul_div_up, sqrt_up};
use haltline::guard::hull::{Hull, Vertex};
use haltline::guard::plan::{Dynamics, Plan};
use haltline::input::Twist;
use haltline::units::{AngularSpeed, Curvature, Speed};

use super::parallel;
use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

const FILE: &str = "verification/src/enumerate/braking.rs";

pub(super) fn all() -> [Enumeration; 4] {
    [
        Enumeration {
            id: "braking::stopping_path",
            means: Means::Enumerated,
            claim: "The planned path is no shorter than v T + v^2 / (2 b), and no time to rest shorter than T + v / b.",
            requirements: &["GUARD-05", "BRAKE-02"],
            domain: "speeds 0 to 20 m/s in steps of 10 mm/s, decelerations 10 mm/s2 to 20 m/s2 in steps of 10 mm/s2, T = 0, 1 us, 0.3 s",
            file: FILE,
            run: stopping,
        },
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
        Enumeration {
            id: "braking::hull_residual",
            means: Means::Enumerated,
            claim: "The turn rate of every motion of a hull lies within the residual of its curvature interval.",
            requirements: &["GUARD-08"],
            domain: "two motions: speeds -50 to 350 mm/s in steps of 50, turn rates -1 to 1 rad/s in steps of 7 mrad/s each",
            file: FILE,
            run: residuals,
        },
    ]
}

fn single(v_um_per_s: i32, w_urad_per_s: i32) -> Vertex {
    Vertex {
        twist: Twist {
            linear: Speed::from_um_per_s(v_um_per_s),
            angular: AngularSpeed::from_urad_per_s(w_urad_per_s),
        },
        curvature: Curvature::ZERO,
    }
}

fn stopping(twin: bool) -> Result<u64, String> {
    let more = u128::from(twin);
    parallel(0..2001 * 2000, |index| {
        let v = (index / 2000) * 10_000;
        let b = (index % 2000 + 1) * 10_000;
        let dynamics = Dynamics {
            braking: b,
            angular_braking: u64::MAX,
            ..Dynamics::default()
        };
        let mut hull = Hull::default();
        hull.push(single(i32::try_from(v).unwrap_or(0), 0));
        for hold in [0_u64, 1, 300_000] {
            let plan = Plan::new(&dynamics, &hull, hold).map_err(|r| format!("{v} {b}: {r:?}"))?;
            if plan.path == 0 && v == 0 {
                continue;
            }
            // All in units of 10^-6 m and s: path 2 b 10^6 >= 2 b v T + v^2 10^6.
            let (v, b, t) = (u128::from(v), u128::from(b), u128::from(hold));
            let need = 2 * b * v * t + v * v * 1_000_000 + more * 40 * b * 1_000_000;
            let far = u128::from(plan.path) * 2 * b * 1_000_000 >= need;
            let late = (u128::from(plan.latest) - t) * b >= v * 1_000_000;
            if !far || !late {
                return Err(format!(
                    "v {v} um/s, b {b} um/s2, T {t} us: path {}",
                    plan.path
                ));
            }
        }
        Ok(())
    })
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

fn residuals(twin: bool) -> Result<u64, String> {
    // 9 speeds and 287 turn rates for each of two motions.
    let (speeds, rates) = (9, 287);
    let motion = |index: u64| {
        let v = (index / rates) as i32 * 50_000 - 50_000;
        let w = (index % rates) as i32 * 7_000 - 1_001_000;
        (v, w)
    };
    let each = speeds * rates;
    parallel(0..each * each, |index| {
        let motions = [motion(index / each), motion(index % each)];
        let mut hull = Hull::default();
        for (v, w) in motions {
            hull.push(single(v, w));
        }
        let interval = hull.curvature_interval();
        let residual = i128::from(hull.curvature_residual(interval)) - i128::from(twin);
        for (v, w) in motions.into_iter().filter(|(v, _)| *v >= 0) {
            let (v, w) = (i128::from(v), i128::from(w) * 1_000_000);
            let low = i128::from(interval.low) * v - residual * 1_000_000;
            let high = i128::from(interval.high) * v + residual * 1_000_000;
            if w < low || w > high {
                return Err(format!(
                    "{motions:?}: interval {interval:?}, residual {residual}"
                ));
            }
        }
        Ok(())
    })
}
