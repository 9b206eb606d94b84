//! Packets: `FA FB N id data.. checksum`, N counting everything after itself.

use haltline::time::{Duration, Instant};

use crate::cursor::Buffer;

/// First two bytes of every packet in both directions.
pub const HEADER: [u8; 2] = [0xFA, 0xFB];
/// Most bytes of id and data that N can announce.
pub const BODY_MAX: usize = 253;
/// Most bytes of a packet that every known receiver takes.
pub const SEND_MAX: usize = 200;
/// Silence within a packet after which the packet is given up.
pub const BYTE_TIMEOUT: Duration = Duration::from_ms(100);

/// What is wrong with bytes that should be a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// N announces less than an id and a checksum.
    TooShort,
    /// The checksum does not fit; the id the packet seemed to have.
    Checksum(u8),
    /// The packet stopped in the middle.
    TimedOut,
}

/// Id and data of a packet with a good checksum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Packet {
    body: Buffer<BODY_MAX>,
}

impl Packet {
    /// A packet with this id and these data; `None` if it would be longer than [`SEND_MAX`].
    #[must_use]
    pub fn new(id: u8, data: &[u8]) -> Option<Self> {
        let mut body = Buffer::default();
        // Header, N and checksum are five bytes, the id is one.
        let fits = data.len() <= SEND_MAX.saturating_sub(6);
        (fits && body.push(id) && body.extend(data)).then_some(Self { body })
    }

    /// Command number or packet type.
    #[must_use]
    pub fn id(&self) -> u8 {
        self.body.as_slice().first().copied().unwrap_or_default()
    }

    /// What follows the id.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        self.body.as_slice().get(1..).unwrap_or_default()
    }

    /// The packet on the wire.
    #[must_use]
    pub fn to_bytes(&self) -> Buffer<258> {
        let body = self.body.as_slice();
        let mut out = Buffer::default();
        let length = u8::try_from(body.len().saturating_add(2)).unwrap_or(u8::MAX);
        // The buffer is as long as the longest packet, so nothing can be left out.
        let _ = out.extend(&HEADER) && out.push(length) && out.extend(body);
        let _ = out.extend(&checksum(body).to_be_bytes());
        out
    }
}

/// Sum of big-endian words modulo 2¹⁶; a byte left over is XORed into the low byte.
#[must_use]
pub fn checksum(body: &[u8]) -> u16 {
    body.chunks(2).fold(0_u16, |sum, pair| match pair {
        [high, low] => sum.wrapping_add(u16::from_be_bytes([*high, *low])),
        [left] => sum ^ u16::from(*left),
        _ => sum,
    })
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Expect {
    #[default]
    Header0,
    Header1,
    Length,
    Body(usize),
}

/// Finds packets in a stream of bytes, however they were split, joined or spoiled.
///
/// Bytes between packets are skipped. A wrong length or checksum costs the bytes it announced and
/// nothing more.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deframer {
    expect: Expect,
    body: Buffer<255>,
    heard: Instant,
}

impl Deframer {
    /// Takes one byte that arrived at `now`.
    ///
    /// # Bound
    /// O(N) once for each packet, O(1) otherwise; no state grows.
    pub fn push(&mut self, byte: u8, now: Instant) -> Option<Result<Packet, FrameError>> {
        let late = now.since(self.heard).is_none_or(|gap| gap > BYTE_TIMEOUT);
        self.heard = now;
        if late && self.expect != Expect::Header0 {
            let inside = matches!(self.expect, Expect::Body(_));
            self.expect = Expect::Header0;
            let event = self.take(byte);
            // The byte cannot end a packet, so nothing is lost by reporting the one given up.
            return if inside {
                Some(Err(FrameError::TimedOut))
            } else {
                event
            };
        }
        self.take(byte)
    }

    fn take(&mut self, byte: u8) -> Option<Result<Packet, FrameError>> {
        match self.expect {
            Expect::Header0 => {
                self.expect = self.header(byte);
                None
            }
            Expect::Header1 if byte == HEADER[1] => {
                self.expect = Expect::Length;
                None
            }
            Expect::Header1 => {
                self.expect = self.header(byte);
                None
            }
            Expect::Length if byte < 3 => {
                self.expect = Expect::Header0;
                Some(Err(FrameError::TooShort))
            }
            Expect::Length => {
                self.body.clear();
                self.expect = Expect::Body(usize::from(byte));
                None
            }
            Expect::Body(length) => self.body(byte, length),
        }
    }

    const fn header(&self, byte: u8) -> Expect {
        if byte == HEADER[0] {
            Expect::Header1
        } else {
            Expect::Header0
        }
    }

    fn body(&mut self, byte: u8, length: usize) -> Option<Result<Packet, FrameError>> {
        let fitted = self.body.push(byte);
        if fitted && self.body.as_slice().len() < length {
            return None;
        }
        self.expect = Expect::Header0;
        let (content, sum) = self.body.as_slice().split_last_chunk::<2>()?;
        let id = content.first().copied().unwrap_or_default();
        let mut packet = Packet::default();
        //= spec/drive.md#drive-09
        //# Bytes that are not a whole and valid frame of the drive MUST NOT cause motion, nor end the adapter, nor change its feedback.
        let good = packet.body.extend(content) && u16::from_be_bytes(*sum) == checksum(content);
        Some(if good {
            Ok(packet)
        } else {
            Err(FrameError::Checksum(id))
        })
    }
}
