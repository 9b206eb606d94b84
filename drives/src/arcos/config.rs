//! The configuration packet (0x20): what the robot says about itself, its watchdog above all.

use super::frame::Packet;
use crate::cursor::{Buffer, Cursor};

/// Packet type.
pub const ID: u8 = 0x20;

/// A short text of the configuration; longer ones are cut.
pub type Text = Buffer<24>;

/// The fields that matter to an adapter. A packet may end anywhere: what it does not hold is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Config {
    /// Robot class, for instance `Pioneer`.
    pub class: Text,
    /// Robot type, for instance `seekurjr`.
    pub subclass: Text,
    /// Serial number.
    pub serial: Text,
    /// Top turn rate, deg/s.
    pub rotation_top_degps: Option<u16>,
    /// Top speed, mm/s.
    pub speed_top_mmps: Option<u16>,
    /// Top angular acceleration, deg/s².
    pub rotation_acceleration_top_degps2: Option<u16>,
    /// Top acceleration, mm/s².
    pub acceleration_top_mmps2: Option<u16>,
    /// Time between two SIPs, ms.
    pub sip_cycle_ms: Option<u8>,
    /// Silence after which the robot stops, ms; 0 would mean never.
    pub watchdog_ms: Option<u16>,
    /// Limit of the turn rate in force, deg/s.
    pub rotation_max_degps: Option<u16>,
    /// Limit of the speed in force, mm/s.
    pub speed_max_mmps: Option<u16>,
    /// Angular acceleration in force, deg/s².
    pub rotation_acceleration_degps2: Option<u16>,
    /// Angular deceleration in force, deg/s².
    pub rotation_deceleration_degps2: Option<u16>,
    /// Acceleration in force, mm/s².
    pub acceleration_mmps2: Option<u16>,
    /// Deceleration in force, mm/s²: also that of STOP and of the watchdog.
    pub deceleration_mmps2: Option<u16>,
    /// Front bumper segments.
    pub front_bumpers: Option<u8>,
    /// Rear bumper segments.
    pub rear_bumpers: Option<u8>,
    /// Whether a gyro is fitted.
    pub has_gyro: Option<bool>,
    /// Voltage below which the robot complains, 0.1 V.
    pub low_battery_decivolts: Option<u16>,
    /// Charge below which the robot complains, percent.
    pub low_charge_percent: Option<u16>,
}

impl Config {
    /// Reads a configuration packet; `None` if it is of another type or even its names are not whole.
    #[must_use]
    pub fn decode(packet: &Packet) -> Option<Self> {
        if packet.id() != ID {
            return None;
        }
        let mut data = Cursor::new(packet.data());
        let mut config = Self {
            class: text(data.text()?),
            subclass: text(data.text()?),
            serial: text(data.text()?),
            ..Self::default()
        };
        // Whatever was read before the packet ended stays.
        let _ = config.fill(&mut data);
        Some(config)
    }

    fn fill(&mut self, data: &mut Cursor<'_>) -> Option<()> {
        data.u8()?; // unused
        self.rotation_top_degps = Some(data.u16()?);
        self.speed_top_mmps = Some(data.u16()?);
        self.rotation_acceleration_top_degps2 = Some(data.u16()?);
        self.acceleration_top_mmps2 = Some(data.u16()?);
        data.u16()?; // largest PWM
        data.text()?; // name given by the owner
        self.sip_cycle_ms = Some(data.u8()?);
        data.bytes(2)?; // baud rates of host and first auxiliary port
        data.bytes(5)?; // gripper, front sonar, rear sonar
        self.low_battery_decivolts = Some(data.u16()?);
        data.u16()?; // encoder ticks of half a turn
        self.watchdog_ms = Some(data.u16()?);
        data.u8()?; // newer packets
        data.bytes(4)?; // stall value and count
        data.bytes(4)?; // joystick speeds
        self.rotation_max_degps = Some(data.u16()?);
        self.speed_max_mmps = Some(data.u16()?);
        self.rotation_acceleration_degps2 = Some(data.u16()?);
        self.rotation_deceleration_degps2 = Some(data.u16()?);
        data.bytes(6)?; // gains of the rotation loop
        self.acceleration_mmps2 = Some(data.u16()?);
        self.deceleration_mmps2 = Some(data.u16()?);
        data.bytes(6)?; // gains of the speed loop
        self.front_bumpers = Some(data.u8()?);
        self.rear_bumpers = Some(data.u8()?);
        data.bytes(3)?; // charger, sonar cycle, automatic baud rate
        self.has_gyro = Some(data.u8()? == 1);
        data.bytes(8)?; // drift factor, baud rates, ticks, shutdown voltage
        data.text()?; // firmware version
        data.bytes(5)?; // gyro scales, kinematics delay
        data.bytes(10)?; // lateral limits
        data.bytes(8)?; // charge threshold, port, gyro limit, temperature, power bits
        data.u8()?; // battery type
        self.low_charge_percent = Some(data.u16()?);
        Some(())
    }

    /// The configuration as a robot sends it, up to the first field that is missing.
    #[must_use]
    pub fn encode(&self) -> Option<Packet> {
        let mut out = Buffer::<194>::default();
        for name in [self.class, self.subclass, self.serial] {
            (out.extend(name.as_slice()) && out.push(0)).then_some(())?;
        }
        // A missing field ends the packet, which is legal anywhere.
        let _ = self.write(&mut out);
        Packet::new(ID, out.as_slice())
    }

    fn write(&self, out: &mut Buffer<194>) -> Option<()> {
        zeros(out, 1)?;
        word(out, self.rotation_top_degps)?;
        word(out, self.speed_top_mmps)?;
        word(out, self.rotation_acceleration_top_degps2)?;
        word(out, self.acceleration_top_mmps2)?;
        zeros(out, 3)?;
        byte(out, self.sip_cycle_ms)?;
        zeros(out, 7)?;
        word(out, self.low_battery_decivolts)?;
        zeros(out, 2)?;
        word(out, self.watchdog_ms)?;
        zeros(out, 9)?;
        word(out, self.rotation_max_degps)?;
        word(out, self.speed_max_mmps)?;
        word(out, self.rotation_acceleration_degps2)?;
        word(out, self.rotation_deceleration_degps2)?;
        zeros(out, 6)?;
        word(out, self.acceleration_mmps2)?;
        word(out, self.deceleration_mmps2)?;
        zeros(out, 6)?;
        byte(out, self.front_bumpers)?;
        byte(out, self.rear_bumpers)?;
        zeros(out, 3)?;
        byte(out, self.has_gyro.map(u8::from))?;
        zeros(out, 33)?;
        word(out, self.low_charge_percent)
    }
}

/// A text of at most the buffer's size.
#[must_use]
pub fn text(bytes: &[u8]) -> Text {
    let mut text = Text::default();
    let kept = bytes.get(..bytes.len().min(24)).unwrap_or_default();
    // It fits: it was cut to size.
    let _ = text.extend(kept);
    text
}

fn zeros(out: &mut Buffer<194>, count: usize) -> Option<()> {
    out.extend([0; 40].get(..count)?).then_some(())
}

fn word(out: &mut Buffer<194>, value: Option<u16>) -> Option<()> {
    out.extend(&value?.to_le_bytes()).then_some(())
}

fn byte(out: &mut Buffer<194>, value: Option<u8>) -> Option<()> {
    out.push(value?).then_some(())
}
