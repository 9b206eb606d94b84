//! Radial sampling: the curvatures through a dynamic window, and the speeds on each (Loh, Fig. 4.4).

use super::arc::{Course, Direction, STRAIGHT_PER_M, Track, Turn};
use super::footprint::Footprint;
use super::margin::worst_stop;
use super::types::{Situation, Velocity};
use super::window::{DynamicWindow, Interval};

/// Curvatures sampled in each plan.
pub const CURVATURES: usize = 61;
/// Speeds sampled on each curvature, and turn rates on the spot in each direction.
pub const SPEEDS: usize = 11;
/// Curvatures and the two turns on the spot.
pub const LANES: usize = 63;
/// Curvatures spread evenly; the others are straight on, the goal's arc and the present one.
const SPREAD: u16 = 58;
/// The lane of the present curvature.
pub(super) const PRESENT: usize = 2;
/// Part of the largest speed that the most curved sample must still allow.
const SLOWEST_PART: f64 = 0.125;
/// How many periods before the last moment slowing down begins.
const EASE_PERIODS: f64 = 5.0;
/// How many gentle stops ahead slowing down begins to matter.
const AHEAD_FACTOR: f64 = 1.5;

/// One sampled path and what may be driven on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lane {
    pub course: Course,
    pub track: Track,
    /// Speeds in m/s, turn rates as magnitudes in rad/s on the spot; may be empty.
    pub rates: Interval,
    /// The outline with the margin of the fastest rate.
    pub rect: Footprint,
    /// The margin where the robot is now, m.
    pub start_m: f64,
    /// Longest travel to rest and a little more: what stopping in time must look at.
    pub horizon: f64,
    /// Travel beyond which a contact does not matter to slowing down gently.
    pub horizon_ahead: f64,
}

impl Default for Lane {
    fn default() -> Self {
        Self {
            course: Course::Spot(Turn::Left),
            track: Track::Line { sense: 1.0 },
            rates: Interval {
                low: 1.0,
                high: 0.0,
            },
            rect: Footprint::default(),
            start_m: 0.0,
            horizon: 0.0,
            horizon_ahead: 0.0,
        }
    }
}

impl Lane {
    /// The command that drives this lane at `rate`, kept within `window` against rounding.
    pub fn velocity(&self, rate: f64, window: &DynamicWindow) -> Velocity {
        match self.course {
            Course::Arc {
                curvature_per_m, ..
            } => Velocity {
                linear_mps: window.linear.clamp(rate),
                angular_radps: window.angular.clamp(curvature_per_m * rate),
            },
            Course::Spot(turn) => Velocity {
                linear_mps: 0.0,
                angular_radps: if turn == Turn::Left { rate } else { -rate },
            },
        }
    }

    /// Whether this is the straight lane, and the window allows it.
    pub fn is_straight(&self) -> bool {
        matches!(self.track, Track::Line { .. }) && self.rates.is_some()
    }

    /// The motion of this lane at unit rate.
    pub fn direction(&self) -> Velocity {
        match self.course {
            Course::Arc {
                curvature_per_m, ..
            } => Velocity {
                linear_mps: 1.0,
                angular_radps: curvature_per_m,
            },
            Course::Spot(turn) => Velocity {
                linear_mps: 0.0,
                angular_radps: if turn == Turn::Left { 1.0 } else { -1.0 },
            },
        }
    }

    /// The curvature, 1/m; `None` on the spot.
    pub fn curvature_per_m(&self) -> Option<f64> {
        match self.course {
            Course::Arc {
                curvature_per_m, ..
            } => Some(curvature_per_m),
            Course::Spot(_) => None,
        }
    }
}

/// The turn rates that bound `window`: those of a steered drive follow from its curvature.
fn turning_bounds(situation: &Situation<'_>, window: &mut DynamicWindow) {
    if let Some(most) = situation.limits.curvature_max_per_m {
        let high = most * situation.limits.speed_mps;
        window.angular = Interval { low: -high, high };
    }
}

/// All lanes through the window, curvatures first, then the turns on the spot; and the window.
pub(super) fn lanes(situation: &Situation<'_>) -> Option<(DynamicWindow, [Lane; LANES])> {
    let mut window = DynamicWindow::new(&situation.limits, situation.velocity)?;
    turning_bounds(situation, &mut window);
    let curvatures = curvatures(situation, &window);
    let mut lanes = [Lane::default(); LANES];
    for (lane, curvature) in lanes.iter_mut().zip(curvatures) {
        *lane = driving(situation, &window, curvature);
    }
    if situation.limits.curvature_max_per_m.is_none() && window.linear.low <= 0.0 {
        for (lane, turn) in lanes
            .iter_mut()
            .skip(CURVATURES)
            .zip([Turn::Left, Turn::Right])
        {
            *lane = turning(situation, &window, turn);
        }
    }
    Some((window, lanes))
}

/// The curvature through (`linear`, `angular`) extremes, evenly spread in slope, plus three.
fn curvatures(situation: &Situation<'_>, window: &DynamicWindow) -> [f64; CURVATURES] {
    let fast = window.linear.high.max(1e-6);
    let slow = window.linear.low.max(SLOWEST_PART * fast);
    let (left, right) = (window.angular.high, window.angular.low);
    let bound = situation
        .limits
        .curvature_max_per_m
        .unwrap_or(f64::INFINITY);
    let range = Interval {
        low: (right / if right < 0.0 { slow } else { fast }).max(-bound),
        high: (left / if left > 0.0 { slow } else { fast }).min(bound),
    };
    // Evenly spread as directions in the plane of v and ω·lever.
    let lever = situation.footprint.corner_m();
    let slope = |curvature: f64| libm::atan(curvature * lever);
    let (first, last) = (slope(range.low), slope(range.high));
    let [goal_x, goal_y] = situation.goal.position;
    let goal_arc = 2.0 * goal_y / (goal_x * goal_x + goal_y * goal_y).max(1e-6);
    let now = situation.velocity;
    let present = now.angular_radps / now.linear_mps.max(1e-6);
    let mut out = [0.0; CURVATURES];
    let spread = (0..SPREAD).map(|index| {
        let part = f64::from(index) / f64::from(SPREAD - 1);
        bent(range.clamp(libm::tan(first + (last - first) * part) / lever))
    });
    let extra = [bent(range.clamp(goal_arc)), bent(range.clamp(present))];
    // The first stays straight, whether or not the window allows it.
    for (slot, value) in out.iter_mut().skip(1).zip(extra.into_iter().chain(spread)) {
        *slot = value;
    }
    out
}

/// Keeps a curvature off zero: only the first lane is straight.
fn bent(curvature: f64) -> f64 {
    if curvature.abs() < 2.0 * STRAIGHT_PER_M {
        2.0 * STRAIGHT_PER_M
    } else {
        curvature
    }
}

fn driving(situation: &Situation<'_>, window: &DynamicWindow, curvature_per_m: f64) -> Lane {
    let course = Course::Arc {
        curvature_per_m,
        direction: Direction::Forward,
    };
    let (one, other) = (
        window.angular.low / curvature_per_m,
        window.angular.high / curvature_per_m,
    );
    let turn_allows = if curvature_per_m.abs() < STRAIGHT_PER_M {
        if window.angular.contains(0.0) {
            window.linear
        } else {
            return Lane::default();
        }
    } else {
        Interval {
            low: one.min(other),
            high: one.max(other),
        }
    };
    let mut rates = window.linear.intersection(turn_allows);
    // The outermost curvatures meet the window in one point, which rounding may miss.
    if rates.low - rates.high < 1e-9 * window.linear.high {
        rates.high = rates.high.max(rates.low);
    }
    let Some(track) = Track::of(course).filter(|_| rates.is_some()) else {
        return Lane::default();
    };
    let fastest = Velocity {
        linear_mps: rates.high,
        angular_radps: rates.high * curvature_per_m,
    };
    let inflation = situation.margin.driving(situation, fastest);
    let stop = worst_stop(situation, fastest).travel;
    let horizon = stop + EASE_PERIODS * rates.high * situation.limits.period_s;
    Lane {
        course,
        track,
        rates,
        rect: situation.footprint.inflated(inflation.end_m),
        start_m: inflation.start_m,
        horizon,
        horizon_ahead: (stop * AHEAD_FACTOR / situation.tuning.comfort)
            .max(situation.lookahead_m()),
    }
}

fn turning(situation: &Situation<'_>, window: &DynamicWindow, turn: Turn) -> Lane {
    let course = Course::Spot(turn);
    let rates = if turn == Turn::Left {
        window.angular
    } else {
        Interval {
            low: -window.angular.high,
            high: -window.angular.low,
        }
    };
    let rates = rates.intersection(Interval {
        low: 0.0,
        high: f64::INFINITY,
    });
    let Some(track) = Track::of(course).filter(|_| rates.is_some()) else {
        return Lane::default();
    };
    let fastest = Velocity {
        linear_mps: 0.0,
        angular_radps: rates.high,
    };
    let inflation = situation.margin.turning(situation, rates.high);
    let stop = worst_stop(situation, fastest).travel;
    let horizon = stop + EASE_PERIODS * rates.high * situation.limits.period_s;
    Lane {
        course,
        track,
        rates,
        rect: situation.footprint.inflated(inflation.end_m),
        start_m: inflation.start_m,
        horizon,
        horizon_ahead: stop * AHEAD_FACTOR / situation.tuning.comfort,
    }
}
