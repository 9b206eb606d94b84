//! Speed from wheel pulses, turn rate from the gyro, pose from both.

use haltline::time::{Duration, Instant};

use super::{GYRO_GROUP, WHEEL_GROUP};
use crate::drive::Feedback;
use crate::uc::daq::{Encoding, Group, Type, Values};

/// Path of the rear-left wheel for each pulse, metres: radius 0.032 m, 8 pulses a turn.
pub const METRES_PER_PULSE: f64 = core::f64::consts::TAU * 0.032 / 8.0;
/// Without a pulse for this long the car stands (MoveIT 2017).
const STANDS_AFTER: Duration = Duration::from_ms(300);
/// rad/s of one count of the gyro at its default range of 500 deg/s.
pub const RADPS_PER_COUNT: f64 = 1.0 / 65.5 * core::f64::consts::PI / 180.0;
/// Samples at rest that make the gyro's zero: one second.
const ZERO_SAMPLES: u32 = 100;

const WHEEL_TYPES: [Type; 2] = [Type::U8, Type::U16];
const GYRO_TYPES: [Type; 1] = [Type::I16];

/// How a group of ours is read.
pub(super) fn group(number: u8) -> Option<Group<'static>> {
    let types: &'static [Type] = match number {
        WHEEL_GROUP => &WHEEL_TYPES,
        GYRO_GROUP => &GYRO_TYPES,
        _ => return None,
    };
    Some(Group {
        types,
        encoding: Encoding::Hex,
        crc: true,
    })
}

/// Dead reckoning of the rear axle's middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct CarOdometry {
    track_m: f64,
    /// Wheel speed of the last pulse, m/s, without sign.
    pulse_mps: f64,
    pulsed: Option<Instant>,
    direction: f64,
    /// Counter of the last message.
    counted: Option<i64>,
    /// Path that the pulses tell and that is not in the pose yet, metres.
    owed_m: f64,
    zero_sum: f64,
    zero_count: u32,
    pose: [f64; 3],
    twist: [f64; 2],
    stamp: Option<Instant>,
}

impl CarOdometry {
    pub(super) const fn new(track_m: f64) -> Self {
        Self {
            track_m,
            pulse_mps: 0.0,
            pulsed: None,
            direction: 1.0,
            counted: None,
            owed_m: 0.0,
            zero_sum: 0.0,
            zero_count: 0,
            pose: [0.0; 3],
            twist: [0.0; 2],
            stamp: None,
        }
    }

    /// The stream starts again; the pose goes on from where it was, the zero of the gyro stays.
    pub(super) const fn restart(&mut self) {
        (self.pulsed, self.stamp, self.pulse_mps) = (None, None, 0.0);
        (self.counted, self.owed_m) = (None, 0.0);
    }

    /// Whether the gyro's zero is known.
    pub(super) const fn is_calibrated(&self) -> bool {
        self.zero_count >= ZERO_SAMPLES
    }

    /// Speed, m/s, with the sign of the last thrust.
    pub(super) const fn speed(&self) -> f64 {
        self.twist[0]
    }

    /// Takes the values of one of our groups; feedback with every turn rate.
    pub(super) fn take(
        &mut self,
        number: u8,
        values: &Values,
        direction: f64,
        may_calibrate: bool,
        now: Instant,
    ) -> Option<Feedback> {
        self.direction = direction;
        if number == WHEEL_GROUP {
            self.count(values.first().copied().flatten());
            let tenths_ms = values.get(1).copied().flatten()?;
            if tenths_ms > 0 {
                self.pulse_mps = METRES_PER_PULSE / (tenths_ms as f64 * 1e-4);
                self.pulsed = Some(now);
            }
            return None;
        }
        let rate = values.first().copied().flatten()? as f64 * RADPS_PER_COUNT;
        self.turned(rate, may_calibrate, now)
    }

    /// The highest five counts look like errors; the next pulse makes up for them.
    fn count(&mut self, pulses: Option<i64>) {
        let Some(pulses) = pulses else { return };
        let before = self.counted.replace(pulses).unwrap_or(pulses - 1);
        self.owed_m += (pulses - before).rem_euclid(256) as f64 * METRES_PER_PULSE;
    }

    fn turned(&mut self, rate: f64, may_calibrate: bool, now: Instant) -> Option<Feedback> {
        if may_calibrate && self.pulsed.is_none() && !self.is_calibrated() {
            self.zero_sum += rate;
            self.zero_count = self.zero_count.saturating_add(1);
        }
        let zero = self.zero_sum / f64::from(self.zero_count.max(1));
        let mut omega = rate - zero;
        let wheel = self.wheel_speed(now);
        let mut v = wheel * self.direction;
        if wheel > 0.0 {
            // The sensor sits on the left wheel, which a left turn slows down.
            v += omega * self.track_m / 2.0;
        } else {
            // A steered car that stands does not turn; what is left is noise.
            omega = 0.0;
        }
        let dt = self
            .stamp
            .and_then(|last| now.since(last))
            .unwrap_or_default();
        self.stamp = Some(now);
        // Across an interruption nothing is integrated that was not measured.
        let dt = (dt.as_us().min(100_000)) as f64 * 1e-6;
        let mean = [
            f64::midpoint(self.twist[0], v),
            f64::midpoint(self.twist[1], omega),
        ];
        let along = self.pose[2] + mean[1] * dt / 2.0;
        // What the pulses told and the speeds did not goes in by at most 1 mm at a time.
        self.owed_m -= wheel * dt;
        let late = (self.owed_m * 0.1).clamp(-1e-3, 1e-3);
        self.owed_m -= late;
        let step = mean[0] * dt + late * self.direction;
        self.pose[0] += step * libm::cos(along);
        self.pose[1] += step * libm::sin(along);
        self.pose[2] = libm::remainder(self.pose[2] + mean[1] * dt, core::f64::consts::TAU);
        self.twist = [v, omega];
        Some(Feedback {
            stamp: now,
            pose: self.pose,
            twist: self.twist,
            ..Feedback::default()
        })
    }

    /// The last pulse's speed, or less: a pulse that has not come yet bounds it.
    fn wheel_speed(&self, now: Instant) -> f64 {
        let Some(gap) = self.pulsed.and_then(|pulsed| now.since(pulsed)) else {
            return 0.0;
        };
        if gap > STANDS_AFTER {
            return 0.0;
        }
        let bound = METRES_PER_PULSE / (gap.as_us().max(1) as f64 * 1e-6);
        self.pulse_mps.min(bound)
    }
}
