//! The formulas of `spec/model.md`, as written there, against single motions drawn at random.
//!
//! This judges the mathematics, not the kernel: a bound that some admissible
//! motion leaves is wrong. Each formula has false twins, with one term taken
//! away, that must be left.

use haltline_spec::draw::Draw;
use haltline_spec::motion::{Brakes, Manoeuvre, Reach, Twist};
use haltline_spec::plane::{Outline, Pose};

/// Terms that a false twin leaves out.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Without {
    Nothing,
    CurvatureSpread,
    TurnTolerance,
    Sampling,
    /// The earliest instead of the latest time.
    LatestTime,
    /// The heading that separate ramps add, with the least deceleration for the largest.
    RampHeading,
    /// Rolling back at negative speed.
    RollingBack,
    /// The hold time in the braking path.
    HoldPath,
}

struct Setting {
    outline: Outline,
    vertices: Vec<Twist>,
    tol_v: f64,
    tol_omega: f64,
    hold: f64,
    brakes: Brakes,
}

/// One inflated sample: pose, inflation, latest time.
struct Sample {
    pose: Pose,
    inflation: f64,
    latest: f64,
}

fn setting(draw: &mut Draw, spot: bool, separate: bool) -> Setting {
    let outline = Outline {
        front_m: draw.between(0.1, 0.8),
        rear_m: draw.between(0.1, 0.8),
        left_m: draw.between(0.1, 0.6),
        right_m: draw.between(0.1, 0.6),
    };
    let v = if spot { 0.0 } else { draw.between(0.05, 1.2) };
    let kappa = if draw.chance(0.2) {
        0.0
    } else {
        draw.sign() * draw.extreme(0.5, 2.0)
    };
    // Bare settings show one term at a time; otherwise the terms cover for each other.
    let bare = draw.chance(0.5);
    let swing = if bare && !spot {
        0.0
    } else {
        draw.extreme(0.0, 0.4)
    };
    let vertices: Vec<Twist> = (0..1 + draw.index(if bare { 2 } else { 4 }))
        .map(|i| {
            let vi = if i == 0 {
                v
            } else {
                v * draw.extreme(0.0, 1.0)
            };
            let wobble = draw.between(-swing, swing);
            Twist::new(
                vi,
                if spot {
                    2.0 * wobble
                } else {
                    kappa * vi + wobble
                },
            )
        })
        .collect();
    let vertices = if separate { boxed(&vertices) } else { vertices };
    let least = draw.between(0.3, 2.0);
    Setting {
        outline,
        vertices,
        tol_v: draw.extreme(0.0, 0.05),
        tol_omega: if bare { 0.0 } else { draw.extreme(0.0, 0.1) },
        hold: draw.between(0.02, 0.4),
        brakes: Brakes {
            least_mps2: least,
            hardest_mps2: least * draw.extreme(1.0, 10.0),
            angular_radps2: draw.between(0.3, 4.0),
            separate,
        },
    }
}

/// Corners of the bounding box: the hull of a drive that ramps each part by itself.
fn boxed(vertices: &[Twist]) -> Vec<Twist> {
    let ends = |part: fn(&Twist) -> f64| {
        let values = vertices.iter().map(part);
        [
            values.clone().fold(f64::INFINITY, f64::min),
            values.fold(f64::NEG_INFINITY, f64::max),
        ]
    };
    let omegas = ends(|t| t.omega_radps);
    ends(|t| t.v_mps)
        .into_iter()
        .flat_map(|v| omegas.map(|omega| Twist::new(v, omega)))
        .collect()
}

/// The curvature interval and the residual turn rate of `spec/model.md`, "Driving".
fn interval(s: &Setting) -> ([f64; 2], f64) {
    let v_max = s.vertices.iter().fold(0.0, |m: f64, t| m.max(t.v_mps));
    let mut k = [f64::INFINITY, f64::NEG_INFINITY];
    for t in s.vertices.iter().filter(|t| t.v_mps >= v_max / 2.0) {
        let kappa = t.omega_radps / t.v_mps;
        k = [k[0].min(kappa), k[1].max(kappa)];
    }
    if s.brakes.separate {
        k = [k[0].min(0.0), k[1].max(0.0)];
    }
    let residual = s.vertices.iter().fold(0.0, |m: f64, t| {
        m.max(k[0] * t.v_mps - t.omega_radps)
            .max(t.omega_radps - k[1] * t.v_mps)
    });
    (k, residual)
}

fn driving_tube(s: &Setting, without: Without) -> Vec<Sample> {
    let ([k_lo, k_hi], residual) = interval(s);
    let rho = s.outline.rho_m();
    let (b, beta) = (s.brakes.least_mps2, s.brakes.angular_radps2);
    let k = k_lo.abs().max(k_hi.abs());
    let kappa_n = (k_lo + k_hi) / 2.0;
    let mut dk = (k_hi - kappa_n).max(kappa_n - k_lo);
    let v_hi = s.vertices.iter().fold(0.0, |m: f64, t| m.max(t.v_mps)) + s.tol_v;
    let v_lo = s.vertices.iter().fold(9.0, |m: f64, t| m.min(t.v_mps));
    let mut tol_w = s.tol_omega + k * s.tol_v + residual;
    let omega_hi = s
        .vertices
        .iter()
        .fold(0.0, |m: f64, t| m.max(t.omega_radps.abs()))
        + k * s.tol_v
        + s.tol_omega;
    let a = tol_w / beta;
    let c = (1.0 / b).max(k / beta);
    let t_brake = (v_hi / b).max(omega_hi / beta);
    let t_max = s.hold + t_brake;
    let hold = if without == Without::HoldPath {
        0.0
    } else {
        s.hold
    };
    let s_max = v_hi * (hold + t_brake / 2.0);
    let mut back = if v_lo < s.tol_v {
        s.tol_v * (s.hold + (s.tol_v / b).max(a) / 2.0)
    } else {
        0.0
    };
    let mut phi_x = 0.0;
    if s.brakes.separate {
        phi_x = omega_hi * omega_hi / (2.0 * beta);
        if without == Without::RampHeading {
            phi_x = 0.0;
            tol_w += s.vertices.iter().fold(0.0, |m: f64, t| {
                m.max(t.omega_radps.abs() - beta * t.v_mps / b)
            });
        }
    }
    match without {
        Without::CurvatureSpread => dk = 0.0,
        Without::TurnTolerance => tol_w = 0.0,
        Without::RollingBack => back = 0.0,
        _ => {}
    }
    let count = (s_max / 0.02).ceil().max(1.0);
    let h = s_max / count;
    let sampling = match without {
        Without::Sampling => 0.0,
        _ => h * (1.0 + rho * kappa_n.abs()) / 2.0,
    };
    (0..=count as usize)
        .map(|j| {
            let at = j as f64 * h;
            let root = (2.0 * c * (at + h)).sqrt();
            let root = if v_lo < s.tol_v {
                root.max(c * s.tol_v)
            } else {
                root
            };
            let latest = if s.brakes.separate && without != Without::RampHeading {
                t_max
            } else if without == Without::LatestTime {
                at / v_hi + h
            } else {
                s.hold + t_brake.min(root + a)
            };
            let spread = dk * (at * at / 2.0 + rho * at) + (tol_w * t_max + phi_x) * (at + rho);
            Sample {
                pose: Pose::default().along_arc(at, kappa_n * at),
                inflation: spread + sampling + back,
                latest,
            }
        })
        .collect()
}

fn spot_tube(s: &Setting, without: Without) -> Vec<Sample> {
    let rho = s.outline.rho_m();
    let (b, beta) = (s.brakes.least_mps2, s.brakes.angular_radps2);
    let tol_omega = if without == Without::TurnTolerance {
        0.0
    } else {
        s.tol_omega
    };
    let reach = |sign: f64| {
        let w = s
            .vertices
            .iter()
            .fold(0.0, |m: f64, t| m.max(sign * t.omega_radps))
            + tol_omega;
        let ramp = (w / beta).max(s.tol_v / b);
        let hold = if without == Without::HoldPath {
            0.0
        } else {
            s.hold
        };
        (w * (hold + ramp / 2.0), ramp)
    };
    let ((left, ramp_left), (right, ramp_right)) = (reach(1.0), reach(-1.0));
    let latest = s.hold + ramp_left.max(ramp_right).max(s.tol_v / b);
    let count = ((left + right) / 0.01).ceil().max(1.0);
    let step = (left + right) / count;
    let sampling = if without == Without::Sampling {
        0.0
    } else {
        rho * step / 2.0
    };
    (0..=count as usize)
        .map(|j| Sample {
            pose: Pose::new(0.0, 0.0, j as f64 * step - right),
            inflation: sampling + s.tol_v * latest,
            latest,
        })
        .collect()
}

/// Points on the outline: corners and three points on each edge.
fn rim(outline: &Outline) -> Vec<[f64; 2]> {
    let corners = outline.corners();
    let mut points = Vec::new();
    for (i, from) in corners.iter().enumerate() {
        let to = corners[(i + 1) % 4];
        for share in [0.0, 0.25, 0.5, 0.75] {
            points.push([
                from[0] + (to[0] - from[0]) * share,
                from[1] + (to[1] - from[1]) * share,
            ]);
        }
    }
    points
}

/// Number of drawn motions that leave the tube, of all drawn.
fn leaving(seed: u64, settings: usize, kind: [bool; 2], without: Without) -> (usize, usize) {
    let [spot, separate] = kind;
    let mut draw = Draw::new(seed);
    let (mut left, mut all) = (0, 0);
    for _ in 0..settings {
        let s = setting(&mut draw, spot, separate);
        let tube = if spot {
            spot_tube(&s, without)
        } else {
            driving_tube(&s, without)
        };
        let manoeuvre = Manoeuvre {
            reach: Reach::Hull(s.vertices.clone()),
            tol_v_mps: s.tol_v,
            tol_omega_radps: s.tol_omega,
            hold_s: s.hold,
            brakes: s.brakes,
        };
        let rim = rim(&s.outline);
        for _ in 0..24 {
            all += 1;
            let course = manoeuvre.course(Pose::default(), &mut draw);
            let outside = course.moments.iter().step_by(3).any(|moment| {
                rim.iter().any(|&point| {
                    let place = moment.pose.place(point);
                    !tube.iter().any(|sample| {
                        moment.t_s <= sample.latest + 1e-9
                            && s.outline
                                .contains(sample.pose.enter(place), sample.inflation + 1e-7)
                    })
                })
            });
            left += usize::from(outside);
        }
    }
    (left, all)
}

const SPOT: [bool; 2] = [true, false];
const DRIVING: [bool; 2] = [false, false];
const SEPARATE: [bool; 2] = [false, true];

#[test]
fn no_motion_leaves_the_tube_of_the_model() {
    for (name, kind) in [
        ("driving", DRIVING),
        ("separate ramps", SEPARATE),
        ("spot", SPOT),
    ] {
        let (left, all) = leaving(7, 600, kind, Without::Nothing);
        println!("{name}: {left} of {all} motions leave the tube");
        assert_eq!(left, 0, "{name}");
    }
}

#[test]
fn without_any_one_term_some_motion_leaves_the_tube() {
    for (kind, without) in [
        (DRIVING, Without::CurvatureSpread),
        (DRIVING, Without::TurnTolerance),
        (DRIVING, Without::Sampling),
        (DRIVING, Without::LatestTime),
        (DRIVING, Without::RollingBack),
        (DRIVING, Without::HoldPath),
        (SEPARATE, Without::RampHeading),
        (SPOT, Without::TurnTolerance),
        (SPOT, Without::Sampling),
        (SPOT, Without::HoldPath),
    ] {
        let (left, all) = leaving(11, 900, kind, without);
        println!("without {without:?}: {left} of {all} motions leave the tube");
        assert!(
            left > 0,
            "{kind:?} without {without:?}: nothing left the tube"
        );
    }
}
