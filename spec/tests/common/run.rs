//! The closed loop: a plant that really drives, the kernel through its public door, a clock.

use super::claim::Sighting;
use super::episode::{Episode, Lie};
use super::pilot::{Pilot, View};
use super::report::Report;
use super::tamper::{Raw, RawScan, Scene, Tamper, Untouched};
use super::wire::{decode, encode};
use haltline::Kernel;
use haltline::convert;
use haltline::decision::{Action, Decision, StopStatus};
use haltline::input::{Inputs, Reading, Scan};
use haltline::time::Instant;
use haltline_spec::draw::Draw;
use haltline_spec::motion::Twist;
use haltline_spec::plane::Pose;
use haltline_spec::plant::{Plant, SetPoint};
use haltline_spec::world::{Mover, Ray, Scanner};
use std::collections::VecDeque;

/// Step of the plant, µs.
const SUB_US: u64 = 2_000;
/// The kernel's clock at the start of an episode, µs.
pub const EPOCH_US: u64 = 1_000_000;
/// Time from the last beam to delivery, µs.
const DELIVERY_US: u64 = 6_000;
/// Motions drawn at each accepted step.
pub const COURSES: usize = 16;

struct Delivery {
    due_us: u64,
    stamp_us: u64,
    rays: Vec<Ray>,
}

/// One moment of the truth and of what the robot measured of it.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    pub pose: Pose,
    pub odometry: Pose,
    pub measured: Twist,
}

/// The loop's state; shared with the account of the claim.
pub struct Loop<'e> {
    pub(super) episode: &'e Episode,
    pub(super) kernel: Box<Kernel<2, 720, 1000>>,
    pub(super) plant: Plant,
    pub(super) world: Vec<Mover>,
    pub(super) scanner: Scanner,
    pub(super) draw: Draw,
    pub(super) bias: f64,
    pub(super) history: Vec<Truth>,
    scans: VecDeque<Delivery>,
    pub(super) next_scan_us: u64,
    pub(super) log: Vec<(f64, SetPoint)>,
    pub(super) sightings: Vec<Option<Sighting>>,
    pub(super) excused: Vec<bool>,
    /// Where the robot last rested, with the inflation there, until it has left.
    pub(super) rested: Option<(Pose, f64)>,
    /// What the last accepted step vouches for.
    pub(super) vouched: Vec<Sighting>,
    pub(super) pilot: Pilot,
    pub(super) status: StopStatus,
    pub(super) report: Report,
    pub(super) over: bool,
}

/// Runs one episode of `seconds`.
pub fn run(episode: &Episode, seconds: f64) -> Report {
    run_with(episode, seconds, &mut Untouched)
}

/// Runs one episode with somebody in between.
pub fn run_with(episode: &Episode, seconds: f64, tamper: &mut dyn Tamper) -> Report {
    drive(Loop::new(episode), seconds, tamper)
}

/// Runs one episode in a given world with somebody in between.
pub fn run_in(
    episode: &Episode,
    world: Vec<Mover>,
    seconds: f64,
    tamper: &mut dyn Tamper,
) -> Report {
    let mut run = Loop::new(episode);
    run.sightings = vec![None; world.len()];
    run.excused = vec![false; world.len()];
    run.pilot = Pilot::new(0);
    run.world = world;
    drive(run, seconds, tamper)
}

fn drive(mut run: Loop<'_>, seconds: f64, tamper: &mut dyn Tamper) -> Report {
    let episode = run.episode;
    let end_us = (seconds * 1e6) as u64;
    let mut now_us = 0;
    while now_us < end_us && !run.over {
        let late_us = run.draw.unit() * episode.jitter_ms as f64 * 1e3;
        let pause_us = tamper.pause_us(&mut run.draw);
        let next_us = now_us + episode.period_ms * 1000 + late_us as u64 + pause_us;
        run.drive_until(next_us);
        now_us = next_us;
        run.tick(now_us, tamper);
    }
    run.report
}

impl<'e> Loop<'e> {
    fn new(episode: &'e Episode) -> Self {
        let mut draw = Draw::new(episode.seed);
        let kernel = Kernel::new(episode.config()).expect("a legal configuration");
        let world = episode.world(&mut draw);
        let plant = Plant::new(episode.quality(), Pose::default(), &mut draw);
        let first = Truth {
            pose: plant.pose,
            odometry: plant.odometry,
            measured: plant.measured(),
        };
        Self {
            episode,
            kernel: Box::new(kernel),
            plant,
            scanner: episode.scanner(),
            bias: draw.extreme(-1.0, 1.0),
            history: vec![first],
            scans: VecDeque::new(),
            next_scan_us: 0,
            log: vec![(-9.0, still(episode))],
            sightings: vec![None; world.len()],
            excused: vec![false; world.len()],
            rested: None,
            vouched: Vec::new(),
            pilot: Pilot::new(draw.index(world.len())),
            world,
            draw,
            status: StopStatus::Latched,
            report: Report::default(),
            over: false,
        }
    }

    /// Lets the plant drive and the scanner turn.
    fn drive_until(&mut self, end_us: u64) {
        while (self.history.len() as u64) * SUB_US <= end_us {
            let before = self.plant.pose;
            self.plant.advance(SUB_US as f64 * 1e-6);
            let pose = self.plant.pose;
            self.report.path_m += (pose.x_m - before.x_m).hypot(pose.y_m - before.y_m);
            self.history.push(Truth {
                pose,
                odometry: self.plant.odometry,
                measured: self.plant.measured(),
            });
            let now_us = (self.history.len() as u64 - 1) * SUB_US;
            if now_us.is_multiple_of(10_000) {
                self.judge(now_us);
            }
            let sweep_us = self.episode.scan_ms * 1000;
            if now_us >= self.next_scan_us + sweep_us {
                self.sweep();
                self.next_scan_us += sweep_us.max(20_000);
            }
        }
    }

    fn sweep(&mut self) {
        let start_s = self.next_scan_us as f64 * 1e-6;
        let history = &self.history;
        let rays = self.scanner.sweep(
            &self.world,
            start_s,
            |t_s| pose_at(history, t_s),
            self.bias,
            &mut self.draw,
        );
        let end_us = self.next_scan_us + self.episode.scan_ms * 1000;
        let late_us = match self.episode.lie {
            Lie::ScanTime => self.episode.scan_ms * 1000,
            _ => 0,
        };
        self.scans.push_back(Delivery {
            due_us: end_us + DELIVERY_US,
            stamp_us: self.next_scan_us + late_us,
            rays,
        });
    }

    fn tick(&mut self, now_us: u64, tamper: &mut dyn Tamper) {
        let stamp_us = now_us / SUB_US * SUB_US;
        let truth = self.history[(stamp_us / SUB_US) as usize];
        let mut raw = self.raw(now_us, stamp_us, &truth);
        tamper.alter(&mut raw, &mut self.draw);
        let scans: Vec<_> = raw
            .scans
            .iter()
            .map(|scan| {
                if scan.malformed {
                    return Reading::Malformed;
                }
                Reading::Value(Scan {
                    scanner: scan.scanner,
                    stamp: scan.stamp,
                    beams: &scan.beams,
                })
            })
            .collect();
        let inputs = Inputs {
            scans: &scans,
            odometry: raw.odometry,
            command: raw.command,
            emergency_stop: raw.emergency_stop,
            reset: raw.reset,
        };
        let decision = self.kernel.step(&inputs, raw.now);
        let from = self.history.len().saturating_sub(50);
        let broken = tamper.judge(&Scene {
            raw: &raw,
            decision: &decision,
            set_point: decode(decision.setpoint),
            recent: &self.history[from..],
        });
        self.report.faults.extend(broken);
        self.obey(&decision, now_us, stamp_us, &truth);
    }

    /// What the sensors and the pilot hand over.
    fn raw(&mut self, now_us: u64, stamp_us: u64, truth: &Truth) -> Raw {
        let deliveries = self.due(now_us);
        for delivery in &deliveries {
            self.note(delivery);
        }
        let scans = deliveries.iter().map(|delivery| RawScan {
            scanner: 0,
            stamp: Instant::from_us(EPOCH_US + delivery.stamp_us),
            beams: encode(&delivery.rays),
            malformed: false,
        });
        let view = View {
            episode: self.episode,
            world: &self.world,
            pose: truth.pose,
            now_us,
        };
        let now = Instant::from_us(EPOCH_US + now_us);
        Raw {
            now,
            scans: scans.collect(),
            odometry: convert::odometry(
                Instant::from_us(EPOCH_US + stamp_us),
                [
                    truth.odometry.x_m,
                    truth.odometry.y_m,
                    truth.odometry.theta_rad,
                ],
                [truth.measured.v_mps, truth.measured.omega_radps],
                None,
            ),
            command: self.pilot.command(&view, &mut self.draw),
            emergency_stop: false,
            reset: (self.status == StopStatus::Latched).then_some(now),
        }
    }

    fn due(&mut self, now_us: u64) -> Vec<Delivery> {
        let mut due = Vec::new();
        while self.scans.front().is_some_and(|scan| scan.due_us <= now_us) {
            due.extend(self.scans.pop_front());
        }
        due
    }

    /// Remembers which bodies the scan returned, where they were then.
    fn note(&mut self, delivery: &Delivery) {
        // Static bodies stay where they were returned; of moving ones only the newest scan speaks.
        if self.episode.obstacle_mps > 0.0 {
            self.sightings.fill(None);
        }
        for index in 0..self.world.len() {
            let rays = delivery.rays.iter().filter(|ray| ray.body == Some(index));
            let surface: Vec<_> = rays.filter_map(|ray| Some((ray.place?, ray.t_s))).collect();
            if let Some(&(_, t_s)) = surface.last() {
                self.sightings[index] = Some(Sighting {
                    index,
                    body: self.world[index].at(t_s),
                    t_s,
                    surface,
                });
            }
        }
    }

    fn obey(&mut self, decision: &Decision, now_us: u64, stamp_us: u64, truth: &Truth) {
        self.report.ticks += 1;
        self.status = decision.status;
        let set_point = decode(decision.setpoint);
        super::rules::check(
            self.episode,
            &self.log,
            set_point,
            decision,
            now_us,
            &mut self.report,
        );
        self.log.push((now_us as f64 * 1e-6, set_point));
        self.plant.send(set_point);
        // A ramp to a wanted standstill passes without a verdict; it belongs to the tube before.
        let accepted =
            matches!(decision.action, Action::Pass | Action::Slow) && decision.verdict.is_some();
        self.report.slowed += usize::from(decision.action == Action::Slow);
        self.report.refused += usize::from(decision.action == Action::Brake);
        self.report.braking +=
            usize::from(decision.action == Action::Brake && !self.plant.is_at_rest());
        self.pilot.learn(accepted && decision.factor_permille > 200);
        if accepted && set_point != still(self.episode) {
            self.check_claim(decision, now_us, stamp_us, truth);
        }
    }
}

fn pose_at(history: &[Truth], t_s: f64) -> Pose {
    let steps = (t_s * 1e6 / SUB_US as f64).max(0.0);
    let index = (steps as usize).min(history.len() - 1);
    let next = (index + 1).min(history.len() - 1);
    let share = steps - index as f64;
    let (a, b) = (history[index].pose, history[next].pose);
    Pose::new(
        a.x_m + (b.x_m - a.x_m) * share,
        a.y_m + (b.y_m - a.y_m) * share,
        a.theta_rad + (b.theta_rad - a.theta_rad) * share,
    )
}

/// Whether a set point keeps the robot at rest is a matter of its speeds alone.
fn still(episode: &Episode) -> SetPoint {
    if episode.steered {
        SetPoint::Arc {
            v_mps: 0.0,
            curvature_per_m: 0.0,
        }
    } else {
        SetPoint::Twist(Twist::default())
    }
}
