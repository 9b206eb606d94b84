//! Every adapter passes every check, and every broken adapter is caught by its own.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use haltline_drives::conformance::{Bench, CHECKS, CarBench, SeekurBench, TWINS};
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
