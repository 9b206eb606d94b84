//! ARCOS, the client-server protocol of the Pioneer family and the Seekur Jr: bytes only.
//!
//! [`frame`] finds packets in a stream, [`command`] is what a client says, [`sip`], [`config`] and
//! [`server`] what a robot says. Everything is pure and total in both directions, so that client
//! and emulator can each be held to the same sheet and not to each other.
#![deny(
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap
)]

pub mod command;
pub mod config;
pub mod frame;
pub mod server;
pub mod sip;

pub use command::{Argument, Command};
pub use frame::{Deframer, FrameError, Packet};
pub use sip::Sip;

/// TCP port of a robot server.
pub const TCP_PORT: u16 = 8101;

/// Nobody sends commands faster than this, milliseconds (H8 manual: one in 3 to 5 ms).
pub const COMMAND_SPACING_MS: u64 = 5;

/// Watchdog of a robot as it leaves the factory, milliseconds.
pub const WATCHDOG_DEFAULT_MS: u16 = 2000;

/// Speed of one count of a VEL2 side, mm/s.
pub const VEL2_DIVISOR: i32 = 20;
