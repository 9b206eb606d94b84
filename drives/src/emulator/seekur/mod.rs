//! A Seekur Jr: ARCOS server, motor ramps, skid, watchdog.

mod say;
mod wire;

use haltline::time::{Duration, Instant};

use super::Robot;
use super::motion::{Truth, ramp, steps};
use crate::arcos::command::number;
pub(crate) use wire::Ear;
use wire::{Data, Heard};

/// What this robot is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeekurModel {
    /// Silence after which it stops; 0 never.
    pub watchdog_ms: u16,
    /// Only warns when it expires, as some simulators do.
    pub ignores_watchdog: bool,
    /// Time between two SIPs.
    pub sip_cycle_ms: u8,
    /// Whether it answers CONFIG.
    pub tells_config: bool,
    /// Whether its SIPs end with its clock.
    pub tells_time: bool,
    /// What it makes of a packet that is not the next of the handshake.
    pub out_of_order: OutOfOrder,
    /// True turn rate for each turn rate of the wheels.
    pub skid: f64,
    /// Deceleration of the watchdog's stop, and of all others until somebody sets another, m/s² and
    /// rad/s². (No source says that SETA changes the watchdog's.)
    pub braking: [f64; 2],
    /// Pose at the start.
    pub start: [f64; 3],
}

/// Servers differ in what they make of a packet that is not the next of the handshake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutOfOrder {
    /// They want the count restarted (packet 255).
    Restart,
    /// They are silent.
    Ignore,
    /// They take its number for the count and lose their way until the link is opened again.
    Adopt,
}

impl Default for SeekurModel {
    fn default() -> Self {
        Self {
            watchdog_ms: 2000,
            ignores_watchdog: false,
            sip_cycle_ms: 100,
            tells_config: true,
            tells_time: true,
            out_of_order: OutOfOrder::Restart,
            skid: 1.0,
            braking: [0.5, 1.0],
            start: [0.0; 3],
        }
    }
}

/// E_STOP overrides the configured deceleration, m/s² and rad/s².
const EMERGENCY: [f64; 2] = [2.0, 4.0];
/// A robot whose motors are off brakes by its gears, m/s² and rad/s².
const MOTORS_OFF: [f64; 2] = [0.4, 0.8];

/// The emulated robot.
#[derive(Clone, Debug)]
pub struct Seekur {
    model: SeekurModel,
    ear: Ear,
    out: Vec<u8>,
    server: Server,
    booted: Instant,
    lived: Instant,
    heard: Instant,
    heard_at: Truth,
    next_sip: Instant,
    motors: bool,
    bumper: bool,
    /// The STOP button is pressed, and it has switched the motors off.
    button: bool,
    stalled: bool,
    /// Set points: m/s and rad/s of the wheels. They outlive the watchdog's stop.
    set: [f64; 2],
    emergency: bool,
    speed_max: f64,
    turn_max: f64,
    acceleration: [f64; 2],
    deceleration: [f64; 2],
    /// Speed and turn rate of the wheels.
    wheels: [f64; 2],
    /// What the wheels think: x, y, heading.
    counted: [f64; 3],
    truth: Truth,
}

/// Where the server stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Server {
    /// Awaits this SYNC.
    Waiting(u8),
    /// Synchronised, awaits OPEN.
    Synchronised,
    /// Sends SIPs.
    Open,
    /// Waits for something that never comes.
    Lost,
}

impl Seekur {
    /// A robot that was switched on at `now`.
    #[must_use]
    pub fn new(model: SeekurModel, now: Instant) -> Self {
        Self {
            model,
            ear: Ear::default(),
            out: Vec::new(),
            server: Server::Waiting(0),
            booted: now,
            lived: now,
            heard: now,
            heard_at: Truth::default(),
            next_sip: now,
            motors: false,
            bumper: false,
            button: false,
            stalled: false,
            set: [0.0; 2],
            emergency: false,
            speed_max: 1.2,
            turn_max: 80_f64.to_radians(),
            acceleration: [0.5, 1.0],
            deceleration: model.braking,
            wheels: [0.0; 2],
            counted: [0.0; 3],
            truth: Truth {
                pose: model.start,
                twist: [0.0; 2],
            },
        }
    }

    fn say(&mut self, packet: &[u8]) {
        self.out.extend_from_slice(packet);
    }

    /// Whatever it is, it is a client's packet: the watchdog starts anew.
    fn packet(&mut self, command: Heard, now: Instant) {
        self.heard = now;
        self.heard_at = self.truth;
        match self.server {
            Server::Waiting(step) if command.number == step => self.synchronised(step),
            Server::Waiting(_) => self.confused(),
            Server::Lost => {}
            Server::Synchronised if command.number == number::OPEN => {
                self.server = Server::Open;
                self.next_sip = now;
            }
            Server::Synchronised if command.number == number::SYNC0 => self.synchronised(0),
            Server::Synchronised => {}
            Server::Open => self.obey(command),
        }
    }

    fn confused(&mut self) {
        match self.model.out_of_order {
            OutOfOrder::Restart => {
                self.server = Server::Waiting(0);
                self.say(&Data::default().packet(255));
            }
            OutOfOrder::Ignore => {}
            OutOfOrder::Adopt => self.server = Server::Lost,
        }
    }

    fn synchronised(&mut self, step: u8) {
        if step < 2 {
            self.server = Server::Waiting(step + 1);
            return self.say(&Data::default().packet(step));
        }
        self.server = Server::Synchronised;
        self.say(&self.identity());
    }

    fn obey(&mut self, command: Heard) {
        let value = command.value.unwrap_or_default();
        let metres = f64::from(value) * 1e-3;
        let radians = f64::from(value).to_radians();
        match command.number {
            number::CLOSE => {
                self.server = Server::Waiting(0);
                (self.motors, self.set) = (false, [0.0; 2]);
            }
            number::ENABLE => {
                self.motors = value != 0 && !self.button;
                self.stalled &= !self.motors;
                self.emergency = false;
            }
            number::SETA if value < 0 => self.deceleration[0] = -metres,
            number::SETA => self.acceleration[0] = metres,
            number::SETRA if value < 0 => self.deceleration[1] = -radians,
            number::SETRA => self.acceleration[1] = radians,
            number::SETV => self.speed_max = metres.abs().min(1.2),
            number::SETRV => self.turn_max = radians.abs().min(80_f64.to_radians()),
            number::SETO => self.counted = [0.0; 3],
            number::VEL => self.tell(Some(metres), None),
            number::RVEL | number::ROTATE => self.tell(None, Some(radians)),
            number::VEL2 => self.sides(value),
            number::STOP => self.set = [0.0; 2],
            number::E_STOP | number::QSTOP => {
                self.set = [0.0; 2];
                self.emergency = true;
            }
            number::CONFIG if self.model.tells_config => self.say(&self.config()),
            _ => {}
        }
    }

    /// VEL2: right in the low byte, left in the high one, counts of 20 mm/s.
    fn sides(&mut self, value: i32) {
        let signed = |byte: i32| f64::from(if byte > 127 { byte - 256 } else { byte });
        let right = signed(value.rem_euclid(256)) * 0.020;
        let left = signed(value.div_euclid(256).rem_euclid(256)) * 0.020;
        self.tell(
            Some(f64::midpoint(left, right)),
            Some((right - left) / 2.0 * 5.6),
        );
    }

    fn tell(&mut self, speed: Option<f64>, turn: Option<f64>) {
        self.emergency = false;
        if let Some(speed) = speed {
            self.set[0] = speed.clamp(-self.speed_max, self.speed_max);
        }
        if let Some(turn) = turn {
            self.set[1] = turn.clamp(-self.turn_max, self.turn_max);
        }
    }

    /// Whether the watchdog holds it.
    fn is_left_alone(&self, now: Instant) -> bool {
        let most = Duration::from_ms(u64::from(self.model.watchdog_ms));
        let silent = now.since(self.heard).is_some_and(|gap| gap > most);
        self.model.watchdog_ms > 0 && silent && !self.model.ignores_watchdog
    }

    fn live(&mut self, now: Instant, dt_s: f64) {
        let alone = self.is_left_alone(now);
        let stopped = !self.motors || alone || self.emergency;
        let target = if stopped { [0.0; 2] } else { self.set };
        let down = if self.emergency {
            EMERGENCY
        } else if !self.motors {
            MOTORS_OFF
        } else if alone {
            self.model.braking
        } else {
            self.deceleration
        };
        for axis in 0..2 {
            let up = self.acceleration[axis];
            self.wheels[axis] = ramp(self.wheels[axis], target[axis], up, down[axis], dt_s);
        }
        let mut wheels = Truth {
            pose: self.counted,
            twist: self.wheels,
        };
        wheels.advance(self.wheels, dt_s);
        self.counted = wheels.pose;
        let ground = [self.wheels[0], self.wheels[1] * self.model.skid];
        self.truth.advance(ground, dt_s);
        if self.server == Server::Open && now >= self.next_sip {
            self.next_sip = now.plus(Duration::from_ms(u64::from(self.model.sip_cycle_ms)));
            self.say(&self.sip(now));
        }
    }
}

impl Robot for Seekur {
    fn receive(&mut self, bytes: &[u8], now: Instant) {
        self.step(now);
        for command in self.ear.hear(bytes) {
            self.packet(command, now);
        }
    }

    fn step(&mut self, now: Instant) {
        let mut lived = self.lived;
        for (at, dt_s) in steps(&mut lived, now) {
            self.live(at, dt_s);
        }
        self.lived = lived;
    }

    fn outgoing(&mut self) -> Vec<u8> {
        core::mem::take(&mut self.out)
    }

    fn truth(&self) -> Truth {
        self.truth
    }

    fn reboot(&mut self, now: Instant) {
        let fresh = Self::new(self.model, now);
        *self = Self {
            truth: self.truth,
            wheels: self.wheels,
            button: self.button,
            ..fresh
        };
    }

    fn last_heard(&self) -> (Instant, Truth) {
        (self.heard, self.heard_at)
    }

    fn bump(&mut self, touching: bool) {
        self.bumper = touching;
    }

    fn press_stop(&mut self, pressed: bool) {
        self.button = pressed;
        if pressed {
            // The motors stay off until somebody enables them again.
            (self.motors, self.stalled) = (false, true);
        }
    }

    fn reopened(&mut self) {
        if self.model.out_of_order == OutOfOrder::Adopt {
            // The session ended with its connection.
            (self.server, self.motors, self.set) = (Server::Waiting(0), false, [0.0; 2]);
        }
    }
}
