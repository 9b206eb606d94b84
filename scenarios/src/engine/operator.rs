//! The operator: resets, the emergency stop line, and the order to follow a route.

use haltline::decision::StopStatus;
use haltline_robots::Robot;

use crate::file::Scenario;
use crate::math::microseconds;

/// The operator's order to follow the route.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Route {
    /// Stamp of the order; none before the first release.
    ordered_us: Option<u64>,
    /// Whether a latched stop has voided it.
    void: bool,
}

impl Route {
    /// The order at a tick: given anew in the tick after each release of a latched stop.
    pub(super) fn order(&mut self, before: Option<StopStatus>, host_us: u64) -> Option<u64> {
        match before {
            Some(StopStatus::Running) if self.void || self.ordered_us.is_none() => {
                (self.ordered_us, self.void) = (Some(host_us), false);
            }
            Some(StopStatus::Latched) => self.void = true,
            _ => {}
        }
        self.ordered_us
    }
}

/// Resets and the emergency stop line.
pub(super) struct Operator {
    /// Times of resets still to be given; `None` waits for the robot to be able to take one.
    resets_us: Option<Vec<u64>>,
    lines_us: Vec<[u64; 2]>,
    wait_us: u64,
}

impl Operator {
    pub(super) fn new(scenario: &Scenario, robot: &Robot) -> Self {
        let times = |list: &Vec<crate::file::value::NonNegative>| {
            list.iter().map(|t| microseconds(t.get())).collect()
        };
        let stops = &scenario.operator.emergency_stops_s;
        Self {
            resets_us: scenario.operator.resets_s.as_ref().map(times),
            lines_us: stops
                .iter()
                .map(|p| p.map(|t| microseconds(t.get())))
                .collect(),
            wait_us: microseconds(0.2 + robot.values.timing.rest_s),
        }
    }

    pub(super) fn line(&self, t_us: u64) -> bool {
        self.lines_us
            .iter()
            .any(|[from, until]| t_us >= *from && t_us < *until)
    }

    /// Whether a reset is given at this tick; each is given once.
    pub(super) fn reset(&mut self, t_us: u64, rested: bool) -> bool {
        match &mut self.resets_us {
            Some(times) => {
                let before = times.len();
                times.retain(|time| *time > t_us);
                times.len() < before
            }
            None if t_us >= self.wait_us && rested => {
                self.resets_us = Some(Vec::new());
                true
            }
            None => false,
        }
    }
}
