//! What a client says: a command number and at most one argument.

use super::frame::Packet;

/// Command numbers (ARCOS tables; the names are the manuals').
#[allow(missing_docs)] // each is documented by its name in the manuals' tables
pub mod number {
    pub const SYNC0: u8 = 0;
    pub const SYNC1: u8 = 1;
    pub const SYNC2: u8 = 2;
    pub const PULSE: u8 = 0;
    pub const OPEN: u8 = 1;
    pub const CLOSE: u8 = 2;
    pub const ENABLE: u8 = 4;
    pub const SETA: u8 = 5;
    pub const SETV: u8 = 6;
    pub const SETO: u8 = 7;
    pub const MOVE: u8 = 8;
    pub const ROTATE: u8 = 9;
    pub const SETRV: u8 = 10;
    pub const VEL: u8 = 11;
    pub const HEAD: u8 = 12;
    pub const DHEAD: u8 = 13;
    pub const JOYINFO: u8 = 17;
    pub const CONFIG: u8 = 18;
    pub const ENCODER: u8 = 19;
    pub const RVEL: u8 = 21;
    pub const SETRA: u8 = 23;
    pub const STOP: u8 = 29;
    pub const VEL2: u8 = 32;
    pub const IOREQUEST: u8 = 40;
    pub const BUMPSTALL: u8 = 44;
    pub const JOYDRIVE: u8 = 47;
    pub const HOSTBAUD: u8 = 50;
    pub const E_STOP: u8 = 55;
    pub const E_STALL: u8 = 56;
    pub const QSTOP: u8 = 57;
    pub const GYRO: u8 = 58;
    pub const BATTERYINFO: u8 = 62;
    pub const LATVEL: u8 = 110;
}

/// Argument types: positive, negative, text.
const POSITIVE: u8 = 0x3B;
const NEGATIVE: u8 = 0x1B;
const TEXT: u8 = 0x2B;

/// The argument of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument<'a> {
    /// Nothing after the command number.
    None,
    /// A sign and a 16-bit magnitude: −65535..=65535.
    Int(i32),
    /// A counted text.
    Text(&'a [u8]),
}

/// One command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Command<'a> {
    /// See [`number`].
    pub number: u8,
    /// Its argument.
    pub argument: Argument<'a>,
}

impl<'a> Command<'a> {
    /// A command without argument.
    #[must_use]
    pub const fn bare(number: u8) -> Self {
        Self {
            number,
            argument: Argument::None,
        }
    }

    /// A command with a signed argument.
    #[must_use]
    pub const fn int(number: u8, value: i32) -> Self {
        Self {
            number,
            argument: Argument::Int(value),
        }
    }

    /// VEL2: a speed for each side in counts of 20 mm/s, left in the high byte.
    #[must_use]
    pub fn vel2(left: i8, right: i8) -> Self {
        let value = i16::from_be_bytes([left.cast_unsigned(), right.cast_unsigned()]);
        Self::int(number::VEL2, i32::from(value))
    }

    /// Reads what a client sent; `None` for an argument type nobody has defined, for a text
    /// longer than the packet and for bytes that follow the argument.
    #[must_use]
    pub fn decode(packet: &'a Packet) -> Option<Self> {
        let argument = match packet.data() {
            [] => Argument::None,
            [POSITIVE, low, high] => Argument::Int(i32::from(u16::from_le_bytes([*low, *high]))),
            [NEGATIVE, low, high] => {
                Argument::Int(0_i32.saturating_sub(i32::from(u16::from_le_bytes([*low, *high]))))
            }
            [TEXT, count, text @ ..] if usize::from(*count) == text.len() => Argument::Text(text),
            _ => return None,
        };
        Some(Self {
            number: packet.id(),
            argument,
        })
    }

    /// The command as a packet; `None` if the argument does not fit.
    #[must_use]
    pub fn encode(&self) -> Option<Packet> {
        match self.argument {
            Argument::None => Packet::new(self.number, &[]),
            Argument::Int(value) => {
                let kind = if value < 0 { NEGATIVE } else { POSITIVE };
                let [low, high] = u16::try_from(value.unsigned_abs()).ok()?.to_le_bytes();
                Packet::new(self.number, &[kind, low, high])
            }
            Argument::Text(text) => {
                let mut data = crate::cursor::Buffer::<200>::default();
                let count = u8::try_from(text.len()).ok()?;
                (data.push(TEXT) && data.push(count) && data.extend(text))
                    .then(|| Packet::new(self.number, data.as_slice()))?
            }
        }
    }
}

/// Both sides of a VEL2 value.
#[must_use]
pub fn vel2_sides(value: i32) -> Option<(i8, i8)> {
    let [left, right] = i16::try_from(value).ok()?.to_be_bytes();
    Some((left.cast_signed(), right.cast_signed()))
}
