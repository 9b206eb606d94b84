//! Every sequence of events up to a depth, on the real kernel: stops, freshness, replays.
//!
//! A robot that follows its set points at once stands in an empty world, so that only the rules of
//! stopping decide. The rules are kept here a second time, in the simplest words, and compared
//! with every decision.

use haltline::config::{
    Config, Footprint, Kinematics, Limits, MASKS_MAX, MemoryRules, Ramps, Scanner, Timing,
    Tolerances, ZoneMargins,
};
use haltline::decision::{Action, Decision, StopStatus};
use haltline::input::{Beam, Command, Inputs, Motion, Odometry, Pose, Reading, Scan, Twist};
use haltline::kernel::Kernel;
use haltline::time::{Duration, Instant};
use haltline::units::{
    Acceleration, AngularAcceleration, AngularSpeed, BinaryAngle, Length, Ppm, Speed,
};

use super::parallel_each;
use crate::prove::ledger::Means;
use crate::prove::native::Enumeration;

const FILE: &str = "verification/src/enumerate/kernel.rs";
const DEPTH: u32 = 6;
const TICK_US: u64 = 40_000;
const BEAMS: usize = 40;
type Robot = Kernel<1, BEAMS, 8>;

/// What a tick may bring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    Fresh,
    NoScan,
    NoOdometry,
    /// Neither scan nor odometry: what ages fastest must stop the robot by itself.
    Blind,
    NoCommand,
    FutureScan,
    FutureOdometry,
    OldCommand,
    Line,
    Reset,
    Pause,
    ZoneReturn,
    Malformed,
}

const EVENTS: [Event; 13] = [
    Event::Fresh,
    Event::NoScan,
    Event::NoOdometry,
    Event::Blind,
    Event::NoCommand,
    Event::FutureScan,
    Event::FutureOdometry,
    Event::OldCommand,
    Event::Line,
    Event::Reset,
    Event::Pause,
    Event::ZoneReturn,
    Event::Malformed,
];

pub(super) fn all() -> [Enumeration; 1] {
    [Enumeration {
        id: "kernel::every_sequence_of_events",
        means: Means::StateSpace,
        claim: "Stale, future, malformed or missing data, a pause, a pulled line and a return in the zone stop in the same tick; a latch ends only by a reset at rest; no old command moves the robot; no set point grows while a stop is active.",
        requirements: &[
            "FRESH-01",
            "FRESH-02",
            "FRESH-03",
            "FRESH-04",
            "LATCH-02",
            "LATCH-03",
            "LATCH-06",
            "LATCH-07",
            "LATCH-08",
            "SILENT-02",
            "SILENT-04",
            "INPUT-10",
            "ZONE-01",
        ],
        domain: "all sequences of 6 of 13 events (scan, odometry, command, line, reset, pause, zone) from a running robot, on Kernel::step",
        file: FILE,
        run,
    }]
}

pub(super) fn config() -> Config<1> {
    let ms = Duration::from_ms;
    let speed = Speed::from_um_per_s;
    let turn = AngularSpeed::from_urad_per_s;
    let mm = Length::from_mm;
    Config {
        footprint: Footprint {
            front: mm(200),
            rear: mm(200),
            left: mm(150),
            right: mm(150),
        },
        kinematics: Kinematics::Differential,
        limits: Limits {
            speed_forward: speed(500_000),
            speed_reverse: Speed::ZERO,
            angular_speed: turn(1_000_000),
            acceleration: Acceleration::from_um_per_s2(1_000_000),
            braking: Acceleration::from_um_per_s2(1_000_000),
            angular_acceleration: AngularAcceleration::from_urad_per_s2(1_000_000),
            angular_braking: AngularAcceleration::from_urad_per_s2(1_000_000),
            ramps: Ramps::Together,
        },
        timing: Timing {
            period: ms(40),
            jitter: ms(2),
            actuation_latency: ms(40),
            scan_age_max: ms(100),
            odometry_age_max: ms(60),
            command_age_max: ms(60),
            rest: ms(40),
            clear: ms(40),
            tracking_window: ms(120),
        },
        tolerances: Tolerances {
            speed: speed(5_000),
            angular_speed: turn(5_000),
            tracking: mm(5),
            odometry_linear: Ppm::from_ppm(1_000),
            odometry_angular: Ppm::from_ppm(1_000),
            rest_speed: speed(2_000),
            rest_angular_speed: turn(2_000),
            follow_speed: speed(200_000),
            follow_angular_speed: turn(300_000),
        },
        zone: ZoneMargins {
            front: mm(20),
            side: mm(20),
        },
        scanners: [Some(scanner())],
        memory: MemoryRules {
            clear_after_scans: 2,
            age_max: ms(600_000),
            clear_at_start: mm(2_000),
            skirt: mm(50),
            body_width_min: mm(1_000),
        },
        obstacle_speed: Speed::ZERO,
        host_death: None,
    }
}

fn scanner() -> Scanner {
    Scanner {
        x: Length::ZERO,
        y: Length::ZERO,
        first_beam: BinaryAngle::from_counts(0x8000_0000),
        increment: 107_000_000,
        beams: 40,
        scan_duration: Duration::from_us(1_000),
        range_min: Length::from_mm(20),
        range_max: Length::from_mm(20_000),
        error: Length::from_mm(5),
        no_return_clear: Length::from_mm(8_000),
        invalid_max: Ppm::from_ppm(50_000),
        invalid_gap_max: 200_000_000,
        masks: [None; MASKS_MAX],
    }
}

/// The robot, its world, and what the rules say of it.
#[derive(Clone)]
pub(super) struct Play {
    robot: Robot,
    now_us: u64,
    pub(super) odometry: Odometry,
    sent: Twist,
    pub(super) status: StopStatus,
    /// What the first beam, straight behind, returns; nothing in an empty world.
    pub(super) behind: Beam,
    scan_us: u64,
    odometry_us: u64,
    command_us: u64,
    released_us: u64,
    latched: bool,
}

impl Play {
    /// A robot that was reset and drives.
    pub(super) fn running() -> Result<Self, String> {
        let robot = Robot::new(config()).map_err(|error| format!("{error:?}"))?;
        let mut play = Self {
            robot,
            now_us: 1_000_000,
            odometry: Odometry::default(),
            sent: Twist::default(),
            status: StopStatus::Latched,
            behind: Beam::NoReturn,
            scan_us: 0,
            odometry_us: 0,
            command_us: 0,
            released_us: 0,
            latched: true,
        };
        for event in [Event::Fresh, Event::Fresh, Event::Fresh, Event::Reset] {
            play.tick(event, false)?;
        }
        for _ in 0..3 {
            play.tick(Event::Fresh, false)?;
        }
        if play.sent.linear.as_um_per_s() < 20_000 {
            return Err(format!(
                "the robot does not drive: {:?} {:?}",
                play.status, play.sent
            ));
        }
        Ok(play)
    }

    pub(super) fn tick(&mut self, event: Event, twin: bool) -> Result<(), String> {
        let span = if event == Event::Pause {
            3 * TICK_US
        } else {
            TICK_US
        };
        self.now_us += span;
        let now = self.now_us;
        // The drive follows at once; odometry is measured now, the scan a moment before.
        let twist = self.sent;
        let step = i64::from(twist.linear.as_um_per_s()) * span.cast_signed() / 1_000_000;
        self.odometry = Odometry {
            stamp: Instant::from_us(now),
            pose: Pose {
                x_um: self.odometry.pose.x_um + step,
                ..Pose::default()
            },
            twist,
            steering: None,
        };
        let decision = self.decide(event);
        self.keep_books(event, now);
        self.judge(event, &decision, twin)
    }

    fn decide(&mut self, event: Event) -> Decision {
        let now = self.now_us;
        let mut beams = [Beam::NoReturn; BEAMS];
        beams[0] = self.behind;
        if event == Event::ZoneReturn {
            beams[20] = Beam::Hit(180);
        }
        let scan = |stamp: u64| {
            Reading::Value(Scan {
                scanner: 0,
                stamp: Instant::from_us(stamp),
                beams: &beams,
            })
        };
        let scans = [match event {
            Event::NoScan | Event::Blind => Reading::Absent,
            Event::FutureScan => scan(now + 5_000),
            Event::Malformed => Reading::Malformed,
            _ => scan(now - 2_000),
        }];
        let odometry = match event {
            Event::NoOdometry | Event::Blind => Reading::Absent,
            Event::FutureOdometry => Reading::Value(Odometry {
                stamp: Instant::from_us(now + 1),
                ..self.odometry
            }),
            _ => Reading::Value(self.odometry),
        };
        let command = |stamp: u64| {
            let twist = Twist {
                linear: Speed::from_um_per_s(400_000),
                angular: AngularSpeed::ZERO,
            };
            Reading::Value(Command {
                stamp: Instant::from_us(stamp),
                motion: Motion::Twist(twist),
            })
        };
        let inputs = Inputs {
            scans: &scans,
            odometry,
            command: match event {
                Event::NoCommand => Reading::Absent,
                Event::OldCommand => command(1_100_000),
                _ => command(now),
            },
            emergency_stop: event == Event::Line,
            reset: (event == Event::Reset).then(|| Instant::from_us(now)),
        };
        self.robot.step(&inputs, Instant::from_us(now))
    }

    /// What the rules need to know, kept apart from the kernel.
    fn keep_books(&mut self, event: Event, now: u64) {
        if !matches!(
            event,
            Event::NoScan | Event::Blind | Event::FutureScan | Event::Malformed
        ) {
            self.scan_us = now - 2_000;
        }
        if !matches!(
            event,
            Event::NoOdometry | Event::Blind | Event::FutureOdometry
        ) {
            self.odometry_us = now;
        }
        if !matches!(event, Event::NoCommand | Event::OldCommand) {
            self.command_us = now;
        }
    }

    fn judge(&mut self, event: Event, decision: &Decision, twin: bool) -> Result<(), String> {
        let now = self.now_us;
        let Motion::Twist(sent) = decision.setpoint else {
            return Err("a differential drive got an arc".into());
        };
        let grows = sent.linear > self.sent.linear;
        let stops = decision.action >= Action::ProtectiveStop;
        let stale = now - self.scan_us > 100_000 || now - self.odometry_us > 60_000;
        let hazard = matches!(
            event,
            Event::FutureScan | Event::FutureOdometry | Event::Pause | Event::ZoneReturn
        ) || event == Event::Malformed
            || stale
            || (twin && event == Event::NoCommand);
        let was_latched = self.latched;
        self.latched =
            event == Event::Line || (was_latched && decision.status == StopStatus::Latched);
        if decision.status == StopStatus::Running && self.status != StopStatus::Running {
            self.released_us = now;
        }
        let rules = [
            (hazard && !stops, "a hazard does not stop"),
            (stops && grows, "a set point grows while a stop is active"),
            (
                self.latched && decision.status != StopStatus::Latched,
                "a pulled line does not latch",
            ),
            (
                was_latched && decision.status != StopStatus::Latched && event != Event::Reset,
                "a latch ends without a reset",
            ),
            (
                was_latched
                    && decision.status != StopStatus::Latched
                    && self.sent != Twist::default(),
                "a latch ends although the robot moves",
            ),
            (
                grows && self.command_us <= self.released_us,
                "a command from before the release moves the robot",
            ),
            (
                grows && now - self.command_us > 60_000,
                "a stale command moves the robot",
            ),
            (
                decision.expires < Instant::from_us(now),
                "a decision has expired at once",
            ),
        ];
        self.sent = sent;
        self.status = decision.status;
        match rules.into_iter().find(|(broken, _)| *broken) {
            Some((_, words)) => Err(format!("{words}: {event:?} at {now} us, {decision:?}")),
            None => Ok(()),
        }
    }
}

fn explore(play: &Play, depth: u32, twin: bool, counted: &mut u64) -> Result<(), String> {
    if depth == 0 {
        return Ok(());
    }
    for event in EVENTS {
        let mut next = play.clone();
        next.tick(event, twin)
            .map_err(|words| format!("{words} after {event:?}"))?;
        *counted += 1;
        explore(&next, depth - 1, twin, counted)?;
    }
    Ok(())
}

fn run(twin: bool) -> Result<u64, String> {
    let start = Play::running()?;
    let ticks = std::sync::atomic::AtomicU64::new(0);
    let first = EVENTS.len() as u64;
    // Each worker takes whole subtrees.
    parallel_each(first * first, |index| {
        let mut play = start.clone();
        for event in [index / first, index % first] {
            let event = EVENTS.get(event as usize).copied().unwrap_or(Event::Fresh);
            play.tick(event, twin)?;
        }
        let mut counted = 1 + u64::from(index % first == 0);
        explore(&play, DEPTH - 2, twin, &mut counted)?;
        ticks.fetch_add(counted, std::sync::atomic::Ordering::Relaxed);
        Ok(())
    })?;
    Ok(ticks.into_inner())
}
