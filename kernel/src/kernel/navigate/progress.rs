//! What the caller learns: driving, arrived, or blocked by what and since when.

use crate::guard::{BodyPoint, Refusal};
use crate::time::{Duration, Instant};

/// How far a route has come in this tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// There is no route: the navigator is a shield.
    Idle,
    /// The robot may not move: a stop is active or something is missing, see the decision's reason.
    Held,
    /// On the way to via point `next`; to the destination when that equals their number.
    Driving {
        /// Index of the next target.
        next: usize,
    },
    /// Position and heading are reached.
    Arrived,
    /// Braking or standing because nothing leads on; tried again in every tick.
    Blocked(Blocked),
}

/// What holds the robot up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blocked {
    /// Why.
    pub reason: Obstruction,
    /// The point that decided, if one did: body frame at this tick.
    pub point: Option<BodyPoint>,
    /// First tick of the ticks without motion that end with this one.
    pub since: Instant,
}

/// Why nothing leads on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstruction {
    /// The planner finds no motion that leads on and ends before a known point.
    NoWay,
    /// So near to the destination lies a known point that the robot cannot stand there.
    GoalOccupied,
    /// The guard refused everything that the planner proposed.
    Guard(Refusal),
    /// The robot moved for the whole time of [`ProgressRules`] without coming nearer. It stays
    /// where it is until it gets a route with another id.
    NoProgress,
}

/// When a robot that moves but comes no nearer gives up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgressRules {
    /// Coming nearer to the next target by less than this does not count, m.
    pub distance_m: f64,
    /// Moving for so long without coming nearer ends the route.
    pub time: Duration,
}

impl Default for ProgressRules {
    fn default() -> Self {
        Self {
            distance_m: 0.1,
            time: Duration::from_ms(20_000),
        }
    }
}

impl ProgressRules {
    pub(super) fn is_valid(&self) -> bool {
        self.distance_m.is_finite() && self.distance_m >= 0.0 && self.time > Duration::ZERO
    }
}

/// Keeps account of moving and standing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Watch {
    /// The target for which `nearest_m` holds.
    next: usize,
    /// Nearest so far, m; `None` before the first tick.
    nearest_m: Option<f64>,
    /// Time in motion since it last came nearer.
    moving: Duration,
    blocked_since: Option<Instant>,
}

impl Watch {
    /// Whether the robot has moved for too long without coming nearer to target `next`.
    pub fn has_given_up(&mut self, rules: &ProgressRules, next: usize, distance_m: f64) -> bool {
        if self.moving > rules.time {
            return true;
        }
        let nearer = self
            .nearest_m
            .is_none_or(|nearest| distance_m < nearest - rules.distance_m);
        if nearer || next != self.next {
            self.next = next;
            self.nearest_m = Some(distance_m);
            self.moving = Duration::ZERO;
        }
        false
    }

    /// A motion was accepted.
    pub fn moved(&mut self, elapsed: Duration) {
        self.moving = self.moving.plus(elapsed);
        self.blocked_since = None;
    }

    /// Neither moving nor blocked.
    pub const fn pause(&mut self) {
        self.blocked_since = None;
    }

    /// Nothing leads on at `now`; returns since when.
    pub fn blocked(&mut self, now: Instant) -> Instant {
        *self.blocked_since.get_or_insert(now)
    }
}

/// A point of the planner as the caller gets it.
pub(super) fn body_point([x, y]: crate::dwa::Point) -> Option<BodyPoint> {
    let mm = |metres: f64| {
        let um = crate::convert::length(metres, crate::convert::Round::Nearest)?.as_um();
        i16::try_from(um.div_euclid(1000)).ok()
    };
    Some(BodyPoint {
        x_mm: mm(x)?,
        y_mm: mm(y)?,
    })
}
