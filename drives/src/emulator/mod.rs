//! Robots that are not there: the far ends of the wires, with dynamics, watchdogs and faults.
//!
//! Written from the fact sheets and not from the adapters; a client of somebody else's must find
//! the same robot. [`Seekur`] and [`Car`] are state machines with time as an argument, [`process`]
//! puts them behind a pseudo-terminal or a socket, [`scanner`] lets their surroundings be seen.

mod board;
mod car;
mod daq;
mod motion;
pub mod process;
pub mod scanner;
mod seekur;

pub use car::{Car, CarModel};
pub use motion::Truth;
pub use seekur::{OutOfOrder, Seekur, SeekurModel};

/// How the emulators read their wires, for those who listen in.
pub(crate) mod wire {
    pub(crate) use super::car::{steady_speed, wheel_angle};
    pub(crate) use super::seekur::Ear;
}

use haltline::time::Instant;

/// A robot behind a byte stream.
pub trait Robot {
    /// Takes bytes from the host.
    fn receive(&mut self, bytes: &[u8], now: Instant);

    /// Lets the robot live until `now`.
    fn step(&mut self, now: Instant);

    /// Bytes for the host since the last call.
    fn outgoing(&mut self) -> Vec<u8>;

    /// Where it really is.
    fn truth(&self) -> Truth;

    /// Switches it off and on again: everything volatile is lost, it rolls on.
    fn reboot(&mut self, now: Instant);

    /// When the host last spoke as the watchdog understands it, and where the robot was then.
    fn last_heard(&self) -> (Instant, Truth);

    /// Someone pushes against a bumper or lets go of it.
    fn bump(&mut self, touching: bool);

    /// Someone presses its STOP button or releases it, if it has one.
    fn press_stop(&mut self, pressed: bool);

    /// The host's connection is a new one.
    fn reopened(&mut self);
}
