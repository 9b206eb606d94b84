//! Every adapter passes every check, and every broken adapter is caught by its own.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use haltline_drives::conformance::{Bench, CHECKS, CarBench, FileBench, SeekurBench, TWINS};
use haltline_drives::robots::Kind;
use haltline_drives::seekur::Wheels;

fn benches() -> Vec<Box<dyn Bench>> {
    vec![
        Box::new(SeekurBench {
            wheels: Wheels::VelRvel,
            skid: 1.0,
        }),
        Box::new(SeekurBench {
            wheels: Wheels::VelRvel,
            skid: 0.6,
        }),
        Box::new(SeekurBench {
            wheels: Wheels::Vel2,
            skid: 1.0,
        }),
        Box::new(CarBench { stx: true }),
        Box::new(CarBench { stx: false }),
    ]
}

//= spec/drive.md#drive-01
//= type=test
//# An adapter MUST NOT send a set point other than zero before its handshake is complete and the operator has enabled the drive.
//= spec/drive.md#drive-02
//= type=test
//# The first set point after a handshake, a gap, a reconnection or a restart of the drive MUST be zero.
//= spec/drive.md#drive-03
//= type=test
//# After an interruption an adapter MUST withhold motion until a decision asks for rest.
//= spec/drive.md#drive-04
//= type=test
//# The set point of a decision MUST be on the wire within one control period.
//= spec/drive.md#drive-05
//= type=test
//# When no decision is in force, an adapter MUST ramp the last set point down to zero on its curvature, at no less than the sure decelerations.
//= spec/drive.md#drive-06
//= type=test
//# A set point beyond a limit of the drive MUST be scaled on its curvature; one whose curvature cannot be steered becomes a stop.
//= spec/drive.md#drive-07
//= type=test
//# Speed and turn MUST keep their signs, and zero stay zero, from the decision to the motion and from the motion to the feedback.
//= spec/drive.md#drive-08
//= type=test
//# The set point on the wire MUST be the decision's within the stated resolution of the wire.
//= spec/drive.md#drive-09
//= type=test
//# Bytes that are not a whole and valid frame of the drive MUST NOT cause motion, nor end the adapter, nor change its feedback.
#[test]
fn every_adapter_passes_every_check() {
    let mut failures = Vec::new();
    for bench in benches() {
        for check in CHECKS {
            match (check.run)(bench.as_ref(), None) {
                Ok(measured) => println!("{}: {}: {measured}", bench.name(), check.name),
                Err(failure) => {
                    failures.push(format!("{}: {}: {failure:?}", bench.name(), check.name))
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// With the times and decelerations of the robot files themselves; a robot without watchdog is found.
#[test]
fn the_robots_of_the_files_rest_in_time_when_their_host_dies() {
    let check = CHECKS
        .iter()
        .find(|check| check.requirements == ["DRIVE-14"]);
    for (kind, name) in [(Kind::SeekurJr, "seekur_jr"), (Kind::PsesCar, "pses_car")] {
        let file = haltline_robots::Robot::embedded(name).unwrap();
        let run = |bench: FileBench| (check.unwrap().run)(&bench, None);
        println!("{name}: {}", run(FileBench::new(kind, &file)).unwrap());
        let failure = run(FileBench::without_watchdog(kind, &file)).unwrap_err();
        assert_eq!(failure.requirement, "DRIVE-14");
    }
}

#[test]
fn every_broken_adapter_is_caught_by_its_check() {
    let benches = benches();
    let mut missed = Vec::new();
    for bench in [&benches[0], &benches[3]] {
        for (twin, name) in TWINS {
            let check = CHECKS.iter().find(|check| check.name == *name).unwrap();
            match (check.run)(bench.as_ref(), Some(*twin)) {
                Err(failure) => {
                    assert!(
                        check.requirements.contains(&failure.requirement),
                        "{twin:?}: {failure:?}"
                    );
                }
                Ok(measured) => missed.push(format!("{}: {twin:?}: {measured}", bench.name())),
            }
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}
