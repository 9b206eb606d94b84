//! LIMIT: set points are finite, inside the limits, and change no faster than allowed.

use haltline::decision::Action;
use haltline_robots::{Kinematics, Robot};

use super::{Ledger, Tick};
use crate::drive::SetPoint;

/// Rounding of the kernel's integers, m/s and rad/s.
const ROUNDING: f64 = 5e-6;

pub(super) struct Limit {
    pub(super) ledger: Ledger,
    before: Option<(u64, SetPoint)>,
    /// Whether the newest command, or the kernel at its destination, asks for standstill: braking, which
    /// no window limits.
    rest_wanted: bool,
}

impl Limit {
    pub(super) fn new() -> Self {
        Self {
            ledger: Ledger::new("LIMIT"),
            before: None,
            rest_wanted: false,
        }
    }

    pub(super) fn tick(&mut self, robot: &Robot, tick: &Tick<'_>) {
        let set_point = tick.decision.set_point;
        if let Some(command) = tick.inputs.command {
            let motion = command.motion;
            self.rest_wanted = motion.speed() == 0.0 && motion.turn_rate() == 0.0;
        }
        if tick.inputs.order_us.is_some() {
            self.rest_wanted = tick.decision.wants_rest;
        }
        self.ledger.judged(tick.decision.moves());
        if tick.decision.moves() {
            self.ledger.near(room(robot, set_point));
        }
        for what in outside(robot, set_point) {
            self.ledger.violated(tick.t_s, what);
        }
        if tick.decision.action < Action::Brake
            && let Some(what) = self.jumped(robot, tick.now_us, set_point)
        {
            self.ledger.violated(tick.t_s, what);
        }
        self.before = Some((tick.now_us, set_point));
    }

    /// LIMIT-04: the step from the set point before.
    fn jumped(&self, robot: &Robot, now_us: u64, set_point: SetPoint) -> Option<String> {
        let (then_us, before) = self.before?;
        let dt_s = now_us.saturating_sub(then_us) as f64 * 1e-6;
        let limits = &robot.values.limits;
        let allowed = |from: f64, to: f64, up: f64, down: f64| {
            let slows = to.abs() <= from.abs();
            let rate = if slows { up.max(down) } else { up };
            (slows && self.rest_wanted) || (to - from).abs() <= rate * dt_s + ROUNDING
        };
        let (up, down) = (limits.acceleration_mps2, limits.braking_mps2);
        if !allowed(before.speed(), set_point.speed(), up, down) {
            return Some(format!(
                "speed set point went from {:.4} to {:.4} m/s in {dt_s:.3} s",
                before.speed(),
                set_point.speed()
            ));
        }
        let SetPoint::Twist { omega, .. } = set_point else {
            return None;
        };
        let (up, down) = (
            limits.angular_acceleration_radps2,
            limits.angular_braking_radps2,
        );
        (!allowed(before.turn_rate(), omega, up, down)).then(|| {
            format!(
                "turn rate set point went from {:.4} to {omega:.4} rad/s in {dt_s:.3} s",
                before.turn_rate()
            )
        })
    }
}

/// How far a set point is inside the limits of the directions in which it moves, m/s or rad/s.
fn room(robot: &Robot, set_point: SetPoint) -> f64 {
    let limits = &robot.values.limits;
    let v = set_point.speed();
    let linear = match v {
        v if v > 0.0 => limits.speed_forward_mps - v,
        v if v < 0.0 => v + limits.speed_reverse_mps,
        _ => f64::INFINITY,
    };
    match set_point {
        SetPoint::Twist { omega, .. } if omega != 0.0 => {
            linear.min(limits.angular_speed_radps - omega.abs())
        }
        _ => linear,
    }
}

/// LIMIT-01, -02, -03, -05: what of a set point lies outside.
fn outside(robot: &Robot, set_point: SetPoint) -> Vec<String> {
    let limits = &robot.values.limits;
    let mut found = Vec::new();
    if !set_point.is_finite() {
        found.push("the set point is not finite".to_owned());
    }
    let v = set_point.speed();
    if v > limits.speed_forward_mps + ROUNDING || v < -limits.speed_reverse_mps - ROUNDING {
        found.push(format!(
            "speed set point {v:.4} m/s lies outside -{} to {}",
            limits.speed_reverse_mps, limits.speed_forward_mps
        ));
    }
    match (set_point, robot.values.kinematics) {
        (SetPoint::Twist { omega, .. }, _)
            if omega.abs() > limits.angular_speed_radps + ROUNDING =>
        {
            found.push(format!("turn rate set point {omega:.4} rad/s is too fast"));
        }
        (SetPoint::Arc { curvature, .. }, Kinematics::Ackermann(steering))
            if curvature.abs() > 1.0 / steering.turning_radius_m + ROUNDING =>
        {
            found.push(format!(
                "curvature set point {curvature:.4} 1/m is too tight"
            ));
        }
        _ => {}
    }
    found
}
