//! What each fault does to data on their way.

use super::*;
use crate::file::fault::KINDS;
use crate::testing::{ROOM, robot, scenario};

/// The room with one fault from 1 s to 2 s.
fn faults(kind: &str, rest: &str) -> Faults {
    let entry = format!("\n[[fault]]\nkind = \"{kind}\"\nfrom_s = 1.0\nuntil_s = 2.0\n{rest}");
    Faults::new(&scenario(&format!("{ROOM}{entry}")), &robot())
}

fn scan(stamp_us: u64, range: f32) -> RawScan {
    RawScan {
        scanner: 0,
        begun_us: stamp_us,
        stamp_us,
        ranges_m: vec![range; 100],
        bodies: vec![Some(0); 100],
    }
}

fn sample(stamp_us: u64, x: f64) -> RawOdometry {
    RawOdometry {
        stamp_us,
        pose: [x, 0.0, 0.0],
        twist: [0.5, 0.0],
        curvature_per_m: None,
    }
}

fn command(stamp_us: u64) -> RawCommand {
    RawCommand {
        stamp_us,
        motion: SetPoint::Twist { v: 0.5, omega: 0.0 },
    }
}

/// Stamps of what arrives when one scan comes at each of these times.
fn stamps(faults: &mut Faults, times_us: &[u64]) -> Vec<u64> {
    times_us
        .iter()
        .flat_map(|t| faults.scans(*t, vec![scan(*t, 1.0)]))
        .map(|scan| scan.stamp_us)
        .collect()
}

#[test]
fn ranges_are_spoiled_inside_the_window_only() {
    for (kind, is_spoiled) in [
        ("ranges_nan", (|r: f32| r.is_nan()) as fn(f32) -> bool),
        ("ranges_infinite", |r| r == f32::INFINITY),
        ("ranges_zero", |r| r == 0.0),
        ("ranges_negative", |r| r < 0.0),
        ("beams_lost", |r| r == 0.0),
    ] {
        let mut faults = faults(kind, "");
        for (t_us, spoiled) in [(900_000, false), (1_500_000, true), (2_000_000, false)] {
            let out = faults.scans(t_us, vec![scan(t_us, 1.0)]);
            assert_eq!(
                out[0].ranges_m.iter().all(|r| is_spoiled(*r)),
                spoiled,
                "{kind}"
            );
            assert_eq!(out[0].bodies.iter().all(Option::is_none), spoiled, "{kind}");
        }
    }
}

#[test]
fn fraction_spoils_about_that_part() {
    let mut faults = faults("ranges_nan", "fraction = 0.3\n");
    let out = faults.scans(1_500_000, vec![scan(1_500_000, 1.0)]);
    let count = out[0].ranges_m.iter().filter(|r| r.is_nan()).count();
    assert!((15..45).contains(&count), "{count}");
}

#[test]
fn scans_go_missing_come_late_or_twice() {
    let times = [900_000, 1_200_000, 1_400_000, 2_100_000];
    assert_eq!(
        stamps(&mut faults("scan_missing", ""), &times),
        [900_000, 2_100_000]
    );
    assert_eq!(
        stamps(&mut faults("scan_reordered", ""), &times),
        [900_000, 1_200_000, 900_000, 1_400_000, 1_200_000, 2_100_000]
    );
    assert_eq!(
        stamps(&mut faults("scan_future", "offset_s = 0.5\n"), &times),
        [900_000, 1_700_000, 1_900_000, 2_100_000]
    );
    let mut late = faults("scan_late", "offset_s = 0.3\n");
    assert!(late.scans(1_200_000, vec![scan(1_200_000, 1.0)]).is_empty());
    assert_eq!(late.scans(1_600_000, Vec::new())[0].stamp_us, 1_200_000);
}

#[test]
fn frozen_scan_keeps_its_ranges_under_fresh_stamps() {
    let mut faults = faults("scan_frozen", "");
    let first = faults.scans(1_100_000, vec![scan(1_100_000, 3.0)]);
    let second = faults.scans(1_200_000, vec![scan(1_200_000, 2.0)]);
    assert_eq!(second[0].ranges_m, first[0].ranges_m);
    assert_eq!(second[0].stamp_us, 1_200_000);
}

#[test]
fn wrapped_stamps_wrap_when_the_fault_begins() {
    let mut faults = faults("scan_wrapped", "");
    let entry = "\n[[fault]]\nkind = \"scan_wrapped\"\nfrom_s = 1.0\n";
    let base = Faults::clock_base_us(&scenario(&format!("{ROOM}{entry}")));
    assert_eq!(base + 1_000_000, 1 << 32);
    let out = faults.scans(1_100_000, vec![scan(base + 1_100_000, 1.0)]);
    assert_eq!(out[0].stamp_us, 100_000);
}

#[test]
fn short_scan_loses_half_its_beams() {
    let out = faults("scan_short", "").scans(1_500_000, vec![scan(1_500_000, 1.0)]);
    assert_eq!((out[0].ranges_m.len(), out[0].bodies.len()), (50, 50));
}

#[test]
fn odometry_jumps_turns_its_sign_freezes_and_vanishes() {
    let at = |kind, rest| {
        let mut faults = faults(kind, rest);
        faults.odometry(1_100_000, sample(1_100_000, 1.0));
        faults.odometry(1_200_000, sample(1_200_000, 1.1))
    };
    let jumped = at("odometry_jump", "jump_m = 0.5\n").expect("it arrives");
    assert!((jumped.pose[0] - 1.6).abs() < 1e-12);
    let turned = at("odometry_sign", "").expect("it arrives");
    assert!((turned.pose[0] - 0.9).abs() < 1e-12 && turned.twist[0] < 0.0);
    let frozen = at("odometry_frozen", "").expect("it arrives");
    assert!((frozen.pose[0] - 1.0).abs() < 1e-12 && frozen.stamp_us == 1_200_000);
    assert!(at("odometry_nan", "").is_some_and(|o| o.pose[0].is_nan()));
    assert!(at("odometry_missing", "").is_none());
    let ahead = at("odometry_future", "offset_s = 0.5\n").expect("it arrives");
    assert_eq!(ahead.stamp_us, 1_700_000);
}

#[test]
fn reordered_odometry_goes_back_in_time() {
    let mut faults = faults("odometry_reordered", "");
    let stamps: Vec<u64> = (0..8)
        .filter_map(|i| faults.odometry(1_100_000 + i, sample(i, 0.0)))
        .map(|sample| sample.stamp_us)
        .collect();
    assert!(
        stamps.windows(2).any(|pair| pair[1] < pair[0]),
        "{stamps:?}"
    );
}

#[test]
fn commands_become_nan_vanish_or_come_late() {
    let mut nan = faults("command_nan", "");
    let spoiled = nan
        .command(1_500_000, command(1_500_000))
        .expect("it arrives");
    assert!(!spoiled.motion.is_finite());
    assert!(
        faults("command_missing", "")
            .command(1_500_000, command(1))
            .is_none()
    );
    let mut late = faults("command_late", "offset_s = 0.5\n");
    assert!(late.command(1_100_000, command(1_100_000)).is_none());
    let arrived = late
        .command(1_600_000, command(1_600_000))
        .expect("the first arrives");
    assert_eq!(arrived.stamp_us, 1_100_000);
}

#[test]
fn host_pauses_dies_and_its_clock_jumps() {
    assert_eq!(faults("host_pause", "").host(1_500_000), (false, true));
    assert_eq!(faults("host_death", "").host(1_500_000), (false, false));
    assert_eq!(faults("host_pause", "").host(2_500_000), (true, true));
    let clock = faults("clock_backwards", "offset_s = 0.7\n");
    assert_eq!(clock.clock_us(1_500_000, 9_000_000), 8_300_000);
    assert_eq!(clock.clock_us(500_000, 9_000_000), 9_000_000);
    let ahead = faults("clock_forwards", "offset_s = 0.7\n");
    assert_eq!(ahead.clock_us(1_500_000, 9_000_000), 9_700_000);
}

/// Ranges that rise with the beam, 0.1 m each, from all around.
fn fan(beams: usize) -> RawScan {
    RawScan {
        ranges_m: (1..=beams).map(|beam| beam as f32 * 0.1).collect(),
        bodies: (0..beams).map(Some).collect(),
        ..scan(1_500_000, 1.0)
    }
}

fn ranges(kind: &str, rest: &str) -> Vec<f32> {
    let mut out = faults(kind, rest).scans(1_500_000, vec![fan(541)]);
    out.remove(0).ranges_m
}

#[test]
fn ranges_saturate_come_in_steps_and_at_another_scale() {
    let near = |a: f32, b: f32| (a - b).abs() < 1e-4;
    let saturated = ranges("ranges_saturated", "range_m = 3.0\n");
    assert!(near(saturated[9], 1.0) && near(saturated[300], 3.0));
    let coarse = ranges("ranges_quantised", "range_m = 0.4\n");
    assert!(near(coarse[0], 0.4) && near(coarse[10], 1.2) && near(coarse[8], 0.8));
    let scaled = ranges("ranges_scaled", "factor = 1.1\n");
    assert!(near(scaled[9], 1.1) && near(scaled[99], 11.0));
}

#[test]
fn sectors_are_lost_or_show_something_else() {
    // Invalid beams are zero. The beams of the Seekur Jr run from -135 to 135 degrees in steps of half a degree.
    let sector = "sector_deg = [-5.0, 5.0]\n";
    let lost = ranges("sector_lost", sector);
    let gone: Vec<usize> = (0..541).filter(|beam| lost[*beam] <= 0.0).collect();
    assert!((20..=21).contains(&gone.len()), "{}", gone.len());
    assert!(gone.contains(&270) && !gone.contains(&250));
    let spoofed = ranges("sector_spoofed", &format!("{sector}range_m = 7.0\n"));
    assert!((spoofed[270] - 7.0).abs() < 1e-6 && (spoofed[200] - 20.1).abs() < 1e-3);
}

#[test]
fn scans_are_mirrored_and_doubled() {
    let mirrored = ranges("scan_mirrored", "");
    assert!((mirrored[0] - 54.1).abs() < 1e-3 && (mirrored[540] - 0.1).abs() < 1e-6);
    let twice = faults("scan_duplicated", "").scans(1_500_000, vec![fan(541)]);
    assert_eq!(twice[0], twice[1]);
}

#[test]
fn stamps_lie_in_the_past_or_jitter() {
    let times = [1_200_000, 1_400_000, 2_100_000];
    assert_eq!(
        stamps(&mut faults("scan_past", "offset_s = 0.1\n"), &times),
        [1_100_000, 1_300_000, 2_100_000]
    );
    let jittered = stamps(&mut faults("scan_jitter", "offset_s = 0.1\n"), &times);
    assert!(jittered[0].abs_diff(1_200_000) <= 100_000 && jittered[0] != 1_200_000);
    assert_eq!(jittered[2], 2_100_000);
}

#[test]
fn odometry_counts_at_another_scale() {
    let mut faults = faults("odometry_scaled", "factor = 0.5\n");
    faults.odometry(1_100_000, sample(1_100_000, 1.0));
    let scaled = faults.odometry(1_200_000, sample(1_200_000, 1.2));
    let scaled = scaled.expect("it arrives");
    assert!((scaled.pose[0] - 1.1).abs() < 1e-12 && (scaled.twist[0] - 0.25).abs() < 1e-12);
}

#[test]
fn ticks_come_late_within_the_window_only() {
    let mut faults = faults("host_jitter", "offset_s = 0.03\n");
    assert_eq!(faults.tick_delay_us(500_000), 0);
    let late: Vec<u64> = (0..50).map(|_| faults.tick_delay_us(1_500_000)).collect();
    assert!(late.iter().all(|us| *us < 30_000) && late.iter().any(|us| *us > 10_000));
}

#[test]
fn drives_are_stuck_or_do_not_hear_a_stop() {
    let twist = |v| SetPoint::Twist { v, omega: 0.0 };
    let mut stuck = faults("drive_stuck", "");
    assert_eq!(stuck.set_point(900_000, twist(0.3)), twist(0.3));
    assert_eq!(stuck.set_point(1_100_000, twist(0.5)), twist(0.3));
    assert_eq!(stuck.set_point(2_100_000, twist(0.0)), twist(0.0));
    let mut deaf = faults("drive_ignores_stop", "");
    assert_eq!(deaf.set_point(1_100_000, twist(0.3)), twist(0.3));
    assert_eq!(deaf.set_point(1_200_000, twist(0.5)), twist(0.5));
    assert_eq!(deaf.set_point(1_300_000, twist(0.1)), twist(0.5));
    assert_eq!(deaf.set_point(2_100_000, twist(0.1)), twist(0.1));
}

#[test]
fn the_list_of_kinds_is_whole() {
    let mut names: Vec<String> = KINDS.iter().map(|kind| format!("{kind:?}")).collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), KINDS.len());
}
