//! Proofs: harnesses, enumerations and lemmas, their runner and the ledger of what was shown.
//!
//! Harnesses in Kani's interface are compiled to wasm with the release profile and overflow checks,
//! translated to C and given to cbmc. A proof counts if it holds, its covers can be reached, and its
//! false twin fails with a panic in a named line. A time-out is unknown, never a pass.

pub mod check;
pub mod command;
pub mod composition;
pub mod engine;
pub mod harness;
pub mod ledger;
pub mod lemma;
pub mod native;
pub mod runner;
pub mod sources;
pub mod tools;
pub mod translate;
pub mod wasm;
