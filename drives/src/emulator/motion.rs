//! Where a body is that was driven with these speeds.

use haltline::time::Instant;

/// Longest dynamics step, µs.
pub(super) const STEP_US: u64 = 1000;

/// The true state of an emulated robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Truth {
    /// Pose of the rotation centre in the world, metres and radians (not wrapped).
    pub pose: [f64; 3],
    /// Speed and turn rate over the ground, m/s and rad/s.
    pub twist: [f64; 2],
}

impl Truth {
    /// Moves on by `dt_s` at the mean of the present twist and `next`.
    pub(super) fn advance(&mut self, next: [f64; 2], dt_s: f64) {
        let v = f64::midpoint(self.twist[0], next[0]);
        let w = f64::midpoint(self.twist[1], next[1]);
        let along = self.pose[2] + w * dt_s / 2.0;
        self.pose[0] += v * dt_s * along.cos();
        self.pose[1] += v * dt_s * along.sin();
        self.pose[2] += w * dt_s;
        self.twist = next;
    }
}

/// A value brought towards a target at limited rates, faster towards zero where `down` is larger.
pub(super) fn ramp(value: f64, target: f64, up: f64, down: f64, dt_s: f64) -> f64 {
    let change = target - value;
    let rate = if value * change < 0.0 { down } else { up };
    value + change.clamp(-rate * dt_s, rate * dt_s)
}

/// Splits the time since `last` into dynamics steps of at most [`STEP_US`].
///
/// A host that pauses an emulator for longer than a second skips the rest.
pub(super) fn steps(last: &mut Instant, now: Instant) -> Vec<(Instant, f64)> {
    let mut steps = Vec::new();
    let gap = now.since(*last).unwrap_or_default().as_us();
    if gap > 1_000_000 {
        *last = now.minus(haltline::time::Duration::from_us(1_000_000));
    }
    while *last < now {
        let left = now.since(*last).unwrap_or_default().as_us();
        let step = haltline::time::Duration::from_us(left.min(STEP_US));
        *last = last.plus(step);
        steps.push((*last, step.as_us() as f64 * 1e-6));
    }
    steps
}
