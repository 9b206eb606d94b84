//! The report: everything the certificate says, drawn.

mod actors;
pub mod cases;
pub mod claims;
pub mod contract;
pub mod drawing;
pub mod page;
pub mod proofs;
pub mod robot;
mod sweeps;
pub mod words;

#[cfg(test)]
mod tests;
