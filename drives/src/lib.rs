//! Drives: from a decision of the kernel to bytes on a robot's wire, and back.
//!
//! Bottom up: [`arcos`], [`uc`] and [`cola`] are the wire formats, pure and total; [`drive`] is
//! what an adapter promises; [`seekur`] and [`car`] are the adapters, state machines that are
//! handed bytes and time and never block. None of these needs `std`. With the feature `std` (the
//! default) come links, emulators, the conformance suite and the loop that drives a robot.
//!
//! Refused here: interpreting what is not understood. A frame that does not parse is an error
//! with the frame in it, and never a motion.
#![cfg_attr(not(feature = "std"), no_std)]

pub mod arcos;
pub mod car;
#[cfg(feature = "std")]
pub mod clock;
pub mod cola;
#[cfg(feature = "std")]
pub mod conformance;
#[cfg(feature = "std")]
pub mod control;
mod cursor;
pub use cursor::Buffer;
pub mod drive;
#[cfg(feature = "std")]
pub mod emulator;
#[cfg(feature = "std")]
pub mod eye;
#[cfg(feature = "std")]
pub mod goal;
pub mod governor;
#[cfg(feature = "std")]
pub mod link;
#[cfg(feature = "std")]
pub mod measure;
#[cfg(feature = "std")]
pub mod robots;
pub mod seekur;
#[cfg(feature = "std")]
pub mod trace;
pub mod uc;
