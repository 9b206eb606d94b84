//! CoLa ASCII of the SICK LMS1xx: the few telegrams that start a scan stream and carry it.
//!
//! `STX text ETX`, words separated by single spaces, numbers hexadecimal without leading zeros or
//! signed decimal with an explicit sign. Source: SICK, Telegram Listing Ranging Sensors
//! (LMDscandata, sEN, sRN), and its worked example.
#![deny(
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap
)]

mod clock;
mod frame;
mod scan;

pub use clock::ClockMap;
pub use frame::{Deframer, TelegramError, frame_into};
pub use scan::{Header, RANGES_MAX, ScanTelegram, decode_scan, header_text};

/// TCP port of a scanner.
pub const TCP_PORT: u16 = 2111;

/// Asks for a stream of scans.
pub const STREAM_START: &str = "sEN LMDscandata 1";
/// Ends the stream.
pub const STREAM_STOP: &str = "sEN LMDscandata 0";
/// Asks for one scan.
pub const POLL: &str = "sRN LMDscandata";
/// Straight ahead in the scanner's own angles, 1/10000 deg.
pub const AHEAD: i32 = 900_000;
