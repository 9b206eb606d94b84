//! The closed loop: a plant that really drives, the kernel through its public door, a clock.

use super::claim::{Contact, Sighting, Step};
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
const COURSES: usize = 16;

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

struct Loop<'e> {
    episode: &'e Episode,
    kernel: Box<Kernel<2, 720, 1000>>,
    plant: Plant,
    world: Vec<Mover>,
    scanner: Scanner,
    draw: Draw,
    bias: f64,
    history: Vec<Truth>,
    scans: VecDeque<Delivery>,
    next_scan_us: u64,
    log: Vec<(f64, SetPoint)>,
    sightings: Vec<Option<Sighting>>,
    excused: Vec<bool>,
    /// Where the robot last rested, with the inflation there, until it has left.
    rested: Option<(Pose, f64)>,
    /// What the last accepted step vouches for.
    vouched: Vec<Sighting>,
    pilot: Pilot,
    status: StopStatus,
    report: Report,
    over: bool,
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

    /// Whether the plant itself touches something while it moves; the episode ends there.
    fn judge(&mut self, now_us: u64) {
        let t_s = now_us as f64 * 1e-6;
        let outline = self.episode.outline();
        for (index, mover) in self.world.iter().enumerate() {
            let body = mover.at(t_s);
            if body.distance_m(&outline, self.plant.pose) > Some(0.0) || self.over {
                continue;
            }
            self.over = true;
            if self.plant.is_at_rest() {
                continue;
            }
            let vouched = self.vouched.iter().find(|sighting| sighting.index == index);
            if vouched.is_some_and(|sighting| self.is_hit(sighting, mover, t_s)) {
                self.report
                    .crashes
                    .push(format!("t={t_s:.3} body {index} {body:?}"));
            } else {
                self.report.unseen += 1;
            }
        }
    }

    /// Whether the part of a body that the claim is about touches the plant.
    fn is_hit(&self, sighting: &Sighting, mover: &Mover, t_s: f64) -> bool {
        let mut moved = sighting.clone();
        for (place, seen_s) in &mut moved.surface {
            for (coordinate, speed) in place.iter_mut().zip(mover.velocity_mps) {
                *coordinate += speed * (t_s - *seen_s);
            }
            *seen_s = t_s;
        }
        let outline = self.episode.outline();
        moved.gap_m(&outline, self.plant.pose, t_s, self.episode.obstacle_mps) <= 0.0
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
        self.pilot.learn(accepted && decision.factor_permille > 200);
        if accepted && set_point != still(self.episode) {
            self.check_claim(decision, now_us, stamp_us, truth);
        }
    }

    fn check_claim(&mut self, decision: &Decision, now_us: u64, stamp_us: u64, truth: &Truth) {
        let allowance_m = decision.verdict.map_or(0.0, |verdict| {
            f64::from(verdict.budget.total().as_um()) * 1e-6
        }) + 0.01;
        self.excuse(allowance_m, stamp_us, truth);
        let sightings: Vec<Sighting> = self
            .sightings
            .iter()
            .flatten()
            .filter(|sighting| !self.excused[sighting.index])
            .cloned()
            .collect();
        self.vouched.clone_from(&sightings);
        let mut step = Step {
            stamp_s: stamp_us as f64 * 1e-6,
            now_s: now_us as f64 * 1e-6,
            pose: truth.pose,
            measured: truth.measured,
            log: self.log.clone(),
            sightings,
        };
        self.report.accepted += 1;
        self.report.courses += COURSES;
        if let Some(contact) = step.first_contact(self.episode, COURSES, &mut self.draw) {
            self.report
                .contacts
                .push(describe(&step, decision, contact));
        }
        step.sightings = self
            .sightings
            .iter()
            .flatten()
            .filter(|sighting| self.excused[sighting.index])
            .cloned()
            .collect();
        let excused = step.first_contact(self.episode, COURSES, &mut self.draw);
        self.report.excused_contacts += usize::from(excused.is_some());
    }

    /// The claim excuses what lies inside the inflation of the place where the robot rested, until
    /// the robot has left all of it (GUARD-19).
    fn excuse(&mut self, allowance_m: f64, stamp_us: u64, truth: &Truth) {
        let outline = self.episode.outline();
        let rest = truth.measured.v_mps.abs() <= self.episode.tol_v_mps + 0.005
            && truth.measured.omega_radps.abs() <= self.episode.tol_omega_radps + 0.005;
        // Where bodies may move nothing is excused.
        if rest && self.episode.obstacle_mps <= 0.0 {
            self.rested = Some((truth.pose, allowance_m));
        }
        self.excused.fill(false);
        let Some((rested, rested_m)) = self.rested else {
            return;
        };
        for sighting in self.sightings.iter().flatten() {
            let age_s = stamp_us as f64 * 1e-6 - sighting.t_s;
            let roam_m = self.episode.obstacle_mps * age_s.max(0.0);
            let near = |pose: Pose, within_m: f64| {
                sighting
                    .body
                    .distance_m(&outline, pose)
                    .is_none_or(|distance_m| distance_m <= within_m + roam_m)
            };
            self.excused[sighting.index] = near(rested, rested_m) && near(truth.pose, allowance_m);
        }
        if !rest && !self.excused.contains(&true) {
            self.rested = None;
        }
        self.report.excused += self.excused.iter().filter(|&&e| e).count();
    }
}

fn describe(step: &Step, decision: &Decision, contact: Contact) -> String {
    format!(
        "t={:.3} v={:.3} w={:.3} body {} depth {:.4} after {:.3}: {:?} {:?} {:?} budget {:?}",
        step.now_s,
        step.measured.v_mps,
        step.measured.omega_radps,
        contact.body,
        contact.depth_m,
        contact.after_s,
        decision.action,
        decision.setpoint,
        step.sightings
            .iter()
            .find(|s| s.index == contact.body)
            .map(|s| (
                step.pose.enter([s.body.pose.x_m, s.body.pose.y_m]),
                s.body.form,
                step.stamp_s - s.t_s
            )),
        decision
            .verdict
            .map(|v| (v.budget, v.stopping_path, v.stopping_time)),
    )
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
