//! The host's side of the scanner: asks for the stream and turns telegrams into scans.

use std::fmt;

use haltline::time::Instant;
use haltline_robots::Scanner as Mount;
use haltline_scenarios::sensor::RawScan;

use crate::cola::{self, ClockMap, Deframer, ScanTelegram, decode_scan, frame_into};
use crate::link::Link;

/// Ranges below this are reserved values and no measurements, mm.
const VALID_FROM_MM: u16 = 16;
/// Angles may differ from the robot file's by this, 1/10000 deg.
const ANGLE_SLACK: i32 = 100;

/// Why a scan was not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScanFault {
    /// A telegram was cut, too long or not text.
    Damaged,
    /// A scan telegram whose content cannot be read.
    Unreadable,
    /// The scanner says that it does not work; its status.
    Status(u8),
    /// Number of ranges: the scanner's, and the robot file's.
    Count(u16, u16),
    /// First angle or step are not the robot file's.
    Angles,
    /// Its clock cannot be followed.
    Clock,
    /// It does not want to stream.
    Refused,
    /// The connection is gone.
    Gone,
}

impl fmt::Display for ScanFault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Damaged => write!(out, "telegram of the scanner: damaged"),
            Self::Unreadable => write!(out, "LMDscandata: content cannot be read"),
            Self::Status(status) => write!(out, "LMDscandata: the scanner reports status {status}"),
            Self::Count(found, wanted) => write!(
                out,
                "LMDscandata: {found} ranges, the robot file says {wanted}; set `beams` or the scanner"
            ),
            Self::Angles => write!(
                out,
                "LMDscandata: first angle or step differ from the robot file; \
                 set `field_of_view_deg` or the scanner"
            ),
            Self::Clock => write!(out, "LMDscandata: time stamps contradict each other"),
            Self::Refused => write!(
                out,
                "the scanner refuses to stream LMDscandata; is it measuring, and does it speak CoLa A?"
            ),
            Self::Gone => write!(
                out,
                "the connection to the scanner is gone; it is tried again once the robot rests"
            ),
        }
    }
}

/// Scanner client.
pub struct Eye {
    link: Option<Box<dyn Link>>,
    mount: Mount,
    deframer: Deframer,
    clock: ClockMap,
    unsent: Vec<u8>,
    fault: Option<ScanFault>,
}

impl Eye {
    /// A client that asks for the stream at its first exchange.
    #[must_use]
    pub fn new(link: Box<dyn Link>, mount: Mount) -> Self {
        let mut eye = Self {
            link: None,
            mount,
            deframer: Deframer::default(),
            clock: ClockMap::default(),
            unsent: Vec::new(),
            fault: None,
        };
        eye.reopen(link);
        eye
    }

    /// A new connection: nothing is carried over from the one before.
    pub fn reopen(&mut self, link: Box<dyn Link>) {
        (self.deframer, self.clock) = (Deframer::default(), ClockMap::default());
        self.unsent.clear();
        frame_into(cola::STREAM_START, |part| {
            self.unsent.extend_from_slice(part)
        });
        self.link = Some(link);
    }

    /// Whether there is a connection.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.link.is_some()
    }

    /// What was wrong with the newest bad scan, once.
    pub const fn fault(&mut self) -> Option<ScanFault> {
        self.fault.take()
    }

    /// Exchanges bytes; appends whole, usable scans. A connection that ends is a fault like others.
    pub fn exchange(&mut self, now: Instant, scans: &mut Vec<RawScan>) {
        let Some(link) = &mut self.link else { return };
        let mut heard = Vec::new();
        let written = link.write(&self.unsent);
        let read = link.read(&mut heard);
        if let Ok(count) = written {
            self.unsent.drain(..count);
        }
        for byte in heard {
            let telegram = match self.deframer.push(byte) {
                None => continue,
                Some(Err(_)) => Err(ScanFault::Damaged),
                Some(Ok(text)) if text.starts_with("sSN LMDscandata") => {
                    decode_scan(text).ok_or(ScanFault::Unreadable)
                }
                Some(Ok(text)) if refuses(text) => Err(ScanFault::Refused),
                Some(Ok(_)) => continue,
            };
            match telegram.and_then(|telegram| scan(&telegram, &self.mount, &mut self.clock, now)) {
                Ok(scan) => scans.push(scan),
                Err(fault) => self.fault = Some(fault),
            }
        }
        if written.is_err() || read.is_err() {
            self.link = None;
            self.fault = Some(ScanFault::Gone);
        }
    }
}

/// Whether a scanner says no: an error, or an answer that the stream is off.
fn refuses(text: &str) -> bool {
    let mut words = text.split(' ');
    match (words.next(), words.next(), words.next()) {
        (Some("sFA"), _, _) => true,
        (Some("sEA"), Some("LMDscandata"), on) => on != Some("1"),
        _ => false,
    }
}

fn scan(
    telegram: &ScanTelegram,
    mount: &Mount,
    clock: &mut ClockMap,
    now: Instant,
) -> Result<RawScan, ScanFault> {
    let header = &telegram.header;
    // 2 is a dirty window, a warning; 1 and 5 are errors.
    if !matches!(header.status, 0 | 2) {
        return Err(ScanFault::Status(header.status));
    }
    if header.count != mount.beams {
        return Err(ScanFault::Count(header.count, mount.beams));
    }
    let tenthousandth = |rad: f64| (rad.to_degrees() * 1e4).round() as i32;
    let first = cola::AHEAD - tenthousandth(mount.field_of_view_rad / 2.0);
    let step = tenthousandth(mount.beam_angle_rad());
    let near = |a: i32, b: i32, slack: i32| a.abs_diff(b) <= slack.unsigned_abs();
    if !near(header.start_angle, first, ANGLE_SLACK) || !near(i32::from(header.step), step, 1) {
        return Err(ScanFault::Angles);
    }
    let stamp = clock
        .map(header.start_us, header.sent_us, now)
        .ok_or(ScanFault::Clock)?;
    let ranges = telegram.ranges_mm.iter().take(usize::from(header.count));
    Ok(RawScan {
        scanner: 0,
        begun_us: stamp.as_us(),
        stamp_us: stamp.as_us(),
        ranges_m: ranges
            .map(|mm| {
                if *mm < VALID_FROM_MM {
                    0.0
                } else {
                    f32::from(*mm) * 1e-3
                }
            })
            .collect(),
        bodies: Vec::new(),
    })
}
