//! Faults injected between the sensors and the kernel, one at a time, at random moments.

use super::tamper::Raw;
use haltline::convert;
use haltline::input::{Beam, Reading};
use haltline::time::{Duration, Instant};
use haltline_spec::draw::Draw;

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    ScanDrop,
    ScanFuture,
    ScanOld,
    ScanMalformed,
    ScanShort,
    ScanInvalid,
    ScanGap,
    ScanForeign,
    ScanFrozen,
    OdometryDrop,
    OdometryFuture,
    OdometryOld,
    OdometryMalformed,
    OdometryJump,
    CommandDrop,
    CommandFuture,
    CommandOld,
    CommandMalformed,
    Emergency,
    Pause,
    TimeReverse,
}

pub const ALL: [Fault; 21] = [
    Fault::ScanDrop,
    Fault::ScanFuture,
    Fault::ScanOld,
    Fault::ScanMalformed,
    Fault::ScanShort,
    Fault::ScanInvalid,
    Fault::ScanGap,
    Fault::ScanForeign,
    Fault::ScanFrozen,
    Fault::OdometryDrop,
    Fault::OdometryFuture,
    Fault::OdometryOld,
    Fault::OdometryMalformed,
    Fault::OdometryJump,
    Fault::CommandDrop,
    Fault::CommandFuture,
    Fault::CommandOld,
    Fault::CommandMalformed,
    Fault::Emergency,
    Fault::Pause,
    Fault::TimeReverse,
];

/// Injects faults; keeps what it needs of the past.
#[derive(Default)]
pub struct Injector {
    pub active: Option<(Fault, usize)>,
    frozen: Option<Vec<Beam>>,
    before: Option<Instant>,
}

const SECOND: Duration = Duration::from_ms(1000);

impl Injector {
    /// Starts, continues or ends a fault; returns how late the next tick comes, µs.
    pub fn turn(&mut self, draw: &mut Draw) -> u64 {
        self.active = match self.active {
            Some((fault, left)) if left > 1 => Some((fault, left - 1)),
            Some(_) => None,
            None if draw.chance(0.03) => Some(begin(draw)),
            None => None,
        };
        match self.active {
            Some((Fault::Pause, _)) => 120_000,
            _ => 0,
        }
    }

    /// Changes the tick's inputs.
    pub fn alter(&mut self, raw: &mut Raw, draw: &mut Draw) {
        if let Some((fault, _)) = self.active {
            self.spoil_scans(fault, raw, draw);
            spoil_odometry(fault, raw);
            spoil_command(fault, raw);
            match fault {
                Fault::Emergency => raw.emergency_stop = true,
                Fault::TimeReverse => {
                    raw.now = self
                        .before
                        .map_or(raw.now, |then| then.minus(Duration::from_ms(5)));
                }
                _ => {}
            }
        }
        self.before = Some(self.before.map_or(raw.now, |then| then.max(raw.now)));
    }

    fn spoil_scans(&mut self, fault: Fault, raw: &mut Raw, draw: &mut Draw) {
        if fault == Fault::ScanDrop {
            raw.scans.clear();
        }
        for scan in &mut raw.scans {
            let count = scan.beams.len();
            match fault {
                Fault::ScanFuture => scan.stamp = scan.stamp.plus(SECOND),
                Fault::ScanOld => scan.stamp = scan.stamp.minus(SECOND),
                Fault::ScanMalformed => scan.malformed = true,
                Fault::ScanShort => scan.beams.truncate(count - 1),
                Fault::ScanInvalid => {
                    for beam in &mut scan.beams {
                        if draw.chance(0.25) {
                            *beam = Beam::Invalid;
                        }
                    }
                }
                Fault::ScanGap => {
                    // 9 % of at least 270 degrees: within the fraction, but wider than the gap.
                    let from = draw.index(count * 9 / 10);
                    for beam in scan.beams.iter_mut().skip(from).take(count * 9 / 100) {
                        *beam = Beam::Invalid;
                    }
                }
                Fault::ScanForeign => scan.scanner = 1,
                Fault::ScanFrozen => {
                    let frozen = self.frozen.get_or_insert_with(|| scan.beams.clone());
                    scan.beams.clone_from(frozen);
                }
                _ => {}
            }
        }
        if fault != Fault::ScanFrozen {
            self.frozen = None;
        }
    }
}

fn begin(draw: &mut Draw) -> (Fault, usize) {
    let fault = ALL[draw.index(ALL.len())];
    let ticks = match fault {
        Fault::Pause | Fault::Emergency | Fault::OdometryJump | Fault::TimeReverse => 1,
        Fault::ScanFrozen => 40,
        _ => 1 + draw.index(12),
    };
    (fault, ticks)
}

fn spoil_odometry(fault: Fault, raw: &mut Raw) {
    match (fault, &mut raw.odometry) {
        (Fault::OdometryDrop, reading) => *reading = Reading::Absent,
        (Fault::OdometryFuture, Reading::Value(odometry)) => {
            odometry.stamp = odometry.stamp.plus(SECOND);
        }
        (Fault::OdometryOld, Reading::Value(odometry)) => {
            odometry.stamp = odometry.stamp.minus(SECOND);
        }
        (Fault::OdometryMalformed, reading) => {
            *reading = convert::odometry(raw.now, [0.0, f64::NAN, 0.0], [0.0; 2], None);
        }
        (Fault::OdometryJump, Reading::Value(odometry)) => odometry.pose.x_um += 3_000_000,
        _ => {}
    }
}

fn spoil_command(fault: Fault, raw: &mut Raw) {
    match (fault, &mut raw.command) {
        (Fault::CommandDrop, reading) => *reading = Reading::Absent,
        (Fault::CommandFuture, Reading::Value(command)) => {
            command.stamp = command.stamp.plus(SECOND);
        }
        (Fault::CommandOld, Reading::Value(command)) => {
            command.stamp = command.stamp.minus(SECOND);
        }
        (Fault::CommandMalformed, reading) => {
            *reading = convert::twist_command(raw.now, f64::INFINITY, 0.0);
        }
        _ => {}
    }
}
