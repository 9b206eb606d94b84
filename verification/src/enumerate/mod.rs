//! Enumerations: every case of a stated domain, run on the compiled kernel.
//!
//! This is machine code of this machine, not a model of it. Where a domain is a grid of a larger
//! one, the ledger says so; nothing is claimed between its points.

// Case numbers are turned into values of the domain; they fit by construction.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss
)]

mod angles;
mod arith;
mod braking;
mod frozen;
mod intervals;
mod kernel;
mod seen;
mod shapes;
mod spot;
mod trig;
mod tube;
mod window;

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;

use crate::prove::native::Enumeration;

/// What a case says that stopped because another one failed.
const FAIL_FAST: &str = "not run";

/// All enumerations.
#[must_use]
pub fn all() -> Vec<Enumeration> {
    let mut all = Vec::new();
    all.extend(angles::all());
    all.extend(trig::all());
    all.extend(arith::all());
    all.extend(seen::all());
    all.extend(braking::all());
    all.extend(shapes::all());
    all.extend(intervals::all());
    all.extend(tube::all());
    all.extend(spot::all());
    all.extend(kernel::all());
    all.extend(frozen::all());
    all.extend(window::all());
    all
}

/// The number of tubes that were looked at; too few are a domain that shows nothing.
fn most_have_tubes(built: u64, cases: u64) -> Result<u64, String> {
    if built > cases / 2 {
        Ok(built)
    } else {
        Err(format!("only {built} of {cases} settings have a tube"))
    }
}

/// Runs `check` for every number of `cases`; the number of cases, or the least failing one seen.
fn parallel(
    cases: Range<u64>,
    check: impl Fn(u64) -> Result<(), String> + Sync,
) -> Result<u64, String> {
    const BLOCK: u64 = 1 << 16;
    let next = AtomicU64::new(cases.start);
    let stop = AtomicBool::new(false);
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let work = || -> Option<(u64, String)> {
        loop {
            let from = next.fetch_add(BLOCK, Ordering::Relaxed);
            if from >= cases.end || stop.load(Ordering::Relaxed) {
                return None;
            }
            for case in from..(from + BLOCK).min(cases.end) {
                if let Err(words) = check(case) {
                    stop.store(true, Ordering::Relaxed);
                    return Some((case, words));
                }
            }
        }
    };
    let failed = thread::scope(|scope| {
        let handles: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        handles
            .into_iter()
            .filter_map(|handle| match handle.join() {
                Ok(found) => found,
                Err(_) => Some((u64::MAX, "a worker has panicked".into())),
            })
            .min()
    });
    match failed {
        Some((case, words)) => Err(format!("case {case}: {words}")),
        None => Ok(cases.end - cases.start),
    }
}

/// Like `parallel`, one case at a time.
fn parallel_each(
    cases: u64,
    check: impl Fn(u64) -> Result<(), String> + Sync,
) -> Result<u64, String> {
    const BLOCK: u64 = 1 << 16;
    parallel(0..cases * BLOCK, |number| {
        if number % BLOCK == 0 {
            check(number / BLOCK)
        } else {
            Ok(())
        }
    })
}
