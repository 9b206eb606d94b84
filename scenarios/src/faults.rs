//! What goes wrong between the sensors and the kernel, applied to raw data on their way.

mod scan;

use std::collections::BTreeMap;

use haltline_robots::{Robot, Scanner};

use crate::drive::SetPoint;
use crate::file::Scenario;
use crate::file::fault::{FaultEntry, FaultKind};
use crate::math::{microseconds, seconds};
use crate::noise::{Noise, Stream};
use crate::odometry::RawOdometry;
use crate::proposer::RawCommand;
use crate::sensor::RawScan;

/// All faults of a scenario with what they remember.
#[derive(Clone, Debug)]
pub struct Faults {
    entries: Vec<FaultEntry>,
    noise: Noise,
    scanners: Vec<Scanner>,
    frozen: BTreeMap<usize, Vec<f32>>,
    scan_before: BTreeMap<usize, RawScan>,
    late_scans: Vec<(u64, RawScan)>,
    odometry_held: Option<RawOdometry>,
    odometry_past: Vec<RawOdometry>,
    commands_past: Vec<RawCommand>,
    late_commands: Vec<(u64, RawCommand)>,
    /// What the drive took last.
    taken: Option<SetPoint>,
}

impl Faults {
    /// The faults of a scenario with its robot.
    #[must_use]
    pub fn new(scenario: &Scenario, robot: &Robot) -> Self {
        Self {
            entries: scenario
                .fault
                .iter()
                .map(|entry| entry.get_ref().clone())
                .collect(),
            noise: Noise::new(scenario.seed, Stream::Fault),
            scanners: robot.values.scanners.clone(),
            frozen: BTreeMap::new(),
            scan_before: BTreeMap::new(),
            late_scans: Vec::new(),
            odometry_held: None,
            odometry_past: Vec::new(),
            commands_past: Vec::new(),
            late_commands: Vec::new(),
            taken: None,
        }
    }

    /// All entries.
    #[must_use]
    pub fn entries(&self) -> &[FaultEntry] {
        &self.entries
    }

    /// Start of the earliest fault.
    #[must_use]
    pub fn first_s(&self) -> Option<f64> {
        self.entries.iter().map(|e| e.from_s.get()).reduce(f64::min)
    }

    /// The active entry of a kind at `t_us`.
    #[must_use]
    pub fn active(&self, kind: FaultKind, t_us: u64) -> Option<&FaultEntry> {
        let t_s = seconds(t_us);
        self.entries.iter().find(|entry| {
            entry.kind == kind
                && t_s >= entry.from_s.get()
                && entry.until_s.is_none_or(|until| t_s < until.get())
        })
    }

    /// Origin of the host's clock: late enough that 32-bit stamps wrap when they should.
    #[must_use]
    pub fn clock_base_us(scenario: &Scenario) -> u64 {
        let wrap =
            |entry: &FaultEntry| (1_u64 << 32).saturating_sub(microseconds(entry.from_s.get()));
        let mut entries = scenario.fault.iter().map(toml::Spanned::get_ref);
        entries
            .find(|entry| entry.kind == FaultKind::ScanWrapped)
            .map_or(1_000_000, wrap)
    }

    fn offset_us(&self, kind: FaultKind, t_us: u64) -> Option<u64> {
        let entry = self.active(kind, t_us)?;
        Some(
            entry
                .offset_s
                .map_or(0, |offset| microseconds(offset.get())),
        )
    }

    /// Whether the kernel is called at `t_us`, and whether its adapter lives.
    #[must_use]
    pub fn host(&self, t_us: u64) -> (bool, bool) {
        let dead = self.active(FaultKind::HostDeath, t_us).is_some();
        let paused = self.active(FaultKind::HostPause, t_us).is_some();
        (!dead && !paused, !dead)
    }

    /// What a clock that should say `right_us` says at `t_us`.
    #[must_use]
    pub fn clock_us(&self, t_us: u64, right_us: u64) -> u64 {
        let jump = |kind| self.offset_us(kind, t_us).unwrap_or(0);
        (right_us + jump(FaultKind::ClockForwards)).saturating_sub(jump(FaultKind::ClockBackwards))
    }

    /// By how much the tick that is due at `t_us` comes late.
    pub fn tick_delay_us(&mut self, t_us: u64) -> u64 {
        let most = self.offset_us(FaultKind::HostJitter, t_us).unwrap_or(0);
        if most == 0 {
            return 0;
        }
        (self.noise.unit() * most as f64) as u64
    }

    /// What the drive takes of the set points that are sent to it.
    pub fn set_point(&mut self, t_us: u64, sent: SetPoint) -> SetPoint {
        let stuck = self.active(FaultKind::DriveStuck, t_us).is_some();
        let deaf = self.active(FaultKind::DriveIgnoresStop, t_us).is_some();
        let kept = self
            .taken
            .filter(|taken| stuck || (deaf && slower(sent, *taken)));
        *self.taken.insert(kept.unwrap_or(sent))
    }

    /// What reaches the kernel of an odometry sample that arrived by `t_us`.
    pub fn odometry(&mut self, t_us: u64, sample: RawOdometry) -> Option<RawOdometry> {
        let mut out = sample;
        if let Some(entry) = self.active(FaultKind::OdometryJump, t_us) {
            out.pose[0] += entry.jump_m.map_or(0.0, |v| v.get());
            out.pose[2] += entry.jump_deg.map_or(0.0, |v| v.get().to_radians());
        }
        let scaled = self.active(FaultKind::OdometryScaled, t_us);
        let factor = scaled.and_then(|entry| entry.factor).map(|f| f.get());
        let frozen = self.active(FaultKind::OdometryFrozen, t_us).is_some();
        let sign = self.active(FaultKind::OdometrySign, t_us).is_some();
        if frozen || sign || factor.is_some() {
            let held = *self.odometry_held.get_or_insert(sample);
            if frozen {
                out = RawOdometry {
                    stamp_us: sample.stamp_us,
                    ..held
                };
            } else if let Some(factor) = factor {
                out.twist = out.twist.map(|value| value * factor);
                for (value, origin) in out.pose.iter_mut().zip(held.pose) {
                    *value = origin + factor * (*value - origin);
                }
            } else {
                out.twist[0] = -out.twist[0];
                for (value, origin) in out.pose.iter_mut().zip(held.pose).take(2) {
                    *value = 2.0 * origin - *value;
                }
            }
        } else {
            self.odometry_held = None;
        }
        if self.active(FaultKind::OdometryNan, t_us).is_some() {
            out.pose = [f64::NAN; 3];
        }
        if let Some(offset) = self.offset_us(FaultKind::OdometryFuture, t_us) {
            out.stamp_us += offset;
        }
        let reordered = self.active(FaultKind::OdometryReordered, t_us).is_some();
        let missing = self.active(FaultKind::OdometryMissing, t_us).is_some();
        let older = every_second(&mut self.odometry_past, out, reordered);
        (!missing).then_some(older)
    }

    /// What reaches the kernel of a command issued at `t_us`, and of those held back.
    pub fn command(&mut self, t_us: u64, command: RawCommand) -> Option<RawCommand> {
        let mut out = command;
        if self.active(FaultKind::CommandNan, t_us).is_some() {
            out.motion = match out.motion {
                SetPoint::Twist { omega, .. } => SetPoint::Twist { v: f64::NAN, omega },
                SetPoint::Arc { curvature, .. } => SetPoint::Arc {
                    v: f64::NAN,
                    curvature,
                },
            };
        }
        if let Some(offset) = self.offset_us(FaultKind::CommandFuture, t_us) {
            out.stamp_us += offset;
        }
        let reordered = self.active(FaultKind::CommandReordered, t_us).is_some();
        let out = every_second(&mut self.commands_past, out, reordered);
        let missing = self.active(FaultKind::CommandMissing, t_us).is_some();
        let late = self.offset_us(FaultKind::CommandLate, t_us);
        let mut arrived = None;
        match late {
            Some(offset) => self.late_commands.push((t_us + offset, out)),
            None if !missing => arrived = Some(out),
            None => {}
        }
        due(&mut self.late_commands, t_us).pop().or(arrived)
    }
}

/// Whether one set point asks for less of speed or turn rate than another.
fn slower(one: SetPoint, other: SetPoint) -> bool {
    one.speed().abs() < other.speed().abs() || one.turn_rate().abs() < other.turn_rate().abs()
}

/// Takes out what is due by `t_us`, oldest first.
fn due<T>(waiting: &mut Vec<(u64, T)>, t_us: u64) -> Vec<T> {
    let (ready, rest): (Vec<_>, Vec<_>) = waiting.drain(..).partition(|(when, _)| *when <= t_us);
    *waiting = rest;
    ready.into_iter().map(|(_, item)| item).collect()
}

/// Replaces every second value by the one three places before it while `active`.
fn every_second<T: Copy>(past: &mut Vec<T>, value: T, active: bool) -> T {
    past.push(value);
    let count = past.len();
    if active && count.is_multiple_of(2) && count > 3 {
        past.get(count - 4).copied().unwrap_or(value)
    } else {
        value
    }
}

#[cfg(test)]
mod tests;
