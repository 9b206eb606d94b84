//! A Seekur Jr: ARCOS server, motor ramps, skid, watchdog.

mod say;

use haltline::time::{Duration, Instant};

use super::Robot;
use super::motion::{Truth, ramp, steps};
use crate::arcos::command::{number, vel2_sides};
use crate::arcos::config::text;
use crate::arcos::server::Identity;
use crate::arcos::{Argument, Command, Deframer, Packet, VEL2_DIVISOR};

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
    /// True turn rate for each turn rate of the wheels.
    pub skid: f64,
    /// Deceleration of its own stops until somebody sets another, m/s² and rad/s².
    pub braking: [f64; 2],
    /// Pose at the start.
    pub start: [f64; 3],
}

impl Default for SeekurModel {
    fn default() -> Self {
        Self {
            watchdog_ms: 2000,
            ignores_watchdog: false,
            sip_cycle_ms: 100,
            tells_config: true,
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
    deframer: Deframer,
    out: Vec<u8>,
    server: Server,
    lived: Instant,
    heard: Instant,
    heard_twist: [f64; 2],
    next_sip: Instant,
    motors: bool,
    bumper: bool,
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
}

impl Seekur {
    /// A robot that was switched on at `now`.
    #[must_use]
    pub fn new(model: SeekurModel, now: Instant) -> Self {
        Self {
            model,
            deframer: Deframer::default(),
            out: Vec::new(),
            server: Server::Waiting(0),
            lived: now,
            heard: now,
            heard_twist: [0.0; 2],
            next_sip: now,
            motors: false,
            bumper: false,
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

    /// Someone presses the STOP button: the motors go off.
    pub fn press_stop(&mut self) {
        self.motors = false;
    }

    fn say(&mut self, packet: Option<Packet>) {
        if let Some(packet) = packet {
            self.out.extend_from_slice(packet.to_bytes().as_slice());
        }
    }

    fn packet(&mut self, packet: &Packet, now: Instant) {
        let Some(command) = Command::decode(packet) else {
            return; // an argument that cannot be read is ignored, the packet counts for nothing
        };
        self.heard = now;
        self.heard_twist = self.truth.twist;
        match self.server {
            Server::Waiting(step) => self.synchronise(step, command.number, now),
            Server::Synchronised if command.number == number::OPEN => {
                self.server = Server::Open;
                self.next_sip = now;
            }
            Server::Synchronised if command.number == number::SYNC0 => {
                self.synchronise(0, number::SYNC0, now);
            }
            Server::Synchronised => {}
            Server::Open => self.obey(&command),
        }
    }

    fn synchronise(&mut self, step: u8, number: u8, _now: Instant) {
        if number > 2 {
            return; // no part of a handshake
        }
        if number != step {
            self.server = Server::Waiting(0);
            return self.say(Packet::new(255, &[]));
        }
        if step < 2 {
            self.server = Server::Waiting(step + 1);
            return self.say(Packet::new(step, &[]));
        }
        self.server = Server::Synchronised;
        let identity = Identity {
            name: text(b"Haltline"),
            class: text(b"Pioneer"),
            subclass: text(b"seekurjr"),
        };
        self.say(identity.encode());
    }

    fn obey(&mut self, command: &Command<'_>) {
        let value = match command.argument {
            Argument::Int(value) => value,
            _ => 0,
        };
        let metres = f64::from(value) * 1e-3;
        let radians = f64::from(value).to_radians();
        match command.number {
            number::CLOSE => {
                self.server = Server::Waiting(0);
                (self.motors, self.set) = (false, [0.0; 2]);
            }
            number::ENABLE => {
                self.motors = value != 0;
                self.emergency = false;
            }
            number::SETA if value < 0 => self.deceleration[0] = -metres,
            number::SETA => self.acceleration[0] = metres,
            number::SETRA if value < 0 => self.deceleration[1] = -radians,
            number::SETRA => self.acceleration[1] = radians,
            number::SETV => self.speed_max = metres.abs().min(1.2),
            number::SETRV => self.turn_max = radians.abs().min(80_f64.to_radians()),
            number::VEL => self.tell(Some(metres), None),
            number::RVEL | number::ROTATE => self.tell(None, Some(radians)),
            number::VEL2 => {
                if let Some((left, right)) = vel2_sides(value) {
                    let side = |count: i8| f64::from(count) * f64::from(VEL2_DIVISOR) * 1e-3;
                    let (left, right) = (side(left), side(right));
                    let turn = (right - left) / 2.0 * 1e3 * 0.0056;
                    self.tell(Some(f64::midpoint(left, right)), Some(turn));
                }
            }
            number::STOP => self.set = [0.0; 2],
            number::E_STOP | number::QSTOP => {
                self.set = [0.0; 2];
                self.emergency = true;
            }
            number::CONFIG if self.model.tells_config => self.say(self.config().encode()),
            _ => {}
        }
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
        let stopped = !self.motors || self.is_left_alone(now) || self.emergency;
        let target = if stopped { [0.0; 2] } else { self.set };
        let down = if self.emergency {
            EMERGENCY
        } else if self.motors {
            self.deceleration
        } else {
            MOTORS_OFF
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
            self.say(self.sip(now).encode());
        }
    }
}

impl Robot for Seekur {
    fn receive(&mut self, bytes: &[u8], now: Instant) {
        self.step(now);
        for byte in bytes {
            if let Some(Ok(packet)) = self.deframer.push(*byte, now) {
                self.packet(&packet, now);
            }
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
            ..fresh
        };
    }

    fn last_heard(&self) -> (Instant, [f64; 2]) {
        (self.heard, self.heard_twist)
    }

    fn bump(&mut self, touching: bool) {
        self.bumper = touching;
    }
}
