//! Data groups: values in three encodings, with or without CRC, and what stands for no value.

use crate::cursor::{Buffer, Cursor};

/// Most values of one group.
pub const VALUES_MAX: usize = 10;

/// Type of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// 8 bits unsigned.
    U8,
    /// 16 bits unsigned.
    U16,
    /// 16 bits signed.
    I16,
    /// 32 bits unsigned.
    U32,
}

impl Type {
    /// Type of a named channel of the board; `None` for a name it does not have.
    #[must_use]
    pub fn of_channel(name: &str) -> Option<Self> {
        const NAMES: [(&str, Type); 30] = [
            ("AX", Type::I16),
            ("AY", Type::I16),
            ("AZ", Type::I16),
            ("GX", Type::I16),
            ("GY", Type::I16),
            ("GZ", Type::I16),
            ("MX", Type::I16),
            ("MY", Type::I16),
            ("MZ", Type::I16),
            ("USF", Type::U16),
            ("USL", Type::U16),
            ("USR", Type::U16),
            ("VSBAT", Type::U16),
            ("VDBAT", Type::U16),
            ("HALL_CNT", Type::U8),
            ("HALL_DT", Type::U16),
            ("HALL_DT8", Type::U16),
            ("_CNT", Type::U32),
            ("_CNT16", Type::U16),
            ("_CNT8", Type::U8),
            ("_TICS", Type::U32),
            ("_TICS16", Type::U16),
            ("_TICS8", Type::U8),
            ("_DTICS", Type::U32),
            ("_DTICS16", Type::U16),
            ("_DTICS8", Type::U8),
            ("PBA", Type::U8),
            ("PBB", Type::U8),
            ("PBC", Type::U8),
            ("_DLY", Type::U8),
        ];
        NAMES
            .iter()
            .find(|(known, _)| known.eq_ignore_ascii_case(name))
            .map(|(_, kind)| *kind)
    }

    /// The five highest values of a type mean that there is no value.
    const fn highest(self) -> i64 {
        match self {
            Self::U8 => 0xFF,
            Self::U16 => 0xFFFF,
            Self::I16 => 0x7FFF,
            Self::U32 => 0xFFFF_FFFF,
        }
    }

    /// Lowest value of the type.
    const fn lowest(self) -> i64 {
        match self {
            Self::I16 => -0x8000,
            Self::U8 | Self::U16 | Self::U32 => 0,
        }
    }

    fn value(self, raw: i64) -> Option<i64> {
        (raw <= self.highest().saturating_sub(5)).then_some(raw)
    }

    fn read(self, data: &mut Cursor<'_>) -> Option<i64> {
        Some(match self {
            Self::U8 => i64::from(data.u8()?),
            Self::U16 => i64::from(data.u16()?),
            Self::I16 => i64::from(data.i16()?),
            Self::U32 => i64::from(data.u32()?),
        })
    }

    /// Little-endian bytes of a value; `None` writes the type's "none".
    fn write(self, value: Option<i64>, out: &mut Buffer<40>) -> Option<()> {
        let raw = value.unwrap_or(self.highest());
        let bytes = raw.to_le_bytes();
        let width = match self {
            Self::U8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 => 4,
        };
        out.extend(bytes.get(..width)?).then_some(())
    }
}

/// How a group's values are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Decimal numbers between bars.
    Ascii,
    /// Hexadecimal digits of little-endian values.
    Hex,
    /// Base 64 without padding.
    Base64,
}

/// What a host must know of a group to read it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Group<'a> {
    /// Types in the order of the definition.
    pub types: &'a [Type],
    /// Encoding.
    pub encoding: Encoding,
    /// Whether a CRC follows (never with [`Encoding::Ascii`]).
    pub crc: bool,
}

/// Values of a data message; `None` where the sensor had none.
pub type Values = [Option<i64>; VALUES_MAX];

/// What is wrong with a data message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DaqError {
    /// Not `n:` with n from 0 to 19.
    Group,
    /// Characters that the encoding does not have.
    Encoding,
    /// More or fewer values than the group has.
    Count,
    /// The CRC does not fit.
    Crc,
}

/// Group number and payload of a data message (its text after the `#`; firmware before 0.12.0 put a
/// second one before binary data).
///
/// # Errors
/// The number is missing or above 19.
pub fn split(text: &str) -> Result<(u8, &str), DaqError> {
    let text = text.strip_prefix('#').unwrap_or(text);
    let (number, payload) = text.split_once(':').ok_or(DaqError::Group)?;
    let number: u8 = number.trim().parse().map_err(|_| DaqError::Group)?;
    if number > 19 {
        return Err(DaqError::Group);
    }
    Ok((number, payload))
}

impl Group<'_> {
    /// Reads the payload of a message of this group.
    ///
    /// # Errors
    /// See [`DaqError`]; nothing of a bad message is used.
    pub fn decode(&self, payload: &str) -> Result<Values, DaqError> {
        let payload = payload.trim();
        let bytes = match self.encoding {
            Encoding::Ascii => return self.ascii(payload),
            Encoding::Hex => from_hex(payload),
            Encoding::Base64 => from_base64(payload),
        };
        let bytes = bytes.ok_or(DaqError::Encoding)?;
        let mut content = bytes.as_slice();
        if self.crc {
            let (head, sum) = content.split_last_chunk::<2>().ok_or(DaqError::Count)?;
            if u16::from_le_bytes(*sum) != crc16(head) {
                return Err(DaqError::Crc);
            }
            content = head;
        }
        self.binary(content).ok_or(DaqError::Count)
    }

    fn binary(&self, content: &[u8]) -> Option<Values> {
        let mut data = Cursor::new(content);
        let mut values = Values::default();
        let mut slots = values.iter_mut();
        for kind in self.types {
            *slots.next()? = kind.value(kind.read(&mut data)?);
        }
        data.u8().is_none().then_some(values)
    }

    fn ascii(&self, payload: &str) -> Result<Values, DaqError> {
        let mut values = Values::default();
        let mut fields = payload.split('|');
        for (slot, kind) in values.iter_mut().zip(self.types) {
            let field = fields.next().ok_or(DaqError::Count)?.trim();
            *slot = if field.starts_with('[') && field.ends_with(']') {
                None
            } else {
                let digits = field.strip_prefix('-').unwrap_or(field);
                let plain = digits.bytes().all(|byte| byte.is_ascii_digit());
                let raw = plain.then(|| field.parse().ok()).flatten();
                let fits = |raw: &i64| (kind.lowest()..=kind.highest()).contains(raw);
                kind.value(raw.filter(fits).ok_or(DaqError::Encoding)?)
            };
        }
        match fields.next() {
            None => Ok(values),
            Some(_) => Err(DaqError::Count),
        }
    }

    /// The payload a board sends for these values; `None` if it does not fit.
    #[must_use]
    pub fn encode(&self, values: &Values) -> Option<Buffer<160>> {
        let mut out = Buffer::default();
        if self.encoding == Encoding::Ascii {
            return self.encode_ascii(values, out);
        }
        let mut raw = Buffer::<40>::default();
        for (kind, value) in self.types.iter().zip(values) {
            kind.write(*value, &mut raw)?;
        }
        if self.crc {
            let sum = crc16(raw.as_slice()).to_le_bytes();
            raw.extend(&sum).then_some(())?;
        }
        match self.encoding {
            Encoding::Base64 => to_base64(raw.as_slice(), &mut out)?,
            _ => to_hex(raw.as_slice(), &mut out)?,
        }
        Some(out)
    }

    fn encode_ascii(&self, values: &Values, mut out: Buffer<160>) -> Option<Buffer<160>> {
        use core::fmt::Write as _;
        for (index, (_, value)) in self.types.iter().zip(values).enumerate() {
            let bar = if index == 0 { "" } else { " | " };
            match value {
                Some(value) => write!(out, "{bar}{value}").ok()?,
                None => write!(out, "{bar}[---]").ok()?,
            }
        }
        Some(out)
    }
}

/// CRC-16-CCITT: polynomial 0x1021, start 0xFFFF, not reflected.
#[must_use]
pub fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF_u16, |crc, byte| {
        (0..8).fold(crc ^ (u16::from(*byte) << 8), |crc, _| {
            if crc & 0x8000 == 0 {
                crc << 1
            } else {
                (crc << 1) ^ 0x1021
            }
        })
    })
}

fn from_hex(text: &str) -> Option<Buffer<40>> {
    let mut out = Buffer::default();
    for pair in text.as_bytes().chunks(2) {
        let [high, low] = pair else { return None };
        let digit = |byte: u8| char::from(byte).to_digit(16);
        let value = (digit(*high)? << 4) | digit(*low)?;
        out.push(u8::try_from(value).ok()?).then_some(())?;
    }
    Some(out)
}

fn to_hex(bytes: &[u8], out: &mut Buffer<160>) -> Option<()> {
    use core::fmt::Write as _;
    bytes
        .iter()
        .try_for_each(|byte| write!(out, "{byte:02X}").ok())
}

const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

fn from_base64(text: &str) -> Option<Buffer<40>> {
    let mut out = Buffer::default();
    for four in text.as_bytes().chunks(4) {
        let mut bits = 0_u32;
        for character in four {
            let digit = ALPHABET.iter().position(|known| known == character)?;
            bits = (bits << 6) | u32::try_from(digit).ok()?;
        }
        let (shift, count) = match four.len() {
            4 => (0, 3),
            3 => (6, 2),
            2 => (12, 1),
            _ => return None,
        };
        let [_, bytes @ ..] = (bits << shift).to_be_bytes();
        out.extend(bytes.get(..count)?).then_some(())?;
    }
    Some(out)
}

fn to_base64(bytes: &[u8], out: &mut Buffer<160>) -> Option<()> {
    for three in bytes.chunks(3) {
        let byte = |index: usize| three.get(index).copied().unwrap_or_default();
        let bits = u32::from_be_bytes([0, byte(0), byte(1), byte(2)]);
        for shift in [18_u32, 12, 6, 0]
            .iter()
            .take(three.len().saturating_add(1))
        {
            let digit = usize::try_from((bits >> shift) & 63).ok()?;
            out.push(*ALPHABET.get(digit)?).then_some(())?;
        }
    }
    Some(())
}
