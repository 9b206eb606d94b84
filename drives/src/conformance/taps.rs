//! Listeners on the wires.

use haltline::time::Instant;

use crate::arcos::command::{number, vel2_sides};
use crate::arcos::{Argument, Command, Deframer, VEL2_DIVISOR};
use crate::car::curve;
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

pub(super) struct ArcosTap {
    deframer: Deframer,
    skid: f64,
    speed: f64,
}

impl ArcosTap {
    pub(super) fn new(skid: f64) -> Self {
        Self {
            deframer: Deframer::default(),
            skid,
            speed: 0.0,
        }
    }
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

#[derive(Default)]
pub(super) struct UcTap {
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
