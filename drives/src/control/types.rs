//! What goes in and out of the loop.

use std::any::Any;
use std::fmt;
use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use haltline::decision::Decision;
use haltline::time::Instant;
use haltline_scenarios::controller::TickInputs;

use crate::drive::{DriveError, Feedback, State};
use crate::eye::ScanFault;

/// What a proposer sees.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Now.
    pub now: Instant,
    /// Newest feedback.
    pub feedback: Feedback,
    /// The kernel's last decision.
    pub decision: Option<Decision>,
}

/// One tick, for status lines and traces.
#[derive(Clone, Copy, Debug)]
pub struct Tick<'a> {
    /// What the kernel was given.
    pub inputs: &'a TickInputs,
    /// When it was.
    pub now: Instant,
    /// What the kernel decided.
    pub decision: Decision,
    /// How far the adapter is.
    pub state: State,
    /// Newest feedback.
    pub feedback: Feedback,
    /// What the adapter objected to since the last tick.
    pub fault: Option<DriveError>,
    /// What was wrong with a scan since the last tick.
    pub scan_fault: Option<ScanFault>,
    /// So far.
    pub account: Account,
}

/// One screen: what is decided and why, where the robot is, what went wrong so far.
impl fmt::Display for Tick<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Decision {
            action,
            reason,
            status,
            ..
        } = self.decision;
        let [x, y, theta] = self.feedback.pose;
        let [v, w] = self.feedback.twist;
        let age_ms = self
            .now
            .since(self.feedback.stamp)
            .unwrap_or_default()
            .as_us()
            / 1000;
        writeln!(out, "drive     {:?}", self.state)?;
        writeln!(out, "decision  {action:?}: {reason:?} ({status:?})")?;
        writeln!(out, "set point {:?}", self.decision.setpoint)?;
        writeln!(out, "measured  {v:+.3} m/s {w:+.3} rad/s, {age_ms} ms old")?;
        writeln!(
            out,
            "pose      {x:+.3} m {y:+.3} m {:+.1} deg",
            theta.to_degrees()
        )?;
        if let Some(battery_v) = self.feedback.battery_v {
            writeln!(out, "battery   {battery_v:.1} V")?;
        }
        let Account {
            ticks,
            missed,
            latest_us,
            reconnections,
            faults,
        } = self.account;
        writeln!(
            out,
            "deadlines {missed} of {ticks} missed, latest {:.1} ms; {reconnections} reconnections, {faults} faults",
            latest_us as f64 * 1e-3
        )?;
        if let Some(fault) = self.fault {
            writeln!(out, "drive says   {fault}")?;
        }
        if let Some(fault) = self.scan_fault {
            writeln!(out, "scanner says {fault}")?;
        }
        Ok(())
    }
}

/// Deadlines and incidents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Account {
    /// Ticks so far.
    pub ticks: u64,
    /// Ticks that came later than period and jitter after the one before; the kernel stops for each.
    pub missed: u64,
    /// Latest tick, µs after its time.
    pub latest_us: u64,
    /// Links lost and opened again.
    pub reconnections: u64,
    /// Faults reported by the adapter.
    pub faults: u64,
}

/// How a drive ended. The last word on the wire was a stop in every case but the last.
#[derive(Debug)]
pub enum Ending {
    /// `end` was set: Ctrl-C, a signal, or the caller.
    Asked,
    /// The proposer has nothing more to propose.
    Finished,
    /// Something panicked; its payload.
    Panicked(Box<dyn Any + Send>),
    /// The link was lost and the farewell did not reach the robot: its own watchdog stops it.
    Unreachable,
}

/// What the caller wants to happen at the next tick.
#[derive(Debug, Default)]
pub struct Operator {
    /// Leave.
    pub end: Arc<AtomicBool>,
    /// Reset the kernel and switch the motors on; taken once.
    pub reset: AtomicBool,
    /// Emergency stop line.
    pub emergency: AtomicBool,
}

impl Operator {
    /// An operator whose `end` is set by Ctrl-C and by SIGTERM.
    ///
    /// # Errors
    /// The handlers cannot be installed.
    pub fn with_signals() -> io::Result<Self> {
        let operator = Self::default();
        for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
            signal_hook::flag::register(signal, Arc::clone(&operator.end))?;
        }
        Ok(operator)
    }
}
