//! The host's side of the scanner: asks for the stream and turns telegrams into scans.

use std::fmt;
use std::io;

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
        }
    }
}

/// Scanner client.
pub struct Eye {
    link: Box<dyn Link>,
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
        let mut unsent = Vec::new();
        frame_into(cola::STREAM_START, |part| unsent.extend_from_slice(part));
        Self {
            link,
            mount,
            deframer: Deframer::default(),
            clock: ClockMap::default(),
            unsent,
            fault: None,
        }
    }

    /// What was wrong with the newest bad scan, once.
    pub const fn fault(&mut self) -> Option<ScanFault> {
        self.fault.take()
    }

    /// Exchanges bytes; appends whole, usable scans.
    ///
    /// # Errors
    /// The scanner is gone.
    pub fn exchange(&mut self, now: Instant, scans: &mut Vec<RawScan>) -> io::Result<()> {
        let written = self.link.write(&self.unsent)?;
        self.unsent.drain(..written);
        let mut heard = Vec::new();
        self.link.read(&mut heard)?;
        for byte in heard {
            match self.deframer.push(byte) {
                None => {}
                Some(Err(_)) => self.fault = Some(ScanFault::Damaged),
                Some(Ok(text)) => {
                    if !text.starts_with("sSN LMDscandata") {
                        continue;
                    }
                    let Some(telegram) = decode_scan(text) else {
                        self.fault = Some(ScanFault::Unreadable);
                        continue;
                    };
                    match scan(&telegram, &self.mount, &mut self.clock, now) {
                        Ok(scan) => scans.push(scan),
                        Err(fault) => self.fault = Some(fault),
                    }
                }
            }
        }
        Ok(())
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
