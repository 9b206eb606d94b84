//! Listeners on the wires.

//!
//! They read the wire with the emulators' means and with nothing of the adapters'.

use haltline::time::Instant;

use crate::emulator::wire::{Ear, steady_speed, wheel_angle};

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

/// Command numbers and the scale of VEL2 (ARCOS tables).
const VEL: u8 = 11;
const RVEL: u8 = 21;
const VEL2: u8 = 32;

pub(super) struct ArcosTap {
    ear: Ear,
    skid: f64,
    speed: f64,
}

impl ArcosTap {
    pub(super) fn new(skid: f64) -> Self {
        Self {
            ear: Ear::default(),
            skid,
            speed: 0.0,
        }
    }
}

impl Tap for ArcosTap {
    fn hear(&mut self, bytes: &[u8], now: Instant) -> Vec<Told> {
        let mut told = Vec::new();
        for heard in self.ear.hear(bytes) {
            let Some(value) = heard.value else { continue };
            let (linear, turn) = match heard.number {
                VEL => {
                    self.speed = f64::from(value) * 1e-3;
                    continue;
                }
                RVEL => (self.speed, f64::from(value).to_radians()),
                VEL2 => {
                    // A signed byte for each side, 20 mm/s a count, right in the low one.
                    let side = |byte: i32| f64::from((byte + 128).rem_euclid(256) - 128) * 0.02;
                    let (left, right) = (side(value >> 8), side(value));
                    (f64::midpoint(left, right), (right - left) / 2.0 * 5.6)
                }
                _ => continue,
            };
            told.push(Told {
                at: now,
                linear,
                turn: turn * self.skid,
                brake: 0,
            });
        }
        told
    }
}

#[derive(Default)]
pub(super) struct UcTap {
    line: Vec<u8>,
    curvature: f64,
}

impl UcTap {
    fn line(&mut self, line: &str, now: Instant) -> Option<Told> {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let twice =
            |one: &str, other: &str| -> Option<i16> { one.parse().ok().filter(|_| one == other) };
        let (linear, brake) = match words.as_slice() {
            ["!STEER", one, other] => {
                self.curvature = wheel_angle(twice(one, other)?).tan() / 0.25;
                return None;
            }
            ["!DRV", "F", one, other] => match twice(one, other)? {
                level if level < 0 => (0.0, -level),
                level => (steady_speed(level), 0),
            },
            ["!DRV", "B", one, other] => (steady_speed(-twice(one, other)?), 0),
            _ => return None,
        };
        Some(Told {
            at: now,
            linear,
            turn: self.curvature,
            brake,
        })
    }
}

impl Tap for UcTap {
    fn hear(&mut self, bytes: &[u8], now: Instant) -> Vec<Told> {
        let mut told = Vec::new();
        for byte in bytes {
            if *byte == b'\n' {
                let line = core::mem::take(&mut self.line);
                told.extend(self.line(&String::from_utf8_lossy(&line), now));
            } else {
                self.line.push(*byte);
            }
        }
        told
    }
}
