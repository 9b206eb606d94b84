//! Stopping distances, ramps and rounding of divisions over whole ranges.

use haltline::guard::hull::{Hull, Vertex};
use haltline::guard::plan::{Dynamics, Plan};
use haltline::input::Twist;
use haltline::units::{AngularSpeed, Curvature, Speed};

use super::parallel;
use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

const FILE: &str = "verification/src/enumerate/braking.rs";

pub(super) fn all() -> [Enumeration; 2] {
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
