//! Each assumption is named when it is broken, and none when all are kept.

use crate::batch::equip;
use crate::engine::run;
use crate::testing::{ROOM, robot, scenario};

/// Ids that a short naked run of the room with `extra` names.
fn named(text: &str) -> Vec<String> {
    let text = text.replace("timeout_s = 10.0", "timeout_s = 0.05");
    let case = equip(scenario(&text), &robot()).expect("the robot can be equipped");
    let result = run(&case.scenario, &case.robot, None).result;
    result
        .assumptions_broken
        .into_iter()
        .map(|b| b.id)
        .collect()
}

fn with(extra: &str) -> Vec<String> {
    named(&format!("{ROOM}\n{extra}"))
}

#[test]
fn kept_assumptions_are_not_named() {
    assert_eq!(named(ROOM), Vec::<String>::new());
    assert!(with("[drive]\nbraking_mps2 = 0.9\nlatency_s = 0.05\n").is_empty());
    assert!(with("[sensor]\nbias_m = -0.03\ndropout_fraction = 0.1\n").is_empty());
    assert!(with("[[fault]]\nkind = \"ranges_nan\"\nfrom_s = 1.0\n").is_empty());
    assert!(with("[[fault]]\nkind = \"command_missing\"\nfrom_s = 1.0\n").is_empty());
}

#[test]
fn drive_that_is_worse_than_stated_is_named() {
    assert_eq!(with("[drive]\nbraking_mps2 = 0.4\n"), ["A-BRAKE"]);
    assert_eq!(with("[drive]\nangular_braking_radps2 = 0.4\n"), ["A-BRAKE"]);
    assert_eq!(
        with("[drive]\nlatency_s = 0.09\nlag_s = 0.02\n"),
        ["A-LATENCY"]
    );
    assert_eq!(with("[drive]\nseparate_ramps = true\n"), ["A-FOLLOW"]);
    assert_eq!(with("[drive]\nslip = 0.9\n"), ["A-ODOMETRY"]);
    assert_eq!(with("[odometry]\nerror_m_per_m = 0.02\n"), ["A-ODOMETRY"]);
}

#[test]
fn sensor_and_bodies_that_are_worse_than_stated_are_named() {
    assert_eq!(with("[sensor]\nnoise_sigma_m = 0.03\n"), ["A-SENSOR"]);
    let disc = |rest: &str| with(&format!("[[circle]]\ncenter_m = [0.0, 2.0]\n{rest}"));
    assert_eq!(
        disc("radius_m = 0.1\nmaterial = \"invisible\"\n"),
        ["A-VISIBLE"]
    );
    assert_eq!(disc("radius_m = 0.01\n"), ["A-WIDTH"]);
    let moving = "radius_m = 0.1\nmotion = { velocity_mps = [0.1, 0.0] }\n";
    assert_eq!(disc(moving), ["A-OBSTACLE"]);
    assert_eq!(disc("radius_m = 0.1\n"), Vec::<String>::new());
}

#[test]
fn faults_that_nothing_can_see_at_once_are_named() {
    let fault = |kind: &str, rest: &str| {
        with(&format!(
            "[[fault]]\nkind = \"{kind}\"\nfrom_s = 1.0\n{rest}"
        ))
    };
    assert_eq!(fault("odometry_jump", "jump_m = 0.5\n"), ["A-ODOMETRY"]);
    assert_eq!(fault("odometry_sign", ""), ["A-ODOMETRY"]);
    assert_eq!(fault("odometry_frozen", ""), ["A-ODOMETRY"]);
    assert_eq!(fault("scan_frozen", ""), ["A-SENSOR"]);
    assert_eq!(fault("scan_future", "offset_s = 0.5\n"), ["A-CLOCK"]);
    assert_eq!(fault("clock_backwards", "offset_s = 0.5\n"), ["A-CLOCK"]);
    assert_eq!(fault("host_death", ""), ["A-WATCHDOG"]);
}

#[test]
fn host_death_is_kept_only_where_it_is_covered() {
    let death = "[[fault]]\nkind = \"host_death\"\nfrom_s = 1.0\n";
    let covered = ROOM.replace("seed = 5\n", "seed = 5\ncover_host_death = true\n");
    assert_eq!(named(&format!("{covered}\n{death}")), Vec::<String>::new());
    let deaf = format!("{covered}\n{death}\n[drive]\nsilence = \"none\"\n");
    assert_eq!(named(&deaf), ["A-WATCHDOG"]);
    let slow = format!("{covered}\n{death}\n[drive]\nwatchdog_s = 3.0\n");
    assert_eq!(named(&slow), ["A-WATCHDOG"]);
}
