//! What the kernel is told about an episode's robot: the truth, or the truth with one lie.

use super::episode::{
    CLEAR_M, CURVATURE_MAX, CURVATURE_TOLERANCE, Episode, Lie, RANGE_MAX_M, SWEEP_S,
};
use haltline::config::{
    Config, Footprint, HostDeath, Kinematics, Limits, MASKS_MAX, MemoryRules, Ramps, Scanner,
    Timing, Tolerances, ZoneMargins,
};
use haltline::convert::{self, Round};
use haltline::time::Duration;

fn up_um(metres: f64) -> haltline::units::Length {
    convert::length(metres, Round::Up).unwrap()
}

fn ms(milliseconds: u64) -> Duration {
    Duration::from_ms(milliseconds)
}

impl Episode {
    /// The kernel's configuration.
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
