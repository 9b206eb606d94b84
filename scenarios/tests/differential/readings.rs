//! What sensors say, and when.

use crate::room::{self, Room, config, m};
use crate::{driving, with_beams};
use haltline::config::Footprint;
use haltline::convert::{BeamEncoding, beam};
use haltline::decision::{Action, Decision, Reason};
use haltline::input::{Beam, Inputs, Reading, Scan};
use haltline::time::{Duration, Instant};
use haltline::units::Length;

fn beams(range_m: f32) -> Vec<Beam> {
    vec![beam(range_m, BeamEncoding::Rep117, m(0.02), m(20.0)); 541]
}

/// What is left where NaN, infinite and out-of-range beams are dropped as if there were nothing.
fn naive(ranges_m: &[f32]) -> usize {
    let kept = ranges_m
        .iter()
        .filter(|r| r.is_finite() && (0.02..=20.0).contains(*r));
    kept.count()
}

/// collision_monitor drops NaN beams: an all-NaN scan is a valid one without obstacles.
#[test]
fn a_scan_of_nothing_but_nan_stops() {
    assert_eq!(naive(&[f32::NAN; 541]), 0, "the naive monitor sees nothing");
    let decision = with_beams(&mut driving(0.5), &beams(f32::NAN), 0.5);
    assert_eq!(decision.reason, Reason::ScanMalformed, "{decision:?}");
    assert!(decision.action >= Action::ProtectiveStop);
}

/// The same for infinite beams: the robot goes on only as far as silence is vouched for (10 m here, none below).
#[test]
fn infinite_ranges_clear_no_more_than_is_vouched_for() {
    assert_eq!(naive(&[f32::INFINITY; 541]), 0);
    let mut deaf = config();
    deaf.scanners[0].as_mut().unwrap().no_return_clear = Length::ZERO;
    let mut room = Room::new((-3.0, 12.0), (-2.0, 2.0), deaf);
    let mut furthest = 0.0_f64;
    for tick in 0..400 {
        let _ = room.told(&beams(f32::INFINITY), 20_000, Some((0.5, 0.0)), tick == 10);
        furthest = furthest.max(room.pose[0]);
    }
    // The disc that the operator vouched for at the reset.
    assert!(
        furthest < 1.2,
        "drove {furthest} m without ever seeing anything"
    );
}

/// The same for beams below the minimum range.
#[test]
fn a_beam_below_the_minimum_range_stops() {
    assert_eq!(naive(&[0.01]), 0);
    let mut room = driving(0.5);
    let mut seen = room.beams();
    seen[270] = beam(0.01, BeamEncoding::Rep117, m(0.02), m(20.0));
    let decision = with_beams(&mut room, &seen, 0.5);
    assert_eq!(decision.reason, Reason::CriticalZone, "{decision:?}");
}

fn stamped(room: &mut Room, stamp_us: u64) -> Decision {
    let beams = room.beams();
    let scans = [Reading::Value(Scan {
        scanner: 0,
        stamp: Instant::from_us(stamp_us),
        beams: &beams,
    })];
    let inputs = Inputs {
        scans: &scans,
        odometry: Reading::Value(room.odometry()),
        command: room.command(0.5, 0.0),
        ..Inputs::default()
    };
    room.step(&inputs)
}

/// `now - stamp > timeout` takes stamps from the future for fresh.
#[test]
fn a_scan_from_the_future_stops() {
    let mut room = driving(0.5);
    let stamp_us = room.now_us + 3_600_000_000;
    let age_us = i64::try_from(room.now_us).unwrap() - i64::try_from(stamp_us).unwrap();
    assert!(age_us <= 60_000, "naively fresh");
    let decision = stamped(&mut room, stamp_us);
    assert_eq!(decision.reason, Reason::ScanFuture, "{decision:?}");
}

/// A timeout of 0 switches the check off.
#[test]
fn an_age_limit_of_zero_is_no_switch() {
    let mut never = config();
    never.timing.scan_age_max = Duration::from_ms(0);
    let Ok(kernel) = room::Robot::new(never) else {
        return;
    };
    let mut room = Room {
        kernel,
        ..Room::new((-3.0, 12.0), (-2.0, 2.0), config())
    };
    let _ = room.start();
    for _ in 0..50 {
        let decision = room.tick(Some((0.5, 0.0)), false);
        assert!(decision.action >= Action::Brake, "{decision:?}");
    }
}

/// #6320: a stale transform gives no guaranteed stop.
#[test]
fn odometry_that_falls_silent_stops() {
    let mut room = driving(0.5);
    let mut reasons = Vec::new();
    for _ in 0..3 {
        let beams = room.beams();
        let scans = [Reading::Value(Scan {
            scanner: 0,
            stamp: Instant::from_us(room.now_us - 20_000),
            beams: &beams,
        })];
        let inputs = Inputs {
            scans: &scans,
            command: room.command(0.5, 0.0),
            ..Inputs::default()
        };
        reasons.push(room.step(&inputs).reason);
    }
    assert!(
        reasons.contains(&Reason::OdometryStale) || reasons.contains(&Reason::OdometryMissing),
        "{reasons:?}"
    );
}

/// #6212, #6430: a footprint without corners and scans of any length crash it.
#[test]
fn hostile_sizes_are_refused_and_crash_nothing() {
    let mut flat = config();
    flat.footprint = Footprint {
        front: Length::ZERO,
        rear: Length::ZERO,
        left: Length::ZERO,
        right: Length::ZERO,
    };
    assert!(room::Robot::new(flat).is_err());
    for count in [0, 1, 540, 542, 65_535] {
        let decision = with_beams(&mut driving(0.5), &vec![Beam::Hit(3_000); count], 0.5);
        assert_eq!(decision.reason, Reason::ScanMalformed, "{count} beams");
    }
}
