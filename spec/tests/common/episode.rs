//! One random robot in one random world, told truthfully or with one lie to the kernel.

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
    /// The whole tube is sampled at each so many accepted steps; contacts are judged at all.
    pub tube_every: usize,
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
            tube_every: 1,
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
/// Longest range of the scanners, m.
pub const RANGE_MAX_M: f64 = 12.0;

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
}
