//! FRESH, SILENT, LATCH and INPUT: whatever is fed to it, the kernel accepts no motion it must not.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

mod common;

use common::check;
use common::episode::{Lie, Style, episodes};
use common::monitor::Monitor;
use common::report::Report;
use common::run::run_with;
use proptest::prelude::*;
use std::cell::RefCell;
use std::collections::BTreeMap;

const ALL: [Style; 3] = [Style::Reckless, Style::Wander, Style::Spot];

/// Every rule the faults must have exercised in a running robot.
const RULES: [&str; 17] = [
    "FRESH-01",
    "FRESH-02",
    "FRESH-03",
    "FRESH-04 odometry",
    "FRESH-04 scan",
    "FRESH-07",
    "INPUT-05",
    "INPUT-06",
    "INPUT-07",
    "INPUT-08 odometry",
    "INPUT-08 scan",
    "INPUT-10 command",
    "INPUT-10 odometry",
    "INPUT-10 scan",
    "INPUT-11",
    "LATCH-02",
    "SILENT-02",
];

struct Total {
    report: Report,
    exercised: BTreeMap<&'static str, usize>,
    releases: usize,
}

fn sum(cases: u32, lie: Lie) -> Total {
    let total = RefCell::new(Total {
        report: Report::default(),
        exercised: BTreeMap::new(),
        releases: 0,
    });
    let strategy = episodes(ALL.to_vec(), false).prop_map(move |mut episode| {
        episode.lie = lie;
        // A history long enough for old odometry does not hold the wheels' as well.
        episode.steered &= lie != Lie::OdometryAge;
        episode
    });
    let strict = lie == Lie::None;
    check(cases, &strategy, |episode| {
        if !strict && !total.borrow().report.faults.is_empty() {
            return Ok(());
        }
        let mut monitor = Monitor::new(&episode);
        let report = run_with(&episode, 10.0, &mut monitor);
        let faults = report.faults.clone();
        let mut total = total.borrow_mut();
        total.report.add(report);
        total.releases += monitor.releases;
        for (id, count) in monitor.exercised {
            *total.exercised.entry(id).or_default() += count;
        }
        prop_assert!(
            !strict || faults.is_empty(),
            "{} broken, first: {}",
            faults.len(),
            faults[0]
        );
        Ok(())
    });
    total.into_inner()
}

#[test]
fn no_motion_is_accepted_on_bad_input() {
    let total = sum(if cfg!(debug_assertions) { 30 } else { 80 }, Lie::None);
    println!(
        "{} ticks, {} accepted steps, {} releases; rules exercised: {:?}",
        total.report.ticks, total.report.accepted, total.releases, total.exercised
    );
    assert!(total.report.accepted > 1000 && total.releases > 50);
    for rule in RULES {
        assert!(
            total.exercised.contains_key(rule),
            "{rule} was never exercised"
        );
    }
}

#[test]
fn false_twins() {
    for lie in [
        Lie::ScanAge,
        Lie::OdometryAge,
        Lie::CommandAge,
        Lie::Jitter,
        Lie::InvalidFraction,
        Lie::InvalidGap,
        Lie::Rest,
        Lie::Clear,
    ] {
        let total = sum(60, lie);
        let first = total.report.faults.first();
        println!("false twin {lie:?}: {first:?}");
        assert!(first.is_some(), "{lie:?}: the monitor found nothing");
    }
}
