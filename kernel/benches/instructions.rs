//! One measured call per scene, for callgrind (`haltline-verification timing` runs it).
//!
//! Usage: `instructions SCENE`; everything but `measured` is set-up and not counted.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]
#![allow(
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

#[path = "../tests/common/mod.rs"]
mod common;
mod scene;

use core::hint::black_box;
use scene::Setup;

/// What callgrind collects.
#[inline(never)]
fn measured<T>(work: impl FnOnce() -> T) -> T {
    black_box(work())
}

fn main() {
    let name = std::env::args().nth(1).unwrap_or_default();
    match name.as_str() {
        "certify-typical" => certify("typical"),
        "certify-crowded" => certify("crowded"),
        "refresh" => {
            let mut setup = Setup::named("typical");
            measured(|| setup.refresh());
        }
        "tick-typical" => tick(scene::Tick::corridor()),
        "tick-crowded" => tick(scene::Tick::closing_in()),
        // `cargo bench` passes its own flags; there is nothing to measure then.
        _ => eprintln!("scenes: certify-typical certify-crowded refresh tick-typical tick-crowded"),
    }
}

fn certify(name: &str) {
    let setup = Setup::named(name);
    let _ = black_box(measured(|| setup.certify()));
}

fn tick(tick: scene::Tick) {
    let _ = black_box(measured(|| tick.run()));
}
