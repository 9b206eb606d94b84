//! The robots of the suite: how to make an adapter, its counterpart and a listener for each.

use haltline::time::{Duration, Instant};
use haltline::units::{Acceleration, AngularAcceleration};

use super::taps::{ArcosTap, Tap, UcTap};
use crate::arcos::Command;
use crate::arcos::command::number;
use crate::car;
use crate::drive::Drive;
use crate::emulator::{Car, CarModel, Robot, Seekur, SeekurModel};
use crate::governor::Braking;
use crate::seekur::{self, Wheels};

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
    /// Deceleration after the watchdog, m/s².
    fn silent_braking(&self) -> f64;
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
        Box::new(ArcosTap::new(self.skid))
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

    fn silent_braking(&self) -> f64 {
        SeekurModel::default().braking[0]
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
        Box::new(UcTap::default())
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

    fn silent_braking(&self) -> f64 {
        0.3
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
