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

//= spec/fresh.md#fresh-01
//= type=test
//# The kernel MUST stop while the newest usable scan of any configured scanner is older than `scan_age_max`.
//= spec/fresh.md#fresh-02
//= type=test
//# The kernel MUST stop while the newest usable odometry is older than `odometry_age_max`.
//= spec/fresh.md#fresh-03
//= type=test
//# The kernel MUST brake while the newest usable command is older than `command_age_max`.
//= spec/fresh.md#fresh-04
//= type=test
//# Data stamped later than `now` MUST be treated as stale.
//= spec/fresh.md#fresh-06
//= type=test
//# The kernel MUST stop while any configured scanner, or the odometry, has never delivered a usable value.
//= spec/fresh.md#fresh-07
//= type=test
//# The kernel MUST stop when scans repeat bit by bit although the robot moves.
//= spec/silent.md#silent-02
//= type=test
//# A tick later than control period plus jitter after the one before MUST start a protective stop.
//= spec/silent.md#silent-03
//= type=test
//# A tick whose `now` is not later than the one before MUST start a protective stop.
//= spec/latch.md#latch-01
//= type=test
//# A kernel that was just created MUST be latched.
//= spec/latch.md#latch-02
//= type=test
//# A pulled emergency stop line MUST latch an emergency stop in the same tick.
//= spec/latch.md#latch-03
//= type=test
//# An emergency stop MUST hold until a reset is given at rest with the line released.
//= spec/latch.md#latch-04
//= type=test
//# A reset MUST have no effect unless its stamp is later than the moment at which the stop was latched and not later than `now`.
//= spec/latch.md#latch-05
//= type=test
//# A protective stop MUST hold until the robot is at rest and its cause has been gone for the clear time.
//= spec/latch.md#latch-06
//= type=test
//# After a release the kernel MUST NOT execute a command stamped at or before the release.
//= spec/input.md#input-05
//= type=test
//# A scan with a larger part of invalid beams than `invalid_max` MUST be unusable.
//= spec/input.md#input-06
//= type=test
//# A scan with a wider run of consecutive invalid beams than `invalid_gap_max` MUST be unusable.
//= spec/input.md#input-07
//= type=test
//# A scan with the wrong number of beams or an unknown scanner MUST be unusable.
//= spec/input.md#input-08
//= type=test
//# A value stamped no later than the newest of its channel MUST NOT replace it.
//= spec/input.md#input-10
//= type=test
//# A malformed value MUST stop or brake the robot in the same tick.
//= spec/input.md#input-11
//= type=test
//# The kernel MUST stop when the odometry pose moved farther between two samples than the robot can.
#[test]
fn no_motion_is_accepted_on_bad_input() {
    let total = sum(common::cases(80), Lie::None);
    println!(
        "{} ticks, {} accepted steps, {} releases; rules exercised: {:?}",
        total.report.ticks, total.report.accepted, total.releases, total.exercised
    );
    assert!(total.report.accepted > 1000 && total.releases > 30);
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
