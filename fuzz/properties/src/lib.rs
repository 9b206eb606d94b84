//! What the fuzz targets hold the project to, each property written once.
//!
//! A property takes any bytes, makes a case of them, and judges what the code under test answers by
//! something that shares no code with it: the oracle of `haltline-spec`, exact geometry, a second
//! computation, or what was put in. libFuzzer calls it through `fuzz/fuzz_targets`, `cargo test` on the
//! committed corpora and on drawn bytes. Each has false twins, cases with a planted fault that it must find.

mod arc;
#[allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::type_complexity
)]
#[path = "../../../spec/tests/common/mod.rs"]
mod closed_loop;
mod corpus;
mod drives;
mod ekf;
mod grid;
mod guard;
mod inputs;
mod latch;
mod logs;
mod maps;
mod navigate;
mod plan;
mod record;
mod script;
mod stops;
mod text;
mod tomls;
mod vehicle;

pub use corpus::{corpus, write_corpus};
pub use haltline_spec::draw::Draw;

/// How many things were judged (motions accepted, files read), or the property that was broken.
pub type Judged = Result<usize, String>;

/// Judges the case that some bytes stand for.
pub type Judge = fn(&[u8]) -> Judged;

/// A property with its false twins.
pub struct Property {
    /// Name of the fuzz target and of its corpus.
    pub name: &'static str,
    /// The property.
    pub judge: Judge,
    /// The same with a planted fault each, by name.
    pub twins: &'static [(&'static str, Judge)],
    /// Bytes worth trying.
    pub draw: fn(&mut Draw) -> Vec<u8>,
    /// Drawn cases of a test run with optimisation.
    pub cases: usize,
}

/// All properties.
pub const ALL: &[Property] = &[
    guard::GUARD,
    stops::STOPS,
    latch::LATCH,
    inputs::INPUTS,
    navigate::NAVIGATE,
    grid::GRID,
    ekf::EKF,
    arc::ARC,
    plan::PLAN,
    tomls::ROBOT,
    tomls::SCENARIO,
    text::MARKER_MAP,
    text::BARN,
    logs::SENA,
    logs::CARMEN,
    logs::MRCLAM,
    maps::PGM,
    maps::YAML,
    record::RECORD,
    drives::ARCOS,
    drives::UC,
    drives::COLA,
    drives::ADAPTERS,
    drives::EMULATORS,
];

/// What a fuzz target does with its bytes: a broken property ends the process.
///
/// # Panics
/// If the property is broken, or there is none of this name.
#[allow(clippy::panic)] // How libFuzzer is told.
pub fn fuzz(name: &str, bytes: &[u8]) {
    let Some(property) = ALL.iter().find(|property| property.name == name) else {
        panic!("no property `{name}`");
    };
    if let Err(broken) = (property.judge)(bytes) {
        panic!("{name}: {broken}");
    }
}

/// Fails with `what` unless it holds.
fn demand(holds: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what()) }
}
