//! The bench of a robot file: its own times and limits, not a bench's.

use haltline::time::{Duration, Instant};
use haltline_robots::Robot as File;

use super::bench::{Bench, CarBench, SeekurBench};
use super::taps::Tap;
use crate::drive::Drive;
use crate::emulator::Robot;
use crate::robots::{Habits, Kind};
use crate::seekur::Wheels;

/// The robot of a file: adapter and emulator as the file configures them.
pub struct FileBench {
    kind: Kind,
    file: File,
    habits: Habits,
    like: Box<dyn Bench + Send + Sync>,
}

impl FileBench {
    /// For the robot of this file.
    #[must_use]
    pub fn new(kind: Kind, file: &File) -> Self {
        let like: Box<dyn Bench + Send + Sync> = match kind {
            Kind::SeekurJr => Box::new(SeekurBench {
                wheels: Wheels::VelRvel,
                skid: 1.0,
            }),
            Kind::PsesCar => Box::new(CarBench { stx: true }),
        };
        Self {
            kind,
            file: file.clone(),
            habits: Habits::default(),
            like,
        }
    }

    /// The false twin: a robot that tells its dead-man time and drives on for ever.
    #[must_use]
    pub fn without_watchdog(kind: Kind, file: &File) -> Self {
        let habits = Habits {
            ignores_watchdog: true,
            ..Habits::default()
        };
        Self {
            habits,
            ..Self::new(kind, file)
        }
    }
}

impl Bench for FileBench {
    fn name(&self) -> &'static str {
        "the robot file's own times and limits"
    }

    fn drive(&self, now: Instant) -> Box<dyn Drive> {
        self.kind.adapter(&self.file, 4711, now)
    }

    fn robot(&self, now: Instant) -> Box<dyn Robot> {
        self.kind.emulated(&self.file, self.habits, now)
    }

    fn tap(&self) -> Box<dyn Tap> {
        self.like.tap()
    }

    fn period(&self) -> Duration {
        self.file.config.timing.period
    }

    fn watchdog(&self) -> Duration {
        let us = self.file.values.host_death.watchdog_s * 1e6;
        Duration::from_us(us.round().max(0.0) as u64)
    }

    fn notices_restart(&self) -> Duration {
        self.like.notices_restart()
    }

    fn braking(&self) -> [f64; 2] {
        let limits = &self.file.values.limits;
        [limits.braking_mps2, limits.angular_braking_radps2]
    }

    fn silent_braking(&self) -> f64 {
        self.file.values.host_death.braking_mps2
    }

    fn limits(&self) -> [f64; 3] {
        let limits = &self.file.values.limits;
        let turn = if self.is_arc() {
            self.like.limits()[2]
        } else {
            limits.angular_speed_radps
        };
        [limits.speed_forward_mps, limits.speed_reverse_mps, turn]
    }

    fn quantum(&self) -> [f64; 2] {
        self.like.quantum()
    }

    fn is_arc(&self) -> bool {
        self.like.is_arc()
    }

    fn raw_motion(&self) -> Vec<u8> {
        self.like.raw_motion()
    }
}
