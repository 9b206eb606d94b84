//! A navigation safety kernel: `no_std`, allocation-free, bounded-time, without `unsafe`.
//= spec/time.md#time-02
//# A tick MUST NOT panic, allocate or recurse.
//= spec/time.md#time-03
//# The kernel MUST contain no unsafe code.
#![no_std]
// Tests may compute as they like; what they test may not.
#![cfg_attr(
    test,
    allow(
        clippy::arithmetic_side_effects,
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        clippy::cast_sign_loss,
        clippy::std_instead_of_core
    )
)]
#[cfg(test)]
extern crate std;

#[doc(hidden)]
pub mod arith;
pub mod checked;
pub mod config;
pub mod convert;
pub mod decision;
pub mod dwa;
pub mod geometry;
pub mod grid;
pub mod guard;
pub mod input;
pub mod kernel;
pub mod marker;
pub mod odometry;
pub mod pipeline;
pub mod stop;
pub mod time;
pub mod units;
pub mod watch;
pub mod window;

pub use checked::ConfigError;
pub use kernel::Kernel;
pub use kernel::navigate::Navigator;
