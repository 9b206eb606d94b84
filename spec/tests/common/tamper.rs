//! Somebody between the sensors and the kernel.

use super::run::Truth;
use haltline::decision::Decision;
use haltline::input::{Beam, Command, Odometry, Reading};
use haltline::time::Instant;
use haltline_spec::draw::Draw;
use haltline_spec::plant::SetPoint;

/// One scan as the kernel will get it.
#[derive(Clone, Debug)]
pub struct RawScan {
    pub scanner: usize,
    pub stamp: Instant,
    pub beams: Vec<Beam>,
    pub malformed: bool,
}

/// Everything one tick hands to the kernel.
#[derive(Clone, Debug)]
pub struct Raw {
    pub now: Instant,
    pub scans: Vec<RawScan>,
    pub odometry: Reading<Odometry>,
    pub command: Reading<Command>,
    pub emergency_stop: bool,
    pub reset: Option<Instant>,
}

/// What is true at a tick, for those who judge it.
#[derive(Clone, Debug)]
pub struct Scene<'a> {
    pub raw: &'a Raw,
    pub decision: &'a Decision,
    pub set_point: SetPoint,
    /// True speeds for the last 100 ms, newest last.
    pub recent: &'a [Truth],
}

/// Somebody between the sensors and the kernel, who also sees what comes of it.
pub trait Tamper {
    /// How much later than planned the next tick comes, µs.
    fn pause_us(&mut self, _draw: &mut Draw) -> u64 {
        0
    }
    /// Changes what the kernel gets.
    fn alter(&mut self, _raw: &mut Raw, _draw: &mut Draw) {}
    /// Sees the answer; a returned text is a broken rule.
    fn judge(&mut self, _scene: &Scene<'_>) -> Option<String> {
        None
    }
}

/// Nobody.
pub struct Untouched;

impl Tamper for Untouched {}
