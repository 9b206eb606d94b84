//! What a robot says besides SIP and configuration: handshake, encoders, I/O, gyro, joystick, battery.

use super::config::{self, Config, Text};
use super::frame::Packet;
use super::sip::{self, Sip};
use crate::cursor::Cursor;

/// Packet types.
#[allow(missing_docs)] // the names are the manuals'
pub mod kind {
    pub const CONFIG: u8 = 0x20;
    pub const ENCODER: u8 = 0x90;
    pub const GYRO: u8 = 0x98;
    pub const IO: u8 = 0xF0;
    pub const JOYSTICK: u8 = 0xF8;
    pub const BATTERY: u8 = 0xFA;
    pub const RESTART_SYNC: u8 = 255;
}

/// Answer to the last step of the handshake.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Identity {
    /// Name given by the owner.
    pub name: Text,
    /// Robot class.
    pub class: Text,
    /// Robot type.
    pub subclass: Text,
}

impl Identity {
    /// Reads the data of a SYNC2 echo; `None` unless all three texts are there.
    #[must_use]
    pub fn decode(packet: &Packet) -> Option<Self> {
        let mut data = Cursor::new(packet.data());
        Some(Self {
            name: config::text(data.text()?),
            class: config::text(data.text()?),
            subclass: config::text(data.text()?),
        })
    }

    /// The echo of SYNC2.
    #[must_use]
    pub fn encode(&self) -> Option<Packet> {
        let mut out = crate::cursor::Buffer::<80>::default();
        for text in [self.name, self.class, self.subclass] {
            (out.extend(text.as_slice()) && out.push(0)).then_some(())?;
        }
        Packet::new(2, out.as_slice())
    }
}

/// Encoder ticks since the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Encoders {
    /// Left side.
    pub left: i32,
    /// Right side.
    pub right: i32,
}

/// Raw samples of the gyro, 25 ms apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Gyro {
    /// Rates, about 0 to 1023; about 512 at rest, more when turning clockwise.
    pub rates: [Option<i16>; 16],
}

impl Gyro {
    /// Turn rate of a raw value, deg/s counter-clockwise.
    ///
    /// - `still`: mean raw value at rest
    /// - `scaler`: 1.626 on the Seekur Jr (seekurjr.p)
    #[must_use]
    pub fn degrees_per_second(raw: f64, still: f64, scaler: f64) -> f64 {
        -((raw - still) * 5.0 / 1023.0) * 300.0 / 2.5 * scaler
    }
}

/// Joystick of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Joystick {
    /// Both buttons.
    pub buttons: [bool; 2],
    /// 0 full left to 1023 full right.
    pub x: u16,
    /// 0 back to 1023 forward.
    pub y: u16,
    /// 0 to 1024.
    pub throttle: u16,
}

/// One battery of the pack.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Battery {
    /// Three bytes of flags.
    pub flags: [u8; 3],
    /// Relative and absolute state of charge, percent.
    pub charge_percent: [u8; 2],
}

/// Anything a robot may send.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(clippy::large_enum_variant)] // passed on the stack, once per packet, without an allocator
pub enum Message {
    /// Echo of a handshake step; only in a handshake, where ids 0 to 2 mean this.
    Sync(u8),
    /// The robot wants the handshake to start again.
    RestartSync,
    /// Standard information.
    Sip(Sip),
    /// Configuration.
    Config(Config),
    /// Encoders.
    Encoders(Encoders),
    /// Gyro.
    Gyro(Gyro),
    /// Joystick.
    Joystick(Joystick),
    /// State of the batteries; as many as fit.
    Battery([Option<Battery>; 4]),
    /// Digital and analogue ports, not interpreted.
    Io,
    /// A well-framed packet of a type not known here.
    Other(u8),
}

/// Reads any packet of a robot; `None` if its type is known and its content is not whole.
#[must_use]
pub fn decode(packet: &Packet) -> Option<Message> {
    let mut data = Cursor::new(packet.data());
    Some(match packet.id() {
        id @ 0..=2 => Message::Sync(id),
        sip::STOPPED | sip::MOVING => Message::Sip(Sip::decode(packet)?),
        kind::CONFIG => Message::Config(Config::decode(packet)?),
        kind::ENCODER => Message::Encoders(Encoders {
            left: data.i32()?,
            right: data.i32()?,
        }),
        kind::GYRO => Message::Gyro(gyro(&mut data)?),
        kind::JOYSTICK => Message::Joystick(Joystick {
            buttons: [data.u8()? != 0, data.u8()? != 0],
            x: data.u16()?,
            y: data.u16()?,
            throttle: data.u16()?,
        }),
        kind::BATTERY => Message::Battery(batteries(&mut data)?),
        kind::IO => Message::Io,
        kind::RESTART_SYNC => Message::RestartSync,
        other => Message::Other(other),
    })
}

fn gyro(data: &mut Cursor<'_>) -> Option<Gyro> {
    let mut gyro = Gyro::default();
    let count = data.u8()?;
    let mut slots = gyro.rates.iter_mut();
    for _ in 0..count {
        let rate = data.i16()?;
        data.u8()?; // temperature
        if let Some(slot) = slots.next() {
            *slot = Some(rate);
        }
    }
    Some(gyro)
}

fn batteries(data: &mut Cursor<'_>) -> Option<[Option<Battery>; 4]> {
    let mut batteries = [None; 4];
    let (count, each) = (data.u8()?, data.u8()?);
    let mut slots = batteries.iter_mut();
    for _ in 0..count {
        let [flags @ .., relative, absolute] =
            *data.bytes(usize::from(each))?.first_chunk::<5>()?;
        if let Some(slot) = slots.next() {
            *slot = Some(Battery {
                flags,
                charge_percent: [relative, absolute],
            });
        }
    }
    Some(batteries)
}
