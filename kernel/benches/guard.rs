//! Wall-clock benchmarks of the guard and of a full tick (`cargo bench -p haltline --bench guard`).
//!
//! Read them as ratios within one run; instruction counts are in `instructions.rs`.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]
#![allow(
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

#[path = "../tests/common/mod.rs"]
mod common;
mod scene;

use divan::{Bencher, black_box};
use scene::{Setup, Tick};

fn main() {
    divan::main();
}

/// Certifying one motion against 541 beams and 1000 remembered points.
#[divan::bench(args = ["typical", "crowded"])]
fn certify(bencher: Bencher<'_, '_>, name: &str) {
    let setup = Setup::named(name);
    bencher.bench_local(|| black_box(setup.certify()));
}

/// Bringing all points to the newest pose.
#[divan::bench]
fn refresh(bencher: Bencher<'_, '_>) {
    let mut setup = Setup::named("typical");
    bencher.bench_local(|| setup.refresh());
}

/// A full shield tick: scan, odometry and command in, decision out.
#[divan::bench(args = ["typical", "crowded"])]
fn tick(bencher: Bencher<'_, '_>, name: &str) {
    let make = match name {
        "crowded" => Tick::closing_in,
        _ => Tick::corridor,
    };
    bencher
        .with_inputs(make)
        .bench_local_values(|inputs| black_box(inputs.run()));
}

/// Cost of certifying against a growing number of points.
#[divan::bench(args = [0, 250, 500, 1000])]
fn certify_remembered(bencher: Bencher<'_, '_>, remembered: usize) {
    let setup = Setup::remembering(remembered);
    bencher.bench_local(|| black_box(setup.certify()));
}
