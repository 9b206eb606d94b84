//! Turns on the spot against the formulas of the model, and hulls that no tube can cover.

use haltline::geometry::frame::PointMm;
use haltline::geometry::rect::Rect;
use haltline::guard::Refusal;
use haltline::guard::hull::{Hull, Vertex};
use haltline::guard::plan::Dynamics;
use haltline::guard::tube::{Sample, Tube, TubeParameters};
use haltline::input::Twist;
use haltline::units::{AngularSpeed, Curvature, Speed};

use std::sync::atomic::{AtomicU64, Ordering};

use super::{most_have_tubes, parallel};
use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

const FILE: &str = "verification/src/enumerate/spot.rs";
const RHO: f64 = 0.75;
const TRACKING: f64 = 0.02;
const FOOTPRINT: Rect = Rect {
    front: 4_800,
    rear: 4_800,
    left: 3_360,
    right: 3_360,
};

pub(super) fn all() -> [Enumeration; 2] {
    [
        Enumeration {
            id: "spot::both_directions_are_covered",
            means: Means::Enumerated,
            claim: "The samples of a turn on the spot reach from the largest angle to the right to the largest to the left, braking included, in steps of at most 5 degrees; each is inflated by at least creep, obstacle motion, tracking, sampling and 3 mm.",
            requirements: &["GUARD-05", "GUARD-06", "GUARD-09"],
            domain: "hulls of two turn rates, 21 each to 1 rad/s, one of them creeping at 0 or half the tolerance; 3 hold times, 2 brakes by 2 angular brakes, 2 tolerances of speed and 2 of turn rate, obstacles at 0 and 1 m/s",
            file: FILE,
            run: spots,
        },
        Enumeration {
            id: "spot::both_signs_of_speed_are_refused",
            means: Means::Enumerated,
            claim: "A hull with speeds beyond the tolerance in both directions has no tube.",
            requirements: &["GUARD-10"],
            domain: "forward and backward speeds in steps of 10 mm/s to 1.2 m/s each, 9 turn rates each, tolerances 0 and 10 mm/s",
            file: FILE,
            run: mixed,
        },
    ]
}

#[derive(Clone, Copy, Debug)]
struct Setting {
    w: [f64; 2],
    creep: f64,
    hold: f64,
    b: f64,
    beta: f64,
    tol_v: f64,
    tol_w: f64,
    obstacle: f64,
}

const CASES: u64 = 21 * 21 * 2 * 3 * 2 * 2 * 2 * 2 * 2;

fn setting(mut index: u64) -> Setting {
    let mut pick = |count: u64| {
        let chosen = index % count;
        index /= count;
        chosen as f64
    };
    let w = [0.1 * (pick(21) - 10.0), 0.1 * (pick(21) - 10.0)];
    let half = 0.5 * pick(2);
    let tol_v = 0.01 * pick(2);
    Setting {
        w,
        creep: half * tol_v,
        hold: 0.1 + 0.12 * pick(3),
        b: 0.3 + pick(2),
        beta: 1.0 + pick(2),
        tol_v,
        tol_w: 0.01 * pick(2),
        obstacle: pick(2),
    }
}

fn micro(value: f64) -> i32 {
    (value * 1e6).round() as i32
}

fn hull_of(motions: &[(f64, f64)]) -> Hull {
    let mut hull = Hull::default();
    for &(v, w) in motions {
        hull.push(Vertex {
            twist: Twist {
                linear: Speed::from_um_per_s(micro(v)),
                angular: AngularSpeed::from_urad_per_s(micro(w)),
            },
            curvature: Curvature::ZERO,
        });
    }
    hull
}

fn parameters(s: &Setting) -> TubeParameters {
    TubeParameters {
        dynamics: Dynamics {
            braking: micro(s.b) as u64,
            angular_braking: micro(s.beta) as u64,
            speed_tolerance: micro(s.tol_v) as u64,
            turn_tolerance: micro(s.tol_w) as u64,
            corner: micro(RHO) as u64,
            ..Dynamics::default()
        },
        footprint: FOOTPRINT,
        tracking_um: micro(TRACKING) as u64,
        obstacle_speed: micro(s.obstacle) as u64,
    }
}

/// Heading of a sample: where a point straight ahead of the start lies in it.
fn heading(sample: &Sample) -> f64 {
    let seen = sample.enter(PointMm { x: 4_000, y: 0 }).unwrap_or_default();
    -f64::from(seen.y).atan2(f64::from(seen.x))
}

fn spots(twin: bool) -> Result<u64, String> {
    let more = if twin { 0.03 } else { 0.0 };
    let seen = AtomicU64::new(0);
    parallel(0..CASES, |index| {
        let s = setting(index);
        let hull = hull_of(&[(0.0, s.w[0]), (s.creep, s.w[1])]);
        let rate = s.w[0].abs().max(s.w[1].abs());
        if rate * RHO < s.creep {
            return Ok(()); // What creeps more than it turns is judged as driving.
        }
        let Ok(tube) = Tube::new(&parameters(&s), &hull, micro(s.hold) as u64) else {
            return Ok(()); // Refused: nothing is certified.
        };
        seen.fetch_add(1, Ordering::Relaxed);
        let speed = s.tol_v + s.creep;
        let turn = |sign: f64| {
            let w = (sign * s.w[0]).max(sign * s.w[1]).max(0.0) + s.tol_w;
            let ramp = (w / s.beta).max(speed / s.b);
            (w * (s.hold + ramp / 2.0), ramp)
        };
        let ((left, ramp_left), (right, ramp_right)) = (turn(1.0), turn(-1.0));
        let latest = s.hold + ramp_left.max(ramp_right);
        let samples = tube.samples();
        let mut headings: Vec<f64> = samples.iter().map(heading).collect();
        headings.sort_by(f64::total_cmp);
        // A rotation is known to 1/30000, a place to an eighth of a millimetre.
        let exact = 1e-4;
        let (first, last) = (headings[0], headings[headings.len() - 1]);
        if first > -right + exact - more || last < left - exact + more {
            return Err(format!("{s:?}: {first} to {last} for {right} and {left}"));
        }
        let step = headings
            .windows(2)
            .fold(0.0_f64, |most, pair| most.max(pair[1] - pair[0]));
        if step > 5_f64.to_radians() {
            return Err(format!("{s:?}: a step of {step} rad"));
        }
        let spacing = (last - first) / (samples.len() - 1) as f64;
        let sum = speed * latest + TRACKING + RHO * spacing / 2.0 + 0.003 + s.obstacle * latest;
        let need = (sum - RHO * exact) * 8_000.0 - 0.1;
        for sample in samples {
            let grown = sample.rect().front - FOOTPRINT.front;
            if f64::from(grown) < need || sample.centre() != PointMm::default() {
                return Err(format!("{s:?}: {grown} for {need}"));
            }
        }
        Ok(())
    })?;
    most_have_tubes(seen.into_inner(), CASES)
}

fn mixed(twin: bool) -> Result<u64, String> {
    parallel(0..120 * 120 * 9 * 9 * 2, |index| {
        let speed = |number: u64| 0.01 * (number % 120 + 1) as f64;
        let (ahead, back) = (speed(index), speed(index / 120));
        let turn = |number: u64| 0.2 * ((number % 9) as f64 - 4.0);
        let (w, other) = (turn(index / 14_400), turn(index / 129_600));
        let tol_v = 0.01 * (index / 1_166_400) as f64;
        let s = Setting {
            w: [w, other],
            creep: 0.0,
            hold: 0.142,
            b: 0.5,
            beta: 1.0,
            tol_v,
            tol_w: 0.01,
            obstacle: 0.0,
        };
        let hull = hull_of(&[(ahead, w), (-back, other)]);
        let refused = Tube::new(&parameters(&s), &hull, 142_000).err();
        // Within the tolerance it may be taken for one direction; the twin denies that.
        let beyond = ahead.min(back) > tol_v + 1e-9 || twin;
        (!beyond || refused == Some(Refusal::MixedMotion))
            .then_some(())
            .ok_or_else(|| format!("{ahead} and {back} m/s, {w} and {other}: {refused:?}"))
    })
}
