//! The tube as built against the formulas of the model, in floats: every term, every sample.

use haltline::geometry::rect::Rect;
use haltline::guard::hull::{Hull, Vertex};
use haltline::guard::plan::Dynamics;
use haltline::guard::tube::{Tube, TubeParameters};
use haltline::input::Twist;
use haltline::units::{AngularSpeed, Curvature, Speed};

use std::sync::atomic::{AtomicU64, Ordering};

use super::{most_have_tubes, parallel};
use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

const FILE: &str = "verification/src/enumerate/tube.rs";

pub(super) fn all() -> [Enumeration; 1] {
    [Enumeration {
        id: "tube::every_term_is_in_every_sample",
        means: Means::Enumerated,
        claim: "Every sample is inflated by at least spread, obstacle motion, tracking, sampling and 3 mm, as the model's formulas give them; samples lie on the nominal arc within 0.5 mm and 1/2048 of the path, turn by at most 5 degrees a step and end at the longest path.",
        requirements: &[
            "GUARD-05", "GUARD-06", "GUARD-07", "GUARD-08", "GUARD-11", "GUARD-13",
        ],
        domain: "hulls of two driving motions: forward and reverse with joint ramps, forward with separate ramps, steered; each 8 x 5 speeds to 1.2 m/s, 9 x 3 turn rates to 0.8 rad/s, 3 hold times, 2 brakes, 2 tolerances, obstacles at 0 and 1 m/s",
        file: FILE,
        run,
    }]
}

/// What kind of drive a setting is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Forward,
    Reverse,
    /// v and omega ramp each by itself.
    Separate,
    /// The wheels hold the curvature.
    Steered,
}

/// One setting in SI units; speeds as seen by a robot that drives forward.
#[derive(Clone, Copy, Debug)]
struct Setting {
    kind: Kind,
    v: [f64; 2],
    w: [f64; 2],
    hold: f64,
    b: f64,
    beta: f64,
    tol_v: f64,
    tol_w: f64,
    obstacle: f64,
}

const RHO: f64 = 0.75;
const TRACKING: f64 = 0.02;
/// Steering error, 1/m.
const TOL_KAPPA: f64 = 0.03;

fn setting(mut index: u64) -> Setting {
    let mut pick = |count: u64| {
        let chosen = index % count;
        index /= count;
        chosen as f64
    };
    let v = 0.15 * (pick(8) + 1.0);
    let w = 0.2 * (pick(9) - 4.0);
    let other_v = v * pick(5) / 4.0;
    let kappa = w / v;
    let other_w = kappa * other_v + 0.04 * (pick(3) - 1.0);
    let hold = 0.1 + 0.12 * pick(3);
    let soft = pick(2);
    let tolerance = pick(2);
    let obstacle = pick(2);
    let kinds = [Kind::Forward, Kind::Reverse, Kind::Separate, Kind::Steered];
    Setting {
        kind: kinds[pick(4) as usize],
        v: [v, other_v],
        w: [w, other_w],
        hold,
        b: 0.5 + soft,
        beta: 1.0 + soft,
        tol_v: 0.01 * tolerance,
        tol_w: 0.01 * tolerance,
        obstacle,
    }
}

const CASES: u64 = 8 * 9 * 5 * 3 * 3 * 2 * 2 * 2 * 4;

fn micro(value: f64) -> i32 {
    (value * 1e6).round() as i32
}

fn built(s: &Setting) -> Option<(Tube, Rect)> {
    let footprint = Rect {
        front: 4_800,
        rear: 4_800,
        left: 3_360,
        right: 3_360,
    };
    let steered = s.kind == Kind::Steered;
    let parameters = TubeParameters {
        dynamics: Dynamics {
            braking: micro(s.b) as u64,
            angular_braking: if steered {
                u64::MAX
            } else {
                micro(s.beta) as u64
            },
            separate_ramps: s.kind == Kind::Separate,
            steered,
            curvature_tolerance: micro(TOL_KAPPA),
            speed_tolerance: micro(s.tol_v) as u64,
            turn_tolerance: micro(s.tol_w) as u64,
            corner: micro(RHO) as u64,
        },
        footprint,
        tracking_um: micro(TRACKING) as u64,
        obstacle_speed: micro(s.obstacle) as u64,
    };
    let sign = if s.kind == Kind::Reverse { -1.0 } else { 1.0 };
    let mut hull = Hull::default();
    for ((v, w), kappa) in s.v.into_iter().zip(s.w).zip(wheels(s)) {
        hull.push(Vertex {
            twist: Twist {
                linear: Speed::from_um_per_s(micro(sign * v)),
                angular: AngularSpeed::from_urad_per_s(micro(sign * w)),
            },
            curvature: Curvature::from_urad_per_m(if steered { micro(kappa) } else { 0 }),
        });
    }
    let tube = Tube::new(&parameters, &hull, micro(s.hold) as u64).ok()?;
    Some((tube, footprint))
}

/// Curvatures of the wheels; at standstill they say what the twist cannot.
fn wheels(s: &Setting) -> [f64; 2] {
    let first = s.w[0] / s.v[0];
    let second = if s.v[1] > 0.0 { s.w[1] / s.v[1] } else { first };
    [first.clamp(-2.0, 2.0), second.clamp(-2.0, 2.0)]
}

/// The quantities of spec/model.md, "Driving", "Separate ramps" and "Ackermann".
struct Model {
    kappa: f64,
    dk: f64,
    tol_w: f64,
    t_max: f64,
    t_brake: f64,
    s_max: f64,
    back: f64,
    c: f64,
    a: f64,
    /// Heading gained after v is at rest.
    phi_x: f64,
}

/// The motions a drive may mix: what it was told, or the corners of the box around it.
fn vertices(s: &Setting) -> Vec<(f64, f64)> {
    let told: Vec<(f64, f64)> = s.v.into_iter().zip(s.w).collect();
    if s.kind != Kind::Separate {
        return told;
    }
    let [v, w] = [s.v, s.w].map(|pair| [pair[0].min(pair[1]), pair[0].max(pair[1])]);
    v.iter()
        .flat_map(|&v| w.iter().map(move |&w| (v, w)))
        .collect()
}

/// Curvatures that some motion may have.
fn interval(s: &Setting, told: &[(f64, f64)]) -> (f64, f64) {
    if s.kind == Kind::Steered {
        let [a, b] = wheels(s);
        return (a.min(b) - TOL_KAPPA, a.max(b) + TOL_KAPPA);
    }
    let top = s.v[0].max(s.v[1]);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for &(v, w) in told.iter().filter(|(v, _)| *v >= top / 2.0) {
        low = low.min(w / v);
        high = high.max(w / v);
    }
    if s.kind == Kind::Separate {
        (low, high) = (low.min(0.0), high.max(0.0));
    }
    (low, high)
}

fn model(s: &Setting) -> Model {
    let told = vertices(s);
    let (low, high) = interval(s, &told);
    let steered = s.kind == Kind::Steered;
    let beta = if steered { f64::INFINITY } else { s.beta };
    let k = low.abs().max(high.abs());
    let residual = told.iter().fold(0.0_f64, |most, &(v, w)| {
        most.max(low * v - w).max(w - high * v)
    });
    let tol_w = if steered {
        s.tol_w
    } else {
        s.tol_w + k * s.tol_v + residual
    };
    let v_hi = s.v[0].max(s.v[1]) + s.tol_v;
    let w_hi = s.w[0].abs().max(s.w[1].abs()) + k * s.tol_v + s.tol_w;
    let t_brake = (v_hi / s.b).max(w_hi / beta);
    let a = tol_w / beta;
    let may_roll = s.v[0].min(s.v[1]) < s.tol_v;
    Model {
        kappa: f64::midpoint(low, high),
        dk: (high - low) / 2.0,
        tol_w,
        t_max: s.hold + t_brake,
        t_brake,
        s_max: v_hi * (s.hold + t_brake / 2.0),
        back: if may_roll {
            s.tol_v * (s.hold + (s.tol_v / s.b).max(a) / 2.0)
        } else {
            0.0
        },
        c: (1.0 / s.b).max(k / beta),
        a,
        phi_x: if s.kind == Kind::Separate {
            w_hi * w_hi / (2.0 * s.beta)
        } else {
            0.0
        },
    }
}

impl Model {
    /// What a sample at path `at` must be inflated by, in metres.
    fn need(&self, s: &Setting, at: f64, step: f64) -> f64 {
        let heading = self.tol_w * self.t_max + self.phi_x;
        let spread = self.dk * (at * at / 2.0 + RHO * at) + heading * (at + RHO) + self.back;
        let sampling = step * (1.0 + RHO * self.kappa.abs()) / 2.0;
        // Once v is at rest, the path tells nothing about the time.
        let late = if s.kind == Kind::Separate {
            self.t_max
        } else {
            s.hold
                + self
                    .t_brake
                    .min((2.0 * self.c * (at + step)).sqrt() + self.a)
        };
        spread + sampling + TRACKING + 0.003 + s.obstacle * late
    }

    /// The nominal place at path `at`.
    fn place(&self, s: &Setting, at: f64) -> (f64, f64) {
        let turn = self.kappa * at;
        let (x, y) = if turn.abs() < 1e-9 {
            (at, 0.0)
        } else {
            (turn.sin() / self.kappa, (1.0 - turn.cos()) / self.kappa)
        };
        (if s.kind == Kind::Reverse { -x } else { x }, y)
    }
}

fn run(twin: bool) -> Result<u64, String> {
    let more = if twin { 0.002 } else { 0.0 };
    let seen = AtomicU64::new(0);
    parallel(0..CASES, |index| {
        let s = setting(index);
        let Some((tube, footprint)) = built(&s) else {
            return Ok(()); // Refused: nothing is certified.
        };
        seen.fetch_add(1, Ordering::Relaxed);
        let m = model(&s);
        let samples = tube.samples();
        let steps = (samples.len() - 1) as f64;
        let h = m.s_max / steps;
        if h * m.kappa.abs() > 5.01_f64.to_radians() {
            return Err(format!("{s:?}: a step turns by more than 5 degrees"));
        }
        for (number, sample) in samples.iter().enumerate() {
            let at = number as f64 * h;
            // Micro-units of the inputs are rounded to nearest: a few micrometres.
            let need = (m.need(&s, at, h) + more) * 8_000.0 - 0.1;
            let rect = sample.rect();
            let grown = [
                rect.front - footprint.front,
                rect.rear - footprint.rear,
                rect.left - footprint.left,
                rect.right - footprint.right,
            ];
            if grown.iter().any(|&by| f64::from(by) < need) {
                return Err(format!("{s:?}, sample {number}: {grown:?} for {need}"));
            }
            let (x, y) = m.place(&s, at);
            let off = (f64::from(sample.centre().x) / 8_000.0 - x)
                .hypot(f64::from(sample.centre().y) / 8_000.0 - y);
            // Rounding, and arcs for chords.
            if off > 0.000_5 + at / 2_048.0 {
                return Err(format!("{s:?}, sample {number}: {off} m from its place"));
            }
        }
        Ok(())
    })?;
    most_have_tubes(seen.into_inner(), CASES)
}
