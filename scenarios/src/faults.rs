//! What goes wrong between the sensors and the kernel, applied to raw data on their way.

use std::collections::BTreeMap;

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
    frozen: BTreeMap<usize, Vec<f32>>,
    scan_before: BTreeMap<usize, RawScan>,
    late_scans: Vec<(u64, RawScan)>,
    odometry_held: Option<RawOdometry>,
    odometry_past: Vec<RawOdometry>,
    commands_past: Vec<RawCommand>,
    late_commands: Vec<(u64, RawCommand)>,
}

impl Faults {
    /// The faults of a scenario.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        Self {
            entries: scenario
                .fault
                .iter()
                .map(|entry| entry.get_ref().clone())
                .collect(),
            noise: Noise::new(scenario.seed, Stream::Fault),
            frozen: BTreeMap::new(),
            scan_before: BTreeMap::new(),
            late_scans: Vec::new(),
            odometry_held: None,
            odometry_past: Vec::new(),
            commands_past: Vec::new(),
            late_commands: Vec::new(),
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
    pub fn clock_base_us(&self) -> u64 {
        let wrap =
            |entry: &FaultEntry| (1_u64 << 32).saturating_sub(microseconds(entry.from_s.get()));
        self.entries
            .iter()
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

    /// How far the host's clock has jumped back at `t_us`.
    #[must_use]
    pub fn clock_back_us(&self, t_us: u64) -> u64 {
        self.offset_us(FaultKind::ClockBackwards, t_us).unwrap_or(0)
    }

    /// What reaches the kernel of the scans that arrived by `t_us`.
    pub fn scans(&mut self, t_us: u64, arrived: Vec<RawScan>) -> Vec<RawScan> {
        let mut out = Vec::new();
        for mut scan in arrived {
            self.spoil_ranges(t_us, &mut scan);
            if self.active(FaultKind::ScanShort, t_us).is_some() {
                let half = scan.ranges_m.len() / 2;
                scan.ranges_m.truncate(half);
                scan.bodies.truncate(half);
            }
            self.freeze(t_us, &mut scan);
            if self.active(FaultKind::ScanWrapped, t_us).is_some() {
                scan.stamp_us &= 0xFFFF_FFFF;
            }
            if let Some(offset) = self.offset_us(FaultKind::ScanFuture, t_us) {
                scan.stamp_us += offset;
            }
            let before = self.scan_before.insert(scan.scanner, scan.clone());
            if self.active(FaultKind::ScanMissing, t_us).is_some() {
                continue;
            }
            if let Some(offset) = self.offset_us(FaultKind::ScanLate, t_us) {
                self.late_scans.push((t_us + offset, scan));
                continue;
            }
            out.push(scan);
            if self.active(FaultKind::ScanReordered, t_us).is_some() {
                out.extend(before);
            }
        }
        out.extend(due(&mut self.late_scans, t_us));
        out
    }

    fn spoil_ranges(&mut self, t_us: u64, scan: &mut RawScan) {
        const SPOILERS: [(FaultKind, f32); 4] = [
            (FaultKind::RangesNan, f32::NAN),
            (FaultKind::RangesInfinite, f32::INFINITY),
            (FaultKind::RangesZero, 0.0),
            (FaultKind::RangesNegative, -1.0),
        ];
        let lost = (FaultKind::BeamsLost, 0.0);
        for (kind, value) in SPOILERS.into_iter().chain([lost]) {
            let Some(part) = self
                .active(kind, t_us)
                .map(|entry| entry.fraction.map_or(1.0, |f| f.get()))
            else {
                continue;
            };
            for (range, body) in scan.ranges_m.iter_mut().zip(&mut scan.bodies) {
                if self.noise.unit() < part {
                    *range = value;
                    *body = None;
                }
            }
        }
    }

    fn freeze(&mut self, t_us: u64, scan: &mut RawScan) {
        if self.active(FaultKind::ScanFrozen, t_us).is_some() {
            let held = self
                .frozen
                .entry(scan.scanner)
                .or_insert_with(|| scan.ranges_m.clone());
            scan.ranges_m.clone_from(held);
            scan.bodies.fill(None);
        } else {
            self.frozen.remove(&scan.scanner);
        }
    }

    /// What reaches the kernel of an odometry sample that arrived by `t_us`.
    pub fn odometry(&mut self, t_us: u64, sample: RawOdometry) -> Option<RawOdometry> {
        let mut out = sample;
        if let Some(entry) = self.active(FaultKind::OdometryJump, t_us) {
            out.pose[0] += entry.jump_m.map_or(0.0, |v| v.get());
            out.pose[2] += entry.jump_deg.map_or(0.0, |v| v.get().to_radians());
        }
        let frozen = self.active(FaultKind::OdometryFrozen, t_us).is_some();
        let sign = self.active(FaultKind::OdometrySign, t_us).is_some();
        if frozen || sign {
            let held = *self.odometry_held.get_or_insert(sample);
            if frozen {
                out = RawOdometry {
                    stamp_us: sample.stamp_us,
                    ..held
                };
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
        use crate::drive::SetPoint;
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
