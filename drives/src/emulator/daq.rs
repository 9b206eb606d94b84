//! Sensors of the control board and the groups in which it streams them.

use haltline::time::{Duration, Instant};

use crate::uc::command::Request;
use crate::uc::daq::{Encoding, Group, Type, VALUES_MAX, Values};
use crate::uc::error;

/// Last values of the sensors that an adapter uses.
#[derive(Clone, Debug)]
pub(super) struct Sensors {
    start: Instant,
    pulses: u8,
    pulsed: Option<Instant>,
    /// Time between the last two pulses, 0.1 ms.
    gap: Option<u16>,
    fresh_pulse: bool,
    rate_radps: f64,
}

impl Sensors {
    pub(super) const fn new(now: Instant) -> Self {
        Self {
            start: now,
            pulses: 0,
            pulsed: None,
            gap: None,
            fresh_pulse: false,
            rate_radps: 0.0,
        }
    }

    /// A magnet passes the sensor.
    pub(super) fn pulse(&mut self, now: Instant) {
        self.pulses = self.pulses.wrapping_add(1);
        self.gap = self.pulsed.and_then(|before| {
            let gap_us = now.since(before)?.as_us();
            u16::try_from(gap_us / 100).ok()
        });
        self.pulsed = Some(now);
        self.fresh_pulse = true;
    }

    pub(super) fn turn_rate(&mut self, rate_radps: f64) {
        self.rate_radps = rate_radps;
    }

    fn value(&self, channel: &str, now: Instant) -> Option<i64> {
        match channel {
            "HALL_CNT" => Some(i64::from(self.pulses)),
            "HALL_DT" => self.gap.map(i64::from),
            // 65.5 counts for each deg/s at the default range.
            "GZ" => Some((self.rate_radps.to_degrees() * 65.5).round() as i64),
            "AZ" => Some(8192),
            "AX" | "AY" | "GX" | "GY" => Some(0),
            "VDBAT" => Some(7600),
            "VSBAT" => Some(7800),
            "_TICS" => Some((now.since(self.start)?.as_us() / 1000) as i64),
            _ => None,
        }
    }
}

#[derive(Clone, Debug)]
struct Stream {
    channels: Vec<String>,
    types: Vec<Type>,
    encoding: Encoding,
    crc: bool,
    /// Every so often, or with every pulse.
    every: Option<Duration>,
    due: Instant,
    active: bool,
}

/// The data groups.
#[derive(Clone, Debug, Default)]
pub(super) struct Streams {
    groups: Vec<(u8, Stream)>,
    started: bool,
}

impl Streams {
    pub(super) fn obey(
        &mut self,
        request: &Request<'_>,
        sensors: &Sensors,
        now: Instant,
    ) -> Result<String, u16> {
        if request.is(1, "START") && request.set {
            self.started = true;
            return Ok("started".to_owned());
        }
        if request.is(1, "STOP") && request.set {
            self.started = false;
            return Ok("stopped".to_owned());
        }
        if request.is(1, "GRP") && request.set {
            return self.define(request, now);
        }
        if request.is(1, "GET") && !request.set {
            let values = request.words_from(2).map(|name| {
                let name = name.to_ascii_uppercase();
                Type::of_channel(&name).ok_or(error::INVALID_CHANNEL)?;
                let value = sensors.value(&name, now);
                Ok(value.map_or("[---]".to_owned(), |value| value.to_string()))
            });
            return values
                .collect::<Result<Vec<_>, u16>>()
                .map(|all| all.join(" | "));
        }
        if request.word(1).is_none() && !request.set {
            return Ok(if self.started { "started" } else { "stopped" }.to_owned());
        }
        Err(error::WRONG_USAGE)
    }

    fn define(&mut self, request: &Request<'_>, now: Instant) -> Result<String, u16> {
        let number: u8 = request
            .word(2)
            .and_then(|word| word.parse().ok())
            .filter(|number| *number < 20)
            .ok_or(error::INVALID_PARAMETER)?;
        let known = self.groups.iter().position(|(known, _)| *known == number);
        if request.option("DELETE").is_some() {
            if let Some(index) = known {
                self.groups.remove(index);
            }
            return Ok("ok".to_owned());
        }
        for (option, active) in [("ACTIVATE", true), ("DEACTIVATE", false)] {
            if request.option(option).is_some() {
                let index = known.ok_or(error::UNKNOWN_PACKAGE)?;
                if let Some((_, stream)) = self.groups.get_mut(index) {
                    stream.active = active;
                }
                return Ok("ok".to_owned());
            }
        }
        if self.started && known.is_some() {
            return Err(error::REDEFINE_ACTIVE);
        }
        let stream = Self::stream(request, now)?;
        if let Some(index) = known {
            self.groups.remove(index);
        }
        self.groups.push((number, stream));
        Ok("ok".to_owned())
    }

    fn stream(request: &Request<'_>, now: Instant) -> Result<Stream, u16> {
        let channels: Vec<String> = request
            .words_from(3)
            .map(|name| name.to_ascii_uppercase())
            .collect();
        if channels.is_empty() || channels.len() > VALUES_MAX {
            return Err(error::WRONG_USAGE);
        }
        let types = channels
            .iter()
            .map(|name| Type::of_channel(name).ok_or(error::INVALID_CHANNEL))
            .collect::<Result<Vec<_>, u16>>()?;
        let encoding = match request.option("ENC").flatten() {
            None => Encoding::Ascii,
            Some(name) if name.eq_ignore_ascii_case("HEX") => Encoding::Hex,
            Some(name) if name.eq_ignore_ascii_case("B64") => Encoding::Base64,
            Some(_) => return Err(error::INVALID_PARAMETER),
        };
        let every = request
            .option("TS")
            .flatten()
            .map(|ms| ms.parse().map(Duration::from_ms))
            .transpose()
            .map_err(|_| error::PARSE)?;
        Ok(Stream {
            channels,
            types,
            encoding,
            crc: request.option("CRC").is_some() && encoding != Encoding::Ascii,
            every,
            due: now,
            active: true,
        })
    }

    /// Messages that are due at `now`, without their frame.
    pub(super) fn due(&mut self, sensors: &mut Sensors, now: Instant) -> Vec<String> {
        let mut messages = Vec::new();
        if !self.started {
            return messages;
        }
        for (number, stream) in &mut self.groups {
            let due = match stream.every {
                Some(_) => now >= stream.due,
                None => sensors.fresh_pulse,
            };
            if !due || !stream.active {
                continue;
            }
            stream.due = now.plus(stream.every.unwrap_or_default());
            let mut values = Values::default();
            for (slot, channel) in values.iter_mut().zip(&stream.channels) {
                *slot = sensors.value(channel, now);
            }
            let group = Group {
                types: &stream.types,
                encoding: stream.encoding,
                crc: stream.crc,
            };
            if let Some(payload) = group.encode(&values) {
                let payload = String::from_utf8_lossy(payload.as_slice()).into_owned();
                messages.push(format!("{number}:{payload}"));
            }
        }
        sensors.fresh_pulse = false;
        messages
    }
}
