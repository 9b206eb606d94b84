//! The transition function, enumerated: every event sequence up to a depth, at a coarse clock.

use super::*;
use std::collections::HashSet;
use std::vec::Vec;

const TIMES: StopTimes = StopTimes {
    clear: Duration::from_us(2),
    reset_age_max: Duration::from_us(1),
};

/// All events that can happen at `now`: with resets of the present, the past and the future.
fn events(now: u64) -> Vec<StopEvents> {
    let mut out = Vec::new();
    let resets = [
        None,
        Some(now),
        Some(now.saturating_sub(1)),
        Some(now.saturating_sub(3)),
        Some(now + 1),
    ];
    for reset in resets {
        for bits in 0..8_u8 {
            out.push(StopEvents {
                now: Instant::from_us(now),
                emergency: bits & 1 != 0,
                hazard: bits & 2 != 0,
                at_rest: bits & 4 != 0,
                reset: reset.map(Instant::from_us),
            });
        }
    }
    out
}

/// Calls `check` on every transition reachable within `depth` ticks; returns how many there were.
fn every_transition(depth: u64, mut check: impl FnMut(StopState, &StopEvents, StopState)) -> usize {
    let mut frontier: HashSet<StopState> = HashSet::from([StopState::default()]);
    let mut count = 0;
    for tick in 0..depth {
        let mut following = HashSet::new();
        for &state in &frontier {
            for event in events(tick + 10) {
                let after = next(state, &event, TIMES);
                check(state, &event, after);
                following.insert(after);
                count += 1;
            }
        }
        frontier = following;
    }
    count
}

#[test]
fn a_latch_opens_only_by_a_fresh_newer_reset_at_rest_without_hazard() {
    let mut opened = 0;
    let count = every_transition(7, |before, event, after| {
        if before.mode != Mode::Latched || after.mode == Mode::Latched {
            return;
        }
        opened += 1;
        let reset = event.reset.unwrap();
        assert!(reset > before.since && reset <= event.now);
        assert!(event.now.since(reset).unwrap() <= TIMES.reset_age_max);
        assert!(event.at_rest && !event.hazard && !event.emergency);
        assert_eq!(after.mode, Mode::Running);
    });
    assert!(opened > 0 && count > 1000, "{opened} of {count}");
}

#[test]
fn an_emergency_always_latches_and_a_hazard_always_stops() {
    every_transition(7, |_, event, after| {
        if event.emergency {
            assert_eq!(after.mode, Mode::Latched);
        }
        if event.hazard {
            assert_ne!(after.mode, Mode::Running);
        }
    });
}

#[test]
fn a_protective_stop_releases_only_at_rest_after_its_clear_time() {
    let mut released = 0;
    every_transition(8, |before, event, after| {
        if before.mode != Mode::Protective || after.mode != Mode::Running {
            return;
        }
        released += 1;
        assert!(event.at_rest && !event.hazard);
        let clear = before.clear_since.unwrap();
        assert!(event.now.since(clear).unwrap() >= TIMES.clear);
    });
    assert!(released > 0);
}

#[test]
fn every_release_kills_the_commands_before_it() {
    every_transition(8, |before, event, after| {
        if after.mode == Mode::Running && before.mode != Mode::Running {
            assert_eq!(after.released, event.now);
        } else {
            assert_eq!(after.released, before.released);
        }
    });
}
