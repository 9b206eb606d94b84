//! A robot in a rectangular room, in exact floats: enough world to drive the kernel through its door.
#![allow(
    dead_code,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs
)]
#![allow(clippy::indexing_slicing, clippy::arithmetic_side_effects)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use haltline::config::*;
use haltline::convert::{self, Round};
use haltline::decision::Decision;
use haltline::input::{Beam, Command, Inputs, Motion, Odometry, Reading, Scan, Twist};
use haltline::time::{Duration, Instant};
use haltline::units::*;

pub type Robot = haltline::Kernel<1, 541, 1024>;

pub fn m(value: f64) -> Length {
    convert::length(value, Round::Nearest).unwrap()
}

fn mps(value: f64) -> Speed {
    convert::speed(value, Round::Nearest).unwrap()
}

fn radps(value: f64) -> AngularSpeed {
    convert::angular_speed(value, Round::Nearest).unwrap()
}

pub fn scanner() -> Scanner {
    Scanner {
        x: m(0.527),
        y: m(0.0),
        first_beam: convert::angle(-135_f64.to_radians()).unwrap(),
        increment: i32::try_from(convert::signed_angle(0.5_f64.to_radians()).unwrap()).unwrap(),
        beams: 541,
        scan_duration: Duration::from_ms(20),
        range_min: m(0.02),
        range_max: m(20.0),
        error: m(0.01),
        no_return_clear: m(10.0),
        invalid_max: Ppm::from_ppm(50_000),
        invalid_gap_max: u32::try_from(convert::signed_angle(0.1).unwrap()).unwrap(),
        masks: [None; MASKS_MAX],
    }
}

/// A Seekur-like robot in a static world.
pub fn config() -> Config<1> {
    Config {
        footprint: Footprint {
            front: m(0.6),
            rear: m(0.6),
            left: m(0.42),
            right: m(0.42),
        },
        kinematics: Kinematics::Differential,
        limits: Limits {
            speed_forward: mps(1.2),
            speed_reverse: mps(0.0),
            angular_speed: radps(1.39),
            acceleration: convert::acceleration(0.5, Round::Down).unwrap(),
            braking: convert::acceleration(0.5, Round::Down).unwrap(),
            angular_acceleration: convert::angular_acceleration(1.0, Round::Down).unwrap(),
            angular_braking: convert::angular_acceleration(1.0, Round::Down).unwrap(),
            ramps: Ramps::Together,
        },
        timing: Timing {
            period: Duration::from_ms(40),
            jitter: Duration::from_ms(2),
            actuation_latency: Duration::from_ms(100),
            scan_age_max: Duration::from_ms(60),
            odometry_age_max: Duration::from_ms(60),
            command_age_max: Duration::from_ms(200),
            rest: Duration::from_ms(200),
            clear: Duration::from_ms(500),
            tracking_window: Duration::from_ms(400),
        },
        tolerances: Tolerances {
            speed: mps(0.01),
            angular_speed: radps(0.01),
            tracking: m(0.02),
            odometry_linear: Ppm::from_ppm(5_000),
            odometry_angular: Ppm::from_ppm(10_000),
            rest_speed: mps(0.005),
            rest_angular_speed: radps(0.005),
            follow_speed: mps(0.15),
            follow_angular_speed: radps(0.3),
        },
        zone: ZoneMargins {
            front: m(0.02),
            side: m(0.02),
        },
        scanners: [Some(scanner())],
        memory: MemoryRules {
            clear_after_scans: 3,
            age_max: Duration::from_ms(600_000),
            clear_at_start: m(1.2),
            skirt: m(0.05),
            body_width_min: m(0.025),
        },
        obstacle_speed: Speed::ZERO,
        host_death: None,
    }
}

/// A room with walls at the given coordinates, and a robot that executes set points at once.
pub struct Room {
    pub x: (f64, f64),
    pub y: (f64, f64),
    pub pose: [f64; 3],
    pub twist: [f64; 2],
    pub now_us: u64,
    pub kernel: Robot,
}

impl Room {
    pub fn new(x: (f64, f64), y: (f64, f64), config: Config<1>) -> Self {
        Self {
            x,
            y,
            pose: [0.0; 3],
            twist: [0.0; 2],
            now_us: 1_000_000,
            kernel: Robot::new(config).unwrap(),
        }
    }

    pub fn now(&self) -> Instant {
        Instant::from_us(self.now_us)
    }

    pub fn beams(&self) -> Vec<Beam> {
        let (sin, cos) = self.pose[2].sin_cos();
        let (ox, oy) = (self.pose[0] + 0.527 * cos, self.pose[1] + 0.527 * sin);
        (0..541)
            .map(|beam| {
                let bearing =
                    self.pose[2] - 135_f64.to_radians() + 0.5_f64.to_radians() * f64::from(beam);
                let (dy, dx) = bearing.sin_cos();
                let along = |o: f64, d: f64, (low, high): (f64, f64)| {
                    if d > 0.0 {
                        (high - o) / d
                    } else if d < 0.0 {
                        (low - o) / d
                    } else {
                        f64::INFINITY
                    }
                };
                let range = along(ox, dx, self.x).min(along(oy, dy, self.y));
                convert::beam(
                    range as f32,
                    convert::BeamEncoding::Rep117,
                    m(0.02),
                    m(20.0),
                )
            })
            .collect()
    }

    pub fn odometry(&self) -> Odometry {
        match convert::odometry(self.now(), self.pose, self.twist, None) {
            Reading::Value(odometry) => odometry,
            other => panic!("{other:?}"),
        }
    }

    /// One tick with fresh inputs; the robot then executes the set point for one period.
    pub fn tick(&mut self, command: Option<(f64, f64)>, reset: bool) -> Decision {
        let beams = self.beams();
        self.told(&beams, 20_000, command, reset)
    }

    /// As [`Self::tick`] with a scan that says this and is so old, µs.
    pub fn told(
        &mut self,
        beams: &[Beam],
        age_us: u64,
        command: Option<(f64, f64)>,
        reset: bool,
    ) -> Decision {
        let command = command.map_or(Reading::Absent, |(v, w)| self.command(v, w));
        let scan = Scan {
            scanner: 0,
            stamp: Instant::from_us(self.now_us - age_us),
            beams,
        };
        let scans = [Reading::Value(scan)];
        let inputs = Inputs {
            scans: &scans,
            odometry: Reading::Value(self.odometry()),
            command,
            emergency_stop: false,
            reset: reset.then(|| self.now()),
        };
        self.step(&inputs)
    }

    /// Hands `inputs` to the kernel and lets the robot execute the answer for one period.
    pub fn step(&mut self, inputs: &Inputs<'_>) -> Decision {
        let decision = self.kernel.step(inputs, self.now());
        let Motion::Twist(twist) = decision.setpoint else {
            panic!("a differential drive gets twists");
        };
        self.execute(twist);
        decision
    }

    pub fn execute(&mut self, twist: Twist) {
        let v = f64::from(twist.linear.as_um_per_s()) * 1e-6;
        let w = f64::from(twist.angular.as_urad_per_s()) * 1e-6;
        for _ in 0..40 {
            self.pose[0] += v * 1e-3 * self.pose[2].cos();
            self.pose[1] += v * 1e-3 * self.pose[2].sin();
            self.pose[2] += w * 1e-3;
        }
        self.twist = [v, w];
        self.now_us += 40_000;
    }

    /// Warms up and resets, so that the kernel runs.
    pub fn start(&mut self) -> Decision {
        for _ in 0..10 {
            let _ = self.tick(None, false);
        }
        self.tick(None, true)
    }

    pub fn command(&self, v: f64, w: f64) -> Reading<Command> {
        convert::twist_command(self.now(), v, w)
    }
}
