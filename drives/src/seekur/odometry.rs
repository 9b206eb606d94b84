//! Pose and twist from SIPs, with the skid taken out.

use haltline::time::{Duration, Instant};

use super::wire::{DIFF_CONV, Seekur};
use crate::arcos::Sip;
use crate::arcos::sip::{RADIANS_PER_COUNT, Unwrap};
use crate::drive::Feedback;

/// A robot that drives or turns this many times faster than it can was not measured.
const TOO_FAST: f64 = 1.5;
/// Two SIPs may arrive together although they were sent one cycle (at most 255 ms) apart.
const JOINED_S: f64 = 0.3;

/// Integrates what the robot reports along a heading that is corrected for skid.
#[derive(Clone, Copy, Debug)]
pub(super) struct WheelOdometry {
    skid: f64,
    speed_max_mps: f64,
    turn_max_radps: f64,
    stamp: Option<Instant>,
    x: Unwrap,
    y: Unwrap,
    heading: Option<i16>,
    pose: [f64; 3],
    twist: [f64; 2],
}

impl WheelOdometry {
    pub(super) fn new(config: &Seekur) -> Self {
        Self {
            skid: config.skid.clamp(0.05, 1.0),
            speed_max_mps: f64::from(config.speed_max_mmps) * 1e-3,
            turn_max_radps: f64::from(config.turn_max_degps).to_radians(),
            stamp: None,
            x: Unwrap::default(),
            y: Unwrap::default(),
            heading: None,
            pose: [0.0; 3],
            twist: [0.0; 2],
        }
    }

    /// The robot's counters start again; the pose goes on from where it was.
    pub(super) fn restart(&mut self) {
        (self.x, self.y, self.heading) = (Unwrap::default(), Unwrap::default(), None);
        self.stamp = None;
        self.twist = [0.0; 2];
    }

    /// Newest speed and turn rate, m/s and rad/s.
    pub(super) const fn twist(&self) -> [f64; 2] {
        self.twist
    }

    /// Takes a SIP measured at `stamp`; `None` if the robot cannot have moved so.
    pub(super) fn take(&mut self, sip: &Sip, stamp: Instant) -> Option<Feedback> {
        let step = [self.x.step(sip.x), self.y.step(sip.y)].map(|mm| f64::from(mm) * 1e-3);
        let before = self.heading.replace(sip.heading).unwrap_or(sip.heading);
        // Counts of 2π/4096: whole turns fall out.
        let turned = sip.heading.wrapping_sub(before).rem_euclid(4096);
        let turned = if turned > 2048 { turned - 4096 } else { turned };
        let turned = f64::from(turned) * RADIANS_PER_COUNT;
        let gap = self.stamp.replace(stamp).and_then(|last| stamp.since(last));
        if !self.is_possible(sip, step, turned, gap.unwrap_or_default()) {
            return None;
        }
        let middle = f64::from(before) * RADIANS_PER_COUNT + turned / 2.0;
        // The reported step, seen from the reported heading, driven along ours.
        let ahead = step[0] * libm::cos(middle) + step[1] * libm::sin(middle);
        let aside = step[1] * libm::cos(middle) - step[0] * libm::sin(middle);
        let along = self.pose[2] + self.skid * turned / 2.0;
        let (sin, cos) = (libm::sin(along), libm::cos(along));
        self.pose[0] += ahead * cos - aside * sin;
        self.pose[1] += ahead * sin + aside * cos;
        self.pose[2] = wrapped(self.pose[2] + self.skid * turned);
        self.twist = self.measured(sip);
        Some(Feedback {
            stamp,
            pose: self.pose,
            twist: self.twist,
            battery_v: Some(volts(sip)),
            charge_percent: sip.tail.charge_percent.and_then(|percent| {
                // 0 means that it is not told.
                u8::try_from(percent).ok().filter(|percent| *percent > 0)
            }),
            bumpers: [sip.bumpers.front(), sip.bumpers.rear()],
        })
    }

    /// Whether this robot can have moved by `step` (m) and `turned` (rad) in `gap`, and move as it says.
    fn is_possible(&self, sip: &Sip, step: [f64; 2], turned: f64, gap: Duration) -> bool {
        let span_s = gap.as_us() as f64 * 1e-6 + JOINED_S;
        let path_m = libm::hypot(step[0], step[1]);
        let [v, w] = self.measured(sip);
        path_m <= TOO_FAST * self.speed_max_mps * span_s
            && turned.abs() <= TOO_FAST * self.turn_max_radps * span_s
            && v.abs() <= TOO_FAST * self.speed_max_mps
            && (w / self.skid).abs() <= TOO_FAST * self.turn_max_radps
    }

    fn measured(&self, sip: &Sip) -> [f64; 2] {
        let (left, right) = (f64::from(sip.left), f64::from(sip.right));
        let wheels = match sip.tail.rotation_decidegps {
            //= spec/drive.md#drive-07
            //# Speed and turn MUST keep their signs, and zero stay zero, from the decision to the motion and from the motion to the feedback.
            Some(rate) => (f64::from(rate) * 0.1).to_radians(),
            None => (right - left) / 2.0 * DIFF_CONV,
        };
        [f64::midpoint(left, right) * 1e-3, wheels * self.skid]
    }
}

fn volts(sip: &Sip) -> f64 {
    let byte = u16::from(sip.battery_decivolts);
    f64::from(sip.tail.battery_decivolts.unwrap_or(byte)) * 0.1
}

fn wrapped(angle: f64) -> f64 {
    use core::f64::consts::{PI, TAU};
    if angle > PI {
        angle - TAU
    } else if angle <= -PI {
        angle + TAU
    } else {
        angle
    }
}
