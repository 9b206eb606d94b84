//! Odometry: wheels integrated with a constant relative error and a little noise on the twist.

use haltline_robots::{Kinematics, Robot};

use crate::file::Scenario;
use crate::math::{Pose, microseconds};
use crate::noise::Noise;

/// A sample as the driver delivers it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawOdometry {
    /// Stamp that the host sees, microseconds.
    pub stamp_us: u64,
    /// Pose in the odometry frame: m, m, rad.
    pub pose: [f64; 3],
    /// Measured twist: m/s, rad/s.
    pub twist: [f64; 2],
    /// Measured path curvature, 1/m, where the wheels are steered.
    pub curvature_per_m: Option<f64>,
}

/// Part of the robot's speed tolerance used up by noise; the rest is left to real drives.
const TWIST_NOISE: f64 = 0.3;

/// The odometry of one run.
#[derive(Clone, Debug)]
pub struct Odometer {
    pose: Pose,
    twist: [f64; 2],
    curvature: Option<f64>,
    /// Relative errors of distance and angle.
    pub error: [f64; 2],
    noise_bound: [f64; 2],
    interval_us: u64,
    delay_us: u64,
    next_us: u64,
    noise: Noise,
}

impl Odometer {
    /// An odometer at its origin.
    #[must_use]
    pub fn new(robot: &Robot, scenario: &Scenario, mut noise: Noise) -> Self {
        let tolerances = &robot.values.tolerances;
        let model = &scenario.odometry;
        let drawn = [
            tolerances.odometry_m_per_m * noise.symmetric(),
            tolerances.odometry_rad_per_rad * noise.symmetric(),
        ];
        let error = [
            model.error_m_per_m.map_or(drawn[0], |v| v.get()),
            model.error_rad_per_rad.map_or(drawn[1], |v| v.get()),
        ];
        let interval_s = model
            .rate_hz
            .map_or(robot.values.timing.period_s, |rate| 1.0 / rate.get());
        let steered = matches!(robot.values.kinematics, Kinematics::Ackermann(_));
        Self {
            pose: Pose::default(),
            twist: [0.0; 2],
            curvature: steered.then_some(0.0),
            error,
            noise_bound: [
                tolerances.speed_mps * TWIST_NOISE,
                tolerances.angular_speed_radps * TWIST_NOISE,
            ],
            interval_us: microseconds(interval_s).max(1),
            delay_us: microseconds(model.delay_s.get()),
            next_us: 0,
            noise,
        }
    }

    /// Integrates what the wheels did during a step and what they do at its end.
    pub fn advance(&mut self, mean: [f64; 2], now: [f64; 2], curvature: f64, dt_s: f64) {
        let seen = |twist: [f64; 2]| {
            [
                twist[0] * (1.0 + self.error[0]),
                twist[1] * (1.0 + self.error[1]),
            ]
        };
        let [v, omega] = seen(mean);
        self.twist = seen(now);
        self.pose = self.pose.advance(v, omega, dt_s);
        self.curvature = self.curvature.map(|_| curvature);
    }

    /// Takes in a displacement in the robot's frame that the wheels know nothing of. It shows in the pose all the same: what
    /// odometry never sees of a skid is drift, not A-TRACKING.
    pub fn slide(&mut self, slid: Pose) {
        self.pose = self.pose.then(slid);
    }

    /// The sample that is due at `now_us`, with its arrival time.
    pub fn sample(&mut self, now_us: u64) -> Option<(u64, RawOdometry)> {
        if now_us < self.next_us {
            return None;
        }
        self.next_us += self.interval_us;
        let mut twist = self.twist;
        for (value, bound) in twist.iter_mut().zip(self.noise_bound) {
            // Encoders of a standing wheel count nothing.
            let error = bound * self.noise.symmetric();
            if value.abs() > bound {
                *value += error;
            }
        }
        let sample = RawOdometry {
            stamp_us: now_us,
            pose: [self.pose.x, self.pose.y, self.pose.theta],
            twist,
            curvature_per_m: self.curvature,
        };
        Some((now_us + self.delay_us, sample))
    }
}
