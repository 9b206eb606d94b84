//! The stop logic: one pure transition function over running, protective stop and latch.
//!
//! Knows no sensors and no geometry; whoever calls it has already decided whether
//! there is a hazard. A model checker calls the very same function.

use crate::time::{Duration, Instant};

/// What the stop logic is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Motion is allowed on commands stamped after [`StopState::released`].
    Running,
    /// Braking or resting until the hazard is gone, the robot rests and the clear time is over.
    Protective,
    /// Braking or resting until an operator's reset at rest.
    Latched,
}

/// State of the stop logic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct StopState {
    /// Present mode.
    pub mode: Mode,
    /// When the mode was entered or, for a latch, last renewed.
    pub since: Instant,
    /// Since when no hazard has been seen while stopped.
    pub clear_since: Option<Instant>,
    /// Commands stamped at or before this instant are dead.
    pub released: Instant,
    /// Whether the latch is the one every kernel starts with.
    pub startup: bool,
}

/// What happened in one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct StopEvents {
    /// Time of the tick.
    pub now: Instant,
    /// The emergency stop line is pulled.
    pub emergency: bool,
    /// Stamp of an operator's reset.
    pub reset: Option<Instant>,
    /// Something calls for a protective stop.
    pub hazard: bool,
    /// The robot rests: measured, fresh, for the rest time.
    pub at_rest: bool,
}

/// Times of the stop logic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct StopTimes {
    /// How long a hazard must be gone.
    pub clear: Duration,
    /// How old a reset may be.
    pub reset_age_max: Duration,
}

impl Default for StopState {
    //= spec/latch.md#latch-01
    //# A kernel that was just created MUST be latched.
    /// Latched: a kernel that was just started waits for an operator.
    fn default() -> Self {
        Self {
            mode: Mode::Latched,
            since: Instant::from_us(0),
            clear_since: None,
            released: Instant::from_us(0),
            startup: true,
        }
    }
}

/// The state after one tick.
///
/// # Bound
/// O(1), no loop.
/// # Source
/// LATCH-01..06, ZONE-04.
#[must_use]
pub fn next(state: StopState, events: &StopEvents, times: StopTimes) -> StopState {
    //= spec/latch.md#latch-02
    //# A pulled emergency stop line MUST latch an emergency stop in the same tick.
    if events.emergency {
        return StopState {
            mode: Mode::Latched,
            since: events.now,
            clear_since: None,
            startup: false,
            ..state
        };
    }
    match state.mode {
        //= spec/latch.md#latch-03
        //# An emergency stop MUST hold until a reset is given at rest with the line released.
        Mode::Latched if may_reset(&state, events, times) => running(events.now),
        Mode::Latched => state,
        Mode::Running if events.hazard => StopState {
            mode: Mode::Protective,
            since: events.now,
            clear_since: None,
            ..state
        },
        Mode::Running => state,
        //= spec/zone.md#zone-04
        //# A protective stop for the critical zone MUST last as long as any new scan has a return in the zone.
        Mode::Protective if events.hazard => StopState {
            clear_since: None,
            ..state
        },
        Mode::Protective => {
            let clear_since = state.clear_since.unwrap_or(events.now);
            let clear = events.now.since(clear_since).unwrap_or_default();
            //= spec/latch.md#latch-05
            //# A protective stop MUST hold until the robot is at rest and its cause has been gone for the clear time.
            if events.at_rest && clear >= times.clear {
                running(events.now)
            } else {
                StopState {
                    clear_since: Some(clear_since),
                    ..state
                }
            }
        }
    }
}

const fn running(now: Instant) -> StopState {
    StopState {
        mode: Mode::Running,
        since: now,
        clear_since: None,
        released: now,
        startup: false,
    }
}

/// A reset counts if it is newer than the latch, not from the future, not old, and the robot
/// rests without a hazard.
fn may_reset(state: &StopState, events: &StopEvents, times: StopTimes) -> bool {
    let Some(stamp) = events.reset else {
        return false;
    };
    //= spec/latch.md#latch-04
    //# A reset MUST have no effect unless its stamp is later than the moment at which the stop was latched and not
    //# later than `now`.
    let fresh = events
        .now
        .since(stamp)
        .is_some_and(|age| age <= times.reset_age_max);
    let newer = stamp > state.since;
    fresh && newer && events.at_rest && !events.hazard
}

#[cfg(test)]
mod tests;
