//! One random robot in one random world, told truthfully or with one lie to the kernel.

use haltline::config::{
    Config, Footprint, HostDeath, Kinematics, Limits, MASKS_MAX, MemoryRules, Ramps, Scanner,
    Timing, Tolerances, ZoneMargins,
};
use haltline::convert::{self, Round};
use haltline::time::Duration;
use haltline_spec::draw::Draw;
use haltline_spec::plane::{Body, Outline, Pose};
use haltline_spec::plant::Quality;
use haltline_spec::world::{self, Mover};
use proptest::prelude::*;

/// What the untrusted side wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Style {
    /// Straight for the nearest body, as fast as possible.
    Reckless,
    /// Random twists held for random times.
    Wander,
    /// Opposite curvatures in quick succession.
    Weave,
    /// Turns on the spot, by 90 degrees and more, beside bodies.
    Spot,
    /// Very slowly for the nearest body.
    Creep,
}

/// What the kernel is told less than the truth about; a false twin each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lie {
    /// Nothing: the kernel knows the truth.
    None,
    /// The drive reacts at once.
    Latency,
    /// Nothing moves.
    ObstacleSpeed,
    /// The drive keeps its path exactly.
    Tracking,
    /// The scanner is exact.
    Sensor,
    /// Speeds are exact.
    SpeedTolerance,
    /// Turn rates are exact.
    TurnTolerance,
    /// The brakes are four times as good.
    Braking,
    /// The angular brakes are four times as good.
    AngularBraking,
    /// The wheels follow at once.
    SteeringSweep,
    /// All beams are fired at the time of the last.
    ScanTime,
    /// Speed and turn rate ramp together.
    JointRamps,
    /// The robot is smaller than it is.
    Footprint,
    /// Scans may be ten times as old.
    ScanAge,
    /// Odometry may be five times as old.
    OdometryAge,
    /// Commands may be ten times as old.
    CommandAge,
    /// Ticks may be a second late.
    Jitter,
    /// Any part of the beams may be invalid.
    InvalidFraction,
    /// Any run of beams may be invalid.
    InvalidGap,
    /// Whatever moves slowly rests, at once.
    Rest,
    /// A hazard need not be gone for any time.
    Clear,
    /// The odometry is exact.
    Drift,
    /// There is no critical zone.
    Zone,
    /// The host never dies.
    HostDeath,
    /// One scan that looks past a point clears it.
    ClearAfter,
}

/// Everything that is drawn for one run.
#[derive(Clone, Debug)]
pub struct Episode {
    /// Source of every further draw.
    pub seed: u64,
    pub style: Style,
    pub lie: Lie,
    pub edges_m: [f64; 4],
    pub steered: bool,
    pub separate: bool,
    pub period_ms: u64,
    pub jitter_ms: u64,
    pub latency_ms: u64,
    pub scan_ms: u64,
    pub beams: usize,
    pub full_circle: bool,
    pub speed_mps: f64,
    pub turn_radps: f64,
    pub braking_mps2: f64,
    pub angular_braking_radps2: f64,
    pub harder: f64,
    pub tol_v_mps: f64,
    pub tol_omega_radps: f64,
    pub tracking_m: f64,
    pub sensor_m: f64,
    pub odometry_linear: f64,
    pub odometry_angular: f64,
    pub obstacle_mps: f64,
    pub bodies: usize,
    pub thin: bool,
    /// Margins of the critical zone: in front, elsewhere.
    pub zone_m: [f64; 2],
    /// The drive's watchdog time, if the tube is to cover the host's death.
    pub watchdog_ms: Option<u64>,
}

prop_compose! {
    /// Truthful episodes of the given styles.
    pub fn episodes(styles: Vec<Style>, moving: bool)(
        seed in any::<u64>(),
        style in prop::sample::select(styles),
        edges_m in [0.15..0.6_f64, 0.15..0.6, 0.12..0.4, 0.12..0.4],
        flags in any::<[bool; 3]>(),
        times in (20..50_u64, 0..8_u64, 0..150_u64, 5..50_u64),
        beams in 180..700_usize,
        limits in (0.2..1.2_f64, 0.4..2.0_f64),
        brakes in (0.4..1.5_f64, 0.6..3.0_f64, 1.0..4.0_f64),
        tolerances in (0.0..0.02_f64, 0.0..0.03_f64, 0.0..0.02_f64, 0.0..0.02_f64),
        odometry in (0.0..0.02_f64, 0.0..0.02_f64),
        obstacle_mps in 0.1..1.0_f64,
        bodies in 3..9_usize,
    ) -> Episode {
        Episode {
            seed,
            style,
            lie: Lie::None,
            edges_m,
            steered: flags[0] && style != Style::Spot,
            separate: false,
            period_ms: times.0,
            jitter_ms: times.1,
            latency_ms: times.2,
            scan_ms: times.3,
            beams,
            full_circle: flags[1],
            speed_mps: limits.0,
            turn_radps: limits.1,
            braking_mps2: brakes.0,
            angular_braking_radps2: brakes.1,
            harder: brakes.2,
            tol_v_mps: tolerances.0,
            tol_omega_radps: tolerances.1,
            tracking_m: tolerances.2,
            sensor_m: tolerances.3,
            odometry_linear: odometry.0,
            odometry_angular: odometry.1,
            obstacle_mps: if moving { obstacle_mps } else { 0.0 },
            bodies,
            thin: flags[2],
            zone_m: [0.01, 0.005],
            watchdog_ms: None,
        }
    }
}

/// Distance around the start that is free of bodies, m.
pub const CLEAR_M: f64 = 1.3;
/// Largest curvature of steered robots, 1/m, and the error of it.
pub const CURVATURE_MAX: f64 = 1.5;
pub const CURVATURE_TOLERANCE: f64 = 0.03;
/// Time from stop to stop of the steered wheels, s.
pub const SWEEP_S: f64 = 0.4;
const RANGE_MAX_M: f64 = 12.0;

fn up_um(metres: f64) -> haltline::units::Length {
    convert::length(metres, Round::Up).unwrap()
}

fn ms(milliseconds: u64) -> Duration {
    Duration::from_ms(milliseconds)
}

impl Episode {
    pub fn outline(&self) -> Outline {
        Outline {
            front_m: self.edges_m[0],
            rear_m: self.edges_m[1],
            left_m: self.edges_m[2],
            right_m: self.edges_m[3],
        }
    }

    /// The scanner sits in the middle of the front edge, or in the rotation centre and sees all.
    pub fn scanner(&self) -> world::Scanner {
        let (x_m, span) = if self.full_circle {
            (0.0, std::f64::consts::TAU)
        } else {
            (self.edges_m[0] * 0.8, 1.5 * std::f64::consts::PI)
        };
        let increment_rad = span / self.beams as f64;
        world::Scanner {
            mount: Pose::new(x_m, 0.0, -span / 2.0 + increment_rad / 2.0),
            increment_rad,
            beams: self.beams,
            duration_s: self.scan_ms as f64 * 1e-3,
            range_max_m: RANGE_MAX_M,
            error_m: self.sensor_m,
        }
    }

    pub fn quality(&self) -> Quality {
        Quality {
            latency_s: self.latency_ms as f64 * 1e-3,
            acceleration_mps2: self.braking_mps2 * 1.05,
            angular_radps2: self.angular_braking_radps2 * 1.05,
            speed_mps: self.tol_v_mps,
            turn_radps: self.tol_omega_radps,
            odometry_linear: self.odometry_linear,
            odometry_angular: self.odometry_angular,
            steering_per_m_s: 2.0 * CURVATURE_MAX / SWEEP_S * 1.05,
        }
    }

    /// Bodies outside the circle that the operator vouches for.
    pub fn world(&self, draw: &mut Draw) -> Vec<Mover> {
        let mut movers = Vec::new();
        while movers.len() < self.bodies {
            let size = if self.thin {
                0.03
            } else {
                draw.between(0.05, 0.4)
            };
            let angle = draw.between(-3.1, 3.1);
            let distance = CLEAR_M + size * 1.5 + 0.02 + draw.unit() * 2.5;
            let (x_m, y_m) = (distance * angle.cos(), distance * angle.sin());
            let body = if self.thin || draw.chance(0.5) {
                Body::disc(x_m, y_m, size)
            } else {
                let other = draw.between(0.03, size);
                Body::rectangle(Pose::new(x_m, y_m, draw.between(-3.0, 3.0)), size, other)
            };
            let course = draw.between(-3.1, 3.1);
            let speed = draw.extreme(0.0, self.obstacle_mps);
            movers.push(Mover {
                body,
                velocity_mps: [speed * course.cos(), speed * course.sin()],
            });
        }
        movers
    }

    /// Oldest scan in use, ms: two sweeps, delivery and a tick.
    pub fn scan_age_ms(&self) -> u64 {
        2 * self.scan_ms.max(20) + 2 * (self.period_ms + self.jitter_ms) + 30
    }

    pub fn config(&self) -> Config<2> {
        let mut config = self.true_config();
        self.falsify(&mut config);
        config
    }

    fn true_config(&self) -> Config<2> {
        Config {
            footprint: Footprint {
                front: up_um(self.edges_m[0]),
                rear: up_um(self.edges_m[1]),
                left: up_um(self.edges_m[2]),
                right: up_um(self.edges_m[3]),
            },
            kinematics: if self.steered {
                Kinematics::Ackermann {
                    curvature_max: convert::curvature(CURVATURE_MAX, Round::Up).unwrap(),
                    curvature_tolerance: convert::curvature(CURVATURE_TOLERANCE, Round::Up)
                        .unwrap(),
                    steering_sweep: convert::duration(SWEEP_S, Round::Up).unwrap(),
                }
            } else {
                Kinematics::Differential
            },
            limits: self.limits(),
            timing: self.timing(),
            tolerances: self.tolerances(),
            zone: ZoneMargins {
                front: up_um(self.zone_m[0]),
                side: up_um(self.zone_m[1]),
            },
            scanners: [Some(self.scanner_config()), None],
            memory: MemoryRules {
                clear_after_scans: 3,
                age_max: ms(60_000),
                clear_at_start: convert::length(CLEAR_M, Round::Down).unwrap(),
                skirt: up_um(0.05),
                body_width_min: up_um(0.06),
            },
            obstacle_speed: convert::speed(self.obstacle_mps, Round::Up).unwrap(),
            host_death: self.watchdog_ms.map(|watchdog| HostDeath {
                watchdog: ms(watchdog),
                braking: self.limits().braking,
                angular_braking: self.limits().angular_braking,
            }),
        }
    }

    fn limits(&self) -> Limits {
        let speed = convert::speed(self.speed_mps, Round::Down).unwrap();
        Limits {
            speed_forward: speed,
            speed_reverse: speed,
            angular_speed: convert::angular_speed(self.turn_radps, Round::Down).unwrap(),
            acceleration: convert::acceleration(self.braking_mps2, Round::Down).unwrap(),
            braking: convert::acceleration(self.braking_mps2, Round::Down).unwrap(),
            angular_acceleration: convert::angular_acceleration(
                self.angular_braking_radps2,
                Round::Down,
            )
            .unwrap(),
            angular_braking: convert::angular_acceleration(
                self.angular_braking_radps2,
                Round::Down,
            )
            .unwrap(),
            ramps: if self.separate {
                Ramps::Separate
            } else {
                Ramps::Together
            },
        }
    }

    fn timing(&self) -> Timing {
        Timing {
            period: ms(self.period_ms),
            jitter: ms(self.jitter_ms),
            actuation_latency: ms(self.latency_ms),
            scan_age_max: ms(self.scan_age_ms()),
            odometry_age_max: ms(60),
            command_age_max: ms(200),
            rest: ms(60),
            clear: ms(100),
            tracking_window: ms(1000),
        }
    }

    fn tolerances(&self) -> Tolerances {
        let speed = |v: f64| convert::speed(v, Round::Up).unwrap();
        let turn = |w: f64| convert::angular_speed(w, Round::Up).unwrap();
        Tolerances {
            speed: speed(self.tol_v_mps),
            angular_speed: turn(self.tol_omega_radps),
            tracking: up_um(self.tracking_m),
            odometry_linear: convert::ratio(self.odometry_linear, Round::Up).unwrap(),
            odometry_angular: convert::ratio(self.odometry_angular, Round::Up).unwrap(),
            rest_speed: speed(self.tol_v_mps + 0.005),
            rest_angular_speed: turn(self.tol_omega_radps + 0.005),
            follow_speed: speed(1.0),
            follow_angular_speed: turn(1.5),
        }
    }

    fn scanner_config(&self) -> Scanner {
        let scanner = self.scanner();
        Scanner {
            x: convert::length(scanner.mount.x_m, Round::Nearest).unwrap(),
            y: convert::length(scanner.mount.y_m, Round::Nearest).unwrap(),
            first_beam: convert::angle(scanner.mount.theta_rad).unwrap(),
            increment: convert::signed_angle(scanner.increment_rad)
                .and_then(|counts| i32::try_from(counts).ok())
                .unwrap(),
            beams: self.beams as u16,
            scan_duration: ms(self.scan_ms),
            range_min: up_um(0.02),
            range_max: up_um(RANGE_MAX_M),
            error: up_um(self.sensor_m),
            no_return_clear: up_um(8.0),
            invalid_max: convert::ratio(0.1, Round::Down).unwrap(),
            invalid_gap_max: 1 << 28,
            masks: [None; MASKS_MAX],
        }
    }

    fn falsify(&self, config: &mut Config<2>) {
        let zero = convert::length(0.0, Round::Up).unwrap();
        match self.lie {
            Lie::None => {}
            Lie::ScanTime => {
                for scanner in config.scanners.iter_mut().flatten() {
                    scanner.scan_duration = Duration::ZERO;
                }
            }
            Lie::Latency => config.timing.actuation_latency = Duration::ZERO,
            Lie::ObstacleSpeed => {
                config.obstacle_speed = convert::speed(0.0, Round::Up).unwrap();
            }
            Lie::Tracking => config.tolerances.tracking = zero,
            Lie::Sensor => {
                for scanner in config.scanners.iter_mut().flatten() {
                    scanner.error = zero;
                }
            }
            Lie::SpeedTolerance => {
                config.tolerances.speed = convert::speed(0.0, Round::Up).unwrap();
            }
            Lie::TurnTolerance => {
                config.tolerances.angular_speed = convert::angular_speed(0.0, Round::Up).unwrap();
            }
            Lie::Braking => {
                config.limits.braking =
                    convert::acceleration(4.0 * self.braking_mps2, Round::Down).unwrap();
            }
            Lie::AngularBraking => {
                config.limits.angular_braking =
                    convert::angular_acceleration(4.0 * self.angular_braking_radps2, Round::Down)
                        .unwrap();
            }
            Lie::SteeringSweep => {
                if let Kinematics::Ackermann { steering_sweep, .. } = &mut config.kinematics {
                    *steering_sweep = Duration::ZERO;
                }
            }
            Lie::JointRamps => config.limits.ramps = Ramps::Together,
            Lie::ScanAge => config.timing.scan_age_max = ms(10 * self.scan_age_ms()),
            Lie::OdometryAge => config.timing.odometry_age_max = ms(300),
            Lie::CommandAge => config.timing.command_age_max = ms(2000),
            Lie::Jitter => config.timing.jitter = ms(1000),
            Lie::InvalidFraction | Lie::InvalidGap => {
                for scanner in config.scanners.iter_mut().flatten() {
                    if self.lie == Lie::InvalidFraction {
                        scanner.invalid_max = convert::ratio(1.0, Round::Up).unwrap();
                    } else {
                        scanner.invalid_gap_max = u32::MAX;
                    }
                }
            }
            Lie::Rest => {
                config.timing.rest = Duration::ZERO;
                config.tolerances.rest_speed = convert::speed(0.3, Round::Up).unwrap();
            }
            Lie::Clear => config.timing.clear = Duration::ZERO,
            Lie::Drift => {
                let exact = convert::ratio(0.0, Round::Up).unwrap();
                config.tolerances.odometry_linear = exact;
                config.tolerances.odometry_angular = exact;
            }
            Lie::HostDeath => config.host_death = None,
            Lie::Zone => config.zone = ZoneMargins::default(),
            Lie::ClearAfter => config.memory.clear_after_scans = 1,
            Lie::Footprint => {
                config.footprint.front = up_um(self.edges_m[0] - 0.05);
                config.footprint.left = up_um(self.edges_m[2] - 0.05);
            }
        }
    }
}
