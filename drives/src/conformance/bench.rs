//! The robots of the suite: how to make an adapter, its counterpart and a listener for each.

use haltline::time::{Duration, Instant};
use haltline::units::{Acceleration, AngularAcceleration};

use crate::arcos::command::{number, vel2_sides};
use crate::arcos::{Argument, Command, Deframer, VEL2_DIVISOR};
use crate::car::{self, curve};
use crate::drive::Drive;
use crate::emulator::{Car, CarModel, Robot, Seekur, SeekurModel};
use crate::governor::Braking;
use crate::seekur::{self, Wheels};
use crate::uc::command::{DriveLevel, Request, SteeringLevel};
use crate::uc::line::LineReader;

/// A set point heard on the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// When its last byte was sent.
    pub at: Instant,
    /// Speed, m/s.
    pub linear: f64,
    /// Turn rate, rad/s, or curvature, 1/m.
    pub turn: f64,
    /// Strength of a brake, of 500; 0 without one.
    pub brake: i16,
}

/// Listens to what a host says.
pub trait Tap {
    /// Takes bytes; set points are complete when both of their parts have been said.
    fn hear(&mut self, bytes: &[u8], now: Instant) -> Vec<Told>;
}

/// One robot of the suite.
pub trait Bench {
    /// Name in reports.
    fn name(&self) -> &'static str;
    /// A fresh adapter.
    fn drive(&self, now: Instant) -> Box<dyn Drive>;
    /// A fresh robot.
    fn robot(&self, now: Instant) -> Box<dyn Robot>;
    /// A fresh listener.
    fn tap(&self) -> Box<dyn Tap>;
    /// Control period.
    fn period(&self) -> Duration;
    /// Time after which the robot stops by itself.
    fn watchdog(&self) -> Duration;
    /// Time after which a restart of the robot shows.
    fn notices_restart(&self) -> Duration;
    /// Sure decelerations, m/s² and rad/s².
    fn braking(&self) -> [f64; 2];
    /// Largest forward and reverse speed and turn rate or curvature.
    fn limits(&self) -> [f64; 3];
    /// Largest error of one set point on the wire: speed and turn.
    fn quantum(&self) -> [f64; 2];
    /// Whether motions are speed and curvature.
    fn is_arc(&self) -> bool;
    /// A nonzero set point as bytes, for twins that misuse it.
    fn raw_motion(&self) -> Vec<u8>;
}

const BRAKING: Braking = Braking {
    linear: Acceleration::from_um_per_s2(500_000),
    angular: AngularAcceleration::from_urad_per_s2(1_000_000),
};

/// Seekur Jr over ARCOS.
#[derive(Clone, Copy, Debug)]
pub struct SeekurBench {
    /// How its wheels are told.
    pub wheels: Wheels,
    /// Skid factor of robot and adapter.
    pub skid: f64,
}

impl SeekurBench {
    fn config(&self) -> seekur::Config {
        seekur::Config {
            braking: BRAKING,
            acceleration: BRAKING.linear,
            angular_acceleration: BRAKING.angular,
            speed_max_mmps: 1200,
            turn_max_degps: 80,
            watchdog_max_ms: 2000,
            accept_untold_watchdog: false,
            skid: self.skid,
            wheels: self.wheels,
            feedback_max: Duration::from_ms(250),
            transport: Duration::ZERO,
        }
    }
}

impl Bench for SeekurBench {
    fn name(&self) -> &'static str {
        match self.wheels {
            Wheels::VelRvel => "Seekur Jr (VEL, RVEL)",
            Wheels::Vel2 => "Seekur Jr (VEL2)",
        }
    }

    fn drive(&self, now: Instant) -> Box<dyn Drive> {
        Box::new(seekur::Adapter::new(self.config(), now))
    }

    fn robot(&self, now: Instant) -> Box<dyn Robot> {
        let model = SeekurModel {
            skid: self.skid,
            sip_cycle_ms: 20,
            ..SeekurModel::default()
        };
        Box::new(Seekur::new(model, now))
    }

    fn tap(&self) -> Box<dyn Tap> {
        Box::new(ArcosTap {
            deframer: Deframer::default(),
            skid: self.skid,
            speed: 0.0,
        })
    }

    fn period(&self) -> Duration {
        Duration::from_ms(40)
    }

    fn watchdog(&self) -> Duration {
        Duration::from_ms(2000)
    }

    fn notices_restart(&self) -> Duration {
        // A server that has restarted sends no SIPs and obeys nothing; after a second of silence
        // the handshake begins anew, and until then a ramp goes to nobody.
        Duration::from_ms(1000 + 40)
    }

    fn braking(&self) -> [f64; 2] {
        [0.5, 1.0]
    }

    fn limits(&self) -> [f64; 3] {
        [1.2, 1.2, 80_f64.to_radians() * self.skid]
    }

    fn quantum(&self) -> [f64; 2] {
        match self.wheels {
            Wheels::VelRvel => [1.0e-3, 0.5_f64.to_radians() * self.skid],
            // Half a count a side: 10 mm/s, and twice that as a difference.
            Wheels::Vel2 => [10.0e-3, 10.0 * 0.0056 * self.skid],
        }
    }

    fn is_arc(&self) -> bool {
        false
    }

    fn raw_motion(&self) -> Vec<u8> {
        let commands = [
            Command::int(number::VEL, 700),
            Command::int(number::RVEL, 20),
        ];
        let packets = commands.iter().filter_map(Command::encode);
        packets
            .flat_map(|packet| packet.to_bytes().as_slice().to_vec())
            .collect()
    }
}

struct ArcosTap {
    deframer: Deframer,
    skid: f64,
    speed: f64,
}

impl Tap for ArcosTap {
    fn hear(&mut self, bytes: &[u8], now: Instant) -> Vec<Told> {
        let mut told = Vec::new();
        for byte in bytes {
            let Some(Ok(packet)) = self.deframer.push(*byte, now) else {
                continue;
            };
            let Some(Command {
                number,
                argument: Argument::Int(value),
            }) = Command::decode(&packet)
            else {
                continue;
            };
            let mut say = |linear: f64, turn: f64| {
                told.push(Told {
                    at: now,
                    linear,
                    turn: turn * self.skid,
                    brake: 0,
                });
            };
            match number {
                number::VEL => self.speed = f64::from(value) * 1e-3,
                number::RVEL => say(self.speed, f64::from(value).to_radians()),
                number::VEL2 => {
                    let (left, right) = vel2_sides(value).unwrap_or_default();
                    let side = |count: i8| f64::from(count) * f64::from(VEL2_DIVISOR) * 1e-3;
                    let turn = (side(right) - side(left)) / 2.0 * 5.6;
                    say(f64::midpoint(side(left), side(right)), turn);
                }
                _ => {}
            }
        }
        told
    }
}

/// Model car over its control board.
#[derive(Clone, Copy, Debug)]
pub struct CarBench {
    /// Firmware 0.12.0 or later.
    pub stx: bool,
}

const CAR_BRAKING: Braking = Braking {
    linear: Acceleration::from_um_per_s2(600_000),
    angular: AngularAcceleration::from_urad_per_s2(1_120_000),
};

impl Bench for CarBench {
    fn name(&self) -> &'static str {
        if self.stx {
            "model car"
        } else {
            "model car (old firmware)"
        }
    }

    fn drive(&self, now: Instant) -> Box<dyn Drive> {
        let config = car::Config {
            braking: CAR_BRAKING,
            speed_max_mmps: 800,
            reverse_max_mmps: 500,
            wheelbase_m: 0.25,
            track_m: 0.17,
            dead_man_ms: 200,
            feedback_max: Duration::from_ms(60),
            session: 4711,
        };
        Box::new(car::Adapter::new(config, now))
    }

    fn robot(&self, now: Instant) -> Box<dyn Robot> {
        let model = CarModel {
            sends_stx: self.stx,
            ..CarModel::default()
        };
        Box::new(Car::new(model, now))
    }

    fn tap(&self) -> Box<dyn Tap> {
        Box::new(UcTap {
            lines: LineReader::default(),
            curvature: 0.0,
        })
    }

    fn period(&self) -> Duration {
        Duration::from_ms(20)
    }

    fn watchdog(&self) -> Duration {
        Duration::from_ms(200)
    }

    fn notices_restart(&self) -> Duration {
        Duration::ZERO
    }

    fn braking(&self) -> [f64; 2] {
        [0.6, 1.12]
    }

    fn limits(&self) -> [f64; 3] {
        [0.8, 0.5, 1.0]
    }

    fn quantum(&self) -> [f64; 2] {
        // One level of thrust and one mm/s; half a steering level where the curve is flattest.
        [1.0 / 439.0 + 1.0e-3, 5.0e-3]
    }

    fn is_arc(&self) -> bool {
        true
    }

    fn raw_motion(&self) -> Vec<u8> {
        b"!DRV F 300 300\n".to_vec()
    }
}

struct UcTap {
    lines: LineReader,
    curvature: f64,
}

impl Tap for UcTap {
    fn hear(&mut self, bytes: &[u8], now: Instant) -> Vec<Told> {
        let mut told = Vec::new();
        for byte in bytes {
            let Some(Ok(line)) = self.lines.push(*byte) else {
                continue;
            };
            let Ok(request) = Request::parse(line.as_slice()) else {
                continue;
            };
            let number = |index| {
                let value = request.checked_number(index).ok();
                value.and_then(|value| i16::try_from(value).ok())
            };
            if request.is(0, "STEER") {
                let level = number(1).and_then(SteeringLevel::new);
                let angle = level.map_or(0.0, |level| curve::STEER.angle(level));
                self.curvature = angle.tan() / 0.25;
            }
            let level = match () {
                () if request.is(1, "F") => number(2).and_then(DriveLevel::forward),
                () if request.is(1, "B") => number(2).and_then(DriveLevel::reverse),
                () => None,
            };
            if let Some(level) = level.filter(|_| request.is(0, "DRV")) {
                told.push(Told {
                    at: now,
                    linear: curve::SPEED.speed(level),
                    turn: self.curvature,
                    brake: level.brake(),
                });
            }
        }
        told
    }
}
