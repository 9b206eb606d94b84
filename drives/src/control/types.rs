//! What goes in and out of the loop.

use std::any::Any;
use std::fmt;
use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use haltline::decision::{Decision, Reason, StopStatus};
use haltline::input::Motion;
use haltline::time::Instant;
use haltline_scenarios::controller::TickInputs;
use haltline_scenarios::navigation::Said;

use crate::drive::{DriveError, Feedback, State};
use crate::eye::ScanFault;

/// What a proposer wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wish {
    /// This motion, m/s with rad/s, or with 1/m for a steered robot, wanted at that moment. The
    /// kernel refuses it once it is too old.
    Motion(Instant, [f64; 2]),
    /// Nothing: for lack of a command the kernel stops.
    Nothing,
    /// The drive ends.
    End,
}

/// What a proposer sees.
#[derive(Clone, Debug)]
pub struct View {
    /// Now.
    pub now: Instant,
    /// Newest feedback.
    pub feedback: Feedback,
    /// The kernel's last decision.
    pub decision: Option<Decision>,
    /// What the kernel last said of its own route, if it has one.
    pub said: Option<Said>,
}

/// One tick, for status lines and traces.
#[derive(Clone, Debug)]
pub struct Tick<'a> {
    /// What the kernel was given.
    pub inputs: &'a TickInputs,
    /// When it was.
    pub now: Instant,
    /// What the kernel decided.
    pub decision: Decision,
    /// What the kernel says of its own route, if it has one.
    pub said: Option<Said>,
    /// How far the adapter is.
    pub state: State,
    /// A reset is under way.
    pub resetting: bool,
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
        write!(out, "decision  {action:?}")?;
        if reason != Reason::None {
            write!(out, " for {reason:?}")?;
        }
        if let Some([x, y]) = self.blocked() {
            write!(out, ", point {x:+.2} m ahead, {y:+.2} m left")?;
        }
        writeln!(out, " ({status:?})")?;
        if let Some(said) = &self.said {
            let reason = said.progress.reason.as_deref().unwrap_or_default();
            writeln!(out, "route     {} {reason}", said.progress.kind)?;
        }
        writeln!(out, "set point {}", Words(self.decision.setpoint))?;
        if let Some(tube) = self.decision.verdict.filter(|v| v.refusal.is_none()) {
            writeln!(
                out,
                "tube      {:.3} m to rest, {:.2} s, margin {:.3} m",
                f64::from(tube.stopping_path.as_um()) * 1e-6,
                tube.stopping_time.as_us() as f64 * 1e-6,
                f64::from(tube.budget.total().as_um()) * 1e-6
            )?;
        }
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

impl Tick<'_> {
    /// The point that decided against a motion, metres from the rotation centre.
    fn blocked(&self) -> Option<[f64; 2]> {
        let verdict = self.decision.verdict.filter(|it| it.refusal.is_some())?;
        let point = verdict.point?;
        Some([point.x_mm, point.y_mm].map(|mm| f64::from(mm) * 1e-3))
    }

    /// Whether nothing moves before the operator resets: the stop is latched, or the drive's motors
    /// are off and nobody asks for them.
    #[must_use]
    pub fn waits_for_operator(&self) -> bool {
        let off = self.state == State::Disabled && !self.resetting;
        off || (self.decision.status == StopStatus::Latched && !self.resetting)
    }
}

/// A motion in words.
struct Words(Motion);

impl fmt::Display for Words {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (linear, turn, unit) = match self.0 {
            Motion::Twist(twist) => (twist.linear, twist.angular.as_urad_per_s(), "rad/s"),
            Motion::Arc { linear, curvature } => (linear, curvature.as_urad_per_m(), "/m"),
        };
        write!(
            out,
            "{:+.3} m/s {:+.3} {unit}",
            f64::from(linear.as_um_per_s()) * 1e-6,
            f64::from(turn) * 1e-6
        )
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
    /// Faults reported by the adapter; one that stays is counted once.
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
    pub reset: Arc<AtomicBool>,
    /// Emergency stop line.
    pub emergency: AtomicBool,
}

impl Operator {
    /// An operator whose `end` is set by Ctrl-C, Ctrl-\\, SIGTERM and the loss of the terminal, and
    /// `reset` by SIGUSR1.
    ///
    /// # Errors
    /// The handlers cannot be installed.
    pub fn with_signals() -> io::Result<Self> {
        let operator = Self::default();
        use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
        for signal in [SIGINT, SIGTERM, SIGHUP, SIGQUIT] {
            signal_hook::flag::register(signal, Arc::clone(&operator.end))?;
        }
        let reset = Arc::clone(&operator.reset);
        signal_hook::flag::register(signal_hook::consts::SIGUSR1, reset)?;
        Ok(operator)
    }
}
