//! The text protocol of the model car's control board (`ucboard`): bytes only.
//!
//! [`mod@line`] finds messages in both directions, [`command`] is what a host says and how a board
//! reads it, [`reply`] what a board answers, [`daq`] the data it streams. Pure and total.
#![deny(
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap
)]

pub mod command;
pub mod daq;
pub mod line;
pub mod reply;

/// Speed of the USB link, baud.
pub const BAUD: u32 = 921_600;

/// Longest time a board takes to answer, milliseconds (the authors' own bridge waits as long).
pub const ANSWER_MS: u64 = 100;

/// Forward levels: below zero brakes, above drives.
pub const FORWARD: core::ops::RangeInclusive<i16> = -500..=1000;
/// Reverse levels.
pub const REVERSE: core::ops::RangeInclusive<i16> = 0..=500;
/// Steering levels; positive is a longer pulse and steers **right**.
pub const STEERING: core::ops::RangeInclusive<i16> = -1000..=1000;

/// Errors of the board (`errcodes.h`) that an adapter can do something about.
#[allow(missing_docs)] // the names are the firmware's
pub mod error {
    pub const UNKNOWN: u16 = 1;
    pub const WRONG_START: u16 = 258;
    pub const TOO_LONG: u16 = 259;
    pub const OVERRUN: u16 = 260;
    pub const WRONG_USAGE: u16 = 261;
    pub const READ_ONLY: u16 = 262;
    pub const WRITE_ONLY: u16 = 263;
    pub const UNKNOWN_COMMAND: u16 = 264;
    pub const OUT_OF_RANGE: u16 = 266;
    pub const PARSE: u16 = 268;
    pub const CORRUPTED: u16 = 269;
    pub const INVALID_PARAMETER: u16 = 1025;
    pub const INVALID_CHANNEL: u16 = 1027;
    pub const UNKNOWN_PARAMETER: u16 = 1028;
    pub const UNKNOWN_PACKAGE: u16 = 1031;
    pub const REDEFINE_ACTIVE: u16 = 1032;
}
