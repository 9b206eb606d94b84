//! Adapters, emulators and worlds by the names of the robots.

use haltline::time::{Duration, Instant};
use haltline_robots::{Kinematics, Robot as File};
use haltline_scenarios::math::Pose;
use haltline_scenarios::world::{Body, Course, Shape, Trigger, World};

use crate::drive::Drive;
use crate::emulator::{Car, CarModel, Robot, Seekur, SeekurModel};
use crate::governor::Braking;
use crate::seekur::Wheels;
use crate::{car, seekur};

/// Robots that have an adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Seekur Jr, ARCOS.
    SeekurJr,
    /// Model car of TU Darmstadt, uc_bridge.
    PsesCar,
}

impl Kind {
    /// All names a person may write.
    pub const NAMES: [&'static str; 2] = ["seekur-jr", "pses-car"];

    /// By name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "seekur-jr" => Some(Self::SeekurJr),
            "pses-car" => Some(Self::PsesCar),
            _ => None,
        }
    }

    /// The robot that carries the name of one that comes with the project.
    #[must_use]
    pub fn of(file: &File) -> Option<Self> {
        let is = |kind: &Self| File::embedded(kind.file()).is_ok_and(|own| own.name == file.name);
        [Self::SeekurJr, Self::PsesCar].into_iter().find(is)
    }

    /// Whether its adapter can steer the robot of `file`.
    #[must_use]
    pub const fn fits(self, file: &File) -> bool {
        matches!(
            (self, &file.values.kinematics),
            (Self::SeekurJr, Kinematics::Differential) | (Self::PsesCar, Kinematics::Ackermann(_))
        )
    }

    /// Name of the robot file that comes with the project.
    #[must_use]
    pub const fn file(self) -> &'static str {
        match self {
            Self::SeekurJr => "seekur_jr",
            Self::PsesCar => "pses_car",
        }
    }

    /// Speed of its serial line, baud.
    #[must_use]
    pub const fn baud(self) -> u32 {
        match self {
            Self::SeekurJr => 38_400,
            Self::PsesCar => crate::uc::BAUD,
        }
    }

    /// An adapter for the robot of `file`.
    ///
    /// - `session`: a number that differs from run to run
    #[must_use]
    pub fn adapter(self, file: &File, session: u32, now: Instant) -> Box<dyn Drive> {
        self.skidding_adapter(file, 1.0, session, now)
    }

    /// As [`Kind::adapter`], for a robot whose wheels turn it less than they say.
    ///
    /// - `skid`: true turn for each turn of the wheels, in (0, 1]; a steered robot has none
    #[must_use]
    pub fn skidding_adapter(
        self,
        file: &File,
        skid: f64,
        session: u32,
        now: Instant,
    ) -> Box<dyn Drive> {
        match self {
            Self::SeekurJr => {
                let config = seekur::Config {
                    skid,
                    ..seekur_config(file)
                };
                Box::new(seekur::Adapter::new(config, now))
            }
            Self::PsesCar => Box::new(car::Adapter::new(car_config(file, session), now)),
        }
    }

    /// The emulated robot, whose drive stops by itself as the file promises.
    #[must_use]
    pub fn emulated(self, file: &File, habits: Habits, now: Instant) -> Box<dyn Robot> {
        let silent = &file.values.host_death;
        match self {
            Self::SeekurJr => Box::new(Seekur::new(
                SeekurModel {
                    watchdog_ms: milliseconds(habits.watchdog_s.unwrap_or(silent.watchdog_s)),
                    ignores_watchdog: habits.ignores_watchdog,
                    sip_cycle_ms: 20,
                    braking: [silent.braking_mps2, silent.angular_braking_radps2],
                    skid: habits.skid,
                    ..SeekurModel::default()
                },
                now,
            )),
            Self::PsesCar => Box::new(Car::new(
                CarModel {
                    ignores_dead_man: habits.ignores_watchdog,
                    coasting: silent.braking_mps2,
                    ..CarModel::default()
                },
                now,
            )),
        }
    }
}

/// How an emulated robot differs from its file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Habits {
    /// Told and kept instead of the file's watchdog time.
    pub watchdog_s: Option<f64>,
    /// It tells a watchdog and does not stop by it.
    pub ignores_watchdog: bool,
    /// True turn rate for each turn rate of its wheels.
    pub skid: f64,
}

impl Default for Habits {
    fn default() -> Self {
        Self {
            watchdog_s: None,
            ignores_watchdog: false,
            skid: 1.0,
        }
    }
}

fn milliseconds(seconds: f64) -> u16 {
    (seconds * 1e3).round().clamp(0.0, 65_535.0) as u16
}

fn braking(file: &File) -> Braking {
    Braking {
        linear: file.config.limits.braking,
        angular: file.config.limits.angular_braking,
    }
}

/// The Seekur Jr's adapter as the robot file wants it.
#[must_use]
pub fn seekur_config(file: &File) -> seekur::Config {
    let limits = &file.values.limits;
    seekur::Config {
        braking: braking(file),
        acceleration: file.config.limits.acceleration,
        angular_acceleration: file.config.limits.angular_acceleration,
        speed_max_mmps: milliseconds(limits.speed_forward_mps),
        // Rounded up: what the kernel allows must not be cut.
        turn_max_degps: limits.angular_speed_radps.to_degrees().ceil() as u16,
        watchdog_max_ms: milliseconds(file.values.host_death.watchdog_s),
        accept_untold_watchdog: false,
        skid: 1.0,
        wheels: Wheels::VelRvel,
        feedback_max: Duration::from_ms(250),
        transport: Duration::ZERO,
    }
}

/// The model car's adapter as the robot file wants it.
#[must_use]
pub fn car_config(file: &File, session: u32) -> car::Config {
    let limits = &file.values.limits;
    let wheelbase_m = match file.values.kinematics {
        Kinematics::Ackermann(steering) => steering.wheelbase_m,
        Kinematics::Differential => 0.25,
    };
    let signed = |mps: f64| (mps * 1e3).round().clamp(0.0, 32_767.0) as i16;
    car::Config {
        braking: braking(file),
        speed_max_mmps: signed(limits.speed_forward_mps),
        reverse_max_mmps: signed(limits.speed_reverse_mps),
        wheelbase_m,
        track_m: 0.17,
        dead_man_ms: milliseconds(file.values.host_death.watchdog_s).max(1),
        feedback_max: Duration::from_ms(60),
        session: session.max(1),
    }
}

fn wall(from: [f64; 2], to: [f64; 2]) -> Body {
    body(Shape::Segment(from, to), Pose::default())
}

fn body(shape: Shape, home: Pose) -> Body {
    Body {
        name: String::new(),
        shape,
        home,
        invisible: false,
        trigger: Trigger::At(0.0),
        course: Course::Still,
    }
}

/// A closed corridor along x, `ahead` and `behind` metres long and 2 × `side` wide, with a box in
/// it if `[x, y, half length, half width]` is given.
#[must_use]
pub fn corridor(ahead: f64, behind: f64, side: f64, obstacle: Option<[f64; 4]>) -> World {
    let mut bodies = vec![
        wall([-behind, side], [ahead, side]),
        wall([-behind, -side], [ahead, -side]),
        wall([ahead, -side], [ahead, side]),
        wall([-behind, -side], [-behind, side]),
    ];
    if let Some([x, y, length, width]) = obstacle {
        bodies.push(body(Shape::Box([length, width]), Pose::new(x, y, 0.0)));
    }
    World::new(bodies)
}

/// The corridor with an obstacle in which a robot is shown, and way points past the obstacle to
/// the wall at the end, which is not to be touched either.
#[must_use]
pub fn course(kind: Kind) -> (World, Vec<[f64; 2]>) {
    match kind {
        Kind::SeekurJr => (
            corridor(9.0, 3.0, 1.8, Some([4.0, 1.1, 0.4, 0.5])),
            vec![[2.0, -0.6], [6.0, -0.6], [30.0, -0.6]],
        ),
        Kind::PsesCar => (
            // Nothing stands in the metre around the start that the operator vouches for.
            corridor(2.6, 1.2, 1.1, Some([1.3, 0.3, 0.1, 0.1])),
            vec![[0.9, -0.15], [1.7, -0.15], [30.0, -0.15]],
        ),
    }
}

/// Steers towards way points: somebody's simple planner, which looks at no obstacle.
///
/// Answers speed and turn rate, or speed and curvature for a steered robot.
#[must_use]
pub fn follow(kind: Kind, points: &[[f64; 2]], pose: [f64; 3], speed_mps: f64) -> [f64; 2] {
    let [x, y, theta] = pose;
    let reach = match kind {
        Kind::SeekurJr => 1.2,
        Kind::PsesCar => 0.5,
    };
    let ahead = points.iter().find(|point| point[0] - x > reach);
    let Some([goal_x, goal_y]) = ahead.or(points.last()).copied() else {
        return [0.0; 2];
    };
    let (dx, dy) = (goal_x - x, goal_y - y);
    let bearing = dy.atan2(dx) - theta;
    // Pure pursuit: the arc through the point.
    let curvature = (2.0 * bearing.sin() / dx.hypot(dy).max(reach)).clamp(-0.8, 0.8);
    match kind {
        Kind::SeekurJr => [speed_mps, speed_mps * curvature],
        Kind::PsesCar => [speed_mps, curvature],
    }
}
