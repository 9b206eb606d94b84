//! A robot that really drives: set points arrive late, speeds follow by ramps, odometry drifts.
//!
//! The plant uses up what the assumptions allow and no more: its errors are
//! drawn once per run, mostly at the ends of their ranges.

use crate::draw::Draw;
use crate::motion::Twist;
use crate::plane::Pose;
use std::collections::VecDeque;

/// What a set point asks of the drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SetPoint {
    /// Speed and turn rate.
    Twist(Twist),
    /// Speed (m/s) and path curvature (1/m) of steered wheels.
    Arc {
        /// Forward speed, m/s.
        v_mps: f64,
        /// Path curvature, 1/m.
        curvature_per_m: f64,
    },
}

/// How well the robot drives and measures. All bounds are magnitudes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Longest time from a decision to its effect, s.
    pub latency_s: f64,
    /// Acceleration and deceleration of the drive, m/s²; at least the sure deceleration.
    pub acceleration_mps2: f64,
    /// Angular acceleration and deceleration of the drive, rad/s².
    pub angular_radps2: f64,
    /// Error of executed and measured speed together, m/s.
    pub speed_mps: f64,
    /// Error of executed and measured turn rate together, rad/s.
    pub turn_radps: f64,
    /// Odometry position error per distance.
    pub odometry_linear: f64,
    /// Odometry heading error per angle.
    pub odometry_angular: f64,
    /// Rate of the steered wheels in curvature, 1/(m s).
    pub steering_per_m_s: f64,
}

/// The true state of the robot and its odometry.
#[derive(Clone, Debug)]
pub struct Plant {
    quality: Quality,
    latency_s: f64,
    executed_error: Twist,
    measured_error: Twist,
    scale: [f64; 2],
    /// Where the robot is.
    pub pose: Pose,
    /// Where the odometry believes it is.
    pub odometry: Pose,
    /// What the drive executes, without errors.
    drive: Twist,
    curvature_per_m: f64,
    in_flight: VecDeque<(f64, SetPoint)>,
    in_force: SetPoint,
    t_s: f64,
}

impl Plant {
    /// A robot at rest at `pose`, its errors drawn within `quality`.
    #[must_use]
    pub fn new(quality: Quality, pose: Pose, draw: &mut Draw) -> Self {
        let third = |bound: f64, draw: &mut Draw| draw.extreme(-bound, bound) / 3.0;
        let executed_error = Twist::new(
            third(quality.speed_mps, draw),
            third(quality.turn_radps, draw),
        );
        let measured_error = Twist::new(
            third(quality.speed_mps, draw),
            third(quality.turn_radps, draw),
        );
        let bounds = [quality.odometry_linear, quality.odometry_angular];
        Self {
            quality,
            latency_s: draw.extreme(0.0, quality.latency_s),
            executed_error,
            measured_error,
            scale: bounds.map(|bound| 1.0 + draw.extreme(-bound, bound)),
            pose,
            odometry: Pose::default(),
            drive: Twist::default(),
            curvature_per_m: 0.0,
            in_flight: VecDeque::new(),
            in_force: SetPoint::Twist(Twist::default()),
            t_s: 0.0,
        }
    }

    /// Sends a set point; it acts after this run's latency.
    pub fn send(&mut self, set_point: SetPoint) {
        self.in_flight
            .push_back((self.t_s + self.latency_s, set_point));
    }

    /// What the drive executes, errors included; exactly zero at rest.
    #[must_use]
    pub fn twist(&self) -> Twist {
        if self.drive == Twist::default() {
            return Twist::default();
        }
        Twist::new(
            self.drive.v_mps + self.executed_error.v_mps,
            self.drive.omega_radps + self.executed_error.omega_radps,
        )
    }

    /// What the odometry measures.
    #[must_use]
    pub fn measured(&self) -> Twist {
        let twist = self.twist();
        if twist == Twist::default() {
            return twist;
        }
        Twist::new(
            twist.v_mps + self.measured_error.v_mps,
            twist.omega_radps + self.measured_error.omega_radps,
        )
    }

    /// Whether the robot stands still.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.twist() == Twist::default()
    }

    /// Lets `dt_s` pass.
    pub fn advance(&mut self, dt_s: f64) {
        while let Some(&(due_s, set_point)) = self.in_flight.front() {
            if due_s > self.t_s {
                break;
            }
            self.in_force = set_point;
            self.in_flight.pop_front();
        }
        match self.in_force {
            SetPoint::Twist(target) => self.follow(target, dt_s),
            SetPoint::Arc {
                v_mps,
                curvature_per_m,
            } => self.steer(v_mps, curvature_per_m, dt_s),
        }
        let twist = self.twist();
        let (path_m, turn_rad) = (twist.v_mps * dt_s, twist.omega_radps * dt_s);
        self.pose = self.pose.along_arc(path_m, turn_rad);
        self.odometry = self
            .odometry
            .along_arc(path_m * self.scale[0], turn_rad * self.scale[1]);
        self.t_s += dt_s;
    }

    /// Speed and turn rate move together along the straight line to the target.
    fn follow(&mut self, target: Twist, dt_s: f64) {
        let dv = target.v_mps - self.drive.v_mps;
        let dw = target.omega_radps - self.drive.omega_radps;
        let needed_s =
            (dv.abs() / self.quality.acceleration_mps2).max(dw.abs() / self.quality.angular_radps2);
        let share = if needed_s > dt_s {
            dt_s / needed_s
        } else {
            1.0
        };
        self.drive = if share < 1.0 {
            Twist::new(
                self.drive.v_mps + dv * share,
                self.drive.omega_radps + dw * share,
            )
        } else {
            target
        };
    }

    /// The wheels turn at their own rate; the path follows the wheels.
    fn steer(&mut self, v_mps: f64, curvature_per_m: f64, dt_s: f64) {
        let reach = self.quality.steering_per_m_s * dt_s;
        self.curvature_per_m += (curvature_per_m - self.curvature_per_m).clamp(-reach, reach);
        let reach = self.quality.acceleration_mps2 * dt_s;
        let v = self.drive.v_mps + (v_mps - self.drive.v_mps).clamp(-reach, reach);
        self.drive = Twist::new(v, v * self.curvature_per_m);
    }
}
