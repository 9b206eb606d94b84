//! Closed loops of the kernel and the oracle: episodes, their run, and the check of the claim.

#![allow(dead_code)] // Every test file uses its own part.

pub mod account;
pub mod claim;
pub mod episode;
pub mod faults;
pub mod monitor;
pub mod pilot;
pub mod report;
pub mod rules;
pub mod run;
pub mod tamper;
pub mod told;
pub mod wire;

use episode::Episode;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// `all` cases with optimisation; a quarter without, so that a debug run ends in reasonable time.
pub const fn cases(all: u32) -> u32 {
    if cfg!(debug_assertions) {
        all.div_ceil(4)
    } else {
        all
    }
}

/// Runs the property on `cases` episodes that are the same on every machine.
pub fn check(
    cases: u32,
    strategy: &impl proptest::strategy::Strategy<Value = Episode>,
    property: impl Fn(Episode) -> Result<(), proptest::test_runner::TestCaseError>,
) {
    let config = Config {
        cases,
        failure_persistence: None,
        max_shrink_iters: 200,
        ..Config::default()
    };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let mut runner = TestRunner::new_with_rng(config, rng);
    if let Err(found) = runner.run(strategy, property) {
        panic!("{found}");
    }
}
