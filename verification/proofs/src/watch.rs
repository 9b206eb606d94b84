//! Stamps: order and age, for every 64-bit instant.

use haltline::time::{Duration, Instant};
use haltline::watch::{Order, is_stale, order};

fn stale(fault: u64) {
    let (stamp, now, limit): (u64, u64, u64) = (kani::any(), kani::any(), kani::any());
    let answer = is_stale(
        Instant::from_us(stamp),
        Instant::from_us(now),
        Duration::from_us(limit),
    );
    kani::cover!(answer && stamp <= now);
    kani::cover!(!answer);
    let old = stamp > now || now - stamp >= limit.saturating_add(1 - fault);
    assert!(answer == (old && !(limit == u64::MAX && stamp <= now)));
}

/// Older than its limit, or from the future, is stale, and nothing else is; every instant and limit.
//= spec/fresh.md#fresh-01
//= type=proof
//# The kernel MUST stop while the newest usable scan of any configured scanner is older than
//# `scan_age_max`.
//= spec/fresh.md#fresh-02
//= type=proof
//# The kernel MUST stop while the newest usable odometry is older than `odometry_age_max`.
//= spec/fresh.md#fresh-03
//= type=proof
//# The kernel MUST brake while the newest usable command is older than `command_age_max`.
//= spec/fresh.md#fresh-04
//= type=proof
//# Data stamped later than `now` MUST be treated as stale.
//= spec/fresh.md#fresh-08
//= type=proof
//# An age limit of zero MUST NOT switch a freshness check off.
#[kani::proof]
fn old_and_future_stamps_are_stale() {
    stale(0);
}

#[kani::proof]
#[kani::should_panic]
fn old_and_future_stamps_are_stale_twin() {
    stale(1);
}

fn ordered(fault: u64) {
    let (stamp, newest, now): (u64, u64, u64) = (kani::any(), kani::any(), kani::any());
    let has: bool = kani::any();
    let known = if has {
        Some(Instant::from_us(newest))
    } else {
        None
    };
    let answer = order(Instant::from_us(stamp), known, Instant::from_us(now));
    kani::cover!(answer == Order::Newer && has);
    kani::cover!(answer == Order::Older);
    kani::cover!(answer == Order::Same);
    kani::cover!(answer == Order::Future);
    if answer == Order::Newer {
        assert!(stamp <= now && (!has || stamp > newest.saturating_add(fault)));
    }
    assert!((stamp > now) == (answer == Order::Future));
}

/// Only a stamp later than the newest and not later than now is newer; every instant.
//= spec/input.md#input-08
//= type=proof
//# A value stamped no later than the newest of its channel MUST NOT replace it.
//= spec/fresh.md#fresh-05
//= type=proof
//# A channel found stale MUST stay stale until a usable value with a newer stamp arrives.
#[kani::proof]
fn only_a_later_stamp_is_newer() {
    ordered(0);
}

#[kani::proof]
#[kani::should_panic]
fn only_a_later_stamp_is_newer_twin() {
    ordered(1);
}

fn spans(fault: u64) {
    let (earlier, later): (u64, u64) = (kani::any(), kani::any());
    let span = Instant::from_us(later).since(Instant::from_us(earlier));
    kani::cover!(span.is_some());
    match span {
        Some(span) => assert!(earlier + fault <= later && span.as_us() == later - earlier),
        None => assert!(earlier > later),
    }
    let wide = Instant::from_us(earlier).plus(Duration::from_us(later));
    assert!(wide.as_us() >= earlier && wide.as_us() >= later);
}

/// Differences of instants never wrap, and sums saturate; every instant.
//= spec/time.md#time-05
//= type=proof
//# The kernel MUST NOT read a clock.
#[kani::proof]
fn time_never_wraps() {
    spans(0);
}

#[kani::proof]
#[kani::should_panic]
fn time_never_wraps_twin() {
    spans(1);
}
