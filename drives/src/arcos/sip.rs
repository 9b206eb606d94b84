//! The standard server information packet (SIP): pose, wheel speeds, flags and optional tails.

use super::frame::Packet;
use crate::cursor::{Buffer, Cursor};

/// Packet type while the motors stand.
pub const STOPPED: u8 = 0x32;
/// Packet type while they turn.
pub const MOVING: u8 = 0x33;

/// Most sonar readings kept; further ones are read over.
pub const SONARS_MAX: usize = 16;

/// Radians of one count of THPOS.
pub const RADIANS_PER_COUNT: f64 = core::f64::consts::TAU / 4096.0;

/// State flags (M3 table 8).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags(pub u16);

impl Flags {
    /// Motors are enabled.
    pub const MOTORS: u16 = 1;
    /// The STOP button is pressed.
    pub const STOP_BUTTON: u16 = 1 << 5;
    /// E_STALL has engaged: motors are off until they are enabled again.
    pub const E_STALL: u16 = 1 << 6;

    /// Whether all bits of `mask` are set.
    #[must_use]
    pub const fn has(self, mask: u16) -> bool {
        self.0 & mask == mask
    }
}

/// Stalls and bumper segments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bumpers(pub u16);

impl Bumpers {
    /// The left wheel is stalled.
    #[must_use]
    pub const fn left_stall(self) -> bool {
        self.0 & 1 != 0
    }

    /// The right wheel is stalled.
    #[must_use]
    pub const fn right_stall(self) -> bool {
        self.0 & 0x100 != 0
    }

    /// Rear segments, bit 0 the first.
    #[must_use]
    pub fn rear(self) -> u8 {
        let [low, _] = self.0.to_le_bytes();
        low >> 1
    }

    /// Front segments, bit 0 the first.
    #[must_use]
    pub fn front(self) -> u8 {
        let [_, high] = self.0.to_le_bytes();
        high >> 1
    }
}

/// The fields that only newer firmware sends, in their order; each may be the first to miss.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tail {
    /// Battery, 0.1 V.
    pub battery_decivolts: Option<u16>,
    /// −1 unknown, 0 not charging, 1 bulk, 2 overcharge, 3 float, 4 balance.
    pub charge_state: Option<i8>,
    /// Turn rate of the wheels, 0.1 deg/s, counter-clockwise positive.
    pub rotation_decidegps: Option<i16>,
    /// Control errors.
    pub faults: Option<u16>,
    /// Lateral speed, mm/s (Seekur only).
    pub lateral_mmps: Option<i16>,
    /// Temperature, °C; −127 and −128 mean not available.
    pub temperature_c: Option<i8>,
    /// State of charge, percent; 0 means not provided.
    pub charge_percent: Option<i8>,
    /// Clock of the controller, µs.
    pub clock_us: Option<u32>,
    /// More flags.
    pub flags3: Option<u32>,
}

/// One SIP. Lengths are counts of DistConvFactor (1 mm on the Seekur Jr), speeds of VelConvFactor
/// (1 mm/s); headings are counts of 2π/4096.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sip {
    /// Whether the packet type says that the motors turn. (Some servers never say so.)
    pub moving: bool,
    /// Position along x; only the low 15 bits count.
    pub x: u16,
    /// Position along y; only the low 15 bits count.
    pub y: u16,
    /// Heading.
    pub heading: i16,
    /// Speed of the left wheels.
    pub left: i16,
    /// Speed of the right wheels.
    pub right: i16,
    /// Battery, 0.1 V.
    pub battery_decivolts: u8,
    /// Stalls and bumpers.
    pub bumpers: Bumpers,
    /// Angle set point of the server.
    pub control: i16,
    /// State.
    pub flags: Flags,
    /// Compass, 2 deg.
    pub compass: u8,
    /// Number and range of each sonar that has news.
    pub sonars: [Option<(u8, u16)>; SONARS_MAX],
    /// Gripper, analogue port, analogue value, digital inputs and outputs.
    pub ports: [u8; 5],
    /// Optional fields.
    pub tail: Tail,
}

impl Sip {
    /// Reads a SIP; `None` if the packet is of another type or a required field is not whole.
    ///
    /// Everything from the battery word on may be missing.
    #[must_use]
    pub fn decode(packet: &Packet) -> Option<Self> {
        if packet.id() != STOPPED && packet.id() != MOVING {
            return None;
        }
        let mut data = Cursor::new(packet.data());
        let mut sip = Self {
            moving: packet.id() == MOVING,
            x: data.u16()?,
            y: data.u16()?,
            heading: data.i16()?,
            left: data.i16()?,
            right: data.i16()?,
            battery_decivolts: data.u8()?,
            bumpers: Bumpers(data.u16()?),
            control: data.i16()?,
            flags: Flags(data.u16()?),
            compass: data.u8()?,
            ..Self::default()
        };
        let count = data.u8()?;
        let mut slots = sip.sonars.iter_mut();
        for _ in 0..count {
            let reading = (data.u8()?, data.u16()?);
            if let Some(slot) = slots.next() {
                *slot = Some(reading);
            }
        }
        sip.ports = data.bytes(5)?.try_into().ok()?;
        sip.tail = Tail::decode(&mut data);
        Some(sip)
    }

    /// The SIP as a packet, its tail up to the first field that is missing.
    #[must_use]
    pub fn encode(&self) -> Option<Packet> {
        let mut out = Buffer::<194>::default();
        let mut fits = out.extend(&self.x.to_le_bytes()) && out.extend(&self.y.to_le_bytes());
        for value in [self.heading, self.left, self.right] {
            fits = fits && out.extend(&value.to_le_bytes());
        }
        fits = fits && out.push(self.battery_decivolts);
        fits = fits && out.extend(&self.bumpers.0.to_le_bytes());
        fits = fits && out.extend(&self.control.to_le_bytes());
        fits = fits && out.extend(&self.flags.0.to_le_bytes()) && out.push(self.compass);
        let sonars = self.sonars.iter().flatten();
        fits = fits && out.push(u8::try_from(sonars.clone().count()).unwrap_or(0));
        for (sonar, range) in sonars {
            fits = fits && out.push(*sonar) && out.extend(&range.to_le_bytes());
        }
        fits = fits && out.extend(&self.ports) && self.tail.encode(&mut out).is_some();
        let id = if self.moving { MOVING } else { STOPPED };
        fits.then(|| Packet::new(id, out.as_slice()))?
    }
}

impl Tail {
    fn decode(data: &mut Cursor<'_>) -> Self {
        let mut tail = Self::default();
        // A field that is not there ends the tail: nothing may be read at a wrong offset.
        let _ = tail.fill(data);
        tail
    }

    fn fill(&mut self, data: &mut Cursor<'_>) -> Option<()> {
        self.battery_decivolts = Some(data.u16()?);
        self.charge_state = Some(data.i8()?);
        self.rotation_decidegps = Some(data.i16()?);
        self.faults = Some(data.u16()?);
        self.lateral_mmps = Some(data.i16()?);
        self.temperature_c = Some(data.i8()?);
        self.charge_percent = Some(data.i8()?);
        self.clock_us = Some(data.u32()?);
        self.flags3 = Some(data.u32()?);
        Some(())
    }

    /// Writes up to the first missing field; `None` only if the buffer is full.
    fn encode(&self, out: &mut Buffer<194>) -> Option<()> {
        let fields: [Option<[u8; 4]>; 9] = [
            self.battery_decivolts.map(pad),
            self.charge_state.map(|v| [v.to_le_bytes()[0], 0, 0, 0]),
            self.rotation_decidegps.map(|v| pad(v.cast_unsigned())),
            self.faults.map(pad),
            self.lateral_mmps.map(|v| pad(v.cast_unsigned())),
            self.temperature_c.map(|v| [v.to_le_bytes()[0], 0, 0, 0]),
            self.charge_percent.map(|v| [v.to_le_bytes()[0], 0, 0, 0]),
            self.clock_us.map(u32::to_le_bytes),
            self.flags3.map(u32::to_le_bytes),
        ];
        let widths = [2, 1, 2, 2, 2, 1, 1, 4, 4];
        for (field, width) in fields.iter().zip(widths) {
            let Some(bytes) = field else { break };
            out.extend(bytes.get(..width)?).then_some(())?;
        }
        Some(())
    }
}

const fn pad(value: u16) -> [u8; 4] {
    let [low, high] = value.to_le_bytes();
    [low, high, 0, 0]
}

/// Follows a 15-bit position across its wrap.
///
/// Works for counters of 15 and 16 bits as long as the robot moves less than 4096 counts between
/// two SIPs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwrap {
    last: Option<u16>,
    /// Counts since the first value.
    pub total: i64,
}

impl Unwrap {
    /// Takes the next raw value and returns the step since the one before, 0 for the first.
    pub fn step(&mut self, raw: u16) -> i32 {
        let raw = raw & 0x7FFF;
        let before = self.last.replace(raw).unwrap_or(raw);
        let mut step = i32::from(raw).saturating_sub(i32::from(before));
        if step > 0x1000 {
            step = step.saturating_sub(0x8000);
        } else if step < -0x1000 {
            step = step.saturating_add(0x8000);
        }
        self.total = self.total.saturating_add(i64::from(step));
        step
    }
}
