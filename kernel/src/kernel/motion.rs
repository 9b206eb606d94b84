//! From a desired motion to a certified one: the speed list, the hull, the ramp.

use super::{Departure, Kernel, Outcome, Tick};
use crate::config::Kinematics;
use crate::decision::{Action, Reason};
use crate::guard::check::Excuse;
use crate::guard::hull::{Hull, Vertex};
use crate::guard::tube::{Sample, eighths_up};
use crate::guard::{Scene, Verdict, certify, leave};
use crate::input::{Command, Odometry, Twist};
use crate::time::{Duration, Instant};
use crate::units::{Curvature, Speed};
use crate::watch::is_stale;
use crate::window::{self, FACTORS_PERMILLE};

impl<const S: usize, const B: usize, const M: usize> Kernel<S, B, M> {
    /// The curvature-holding ramp to rest.
    ///
    /// A set point holds until the next tick, which may come late, so it is the ramp's value
    /// at the decision's expiry. The ramp starts no faster than the robot is measured: a drive
    /// still accelerating towards an older set point must fall from the first braking tick on.
    /// # Source
    /// BRAKE-05, BRAKE-06.
    pub(super) fn braking(&mut self, action: Action, reason: Reason, elapsed: Duration) -> Outcome {
        let config = self.config.config();
        let timing = &config.timing;
        let last = self.pipeline.last();
        //= spec/brake.md#brake-05
        //# A braking set point MUST ask for no more speed and no more turn rate than a ramp at the sure
        //# decelerations, begun at the first braking tick, has left at the expiry of the decision.
        let vertex = if self.is_braking {
            window::braked(config, last, elapsed)
        } else {
            let start = match self.track.newest() {
                //= spec/brake.md#brake-06
                //# A braking set point MUST NOT exceed in magnitude the measured twist plus its tolerance, nor the
                //# set point before it.
                Some(odometry) => window::no_faster(config, last, odometry.twist),
                None => last,
            };
            window::braked(
                config,
                start,
                timing.period.plus(timing.jitter).max(elapsed),
            )
        };
        self.leaving = None;
        self.is_braking = true;
        Outcome {
            action,
            reason,
            vertex,
            verdict: None,
            factor_permille: 0,
        }
    }

    /// Why the newest command cannot be followed, if it cannot.
    fn command_reason(&self, now: Instant) -> Result<Command, Reason> {
        if let Some(fault) = self.command_fault {
            return Err(fault);
        }
        let command = self.command.ok_or(Reason::CommandMissing)?;
        //= spec/latch.md#latch-06
        //# After a release the kernel MUST NOT execute a command stamped at or before the release.
        if command.stamp <= self.stop.released {
            return Err(Reason::CommandMissing);
        }
        //= spec/fresh.md#fresh-03
        //# The kernel MUST brake while the newest usable command is older than `command_age_max`.
        if is_stale(
            command.stamp,
            now,
            self.config.config().timing.command_age_max,
        ) {
            return Err(Reason::CommandStale);
        }
        Ok(command)
    }

    /// Certifies the fastest motion of the list towards the desired one, or brakes.
    //= spec/brake.md#brake-01
    //# When no motion is accepted, the kernel MUST send a braking set point in the same tick.
    //= spec/brake.md#brake-02
    //# At every tick the robot MUST be at rest or inside a tube that was accepted at an earlier tick and not yet left
    //# by time.
    //= spec/limit.md#limit-06
    //# When limits and dynamic window leave no admissible set point, the kernel MUST brake.
    //= spec/limit.md#limit-07
    //# `limit` MUST return the fastest motion of its fixed, descending list of speed factors that the guard accepts.
    pub(super) fn drive(&mut self, tick: &Tick) -> Outcome {
        let (now, elapsed) = (tick.now, tick.elapsed);
        let desired = self
            .command_reason(now)
            .and_then(|command| window::desired(self.config.config(), &command.motion));
        let (wanted, exceeded) = match desired {
            Ok(desired) => desired,
            Err(reason) => return self.braking(Action::Brake, reason, elapsed),
        };
        let Some(odometry) = self.track.newest().copied() else {
            return self.braking(Action::Brake, Reason::OdometryMissing, elapsed);
        };
        if wanted.twist == Twist::default() {
            // To stand still needs no certificate.
            // The wheels turn only at rest: turning them while braking would leave the arc.
            let rests = self.is_at_rest();
            let mut outcome = self.braking(Action::Pass, Reason::None, elapsed);
            if rests {
                outcome.vertex.curvature = wanted.curvature;
            }
            outcome.factor_permille = 1000;
            return outcome;
        }
        let mut blocked: Option<Verdict> = None;
        let mut previous: Option<Vertex> = None;
        for &factor in &FACTORS_PERMILLE {
            let candidate = self.candidate(wanted, factor, elapsed);
            let Some(candidate) = candidate else { continue };
            if previous == Some(candidate) {
                continue;
            }
            previous = Some(candidate);
            let verdict = self.judge(&odometry, candidate, now);
            if verdict.refusal.is_none() {
                return self.accepted(candidate, factor, exceeded, verdict);
            }
            blocked.get_or_insert(verdict);
        }
        let mut outcome = self.braking(
            Action::Brake,
            blocked
                .as_ref()
                .map_or(Reason::EmptyWindow, Outcome::blocked),
            elapsed,
        );
        outcome.verdict = blocked;
        outcome
    }

    /// The command for one speed factor, if speed and acceleration limits admit one.
    fn candidate(&self, wanted: Vertex, factor: u16, elapsed: Duration) -> Option<Vertex> {
        let config = self.config.config();
        let reference = self.pipeline.last();
        // A late tick does not earn more acceleration.
        let step = elapsed.min(config.timing.period);
        let candidate = window::towards(config, reference, wanted, factor, step);
        let moves = candidate.twist != Twist::default();
        (moves && window::admissible(config, reference, candidate, step)).then_some(candidate)
    }

    pub(super) fn accepted(
        &mut self,
        vertex: Vertex,
        factor_permille: u16,
        exceeded: bool,
        verdict: Verdict,
    ) -> Outcome {
        self.is_braking = false;
        self.leaving = self.departure(vertex);
        let (action, reason) = match (factor_permille, exceeded) {
            (1000, false) => (Action::Pass, Reason::None),
            (1000, true) => (Action::Slow, Reason::LimitExceeded),
            _ => (Action::Slow, Reason::GuardLimited),
        };
        Outcome {
            action,
            reason,
            vertex,
            verdict: Some(verdict),
            factor_permille,
        }
    }

    /// The motions that may be executed from the odometry stamp on: measured, in flight, new.
    //= spec/guard.md#guard-03
    //# The hull of a motion MUST contain the measured twist, every set point sent after the odometry stamp minus the
    //# actuation latency, the last set point sent before that moment, and the set point to be sent.
    fn hull(&self, odometry: &Odometry, candidate: Vertex) -> Hull {
        let mut hull = Hull::default();
        hull.push(Vertex {
            twist: odometry.twist,
            curvature: odometry.steering.unwrap_or(candidate.curvature),
        });
        let since = odometry.stamp.minus(self.window(odometry));
        let mut previous: Option<Vertex> = None;
        for sent in self.pipeline.since(since) {
            if previous != Some(*sent) {
                hull.push(*sent);
            }
            previous = Some(*sent);
        }
        if self.pipeline.has_forgotten(since) {
            hull.mark_incomplete();
        } else if !self.pipeline.reaches(since) {
            self.push_unknown_past(&mut hull, odometry);
        }
        hull.push(candidate);
        hull
    }

    /// Before the kernel's first command the drive rested, but its wheels may have stood anywhere.
    fn push_unknown_past(&self, hull: &mut Hull, odometry: &Odometry) {
        let bend = match (self.config.config().kinematics, odometry.steering) {
            (Kinematics::Ackermann { curvature_max, .. }, None) => curvature_max.as_urad_per_m(),
            _ => 0,
        };
        for curvature in [bend, bend.saturating_neg()] {
            hull.push(Vertex {
                twist: Twist::default(),
                curvature: Curvature::from_urad_per_m(curvature),
            });
        }
    }

    /// How far back commands may still determine the motion: a steering sensor makes the
    /// sweep of the wheels unnecessary.
    pub(super) fn window(&self, odometry: &Odometry) -> Duration {
        match odometry.steering {
            Some(_) => self.config.config().timing.actuation_latency,
            None => self.config.pipeline(),
        }
    }

    pub(super) fn judge(&self, odometry: &Odometry, candidate: Vertex, now: Instant) -> Verdict {
        let age = now.since(odometry.stamp).unwrap_or_default();
        let scene = Scene {
            memory: &self.memory,
            model: self.config.memory(),
            pose: self.track.pose().unwrap_or_default(),
            stamp: odometry.stamp,
            odometer: self.track.odometer(),
            excuse: self.excuse(),
        };
        certify(
            self.config.tube(),
            &self.hull(odometry, candidate),
            self.config.reaction_us(age),
            &scene,
        )
    }

    /// What the robot is excused while it leaves rest (GUARD-19).
    ///
    /// Only in a static world: where bodies move, one that stands within reach may step nearer.
    fn excuse(&self) -> Option<Excuse> {
        if self.config.config().obstacle_speed != Speed::ZERO {
            return None;
        }
        if self.is_at_rest() {
            return Some(Excuse { rested: None });
        }
        let departure = self.leaving?;
        let here = self.track.pose()?;
        Some(Excuse {
            rested: Some(Sample::seen_from(here, departure.pose, departure.left.rect)),
        })
    }

    /// The departure that goes on when `candidate` is executed; over once every excused point is
    /// left behind or one of them has come nearer.
    fn departure(&self, candidate: Vertex) -> Option<Departure> {
        let excuse = self.excuse()?;
        let (odometry, here) = (self.track.newest()?, self.track.pose()?);
        let left = leave(
            self.config.tube(),
            &self.hull(odometry, candidate),
            self.config.reaction_us(Duration::ZERO),
            &self.memory,
            &excuse,
        )?;
        let Some(departure) = self.leaving.filter(|_| excuse.rested.is_some()) else {
            return Some(Departure { pose: here, left });
        };
        // A static point wanders by the sensor's error; more is a body that approaches.
        let noise = u64::from(eighths_up(self.config.memory().sensor_um).unsigned_abs());
        (left.nearest.saturating_add(noise) >= departure.left.nearest).then_some(departure)
    }
}
