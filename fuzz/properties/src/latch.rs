//! The stop logic against what the requirements say of its history: a latch leaves only by a reset at rest.

use crate::script::{Script, noise};
use crate::{Judged, Property, demand};
use haltline::stop::{self, Mode, StopEvents, StopState, StopTimes};
use haltline::time::{Duration, Instant};

pub const LATCH: Property = Property {
    name: "latch",
    judge: |bytes| judge(bytes, stop::next),
    twins: &[
        ("a reset in motion", |bytes| {
            judge(bytes, |state, events, times| {
                let rest = StopEvents {
                    at_rest: true,
                    ..*events
                };
                stop::next(state, &rest, times)
            })
        }),
        ("a reset as old as the latch", |bytes| {
            judge(bytes, |state, events, times| {
                let older = StopState {
                    since: state.since.minus(Duration::from_us(1)),
                    ..state
                };
                stop::next(older, events, times)
            })
        }),
        ("no clear time", |bytes| {
            judge(bytes, |state, events, times| {
                let none = StopTimes {
                    clear: Duration::ZERO,
                    ..times
                };
                stop::next(state, events, none)
            })
        }),
        ("the line is a hazard only", |bytes| {
            judge(bytes, |state, events, times| {
                let hazard = StopEvents {
                    emergency: false,
                    hazard: events.hazard || events.emergency,
                    ..*events
                };
                stop::next(state, &hazard, times)
            })
        }),
        ("never releases", |bytes| {
            judge(bytes, |state, events, times| {
                let next = stop::next(state, events, times);
                if next.mode == Mode::Running && state.mode != Mode::Running {
                    state
                } else {
                    next
                }
            })
        }),
    ],
    draw: noise::<8, 300>,
    cases: 20_000,
};

type Next = fn(StopState, &StopEvents, StopTimes) -> StopState;

/// What happened so far, as the requirements speak of it.
struct History {
    /// Last tick with the line pulled, or the start.
    latched_at: Instant,
    /// First tick of the unbroken run of ticks without hazard in which the stop was active.
    clear_from: Option<Instant>,
    released: Instant,
}

fn judge(bytes: &[u8], next: Next) -> Judged {
    let mut script = Script::new(bytes);
    let times = StopTimes {
        clear: Duration::from_us(script.count(0, 60) as u64),
        reset_age_max: Duration::from_us(script.count(0, 60) as u64),
    };
    let mut now = Instant::from_us(script.count(0, 50) as u64);
    let mut state = StopState::default();
    let mut history = History {
        latched_at: Instant::from_us(0),
        clear_from: None,
        released: Instant::from_us(0),
    };
    let mut releases = 0;
    while !script.is_over() {
        now = now.plus(Duration::from_us(script.count(0, 15) as u64));
        let flags = script.byte();
        let around = now
            .plus(Duration::from_us(8))
            .minus(Duration::from_us(u64::from(script.byte() % 80)));
        let events = StopEvents {
            now,
            emergency: flags & 15 == 0,
            reset: (flags & 16 != 0).then_some(around),
            hazard: flags & 96 == 0,
            at_rest: flags & 128 != 0,
        };
        let after = next(state, &events, times);
        step(&history, state.mode, after, &events, times)?;
        if after.mode == Mode::Running && state.mode != Mode::Running {
            releases += 1;
            history.released = now;
        }
        if events.emergency {
            history.latched_at = now;
        }
        let calm = after.mode == Mode::Protective && !events.hazard;
        history.clear_from = calm.then(|| history.clear_from.unwrap_or(now));
        state = after;
    }
    Ok(releases)
}

fn step(
    history: &History,
    before: Mode,
    after: StopState,
    events: &StopEvents,
    times: StopTimes,
) -> Result<(), String> {
    let now = events.now;
    let expected = match before {
        _ if events.emergency => Mode::Latched,
        Mode::Latched => {
            let counts = events.reset.is_some_and(|stamp| {
                let age = now.as_us().checked_sub(stamp.as_us());
                stamp > history.latched_at
                    && age.is_some_and(|age| age <= times.reset_age_max.as_us())
            });
            if counts && events.at_rest && !events.hazard {
                Mode::Running
            } else {
                Mode::Latched
            }
        }
        Mode::Running | Mode::Protective if events.hazard => Mode::Protective,
        Mode::Running => Mode::Running,
        Mode::Protective => {
            let from = history.clear_from.unwrap_or(now);
            let clear = now.as_us() - from.as_us() >= times.clear.as_us();
            if clear && events.at_rest {
                Mode::Running
            } else {
                Mode::Protective
            }
        }
    };
    demand(after.mode == expected, || {
        format!(
            "{before:?} became {:?}, not {expected:?}: {events:?}",
            after.mode
        )
    })?;
    let released = if after.mode == Mode::Running && before != Mode::Running {
        now
    } else {
        history.released
    };
    demand(after.released == released, || {
        format!("commands die at {:?}, not at {released:?}", after.released)
    })
}
