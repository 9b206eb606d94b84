//! The report: everything the certificate says, drawn.

pub mod drawing;
pub mod words;
