//! The control board of the model car: commands, answers, dead-man switch, reversing sequence.

use haltline::time::{Duration, Instant};

use super::daq::{Sensors, Streams};
use crate::uc::command::Request;
use crate::uc::line::LineReader;
use crate::uc::{FORWARD, REVERSE, STEERING, error};

/// What the motor controller makes of the pulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Thrust {
    /// Rolls.
    Neutral,
    /// Brakes with this strength, 1 to 500.
    Brake(i16),
    /// Drives: positive forward.
    Drive(i16),
}

/// Brake, then neutral, before the board lets the motor turn backwards.
const BRAKE_PULSE: Duration = Duration::from_ms(100);
const NEUTRAL_PULSE: Duration = Duration::from_ms(100);

/// Board, without the car around it.
#[derive(Clone, Debug)]
pub(super) struct Board {
    stx: bool,
    heeds_dead_man: bool,
    lines: LineReader,
    out: Vec<u8>,
    mode: Mode,
    value: i16,
    steering: Option<i16>,
    dead_man_ms: u32,
    /// Last successful `!DRV`.
    driven: Instant,
    session: u32,
    /// The last number it was given; a command without one takes this (a fault of the firmware).
    stale: i32,
    /// The motor may turn backwards: the sequence is through.
    reversed: bool,
    /// When reverse was first asked for.
    reversing: Option<Instant>,
    now: Instant,
    pub(super) sensors: Sensors,
    streams: Streams,
}

/// Digit after digit: what is none silently gives a wrong number, and no error.
fn digits(word: &str) -> i32 {
    let (sign, digits) = word.strip_prefix('-').map_or((1, word), |rest| (-1, rest));
    let value = digits.bytes().fold(0_i32, |value, byte| {
        value
            .wrapping_mul(10)
            .wrapping_add(i32::from(byte) - i32::from(b'0'))
    });
    value.wrapping_mul(sign)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Forward,
    Reverse,
    Direct,
    Off,
}

impl Board {
    pub(super) fn new(stx: bool, heeds_dead_man: bool, now: Instant) -> Self {
        Self {
            stx,
            heeds_dead_man,
            lines: LineReader::default(),
            out: Vec::new(),
            mode: Mode::Off,
            value: 0,
            steering: None,
            dead_man_ms: 0,
            driven: now,
            session: 0,
            stale: 0,
            reversed: false,
            reversing: None,
            now,
            sensors: Sensors::new(now),
            streams: Streams::default(),
        }
    }

    pub(super) fn receive(&mut self, bytes: &[u8], now: Instant) {
        self.now = now;
        for byte in bytes {
            match self.lines.push(*byte) {
                None => {}
                Some(Err(_)) => self.answer(&format!("ERR({})", error::TOO_LONG)),
                Some(Ok(line)) => self.line(line.as_slice()),
            }
        }
    }

    pub(super) fn outgoing(&mut self) -> Vec<u8> {
        core::mem::take(&mut self.out)
    }

    /// When the last successful `!DRV` came.
    pub(super) const fn last_drive(&self) -> Instant {
        self.driven
    }

    /// Pulse on the steering servo, if there is one.
    pub(super) const fn steering(&self) -> Option<i16> {
        self.steering
    }

    fn message(&mut self, kind: char, text: &str) {
        if self.stx {
            self.out.push(2);
        }
        self.out.extend_from_slice(kind.to_string().as_bytes());
        self.out.extend_from_slice(text.as_bytes());
        self.out.extend_from_slice(&[3, b'\n']);
    }

    fn answer(&mut self, text: &str) {
        self.message(':', text);
    }

    fn line(&mut self, line: &[u8]) {
        if line.is_empty() {
            return;
        }
        let result = Request::parse(line).and_then(|request| self.obey(&request));
        match result {
            Ok(text) => self.answer(&text),
            Err(code) => self.answer(&format!("ERR({code})")),
        }
    }

    fn obey(&mut self, request: &Request<'_>) -> Result<String, u16> {
        if request.is(0, "DRV") {
            return if request.set {
                self.drive(request)
            } else {
                Ok(self.drive_state(request))
            };
        }
        if request.is(0, "STEER") {
            return self.steer(request);
        }
        if request.is(0, "SID") {
            if request.set {
                let word = request.word(1).ok_or(error::WRONG_USAGE)?;
                self.session = word.parse().map_err(|_| error::PARSE)?;
            }
            return Ok(self.session.to_string());
        }
        if request.is(0, "VER") || request.is(0, "ID") {
            return if request.set {
                Err(error::READ_ONLY)
            } else {
                Ok("emulated".to_owned())
            };
        }
        if request.is(0, "TICS") {
            return Ok((self.now.as_us() / 1000).to_string());
        }
        if request.is(0, "DAQ") {
            return self.streams.obey(request, &self.sensors, self.now);
        }
        let switches = ["VOUT", "US", "LED", "IMU", "MAG"];
        if switches.iter().any(|name| request.is(0, name)) {
            return Ok("ok".to_owned());
        }
        Err(error::UNKNOWN_COMMAND)
    }

    fn drive(&mut self, request: &Request<'_>) -> Result<String, u16> {
        if let Some(value) = request.option("DMS") {
            let value = value.ok_or(error::WRONG_USAGE)?;
            self.dead_man_ms = value.parse().map_err(|_| error::PARSE)?;
            self.driven = self.now;
            return Ok(format!("~DMS={}", self.dead_man_ms));
        }
        let Some(word) = request.word(1) else {
            self.driven = self.now;
            return Ok("ok".to_owned());
        };
        if word.eq_ignore_ascii_case("OFF") {
            (self.mode, self.value, self.driven) = (Mode::Off, 0, self.now);
            return Ok("OFF".to_owned());
        }
        let (mode, range) = match word.to_ascii_uppercase().as_str() {
            "F" => (Mode::Forward, FORWARD),
            "B" => (Mode::Reverse, REVERSE),
            "D" => (Mode::Direct, -500..=500),
            _ => return Err(error::WRONG_USAGE),
        };
        let value = self.number(request, 2)?;
        // Out of range: refused, and the set point before stays in force.
        let value = i16::try_from(value).map_err(|_| error::OUT_OF_RANGE)?;
        if !range.contains(&value) {
            return Err(error::OUT_OF_RANGE);
        }
        if mode != Mode::Reverse && value > 0 {
            (self.reversed, self.reversing) = (false, None);
        }
        if mode == Mode::Reverse && value > 0 && self.reversing.is_none() {
            self.reversing = Some(self.now);
        }
        (self.mode, self.value, self.driven) = (mode, value, self.now);
        Ok(format!("{} {value}", word.to_ascii_uppercase()))
    }

    /// The number in word `index`, which may be given twice as a check.
    fn number(&mut self, request: &Request<'_>, index: usize) -> Result<i32, u16> {
        let first = request.word(index).map_or(self.stale, digits);
        self.stale = first;
        match request.word(index + 1).map(digits) {
            Some(second) if second != first => Err(error::CORRUPTED),
            _ => Ok(first),
        }
    }

    fn drive_state(&self, request: &Request<'_>) -> String {
        let state = match self.mode {
            Mode::Forward => format!("F {}", self.value),
            Mode::Reverse => format!("B {}", self.value),
            Mode::Direct => format!("D {}", self.value),
            Mode::Off => "OFF".to_owned(),
        };
        match request.option("DMS") {
            Some(_) => format!("{state} ~DMS={}", self.dead_man_ms),
            None => state,
        }
    }

    fn steer(&mut self, request: &Request<'_>) -> Result<String, u16> {
        if !request.set {
            return Ok(self
                .steering
                .map_or("OFF".to_owned(), |value| value.to_string()));
        }
        if request.is(1, "OFF") {
            self.steering = None;
            return Ok("OFF".to_owned());
        }
        let value = self.number(request, 1)?;
        let value = i16::try_from(value).map_err(|_| error::OUT_OF_RANGE)?;
        if !STEERING.contains(&value) {
            return Err(error::OUT_OF_RANGE);
        }
        self.steering = Some(value);
        Ok(value.to_string())
    }

    /// Dead-man switch and data streams.
    pub(super) fn live(&mut self, now: Instant) {
        self.now = now;
        let silent = now.since(self.driven).unwrap_or_default();
        let most = Duration::from_ms(u64::from(self.dead_man_ms) + 1);
        if self.heeds_dead_man && self.dead_man_ms > 0 && silent > most {
            // Neutral: it rolls, does not brake, and the steering stays.
            self.value = 0;
        }
        if let Some(since) = self.reversing
            && now
                .since(since)
                .is_some_and(|gap| gap >= BRAKE_PULSE.plus(NEUTRAL_PULSE))
        {
            self.reversed = true;
        }
        for message in self.streams.due(&mut self.sensors, now) {
            self.message('#', &message);
        }
    }

    /// What the motor does now.
    pub(super) fn thrust(&self) -> Thrust {
        match self.mode {
            Mode::Off => Thrust::Neutral,
            // Direct pulses: negative is forward.
            Mode::Direct if self.value != 0 => Thrust::Drive(-self.value),
            Mode::Forward if self.value > 0 => Thrust::Drive(self.value),
            Mode::Forward if self.value < 0 && !self.reversed => Thrust::Brake(-self.value),
            Mode::Reverse if self.value > 0 && self.reversed => Thrust::Drive(-self.value),
            Mode::Reverse if self.value > 0 => {
                let since = self.reversing.unwrap_or(self.now);
                if self.now.since(since).is_some_and(|gap| gap < BRAKE_PULSE) {
                    Thrust::Brake(500)
                } else {
                    Thrust::Neutral
                }
            }
            _ => Thrust::Neutral,
        }
    }
}
