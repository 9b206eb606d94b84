//! The passive-safety condition that KeYmaera X proves for a point robot, against the guard.
//!
//! Mitsch et al. (IJRR 2017): a new curve may be chosen if the obstacle is farther away, in the maximum norm, than
//! `v^2/(2b) + V v/b + (A/b + 1)(A/2 eps^2 + eps (v + V))`. On the circumscribed circle of the footprint, with no other
//! margins and T = eps, the guard must accept whatever the condition allows, but for what the guard adds for counting:
//! samples, rounding, square corners of grown rectangles. The converse is false, and must be: a rectangle passes
//! where its circle does not.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

mod common;

use common::episode::{Episode, Lie, Style};
use haltline::checked::KernelConfig;
use haltline::config::Config;
use haltline::guard::check::{CloudPoint, first_touch};
use haltline::guard::hull::{Hull, Vertex};
use haltline::guard::tube::Tube;
use haltline::input::Twist;
use haltline::units::{AngularSpeed, Curvature, Length, Speed};
use haltline_spec::draw::Draw;

const CASES: usize = if cfg!(debug_assertions) {
    5_000
} else {
    60_000
};
/// A premise that holds by less is tight, m.
const TIGHT_M: f64 = 0.02;
/// Points in whole millimetres, set points in whole micrometres per second, m.
const UNITS_M: f64 = 2e-3;

/// One robot, one command, one obstacle.
struct Case {
    episode: Episode,
    config: Config<2>,
    /// Present speed, speed and curvature of the command.
    v: f64,
    commanded: f64,
    curvature: f64,
    /// Acceleration bound A, reaction time eps.
    acceleration: f64,
    eps: f64,
    point: [f64; 2],
}

fn case(draw: &mut Draw, moving: bool) -> Case {
    let episode = Episode {
        seed: 0,
        style: Style::Creep,
        lie: Lie::None,
        edges_m: [
            draw.between(0.1, 0.6),
            draw.between(0.1, 0.6),
            // Narrow ones are about as long as their circle: there the condition leaves no room.
            draw.extreme(0.03, 0.4),
            draw.extreme(0.03, 0.4),
        ],
        steered: false,
        separate: false,
        period_ms: 40,
        jitter_ms: 0,
        latency_ms: 0,
        scan_ms: 5,
        beams: 400,
        full_circle: true,
        speed_mps: 2.0,
        turn_radps: 3.0,
        braking_mps2: draw.between(0.3, 2.0),
        // The condition knows no angular brakes: they hold any arc.
        angular_braking_radps2: 9.0,
        harder: 1.0,
        tol_v_mps: 0.0,
        tol_omega_radps: 0.0,
        tracking_m: 0.0,
        sensor_m: 0.0,
        odometry_linear: 0.0,
        odometry_angular: 0.0,
        obstacle_mps: if moving { draw.between(0.05, 0.8) } else { 0.0 },
        bodies: 0,
        thin: false,
        zone_m: [0.0, 0.0],
        watchdog_ms: None,
        tube_every: 1,
    };
    let mut config = episode.config();
    config.zone.front = Length::ZERO;
    config.zone.side = Length::ZERO;
    let acceleration = draw.extreme(0.0, 1.0);
    let eps = (draw.between(0.02, 0.4) * 1e6).round() * 1e-6;
    let v = draw.between(0.02, 1.0);
    // The mean speed of the reaction time: the guard lets set points act at once.
    let commanded = draw.extreme(0.3, 1.0) * (v + acceleration * eps / 2.0);
    let mut case = Case {
        curvature: draw
            .extreme(-1.5, 1.5)
            .clamp(-2.5 / commanded, 2.5 / commanded),
        episode,
        config,
        v,
        commanded,
        acceleration,
        eps,
        point: [0.0; 2],
    };
    case.point = case.obstacle(draw);
    case
}

impl Case {
    fn rho(&self) -> f64 {
        self.episode.outline().rho_m()
    }

    /// The formula, with the speed of obstacles and the part of the reaction time as factors for the false twins.
    fn bound(&self, obstacles: f64, reaction: f64) -> f64 {
        let (v, b, a, eps) = (
            self.v,
            self.episode.braking_mps2,
            self.acceleration,
            self.eps,
        );
        let obstacle = self.episode.obstacle_mps * obstacles;
        v * v / (2.0 * b)
            + obstacle * v / b
            + reaction * (a / b + 1.0) * (a / 2.0 * eps * eps + eps * (v + obstacle))
    }

    /// Mostly about as far away as the condition asks, on whole millimetres.
    fn obstacle(&self, draw: &mut Draw) -> [f64; 2] {
        let (far, angle) = if draw.chance(0.8) {
            let bound = self.rho() + self.bound(1.0, 1.0);
            let angle = if draw.chance(0.5) {
                draw.between(-0.1, 0.1)
            } else {
                draw.between(-3.2, 3.2)
            };
            (
                bound + draw.extreme(0.0, 1.0).powi(2) * draw.between(-0.05, 0.08),
                angle,
            )
        } else {
            (draw.between(0.2, 4.0), draw.between(-3.2, 3.2))
        };
        // On the square of the maximum norm around the robot.
        let (sin, cos) = angle.sin_cos();
        let scale = far / sin.abs().max(cos.abs());
        [cos * scale, sin * scale].map(|at| (at * 1e3).round() * 1e-3)
    }

    /// How much farther than the condition asks the obstacle is, m.
    fn spare(&self, obstacles: f64, reaction: f64) -> f64 {
        let distance = self.point[0].abs().max(self.point[1].abs());
        distance - self.rho() - self.bound(obstacles, reaction)
    }

    /// What the guard says; the tube of some fast obstacles is larger than it can look at.
    fn verdict(&self) -> Verdict {
        let checked = KernelConfig::new(self.config, 720).unwrap();
        let mut hull = Hull::default();
        for speed in [self.commanded, self.commanded.min(self.v)] {
            let um = |value: f64| (value * 1e6).round() as i32;
            hull.push(Vertex {
                twist: Twist {
                    linear: Speed::from_um_per_s(um(speed)),
                    angular: AngularSpeed::from_urad_per_s(um(speed * self.curvature)),
                },
                curvature: Curvature::ZERO,
            });
        }
        let Ok(tube) = Tube::new(checked.tube(), &hull, (self.eps * 1e6).round() as u64) else {
            return Verdict::TooLarge;
        };
        let mm = |value: f64| (value * 1e3).round() as i16;
        let cloud = [CloudPoint {
            x_mm: mm(self.point[0]),
            y_mm: mm(self.point[1]),
            ..CloudPoint::default()
        }];
        let Some(touch) = first_touch(&tube, checked.tube().footprint, &cloud, None) else {
            return Verdict::Accepted;
        };
        let metres = |length: Length| f64::from(length.as_um()) * 1e-6;
        let budget = touch.budget;
        let counting = metres(budget.sampling) + metres(budget.rounding) + metres(budget.spread);
        // A grown rectangle reaches farther at its corners than a circle grown as much.
        let corners = (2.0_f64.sqrt() - 1.0) * metres(budget.total());
        Verdict::Refused {
            counting: counting + corners + UNITS_M,
        }
    }
}

enum Verdict {
    Accepted,
    /// What it had added for counting where it refused, m.
    Refused {
        counting: f64,
    },
    TooLarge,
}

/// Counts of one kind of world.
#[derive(Debug, Default)]
struct Counts {
    premises: usize,
    tight: usize,
    /// Refused although the condition holds, by no more than what counting adds.
    within_counting: usize,
    /// Most by which the condition held where the guard refused, m.
    largest: f64,
    /// Accepted although the condition does not hold.
    converse: usize,
    /// Left out: the tube is larger than the guard can look at.
    too_large: usize,
}

fn compare(moving: bool) -> Counts {
    let mut draw = Draw::new(64);
    let mut counts = Counts::default();
    for number in 0..CASES {
        let case = case(&mut draw, moving);
        let (spare, verdict) = (case.spare(1.0, 1.0), case.verdict());
        if matches!(verdict, Verdict::TooLarge) {
            counts.too_large += 1;
            continue;
        }
        if spare < 0.0 {
            counts.converse += usize::from(matches!(verdict, Verdict::Accepted));
            continue;
        }
        counts.premises += 1;
        counts.tight += usize::from(spare < TIGHT_M);
        if let Verdict::Refused { counting } = verdict {
            counts.within_counting += 1;
            counts.largest = counts.largest.max(spare);
            assert!(
                spare <= counting,
                "case {number}: {:?} from the robot, condition holds by {spare} m, counting explains {counting} m; \
                 v {} to {} on {} 1/m, A {}, eps {}, V {}",
                case.point,
                case.v,
                case.commanded,
                case.curvature,
                case.acceleration,
                case.eps,
                case.episode.obstacle_mps
            );
        }
    }
    counts
}

#[test]
fn what_the_proved_condition_allows_the_guard_accepts() {
    for moving in [false, true] {
        let counts = compare(moving);
        println!("{CASES} cases, obstacles that move: {moving}: {counts:?}");
        assert!(counts.premises * 4 > CASES && counts.tight > 1000.min(CASES / 20));
        assert!(counts.converse > CASES / 100, "a rectangle is no circle");
        assert!(counts.too_large * 50 < CASES, "too many are left out");
    }
}

/// A condition that leaves out a term is refused somewhere by more than counting explains.
#[test]
fn weaker_conditions_are_found() {
    for (name, obstacles, reaction) in [("V = 0", 0.0, 1.0), ("eps = 0", 1.0, 0.0)] {
        let mut draw = Draw::new(64);
        let found = (0..CASES).find(|_| {
            let case = case(&mut draw, true);
            let spare = case.spare(obstacles, reaction);
            matches!(case.verdict(), Verdict::Refused { counting } if spare > counting)
        });
        println!("`{name}` found by case {found:?}");
        assert!(found.is_some(), "{name}");
    }
}
