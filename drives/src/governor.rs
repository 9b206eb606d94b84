//! What may be on the wire now: the decision in force, or a ramp that ends it.
//!
//! One for all adapters, so that none can forget it: an expired decision becomes a ramp on the
//! same curvature, an interruption a zero, and motion comes back only after a decision has asked
//! for rest.

use haltline::decision::Decision;
use haltline::input::{Motion, Twist};
use haltline::time::{Duration, Instant};
use haltline::units::{Acceleration, AngularAcceleration, AngularSpeed, Curvature, Speed};

/// How hard ramps brake: the robot's sure decelerations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Braking {
    /// Along the path.
    pub linear: Acceleration,
    /// Turning.
    pub angular: AngularAcceleration,
}

/// A motion as numbers that scale together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setpoint {
    /// µm/s, forward positive.
    pub linear: i32,
    /// µrad/s of a twist, 10⁻⁶/m of an arc.
    pub turn: i32,
    /// Whether `turn` is a curvature, which a ramp leaves alone.
    pub is_arc: bool,
}

impl Setpoint {
    /// Standing still, wheels straight.
    #[must_use]
    pub const fn rest(is_arc: bool) -> Self {
        Self {
            linear: 0,
            turn: 0,
            is_arc,
        }
    }

    /// From the kernel's motion.
    #[must_use]
    pub const fn new(motion: Motion) -> Self {
        match motion {
            Motion::Twist(twist) => Self {
                linear: twist.linear.as_um_per_s(),
                turn: twist.angular.as_urad_per_s(),
                is_arc: false,
            },
            Motion::Arc { linear, curvature } => Self {
                linear: linear.as_um_per_s(),
                turn: curvature.as_urad_per_m(),
                is_arc: true,
            },
        }
    }

    /// As the kernel's motion.
    #[must_use]
    pub const fn motion(self) -> Motion {
        if self.is_arc {
            Motion::Arc {
                linear: Speed::from_um_per_s(self.linear),
                curvature: Curvature::from_urad_per_m(self.turn),
            }
        } else {
            Motion::Twist(Twist {
                linear: Speed::from_um_per_s(self.linear),
                angular: AngularSpeed::from_urad_per_s(self.turn),
            })
        }
    }

    /// Whether nothing moves.
    #[must_use]
    pub const fn is_rest(self) -> bool {
        self.linear == 0 && (self.is_arc || self.turn == 0)
    }

    /// The same curve, braked for `span`: speed and turn rate keep their ratio, and reach zero
    /// together when the slower of the two has.
    #[must_use]
    pub fn braked(self, braking: Braking, span: Duration) -> Self {
        let span = i64::try_from(span.as_us()).unwrap_or(i64::MAX);
        let time = |value: i32, rate: u32| {
            i64::from(value.unsigned_abs()).saturating_mul(1_000_000) / i64::from(rate.max(1))
        };
        let turning = if self.is_arc { 0 } else { self.turn };
        let left = time(self.linear, braking.linear.as_um_per_s2())
            .max(time(turning, braking.angular.as_urad_per_s2()));
        if span >= left {
            return Self {
                linear: 0,
                turn: if self.is_arc { self.turn } else { 0 },
                ..self
            };
        }
        let scaled = |value: i32| {
            let wide = i128::from(value) * i128::from(left - span) / i128::from(left);
            i32::try_from(wide).unwrap_or_default()
        };
        Self {
            linear: scaled(self.linear),
            turn: if self.is_arc {
                self.turn
            } else {
                scaled(self.turn)
            },
            ..self
        }
    }
}

/// Longest time a decision stays in force, whatever it says itself.
const DECISION_MAX: Duration = Duration::from_ms(500);

/// Watches over what is on the wire.
#[derive(Clone, Copy, Debug)]
pub struct Governor {
    braking: Braking,
    /// On the wire now.
    wire: Setpoint,
    /// When `wire` was last changed or confirmed.
    since: Instant,
    /// Until when `wire` may stay; `None` while nothing is in force.
    expires: Option<Instant>,
    /// Motion is withheld until a decision asks for rest.
    holding: bool,
}

impl Governor {
    /// Holding at rest.
    #[must_use]
    pub const fn new(braking: Braking, is_arc: bool) -> Self {
        Self {
            braking,
            wire: Setpoint::rest(is_arc),
            since: Instant::from_us(0),
            expires: None,
            holding: true,
        }
    }

    /// What is on the wire.
    #[must_use]
    pub const fn wire(&self) -> Setpoint {
        self.wire
    }

    /// Whether motion is withheld.
    #[must_use]
    pub const fn is_holding(&self) -> bool {
        self.holding
    }

    /// Takes a decision; the answer goes on the wire.
    ///
    /// - `may_release`: zero really is on the wire and the drive is ready
    pub fn decide(&mut self, decision: &Decision, now: Instant, may_release: bool) -> Setpoint {
        let wanted = Setpoint::new(decision.setpoint);
        if now < self.since {
            return self.interrupt(now);
        }
        if now > decision.expires {
            return self.withhold(now);
        }
        if self.holding {
            //= spec/drive.md#drive-03
            //# After an interruption an adapter MUST withhold motion until a decision asks for rest.
            let released = may_release && self.wire.is_rest() && wanted.is_rest();
            if !released {
                return self.withhold(now);
            }
            self.holding = false;
        }
        self.wire = wanted;
        self.since = now;
        self.expires = Some(decision.expires.min(now.plus(DECISION_MAX)));
        wanted
    }

    /// Lets time pass; a new set point if the decision in force has expired or a ramp goes on.
    ///
    /// A clock that ran backwards would keep a decision in force until it has caught up: zero at once.
    pub fn tick(&mut self, now: Instant) -> Option<Setpoint> {
        if now < self.since {
            return Some(self.interrupt(now));
        }
        let overdue = self.expires.is_some_and(|expires| now > expires);
        let ramping = self.holding && !self.wire.is_rest();
        if !overdue && !ramping {
            return None;
        }
        let before = self.wire;
        let wire = self.withhold(now);
        (wire != before).then_some(wire)
    }

    /// Starts or continues the ramp to rest; nothing but a decision for rest ends it.
    pub fn withhold(&mut self, now: Instant) -> Setpoint {
        // What was in force ran until it expired, no longer: the ramp starts there.
        //= spec/drive.md#drive-05
        //# When no decision is in force, an adapter MUST ramp the last set point down to zero on its curvature, at no less than the sure decelerations.
        let ended = self.expires.filter(|expires| *expires < now);
        let from = if self.holding {
            self.since
        } else {
            ended.unwrap_or(now)
        };
        let span = now.since(from).unwrap_or_default();
        self.holding = true;
        self.expires = None;
        self.since = now;
        self.wire = self.wire.braked(self.braking, span);
        self.wire
    }

    /// After a gap, a reconnection or a reboot: zero, at once.
    pub fn interrupt(&mut self, now: Instant) -> Setpoint {
        self.holding = true;
        self.expires = None;
        self.since = now;
        self.wire.linear = 0;
        if !self.wire.is_arc {
            self.wire.turn = 0;
        }
        self.wire
    }
}
