//! The shipped files parse to the pinned figures; every rule refuses what it should.

mod change;
mod contract;
mod conversion;
mod refusals;
mod shipped;
mod template;
