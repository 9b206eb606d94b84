//! Properties of anybody's bytes, written once: called by tests and by the fuzz targets.

use std::panic::Location;

use haltline::time::Duration;

use super::bench::{Bench, CarBench, SeekurBench};
use super::checks::moves;
use super::rig::Rig;
use super::twins::Twin;
use crate::arcos::{self, Command, Deframer, Packet, Sip, server};
use crate::cola::{self, ScanTelegram};
use crate::seekur::Wheels;
use crate::uc::command::Request;
use crate::uc::daq::{self, Encoding, Group, Type};
use crate::uc::{line, reply};

/// A property that was broken, and where.
pub type Broken = String;

#[track_caller]
pub(super) fn demand(holds: bool, what: &str) -> Result<(), Broken> {
    if holds {
        Ok(())
    } else {
        Err(format!("{what} ({})", Location::caller()))
    }
}

/// Every ARCOS decoder: total, and what it accepts it writes again as it was, behind `checksum`.
///
/// # Errors
/// The property that does not hold.
pub fn arcos(bytes: &[u8], checksum: fn(&[u8]) -> u16) -> Result<(), Broken> {
    let mut deframer = Deframer::default();
    let now = haltline::time::Instant::from_us(1);
    let found = bytes.iter().filter_map(|byte| deframer.push(*byte, now));
    let packets: Vec<Packet> = found.flatten().collect();
    // The same bytes behind a right checksum, so that their content is reached, too.
    let made = bytes.split_first().and_then(|(id, data)| {
        Packet::new(*id, data.get(..data.len().min(194)).unwrap_or_default())
    });
    for packet in packets.iter().chain(&made) {
        let wire = packet.to_bytes();
        let sum = checksum(packet_body(wire.as_slice()));
        demand(wire.as_slice().ends_with(&sum.to_be_bytes()), "checksum")?;
        if let Some(command) = Command::decode(packet) {
            let again = command
                .encode()
                .and_then(|packet| Command::decode(&packet).map(number));
            demand(again == Some(number(command)), "command round trip")?;
        }
        if let Some(sip) = Sip::decode(packet) {
            let again = sip.encode().and_then(|packet| Sip::decode(&packet));
            demand(again == Some(sip), "SIP round trip")?;
        }
        if let Some(config) = arcos::config::Config::decode(packet) {
            let again = config.encode();
            let again = again.and_then(|packet| arcos::config::Config::decode(&packet));
            demand(again == Some(config), "configuration round trip")?;
        }
        let _ = server::decode(packet);
        let _ = server::Identity::decode(packet);
    }
    Ok(())
}

const fn number(command: Command<'_>) -> u8 {
    command.number
}

fn packet_body(wire: &[u8]) -> &[u8] {
    wire.get(3..wire.len().saturating_sub(2))
        .unwrap_or_default()
}

/// Every decoder of the control board's text: total, and errors (by `error_code`) never pass for
/// answers.
///
/// # Errors
/// The property that does not hold.
pub fn uc(bytes: &[u8], error_code: fn(&str) -> Option<u16>) -> Result<(), Broken> {
    let mut deframer = line::Deframer::default();
    let mut texts: Vec<String> = Vec::new();
    for byte in bytes {
        if let Some(Ok(message)) = deframer.push(*byte) {
            texts.push(message.text().to_owned());
        }
    }
    texts.push(String::from_utf8_lossy(bytes).into_owned());
    let types = [Type::U8, Type::U16, Type::I16, Type::U32];
    for text in &texts {
        let is_error = error_code(text).is_some();
        demand(
            !is_error || reply::drive_state(text).is_none(),
            "an error is no state",
        )?;
        demand(
            !is_error || reply::number(text).is_none(),
            "an error is no number",
        )?;
        demand(
            !is_error || reply::session(text).is_none(),
            "an error is no session",
        )?;
        let _ = Request::parse(text.as_bytes());
        let payload = daq::split(text).map_or(text.as_str(), |(_, payload)| payload);
        for (encoding, crc) in [
            (Encoding::Ascii, false),
            (Encoding::Hex, true),
            (Encoding::Base64, true),
        ] {
            let group = Group {
                types: &types,
                encoding,
                crc,
            };
            if let Ok(values) = group.decode(payload) {
                let again = group.encode(&values);
                let again = again
                    .as_ref()
                    .map(|text| String::from_utf8_lossy(text.as_slice()));
                let read = again.and_then(|text| group.decode(&text).ok());
                demand(
                    encoding == Encoding::Ascii || read == Some(values),
                    "group round trip",
                )?;
            }
        }
    }
    Ok(())
}

/// The scanner's decoder: total, and a scan has as many ranges as it says.
///
/// # Errors
/// The property that does not hold.
pub fn cola(bytes: &[u8], decode: fn(&str) -> Option<ScanTelegram>) -> Result<(), Broken> {
    let mut deframer = cola::Deframer::default();
    for byte in bytes {
        if let Some(Ok(text)) = deframer.push(*byte)
            && let Some(scan) = decode(text)
        {
            demand(usize::from(scan.header.count) <= cola::RANGES_MAX, "count")?;
        }
    }
    let _ = decode(&String::from_utf8_lossy(bytes));
    Ok(())
}

/// Both adapters on a wire with an attacker: each byte of the script lets time pass, says part of
/// the script to the adapter, cuts the link, or restarts the robot. With rest decided all the
/// time, nothing may move.
///
/// # Errors
/// What was said or measured that should not be.
pub fn adapters(script: &[u8], twin: Option<Twin>) -> Result<(), Broken> {
    let seekur = SeekurBench {
        wheels: Wheels::VelRvel,
        skid: 1.0,
    };
    against(&seekur, twin, script)?;
    against(&CarBench { stx: true }, twin, script)
}

fn against(bench: &dyn Bench, twin: Option<Twin>, script: &[u8]) -> Result<(), Broken> {
    let mut rig = Rig::new(bench, twin);
    for (index, byte) in script.iter().take(400).enumerate() {
        match byte & 7 {
            0 => rig.to_host = byte & 8 == 0,
            1 => rig.to_robot = byte & 8 == 0,
            2 => rig.robot.reboot(rig.now),
            3 => rig.drive.reconnected(rig.now),
            4 => rig.drive.enable(rig.now),
            5 => {
                let said = script.iter().skip(index).take(usize::from(byte >> 3));
                let said: Vec<u8> = said.copied().collect();
                rig.drive.receive(&said, rig.now);
            }
            _ => rig.decide(0.0, 0.0, Duration::from_ms(u64::from(byte >> 3) + 1)),
        }
    }
    let told = rig.told.iter().find(|told| moves(told, bench.is_arc()));
    demand(told.is_none(), &format!("{}: {told:?}", bench.name()))?;
    let moved = rig.fastest.iter().any(|rate| *rate > 1e-9);
    demand(!moved, &format!("{}: {:?}", bench.name(), rig.fastest))?;
    let finite = rig.feedback.is_none_or(|feedback| {
        let numbers = feedback.pose.iter().chain(&feedback.twist);
        numbers.into_iter().all(|value| value.is_finite())
    });
    demand(finite, "feedback is finite")
}
