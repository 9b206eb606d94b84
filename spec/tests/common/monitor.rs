//! Judges every decision by what the kernel was given: when it must not have accepted a motion.
//!
//! Written from the requirements alone; it keeps its own record of stamps.

use super::episode::Episode;
use super::faults::Injector;
use super::tamper::{Raw, RawScan, Scene, Tamper};
use haltline::decision::{Action, StopStatus};
use haltline::input::{Beam, Reading};
use haltline::time::Instant;
use haltline_spec::draw::Draw;
use std::collections::BTreeMap;

/// The record of one episode.
pub struct Monitor<'e> {
    episode: &'e Episode,
    injector: Injector,
    now: Option<Instant>,
    scan: Option<Instant>,
    scan_content: Vec<Beam>,
    content_at: [f64; 3],
    odometry: Option<(Instant, i64, i64)>,
    command: Option<Instant>,
    command_usable: bool,
    status: StopStatus,
    /// When the latch was set or renewed.
    latched_at: Instant,
    released_at: Instant,
    hazard_at: Option<Instant>,
    /// Ticks in which a rule had to stop a running robot, per rule.
    pub exercised: BTreeMap<&'static str, usize>,
    pub releases: usize,
}

/// What forbids motion in a tick.
#[derive(Default)]
struct Objections {
    /// Calls for a stop.
    hazards: Vec<&'static str>,
    /// Calls for braking.
    commands: Vec<&'static str>,
}

impl<'e> Monitor<'e> {
    pub fn new(episode: &'e Episode) -> Self {
        Self {
            episode,
            injector: Injector::default(),
            now: None,
            scan: None,
            scan_content: Vec::new(),
            content_at: [0.0; 3],
            odometry: None,
            command: None,
            command_usable: false,
            status: StopStatus::Latched,
            latched_at: Instant::default(),
            released_at: Instant::default(),
            hazard_at: None,
            exercised: BTreeMap::new(),
            releases: 0,
        }
    }

    /// Age of a stamp in µs; future stamps count as infinitely old.
    fn age_us(now: Instant, stamp: Option<Instant>) -> u64 {
        stamp
            .and_then(|stamp| now.since(stamp))
            .map_or(u64::MAX, |age| age.as_us())
    }

    fn clock(&mut self, raw: &Raw, found: &mut Objections) -> Instant {
        let tick_us = (self.episode.period_ms + self.episode.jitter_ms) * 1000;
        match self.now.map(|before| raw.now.since(before)) {
            Some(None) => found.hazards.push("SILENT-03"),
            Some(Some(step)) if step.as_us() == 0 => found.hazards.push("SILENT-03"),
            Some(Some(step)) if step.as_us() > tick_us => found.hazards.push("SILENT-02"),
            _ => {}
        }
        let now = self.now.map_or(raw.now, |before| before.max(raw.now));
        self.now = Some(now);
        now
    }

    fn odometry(&mut self, raw: &Raw, now: Instant, found: &mut Objections) {
        match &raw.odometry {
            Reading::Absent => {}
            Reading::Malformed => found.hazards.push("INPUT-10 odometry"),
            Reading::Value(value) => {
                let place = (value.stamp, value.pose.x_um, value.pose.y_um);
                match self.odometry {
                    _ if value.stamp > now => found.hazards.push("FRESH-04 odometry"),
                    Some((newest, ..)) if value.stamp < newest => {
                        found.hazards.push("INPUT-08 odometry");
                    }
                    Some((newest, ..)) if value.stamp == newest => {}
                    Some((_, x_um, y_um)) => {
                        if (x_um - place.1).abs() + (y_um - place.2).abs() > 1_500_000 {
                            found.hazards.push("INPUT-11");
                        }
                        self.odometry = Some(place);
                    }
                    None => self.odometry = Some(place),
                }
            }
        }
        if Self::age_us(now, self.odometry.map(|newest| newest.0)) > 60_000 {
            found.hazards.push("FRESH-02");
        }
    }

    fn scan(&mut self, scan: &RawScan, now: Instant, pose: [f64; 3], found: &mut Objections) {
        let ends = scan
            .stamp
            .plus(haltline::time::Duration::from_ms(self.episode.scan_ms));
        let invalid = |beam: &Beam| *beam == Beam::Invalid;
        let count = scan.beams.iter().filter(|beam| invalid(beam)).count();
        let widest = scan
            .beams
            .split(|beam| !invalid(beam))
            .map(<[Beam]>::len)
            .max()
            .unwrap_or(0);
        let gap_rad = widest as f64 * self.episode.scanner().increment_rad;
        let objection = if scan.malformed {
            Some("INPUT-10 scan")
        } else if scan.scanner != 0 || scan.beams.len() != self.episode.beams {
            Some("INPUT-07")
        } else if ends > now {
            Some("FRESH-04 scan")
        } else if self.scan.is_some_and(|newest| scan.stamp < newest) {
            Some("INPUT-08 scan")
        } else if count as f64 > 0.101 * scan.beams.len() as f64 {
            Some("INPUT-05")
        } else if gap_rad > std::f64::consts::TAU / 16.0 + 0.01 {
            Some("INPUT-06")
        } else {
            None
        };
        match objection {
            Some(id) => found.hazards.push(id),
            None => {
                self.scan = Some(scan.stamp);
                // Without a single return nothing tells one scan from another.
                let blank = !scan.beams.iter().any(|beam| matches!(beam, Beam::Hit(_)));
                if blank || self.scan_content != scan.beams {
                    self.scan_content.clone_from(&scan.beams);
                    self.content_at = pose;
                }
                let moved = (pose[0] - self.content_at[0]).hypot(pose[1] - self.content_at[1]);
                if moved > 0.1 || (pose[2] - self.content_at[2]).abs() > 0.1 {
                    found.hazards.push("FRESH-07");
                }
            }
        }
    }

    fn command(&mut self, raw: &Raw, now: Instant, found: &mut Objections) {
        match &raw.command {
            Reading::Absent => {}
            Reading::Malformed => self.command_usable = false,
            Reading::Value(value) => match self.command {
                _ if value.stamp > now => self.command_usable = false,
                Some(newest) if value.stamp < newest => self.command_usable = false,
                Some(newest) if value.stamp == newest => {}
                _ => {
                    self.command = Some(value.stamp);
                    self.command_usable = true;
                }
            },
        }
        if !self.command_usable {
            found.commands.push("INPUT-10 command");
        }
        if Self::age_us(now, self.command) > 200_000 {
            found.commands.push("FRESH-03");
        }
    }

    /// Whether the robot really stood still for the rest time.
    fn rested(&self, scene: &Scene<'_>) -> bool {
        let enough = scene.recent.len() >= 28;
        // The plant's steps are 2 ms; the rest time is 60 ms.
        enough
            && scene.recent.iter().rev().take(28).all(|truth| {
                truth.measured.v_mps.abs() <= self.episode.tol_v_mps + 0.006
                    && truth.measured.omega_radps.abs() <= self.episode.tol_omega_radps + 0.006
            })
    }

    /// Rules about leaving a stop.
    fn transition(&mut self, scene: &Scene<'_>, now: Instant, hazards: &[&str]) -> Option<String> {
        let (before, after) = (self.status, scene.decision.status);
        self.status = after;
        if scene.raw.emergency_stop {
            self.latched_at = now;
            let latched =
                after == StopStatus::Latched && scene.decision.action == Action::EmergencyStop;
            return (!latched).then(|| "LATCH-02: the line did not latch".to_owned());
        }
        if after != StopStatus::Running || before == StopStatus::Running {
            return None;
        }
        self.released_at = now;
        self.releases += 1;
        if !hazards.is_empty() {
            return Some(format!(
                "LATCH-03/05: released from {before:?} among {hazards:?}"
            ));
        }
        if !self.rested(scene) {
            return Some(format!(
                "LATCH-03/05: released from {before:?} without rest"
            ));
        }
        if before == StopStatus::Latched {
            let reset = scene
                .raw
                .reset
                .filter(|&stamp| stamp > self.latched_at && stamp <= now);
            return reset
                .is_none()
                .then(|| "LATCH-04: released without a new reset".to_owned());
        }
        let clear = Self::age_us(now, self.hazard_at) >= 100_000;
        (!clear).then(|| "LATCH-05: released before the clear time".to_owned())
    }
}

impl Tamper for Monitor<'_> {
    fn pause_us(&mut self, draw: &mut Draw) -> u64 {
        self.injector.turn(draw)
    }

    fn alter(&mut self, raw: &mut Raw, draw: &mut Draw) {
        self.injector.alter(raw, draw);
    }

    fn judge(&mut self, scene: &Scene<'_>) -> Option<String> {
        let mut found = Objections::default();
        let now = self.clock(scene.raw, &mut found);
        self.odometry(scene.raw, now, &mut found);
        let pose = scene.recent.last().map_or([0.0; 3], |truth| {
            [truth.pose.x_m, truth.pose.y_m, truth.pose.theta_rad]
        });
        for scan in &scene.raw.scans {
            self.scan(scan, now, pose, &mut found);
        }
        if Self::age_us(now, self.scan) > self.episode.scan_age_ms() * 1000 {
            found.hazards.push("FRESH-01");
        }
        self.command(scene.raw, now, &mut found);
        if scene.raw.emergency_stop {
            found.hazards.push("LATCH-02");
        }
        for &id in found.hazards.iter().chain(&found.commands) {
            // The kernel finds a frozen scan sooner than this record does.
            if self.status == StopStatus::Running || id == "FRESH-07" {
                *self.exercised.entry(id).or_default() += 1;
            }
        }
        let hazard = !found.hazards.is_empty();
        let broken = self.transition(scene, now, &found.hazards);
        if hazard {
            self.hazard_at = Some(now);
        }
        if self.command.is_none_or(|stamp| stamp <= self.released_at) {
            found.commands.push("LATCH-06");
        }
        let decision = scene.decision;
        let accepted =
            matches!(decision.action, Action::Pass | Action::Slow) && decision.verdict.is_some();
        let stopped = decision.action >= Action::ProtectiveStop;
        let fault = self.injector.active;
        if accepted && (hazard || !found.commands.is_empty()) || hazard && !stopped {
            return Some(format!(
                "{:?} {:?}: {:?} {:?} under {fault:?}",
                found.hazards, found.commands, decision.action, decision.reason
            ));
        }
        broken
    }
}
