//! The drive: command pipeline, first-order lag, limited ramps, and its own watchdog.

use std::collections::VecDeque;

use haltline_robots::{Kinematics, Ramps, Robot};

use crate::file::{Scenario, Silence};
use crate::math::microseconds;

/// What a drive is told, m/s with rad/s or 1/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SetPoint {
    /// Speed and turn rate.
    Twist {
        /// Forward speed.
        v: f64,
        /// Turn rate.
        omega: f64,
    },
    /// Speed and path curvature.
    Arc {
        /// Forward speed.
        v: f64,
        /// Curvature, positive to the left.
        curvature: f64,
    },
}

impl SetPoint {
    /// Forward speed.
    #[must_use]
    pub const fn speed(self) -> f64 {
        match self {
            Self::Twist { v, .. } | Self::Arc { v, .. } => v,
        }
    }

    /// Turn rate it amounts to.
    #[must_use]
    pub fn turn_rate(self) -> f64 {
        match self {
            Self::Twist { omega, .. } => omega,
            Self::Arc { v, curvature } => v * curvature,
        }
    }

    /// Whether all numbers are finite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        match self {
            Self::Twist { v, omega } => v.is_finite() && omega.is_finite(),
            Self::Arc { v, curvature } => v.is_finite() && curvature.is_finite(),
        }
    }
}

/// What the simulated drive can do: not what the robot file promises, but what it really does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveModel {
    /// Time from a set point to its effect.
    pub latency_us: u64,
    /// Time constant of the lag.
    pub lag_s: f64,
    /// True turn rate for each turn rate of the wheels.
    pub slip: f64,
    /// Acceleration.
    pub acceleration: f64,
    /// Deceleration.
    pub braking: f64,
    /// Angular acceleration.
    pub angular_acceleration: f64,
    /// Angular deceleration.
    pub angular_braking: f64,
    /// Whether v and omega ramp separately.
    pub separate: bool,
    /// Behaviour when the watchdog expires.
    pub silence: Silence,
    /// Watchdog time.
    pub watchdog_us: u64,
    /// Deceleration then.
    pub silent_braking: f64,
    /// Angular deceleration then.
    pub silent_angular_braking: f64,
    /// Curvature the wheels can change in a second (steered robots).
    pub curvature_rate: f64,
}

impl DriveModel {
    /// The worst drive that the robot file allows, with what the scenario changes.
    #[must_use]
    pub fn new(robot: &Robot, scenario: &Scenario) -> Self {
        let values = &robot.values;
        let (limits, silent) = (&values.limits, &values.host_death);
        let drive = &scenario.drive;
        let allowed = values.timing.actuation_latency_s;
        // Whole dynamics steps, with room left for the lag.
        let usual = (libm::floor(allowed * 0.6 * 100.0 + 1e-9) / 100.0).min(0.06);
        let latency_s = drive.latency_s.map_or(usual, |v| v.get());
        let lag_s = drive
            .lag_s
            .map_or(((allowed - latency_s) / 2.0).clamp(0.0, 0.02), |v| v.get());
        let curvature_rate = match values.kinematics {
            Kinematics::Differential => 0.0,
            Kinematics::Ackermann(steering) => {
                2.0 / steering.turning_radius_m / steering.sweep_s.max(1e-3)
            }
        };
        let silence = match silent.behaviour {
            haltline_robots::Silence::Brake => Silence::Brake,
            haltline_robots::Silence::Coast => Silence::Coast,
        };
        let braking = drive.braking_mps2.map_or(limits.braking_mps2, |v| v.get());
        Self {
            latency_us: microseconds(latency_s),
            lag_s,
            slip: drive.slip.map_or(1.0, |v| v.get()),
            acceleration: limits.acceleration_mps2,
            braking,
            angular_acceleration: limits.angular_acceleration_radps2,
            angular_braking: drive
                .angular_braking_radps2
                .map_or(limits.angular_braking_radps2, |v| v.get()),
            separate: drive
                .separate_ramps
                .unwrap_or(limits.ramps == Ramps::Separate),
            silence: drive.silence.unwrap_or(silence),
            watchdog_us: microseconds(drive.watchdog_s.map_or(silent.watchdog_s, |v| v.get())),
            silent_braking: drive
                .silent_braking_mps2
                .map_or(silent.braking_mps2, |v| v.get()),
            silent_angular_braking: silent.angular_braking_radps2,
            curvature_rate,
        }
    }
}

/// State of the drive. Speeds are those of the wheels; the ground sees the slip.
#[derive(Clone, Debug)]
pub struct Drive {
    model: DriveModel,
    pipeline: VecDeque<(u64, SetPoint)>,
    target: SetPoint,
    heard_us: u64,
    v: f64,
    omega: f64,
    curvature: f64,
}

/// Mean motion over one step, over the ground and at the wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moved {
    /// Speed and turn rate over the ground.
    pub ground: [f64; 2],
    /// Speed and turn rate of the wheels.
    pub wheels: [f64; 2],
}

impl Drive {
    /// A drive that moves at `twist` (m/s, rad/s) and was told to.
    #[must_use]
    pub fn new(model: DriveModel, steered: bool, [v, omega]: [f64; 2]) -> Self {
        let curvature = if v.abs() > 1e-6 { omega / v } else { 0.0 };
        let target = if steered {
            SetPoint::Arc { v, curvature }
        } else {
            SetPoint::Twist { v, omega }
        };
        Self {
            model,
            pipeline: VecDeque::new(),
            target,
            heard_us: 0,
            v,
            omega,
            curvature,
        }
    }

    /// Hands a set point to the pipeline.
    pub fn command(&mut self, now_us: u64, set_point: SetPoint) {
        self.heard_us = now_us;
        self.pipeline
            .push_back((now_us + self.model.latency_us, set_point));
    }

    /// True speed and turn rate over the ground.
    #[must_use]
    pub fn ground(&self) -> [f64; 2] {
        [self.v, self.omega * self.model.slip]
    }

    /// Speed and turn rate of the wheels.
    #[must_use]
    pub const fn wheels(&self) -> [f64; 2] {
        [self.v, self.omega]
    }

    /// Path curvature of the front wheels.
    #[must_use]
    pub const fn curvature(&self) -> f64 {
        self.curvature
    }

    /// Whether the watchdog has expired at `now_us`.
    #[must_use]
    pub fn silent(&self, now_us: u64) -> bool {
        self.model.silence != Silence::None
            && now_us.saturating_sub(self.heard_us) > self.model.watchdog_us
    }

    /// One step of `dt_s` from `now_us`.
    pub fn step(&mut self, now_us: u64, dt_s: f64) -> Moved {
        while let Some((due, set_point)) = self.pipeline.front().copied() {
            if due > now_us {
                break;
            }
            self.target = set_point;
            self.pipeline.pop_front();
        }
        let before = (self.wheels(), self.ground());
        if self.silent(now_us) {
            self.run_out(dt_s);
        } else {
            self.follow(dt_s);
        }
        let mean = |a: [f64; 2], b: [f64; 2]| [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
        Moved {
            wheels: mean(before.0, self.wheels()),
            ground: mean(before.1, self.ground()),
        }
    }

    /// Towards the target through lag and limited ramps.
    fn follow(&mut self, dt_s: f64) {
        let model = &self.model;
        let part = if model.lag_s > 0.0 {
            1.0 - libm::exp(-dt_s / model.lag_s)
        } else {
            1.0
        };
        let dv = (self.target.speed() - self.v) * part;
        let v_limit = dt_s * ramp(self.v, dv, model.acceleration, model.braking);
        match self.target {
            SetPoint::Arc { curvature, .. } => {
                let reach = model.curvature_rate * dt_s;
                self.curvature += (curvature - self.curvature).clamp(-reach, reach);
                self.v += dv.clamp(-v_limit, v_limit);
                self.omega = self.v * self.curvature;
            }
            SetPoint::Twist { omega, .. } => {
                let dw = (omega - self.omega) * part;
                let (up, down) = (model.angular_acceleration, model.angular_braking);
                let w_limit = dt_s * ramp(self.omega, dw, up, down);
                let (v_part, w_part) = (share(dv, v_limit), share(dw, w_limit));
                let both = v_part.min(w_part);
                self.v += dv * if model.separate { v_part } else { both };
                self.omega += dw * if model.separate { w_part } else { both };
            }
        }
    }

    /// What the drive does by itself: brake along the curve, or let both run out.
    fn run_out(&mut self, dt_s: f64) {
        let model = &self.model;
        let v_part = share(self.v, model.silent_braking * dt_s);
        let w_part = share(self.omega, model.silent_angular_braking * dt_s);
        let steered = matches!(self.target, SetPoint::Arc { .. });
        let (v_part, w_part) = if model.silence == Silence::Coast && !steered {
            (v_part, w_part)
        } else if steered {
            (v_part, v_part)
        } else {
            (v_part.min(w_part), v_part.min(w_part))
        };
        self.v -= self.v * v_part;
        self.omega -= self.omega * w_part;
        // A drive that was silent starts from zero, whatever it was told before.
        self.pipeline.clear();
        self.target = match self.target {
            SetPoint::Twist { .. } => SetPoint::Twist { v: 0.0, omega: 0.0 },
            SetPoint::Arc { curvature, .. } => SetPoint::Arc { v: 0.0, curvature },
        };
    }
}

/// Rate that limits a change: the brake's while the magnitude falls, else the motor's.
fn ramp(value: f64, change: f64, up: f64, down: f64) -> f64 {
    if value * change < 0.0 { down } else { up }
}

/// Part of a change that a limit lets through, from 0 to 1.
fn share(change: f64, limit: f64) -> f64 {
    if change.abs() <= limit {
        1.0
    } else {
        limit / change.abs()
    }
}

#[cfg(test)]
mod tests;
