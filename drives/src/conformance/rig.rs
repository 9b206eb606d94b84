//! An adapter, a robot and the wire between them, in virtual time.

use haltline::decision::{Action, Decision, Reason, StopStatus};
use haltline::input::{Motion, Twist};
use haltline::time::{Duration, Instant};
use haltline::units::{AngularSpeed, Curvature, Speed};

use super::bench::Bench;
use super::taps::{Tap, Told};
use super::twins::{self, Twin};
use crate::drive::{Drive, DriveError, Feedback, State};
use crate::emulator::Robot;

/// Everything of one run.
pub struct Rig {
    /// The adapter, possibly a broken one.
    pub drive: Box<dyn Drive>,
    /// The robot.
    pub robot: Box<dyn Robot>,
    tap: Box<dyn Tap>,
    /// The present.
    pub now: Instant,
    /// Bytes reach the robot.
    pub to_robot: bool,
    /// Bytes reach the host.
    pub to_host: bool,
    /// What goes to the host instead of, or besides, the robot's bytes.
    pub spoil: Option<Spoiler>,
    /// What goes to the robot instead of the adapter's bytes.
    pub spoil_said: Option<Spoiler>,
    /// Its randomness.
    pub random: Random,
    /// Fastest the robot really was, m/s, and fastest it turned, rad/s.
    pub fastest: [f64; 2],
    /// Set points that reached the robot.
    pub told: Vec<Told>,
    /// Errors the adapter reported.
    pub faults: Vec<DriveError>,
    /// Newest feedback.
    pub feedback: Option<Feedback>,
    period: Duration,
    is_arc: bool,
    next_decision: Instant,
    /// When the last decision expires.
    pub expires: Instant,
}

/// A way to spoil a stream.
pub type Spoiler = fn(&mut Random, Vec<u8>) -> Vec<u8>;

/// A small generator of numbers that look random (xorshift64*).
#[derive(Clone, Copy, Debug)]
pub struct Random(u64);

impl Random {
    /// From a seed; 0 is turned into another.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(if seed == 0 {
            0x9E37_79B9_7F4A_7C15
        } else {
            seed
        })
    }

    /// The next 64 bits.
    pub const fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// A number below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() >> 33) as usize % end.max(1)
    }
}

impl Rig {
    /// A rig at one second after the origin of time, nothing connected yet.
    #[must_use]
    pub fn new(bench: &dyn Bench, twin: Option<Twin>) -> Self {
        let now = Instant::from_us(1_000_000);
        let drive = bench.drive(now);
        Self {
            drive: match twin {
                Some(twin) => twins::wrap(twin, drive, bench.raw_motion()),
                None => drive,
            },
            robot: bench.robot(now),
            tap: bench.tap(),
            now,
            to_robot: true,
            to_host: true,
            spoil: None,
            spoil_said: None,
            random: Random::new(7),
            fastest: [0.0; 2],
            told: Vec::new(),
            faults: Vec::new(),
            feedback: None,
            period: bench.period(),
            is_arc: bench.is_arc(),
            next_decision: now,
            expires: now,
        }
    }

    /// A decision of the kernel for this set point, good for one period and 2 ms.
    pub fn decision(&self, linear: f64, turn: f64) -> Decision {
        let micro = |value: f64| (value * 1e6).round() as i32;
        let linear = Speed::from_um_per_s(micro(linear));
        Decision {
            action: Action::Pass,
            setpoint: if self.is_arc {
                Motion::Arc {
                    linear,
                    curvature: Curvature::from_urad_per_m(micro(turn)),
                }
            } else {
                Motion::Twist(Twist {
                    linear,
                    angular: AngularSpeed::from_urad_per_s(micro(turn)),
                })
            },
            reason: Reason::None,
            status: StopStatus::Running,
            expires: self.now.plus(self.period).plus(Duration::from_ms(2)),
            verdict: None,
            factor_permille: 1000,
        }
    }

    /// One millisecond of wire and robot; the adapter is only asked if the host is `awake`.
    fn millisecond(&mut self, awake: bool) {
        self.now = self.now.plus(Duration::from_ms(1));
        self.robot.step(self.now);
        let twist = self.robot.truth().twist;
        for (fastest, rate) in self.fastest.iter_mut().zip(twist) {
            *fastest = fastest.max(rate.abs());
        }
        let mut bytes = self.robot.outgoing();
        if !self.to_host {
            bytes.clear();
        }
        if let Some(spoil) = self.spoil {
            bytes = spoil(&mut self.random, bytes);
        }
        if !awake {
            return;
        }
        // Streams are split anywhere.
        let cut = self.random.below(bytes.len() + 1);
        let (first, second) = bytes.split_at(cut);
        self.drive.receive(first, self.now);
        self.drive.receive(second, self.now);
        self.drive.tick(self.now);
        self.faults.extend(self.drive.fault());
        self.feedback = self.drive.feedback().or(self.feedback);
        let mut room = [0; 64];
        loop {
            let count = self.drive.outgoing(&mut room, self.now);
            let Some(said) = room.get(..count).filter(|said| !said.is_empty()) else {
                break;
            };
            if self.to_robot {
                self.told.extend(self.tap.hear(said, self.now));
                let heard = match self.spoil_said {
                    Some(spoil) => spoil(&mut self.random, said.to_vec()),
                    None => said.to_vec(),
                };
                self.robot.receive(&heard, self.now);
            }
        }
    }

    /// Lets `span` pass without decisions.
    pub fn idle(&mut self, span: Duration) {
        for _ in 0..span.as_us() / 1000 {
            self.millisecond(true);
        }
    }

    /// The host does nothing at all for `span`.
    pub fn pause(&mut self, span: Duration) {
        for _ in 0..span.as_us() / 1000 {
            self.millisecond(false);
        }
    }

    /// The host listens for `span` and says nothing.
    pub fn listen(&mut self, span: Duration) {
        for _ in 0..span.as_us() / 1000 {
            self.now = self.now.plus(Duration::from_ms(1));
            self.robot.step(self.now);
            let bytes = self.robot.outgoing();
            self.drive.receive(&bytes, self.now);
            self.feedback = self.drive.feedback().or(self.feedback);
        }
    }

    /// Lets `span` pass with this decision in every period.
    pub fn decide(&mut self, linear: f64, turn: f64, span: Duration) {
        for _ in 0..span.as_us() / 1000 {
            if self.now >= self.next_decision {
                self.next_decision = self.now.plus(self.period);
                let decision = self.decision(linear, turn);
                self.expires = decision.expires;
                self.faults
                    .extend(self.drive.send(&decision, self.now).err());
            }
            self.millisecond(true);
        }
    }

    /// Shakes hands, enables and waits until decisions are sent; `false` if that takes 10 s.
    pub fn start(&mut self) -> bool {
        for _ in 0..1000 {
            self.decide(0.0, 0.0, Duration::from_ms(10));
            match self.drive.state() {
                State::Disabled => self.drive.enable(self.now),
                State::Driving => return true,
                _ => {}
            }
        }
        false
    }

    /// Starts, and brings the robot to a steady motion.
    pub fn cruise(&mut self, linear: f64, turn: f64) -> bool {
        if !self.start() {
            return false;
        }
        let step = Duration::from_ms(40);
        for part in 1..=50 {
            let part = f64::from(part) / 50.0;
            let turn = if self.is_arc { turn } else { turn * part };
            self.decide(linear * part, turn, step);
        }
        self.decide(linear, turn, Duration::from_ms(600));
        true
    }

    /// Set points that reached the robot after `since`.
    pub fn told_since(&self, since: Instant) -> impl Iterator<Item = &Told> {
        self.told.iter().filter(move |told| told.at > since)
    }
}
