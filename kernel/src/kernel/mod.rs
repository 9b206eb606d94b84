//! One tick: inputs in, decision out. The only module that sees all the others.
//!
//! `step` is total: whatever comes in, it answers with a set point the robot may
//! execute and the reason for it. [`Kernel`] is the shield: somebody else proposes the
//! motion. [`navigate::Navigator`] proposes its own and hands it to the same judge.

mod ingest;
mod motion;
pub mod navigate;

use crate::checked::{ConfigError, KernelConfig};
use crate::config::Config;
use crate::decision::{Action, Decision, Reason, StopStatus};
use crate::guard::memory::Memory;
use crate::guard::tube::eighths_up;
use crate::guard::{Leave, Refusal, Verdict};
use crate::input::{Beam, Command, Inputs};
use crate::odometry::{LocalPose, Track};
use crate::pipeline::Pipeline;
use crate::stop::{self, Mode, StopEvents, StopState, StopTimes};
use crate::time::{Duration, Instant};
use crate::window;

/// The safety kernel of one robot: up to `S` scanners of up to `B` beams, `M` remembered points.
///
/// Plain data without pointers; about 40 bytes per beam and scanner and 60 per remembered point.
#[derive(Clone, Debug)]
pub struct Kernel<const S: usize, const B: usize, const M: usize> {
    config: KernelConfig<S>,
    track: Track,
    memory: Memory<S, B, M>,
    channels: [Channel<B>; S],
    pipeline: Pipeline,
    stop: StopState,
    command: Option<Command>,
    /// Newest command stamp ever accepted; older ones never come back.
    command_stamp: Option<Instant>,
    command_fault: Option<Reason>,
    /// Since when the odometry has shown rest.
    resting_since: Option<Instant>,
    /// Moving off from rest: what stood inside the inflation then is excused (GUARD-19).
    leaving: Option<Departure>,
    /// The last set point lay on a braking ramp.
    is_braking: bool,
    last_tick: Option<Instant>,
}

/// Where the robot rested before it moved off.
#[derive(Clone, Copy, Debug)]
struct Departure {
    /// Pose at rest, relative to the anchor.
    pose: LocalPose,
    /// The inflation it had there, and how near the nearest excused point has been.
    left: Leave,
}

/// What arrived from one scanner.
#[derive(Clone, Copy, Debug)]
struct Channel<const B: usize> {
    /// Stamp of the newest accepted or pending scan.
    newest: Option<Instant>,
    /// Stamp of the newest scan in memory.
    accepted: Option<Instant>,
    /// The newest scan.
    beams: [Beam; B],
    beams_stamp: Option<Instant>,
    /// It waits for odometry that covers it.
    pending: bool,
    /// Content of the newest scan and the odometer when that content was first seen.
    fingerprint: u64,
    fingerprint_since: crate::odometry::Odometer,
    frozen: bool,
}

impl<const B: usize> Default for Channel<B> {
    fn default() -> Self {
        Self {
            newest: None,
            accepted: None,
            beams: [Beam::Invalid; B],
            beams_stamp: None,
            pending: false,
            fingerprint: 0,
            fingerprint_since: crate::odometry::Odometer::default(),
            frozen: false,
        }
    }
}

/// What a tick knows of time and hazards before it decides.
#[derive(Clone, Copy, Debug)]
struct Tick {
    now: Instant,
    /// Since the last tick.
    elapsed: Duration,
    /// When the decision ends.
    expires: Instant,
    hazard: Reason,
}

/// The most restrictive reason seen so far in a tick.
#[derive(Clone, Copy, Debug)]
struct Worst(Reason);

impl Worst {
    //= spec/latch.md#latch-08
    //# When several causes apply in one tick, the most restrictive action MUST win.
    fn add(&mut self, reason: Reason) {
        self.0 = self.0.max(reason);
    }

    fn add_if(&mut self, condition: bool, reason: Reason) {
        if condition {
            self.add(reason);
        }
    }
}

impl<const S: usize, const B: usize, const M: usize> Kernel<S, B, M> {
    /// A kernel for the robot of `config`, latched until its first reset.
    ///
    /// # Errors
    /// The first rule of the configuration that is broken.
    pub fn new(config: Config<S>) -> Result<Self, ConfigError> {
        Ok(Self {
            //= spec/input.md#input-14
            //# A configuration that contains an impossible combination MUST be refused before the first tick.
            config: KernelConfig::new(config, B)?,
            track: Track::default(),
            memory: Memory::default(),
            channels: [Channel::default(); S],
            pipeline: Pipeline::default(),
            stop: StopState::default(),
            command: None,
            command_stamp: None,
            command_fault: None,
            resting_since: None,
            leaving: None,
            is_braking: false,
            last_tick: None,
        })
    }

    /// One control tick at `now`.
    ///
    /// - `inputs`: everything that arrived since the last tick
    /// - `now`: the caller's monotonic clock, the same time base as all stamps
    ///
    /// # Bound
    /// O(scans × (beams + remembered) + speed factors × points × samples); no allocation.
    /// # Source
    /// spec/model.md; spec/ GUARD, BRAKE, LIMIT, ZONE, FRESH, SILENT, LATCH, INPUT, MEMORY.
    //= spec/time.md#time-01
    //# The number of loop iterations of a tick MUST be bounded by the capacities of the kernel, whatever the input.
    //= spec/time.md#time-05
    //# The kernel MUST NOT read a clock.
    pub fn step(&mut self, inputs: &Inputs<'_>, now: Instant) -> Decision {
        let tick = self.perceive(inputs, now);
        self.decide(&tick, Self::drive)
    }

    /// Takes in everything that arrived and advances the stop logic.
    fn perceive(&mut self, inputs: &Inputs<'_>, now: Instant) -> Tick {
        let mut hazard = Worst(Reason::None);
        // The caller's clock, even if it ran backwards: nobody may hold a set point for longer.
        let timing = &self.config.config().timing;
        //= spec/silent.md#silent-01
        //# Every decision MUST expire no later than one control period plus jitter after its tick.
        let expires = now.plus(timing.period).plus(timing.jitter);
        let (now, elapsed) = self.tick(now, &mut hazard);
        self.take_odometry(&inputs.odometry, now, &mut hazard);
        for scan in inputs.scans {
            self.take_scan(scan, now, &mut hazard);
        }
        self.settle_pending();
        self.take_command(&inputs.command, now);
        self.refresh_memory();
        self.watch(now, &mut hazard);
        let events = StopEvents {
            now,
            emergency: inputs.emergency_stop,
            reset: inputs.reset,
            hazard: hazard.0 != Reason::None,
            at_rest: self.is_at_rest(),
        };
        self.advance_stop(&events);
        Tick {
            now,
            elapsed,
            expires,
            hazard: hazard.0,
        }
    }

    /// Checks the clock; returns the time to work with and the step since the last tick.
    fn tick(&mut self, now: Instant, hazard: &mut Worst) -> (Instant, Duration) {
        let timing = &self.config.config().timing;
        let Some(last) = self.last_tick else {
            self.last_tick = Some(now);
            return (now, timing.period);
        };
        match now.since(last) {
            Some(elapsed) if elapsed > Duration::ZERO => {
                //= spec/silent.md#silent-02
                //# A tick later than control period plus jitter after the one before MUST start a protective stop.
                hazard.add_if(
                    elapsed > timing.period.plus(timing.jitter),
                    Reason::TickLate,
                );
                self.last_tick = Some(now);
                (now, elapsed)
            }
            _ => {
                //= spec/silent.md#silent-03
                //# A tick whose `now` is not later than the one before MUST start a protective stop.
                hazard.add(Reason::TimeReversed);
                (last, timing.period)
            }
        }
    }

    fn advance_stop(&mut self, events: &StopEvents) {
        let timing = &self.config.config().timing;
        let times = StopTimes {
            clear: timing.clear,
            reset_age_max: timing.command_age_max,
        };
        let before = self.stop;
        self.stop = stop::next(before, events, times);
        let released = self.stop.mode == Mode::Running && before.mode == Mode::Latched;
        if let (true, Some(pose)) = (released, self.track.pose()) {
            let rules = &self.config.config().memory;
            self.memory.vouch(
                self.config.memory(),
                pose,
                rules.clear_at_start.as_um() / 1000,
            );
            let skirt = eighths_up(u64::from(rules.skirt.as_um().unsigned_abs()));
            self.memory
                .occupy(pose, self.config.tube().footprint.grown(skirt));
        }
    }

    /// Turns the state of the tick into a decision and records what is sent; `drive` is asked
    /// only while motion is allowed.
    fn decide(&mut self, tick: &Tick, drive: impl FnOnce(&mut Self, &Tick) -> Outcome) -> Decision {
        let (hazard, elapsed) = (tick.hazard, tick.elapsed);
        //= spec/silent.md#silent-04
        //# The kernel MUST answer every tick with a set point, whether or not a command arrived.
        //= spec/latch.md#latch-07
        //# The set point MUST NOT grow in magnitude while a stop is active.
        let outcome = match self.stop.mode {
            Mode::Latched => self.braking(
                Action::EmergencyStop,
                hazard.max(if self.stop.startup {
                    Reason::Startup
                } else {
                    Reason::EmergencyStopLine
                }),
                elapsed,
            ),
            Mode::Protective => self.braking(
                Action::ProtectiveStop,
                hazard.max(Reason::WaitingForRelease),
                elapsed,
            ),
            Mode::Running => drive(self, tick),
        };
        self.pipeline.push(tick.now, outcome.vertex);
        Decision {
            action: outcome.action,
            setpoint: window::setpoint(self.config.config(), outcome.vertex),
            reason: outcome.reason,
            status: match self.stop.mode {
                Mode::Running => StopStatus::Running,
                Mode::Protective => StopStatus::Protective,
                Mode::Latched => StopStatus::Latched,
            },
            expires: tick.expires,
            verdict: outcome.verdict,
            factor_permille: outcome.factor_permille,
        }
    }

    /// The checked configuration.
    #[must_use]
    pub const fn config(&self) -> &KernelConfig<S> {
        &self.config
    }

    /// What the guard knows of its surroundings.
    #[must_use]
    pub const fn memory(&self) -> &Memory<S, B, M> {
        &self.memory
    }

    /// The odometry the kernel works with.
    #[must_use]
    pub const fn track(&self) -> &Track {
        &self.track
    }

    /// State of the stop logic.
    #[must_use]
    pub const fn stop_state(&self) -> StopState {
        self.stop
    }
}

/// A set point with its explanation, before it becomes a [`Decision`].
struct Outcome {
    action: Action,
    reason: Reason,
    vertex: crate::guard::hull::Vertex,
    verdict: Option<Verdict>,
    factor_permille: u16,
}

impl Outcome {
    /// The reason a verdict stands for.
    const fn blocked(verdict: &Verdict) -> Reason {
        match verdict.refusal {
            None => Reason::None,
            Some(
                Refusal::KnownPoint
                | Refusal::UnknownSpace
                | Refusal::MixedMotion
                | Refusal::TooLong,
            ) => Reason::GuardBlocked,
        }
    }
}
