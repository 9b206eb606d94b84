//! A model car: motor, brake, steering servo, wheel sensor, gyro.

use std::sync::OnceLock;

use haltline::time::{Duration, Instant};

use super::Robot;
use super::board::{Board, Thrust};
use super::motion::{Truth, steps};

/// What this car is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarModel {
    /// Whether its board sends an STX (firmware 0.12.0 and later).
    pub sends_stx: bool,
    /// Its dead-man switch does nothing, whatever it says.
    pub ignores_dead_man: bool,
    /// Rear axle to front axle, metres.
    pub wheelbase_m: f64,
    /// Distance of the rear wheels, metres.
    pub track_m: f64,
    /// Deceleration in neutral, m/s².
    pub coasting: f64,
    /// Deceleration of the full brake beyond that, m/s².
    pub full_brake: f64,
    /// Acceleration of the motor, m/s².
    pub acceleration: f64,
    /// Turn of the wheels, rad/s.
    pub steering_rate: f64,
    /// Zero of the gyro, rad/s.
    pub gyro_zero: f64,
    /// Pose of the rear axle at the start.
    pub start: [f64; 3],
}

impl Default for CarModel {
    fn default() -> Self {
        Self {
            sends_stx: true,
            ignores_dead_man: false,
            wheelbase_m: 0.25,
            track_m: 0.17,
            coasting: 0.3,
            full_brake: 1.0,
            acceleration: 0.8,
            steering_rate: 2.0,
            gyro_zero: 0.01,
            start: [0.0; 3],
        }
    }
}

/// Time from a pulse width to the servo, one frame.
const SERVO_FRAME: Duration = Duration::from_ms(20);

/// The emulated car.
#[derive(Clone, Debug)]
pub struct Car {
    model: CarModel,
    board: Board,
    lived: Instant,
    wheel_angle: f64,
    /// Pulse width on its way to the servo.
    steered: (Instant, f64),
    heard_at: Truth,
    truth: Truth,
    /// Path of the rear-left wheel since its last pulse.
    since_pulse_m: f64,
}

impl Car {
    /// A car that was switched on at `now`.
    #[must_use]
    pub fn new(model: CarModel, now: Instant) -> Self {
        Self {
            model,
            board: Board::new(model.sends_stx, !model.ignores_dead_man, now),
            lived: now,
            wheel_angle: 0.0,
            steered: (now, 0.0),
            heard_at: Truth::default(),
            truth: Truth {
                pose: model.start,
                twist: [0.0; 2],
            },
            since_pulse_m: 0.0,
        }
    }

    /// Speed after `dt_s`: the motor pulls towards the level's steady speed, the brake only from
    /// forward motion, and neutral lets it roll.
    fn next_speed(&self, dt_s: f64) -> f64 {
        let model = &self.model;
        let v = self.truth.twist[0];
        let towards_rest = |rate: f64| {
            if v > 0.0 {
                (v - rate * dt_s).max(0.0)
            } else {
                (v + rate * dt_s).min(0.0)
            }
        };
        match self.board.thrust() {
            Thrust::Neutral => towards_rest(model.coasting),
            Thrust::Brake(level) if v > 0.0 => {
                towards_rest(model.coasting + model.full_brake * f64::from(level) / 500.0)
            }
            Thrust::Brake(_) => towards_rest(model.coasting),
            Thrust::Drive(level) => {
                let steady = steady_speed(level);
                if v.abs() > steady.abs() && v * steady >= 0.0 {
                    // The motor drags a little more than neutral.
                    let slower = towards_rest(model.coasting + 0.3);
                    return if slower.abs() < steady.abs() {
                        steady
                    } else {
                        slower
                    };
                }
                let reach = model.acceleration * dt_s;
                v + (steady - v).clamp(-reach, reach)
            }
        }
    }

    fn live(&mut self, now: Instant, dt_s: f64) {
        self.board.live(now);
        if let Some(level) = self.board.steering() {
            let wanted = wheel_angle(level);
            if (wanted - self.steered.1).abs() > 1e-9 {
                self.steered = (now.plus(SERVO_FRAME), wanted);
            }
        }
        if now >= self.steered.0 {
            let reach = self.model.steering_rate * dt_s;
            self.wheel_angle += (self.steered.1 - self.wheel_angle).clamp(-reach, reach);
        }
        let v = self.next_speed(dt_s);
        let omega = v * self.wheel_angle.tan() / self.model.wheelbase_m;
        self.truth.advance([v, omega], dt_s);
        let wheel = v - omega * self.model.track_m / 2.0;
        self.since_pulse_m += wheel.abs() * dt_s;
        let pulse_m = core::f64::consts::TAU * 0.032 / 8.0;
        if self.since_pulse_m >= pulse_m {
            self.since_pulse_m -= pulse_m;
            self.board.sensors.pulse(now);
        }
        self.board.sensors.turn_rate(omega + self.model.gyro_zero);
    }
}

/// Speed at which the car settles for a level, m/s: the measured lines of DCAD 2018, read off the
/// plot (friction holds the car below about 105 forward and 116 backward), not the printed signs.
pub(crate) fn steady_speed(level: i16) -> f64 {
    let level = f64::from(level);
    if level > 0.0 {
        ((level - 104.623_299) / 477.518_514).max(0.0)
    } else {
        ((level + 116.136_943) / 439.8038).min(0.0)
    }
}

/// Angle at which the wheels settle for a steering level, rad, left positive: the polynomial of
/// DCAD 2018 solved by walking along it.
pub(crate) fn wheel_angle(level: i16) -> f64 {
    static ANGLES: OnceLock<Vec<f64>> = OnceLock::new();
    let printed = |x: f64| {
        196_814.0 * x.powi(6) - 50_518.0 * x.powi(5) - 47_550.0 * x.powi(4)
            + 5979.7 * x.powi(3)
            + 2459.5 * x.powi(2)
            - 2442.1 * x
            + 143.78
    };
    let walk = || {
        // The highest level is the farthest to the right, where the walk begins.
        let mut angle = -0.40;
        let mut angles: Vec<f64> = (-1000..=1000)
            .rev()
            .map(|level| {
                while angle < 0.45 && printed(angle) > f64::from(level) {
                    angle += 1e-5;
                }
                angle
            })
            .collect();
        angles.reverse();
        angles
    };
    let angles = ANGLES.get_or_init(walk);
    let index = usize::try_from(i32::from(level) + 1000).unwrap_or_default();
    angles.get(index).copied().unwrap_or_default()
}

impl Robot for Car {
    fn receive(&mut self, bytes: &[u8], now: Instant) {
        self.step(now);
        let before = self.board.last_drive();
        self.board.receive(bytes, now);
        if self.board.last_drive() != before {
            self.heard_at = self.truth;
        }
    }

    fn step(&mut self, now: Instant) {
        let mut lived = self.lived;
        for (at, dt_s) in steps(&mut lived, now) {
            self.live(at, dt_s);
        }
        self.lived = lived;
    }

    fn outgoing(&mut self) -> Vec<u8> {
        self.board.outgoing()
    }

    fn truth(&self) -> Truth {
        self.truth
    }

    fn reboot(&mut self, now: Instant) {
        self.board = Board::new(self.model.sends_stx, !self.model.ignores_dead_man, now);
    }

    fn last_heard(&self) -> (Instant, Truth) {
        (self.board.last_drive(), self.heard_at)
    }

    fn bump(&mut self, _touching: bool) {}

    fn press_stop(&mut self, _pressed: bool) {}

    fn reopened(&mut self) {}
}
