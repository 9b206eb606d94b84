//! The stop logic: one step from any state on any event.

use haltline::stop::{Mode, StopEvents, StopState, StopTimes, next};
use haltline::time::{Duration, Instant};

fn any_instant() -> Instant {
    Instant::from_us(kani::any())
}

fn any_option() -> Option<Instant> {
    if kani::any() {
        Some(any_instant())
    } else {
        None
    }
}

fn any_state() -> StopState {
    let mode = match kani::any::<u8>() {
        0 => Mode::Running,
        1 => Mode::Protective,
        _ => Mode::Latched,
    };
    StopState {
        mode,
        since: any_instant(),
        clear_since: any_option(),
        released: any_instant(),
        startup: kani::any(),
    }
}

fn any_events() -> StopEvents {
    StopEvents {
        now: any_instant(),
        emergency: kani::any(),
        reset: any_option(),
        hazard: kani::any(),
        at_rest: kani::any(),
    }
}

fn any_times() -> StopTimes {
    StopTimes {
        clear: Duration::from_us(kani::any()),
        reset_age_max: Duration::from_us(kani::any()),
    }
}

fn line_latches(fault: bool) {
    let (state, events) = (any_state(), any_events());
    let after = next(state, &events, any_times());
    kani::cover!(events.emergency && state.mode == Mode::Running);
    let pulled = events.emergency || (fault && events.hazard);
    assert!(!pulled || (after.mode == Mode::Latched && after.since == events.now));
}

/// A pulled line latches in the same step, from every state.
//= spec/latch.md#latch-02
//= type=proof
//# A pulled emergency stop line MUST latch an emergency stop in the same tick.
#[kani::proof]
fn a_pulled_line_latches() {
    line_latches(false);
}

#[kani::proof]
#[kani::should_panic]
fn a_pulled_line_latches_twin() {
    line_latches(true);
}

fn latch_holds(fault: bool) {
    let (state, events, times) = (any_state(), any_events(), any_times());
    kani::assume(state.mode == Mode::Latched);
    let after = next(state, &events, times);
    kani::cover!(after.mode != Mode::Latched);
    if after.mode != Mode::Latched {
        assert!(!events.emergency && !events.hazard);
        assert!(events.at_rest && !(fault && events.now.as_us() > 9));
        let reset = events.reset.map_or(0, Instant::as_us);
        assert!(events.reset.is_some());
        assert!(reset > state.since.as_us() && reset <= events.now.as_us());
        assert!(events.now.as_us() - reset <= times.reset_age_max.as_us());
    }
}

/// No step leaves a latched stop but for a reset at rest, newer than the latch, not from the future
/// and not old, with the line released and no hazard.
//= spec/latch.md#latch-03
//= type=proof
//# An emergency stop MUST hold until a reset is given at rest with the line released.
//= spec/latch.md#latch-04
//= type=proof
//# A reset MUST have no effect unless its stamp is later than the moment at which the stop was
//# latched and not later than `now`.
#[kani::proof]
fn a_latch_holds_without_a_reset_at_rest() {
    latch_holds(false);
}

#[kani::proof]
#[kani::should_panic]
fn a_latch_holds_without_a_reset_at_rest_twin() {
    latch_holds(true);
}

fn protective_holds(fault: u64) {
    let (state, events, times) = (any_state(), any_events(), any_times());
    kani::assume(state.mode == Mode::Protective);
    let after = next(state, &events, times);
    kani::cover!(after.mode == Mode::Running);
    if after.mode == Mode::Running {
        assert!(!events.hazard && !events.emergency && events.at_rest);
        // Clear since the recorded moment; without one the clear time must be zero.
        let since = state.clear_since.map_or(events.now.as_us(), Instant::as_us);
        let clear = events.now.as_us().saturating_sub(since);
        assert!(clear >= times.clear.as_us().saturating_add(fault));
    }
    // A hazard starts the clear time anew.
    assert!(!events.hazard || after.clear_since.is_none());
}

/// A protective stop ends only at rest, without a hazard, after the clear time.
//= spec/latch.md#latch-05
//= type=proof
//# A protective stop MUST hold until the robot is at rest and its cause has been gone for the
//# clear time.
//= spec/zone.md#zone-04
//= type=proof
//# A protective stop for the critical zone MUST last as long as any new scan has a return in the
//# zone.
#[kani::proof]
fn a_protective_stop_holds_until_rest_and_clear() {
    protective_holds(0);
}

#[kani::proof]
#[kani::should_panic]
fn a_protective_stop_holds_until_rest_and_clear_twin() {
    protective_holds(1);
}

fn release_kills_old(fault: u64) {
    let (state, events) = (any_state(), any_events());
    let after = next(state, &events, any_times());
    let released = after.mode == Mode::Running && state.mode != Mode::Running;
    kani::cover!(released);
    if released {
        // A command is dead when stamped at or before `released`.
        assert!(after.released.as_us() >= events.now.as_us().saturating_add(fault));
    } else {
        assert!(after.released == state.released);
    }
}

/// A release kills every command stamped up to now, and nothing else moves that moment.
//= spec/latch.md#latch-06
//= type=proof
//# After a release the kernel MUST NOT execute a command stamped at or before the release.
#[kani::proof]
fn a_release_kills_older_commands() {
    release_kills_old(0);
}

#[kani::proof]
#[kani::should_panic]
fn a_release_kills_older_commands_twin() {
    release_kills_old(1);
}

fn hazard_stops(fault: bool) {
    let (state, events) = (any_state(), any_events());
    let after = next(state, &events, any_times());
    kani::cover!(events.hazard && state.mode == Mode::Running && !events.emergency);
    let calls = events.hazard || (fault && events.at_rest);
    assert!(!calls || after.mode != Mode::Running);
}

/// A hazard leaves no state running.
//= spec/latch.md#latch-08
//= type=proof
//# When several causes apply in one tick, the most restrictive action MUST win.
#[kani::proof]
fn a_hazard_leaves_nothing_running() {
    hazard_stops(false);
}

#[kani::proof]
#[kani::should_panic]
fn a_hazard_leaves_nothing_running_twin() {
    hazard_stops(true);
}

fn starts_latched(fault: bool) {
    let state = StopState::default();
    let events = any_events();
    let after = next(state, &events, any_times());
    kani::cover!(after.mode == Mode::Running);
    assert!(state.mode == Mode::Latched && state.startup);
    assert!(after.mode == Mode::Latched || (events.reset.is_some() && !fault));
}

/// A new kernel is latched, and its first step stays so without a reset.
//= spec/latch.md#latch-01
//= type=proof
//# A kernel that was just created MUST be latched.
#[kani::proof]
fn a_new_kernel_is_latched() {
    starts_latched(false);
}

#[kani::proof]
#[kani::should_panic]
fn a_new_kernel_is_latched_twin() {
    starts_latched(true);
}
