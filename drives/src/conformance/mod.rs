//! The suite every adapter must pass against its robot, and broken adapters it must catch.
//!
//! Runs in virtual time: adapter and robot are state machines, the wire between them is a list of
//! bytes that can be cut, spoiled and listened to. What is judged is what a listener on the wire
//! hears, not what the adapter says of itself.

pub mod attack;
mod bench;
mod checks;
pub mod clients;
mod curves;
mod hostile;
mod own;
mod ranges;
mod rig;
mod silence;
mod taps;
mod twins;

pub use bench::{Bench, CarBench, SeekurBench};
pub use curves::speed_and_steering;
pub use own::FileBench;
pub use rig::Rig;
pub use taps::{Tap, Told};
pub use twins::{TWINS, Twin};

/// A demand that was not met.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// The requirement, for instance `DRIVE-02`.
    pub requirement: &'static str,
    /// What was seen.
    pub seen: String,
}

/// One check of the suite.
#[derive(Clone, Copy, Debug)]
pub struct Check {
    /// Short name.
    pub name: &'static str,
    /// Requirements it looks at.
    pub requirements: &'static [&'static str],
    /// Runs it; the text says what was measured.
    pub run: fn(&dyn Bench, Option<Twin>) -> Result<String, Failure>,
}

/// All checks.
pub const CHECKS: &[Check] = &[
    Check {
        name: "no motion before handshake and enable",
        requirements: &["DRIVE-01"],
        run: checks::start,
    },
    Check {
        name: "stop on the wire within one period, as a ramp on the same curvature",
        requirements: &["DRIVE-04", "DRIVE-05"],
        run: checks::stop,
    },
    Check {
        name: "zero first after gaps, pauses, reconnections and reboots",
        requirements: &["DRIVE-02", "DRIVE-03"],
        run: checks::zero_first,
    },
    Check {
        name: "saturation keeps the curvature",
        requirements: &["DRIVE-06"],
        run: ranges::saturation,
    },
    Check {
        name: "sign and scale over the whole range",
        requirements: &["DRIVE-07", "DRIVE-08"],
        run: ranges::scale,
    },
    Check {
        name: "feedback has the sign and scale of the motion",
        requirements: &["DRIVE-07"],
        run: ranges::feedback,
    },
    Check {
        name: "the robot rests in time when its host falls silent",
        requirements: &["DRIVE-14"],
        run: silence::host_death,
    },
    Check {
        name: "hostile bytes never move the robot",
        requirements: &["DRIVE-09"],
        run: hostile::bytes,
    },
];
