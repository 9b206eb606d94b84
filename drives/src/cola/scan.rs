//! LMDscandata: one sweep with its clock, angles and ranges.

use core::fmt::Write;

/// Most ranges of a telegram that are read.
pub const RANGES_MAX: usize = 1100;

/// What stands before the ranges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Header {
    /// Second word of the device status: 0 fine, 1 error, 2 dirty window, 5 too dirty.
    pub status: u8,
    /// Telegrams sent.
    pub telegrams: u16,
    /// Sweeps made.
    pub scans: u16,
    /// Scanner's clock at the start of the sweep, µs.
    pub start_us: u32,
    /// Scanner's clock when the telegram was ready, µs.
    pub sent_us: u32,
    /// Sweeps per second, 1/100 Hz.
    pub frequency_chz: u32,
    /// First angle, 1/10000 deg, counter-clockwise, 90 deg ahead.
    pub start_angle: i32,
    /// Angle from one range to the next, 1/10000 deg.
    pub step: u16,
    /// Number of ranges.
    pub count: u16,
}

/// A whole sweep; ranges in units of the scale factor, which must be 1 mm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScanTelegram {
    /// Clock, angles, status.
    pub header: Header,
    /// Ranges, mm; 0 is no measurement, 1 to 15 are reserved and none either.
    pub ranges_mm: [u16; RANGES_MAX],
}

/// Reads a telegram with a sweep, polled (`sRA`) or streamed (`sSN`).
///
/// `None` for every other telegram and for one whose numbers, scale, count or end do not fit:
/// nothing of a bad telegram is used.
#[must_use]
pub fn decode_scan(text: &str) -> Option<ScanTelegram> {
    let mut words = text.split(' ').filter(|word| !word.is_empty());
    let kind = words.next()?;
    if !matches!(kind, "sRA" | "sSN") || words.next()? != "LMDscandata" {
        return None;
    }
    let mut header = Header::default();
    skip(&mut words, 4)?; // version, device, serial number, first status word
    header.status = number(words.next()?)?;
    header.telegrams = number(words.next()?)?;
    header.scans = number(words.next()?)?;
    header.start_us = number(words.next()?)?;
    header.sent_us = number(words.next()?)?;
    skip(&mut words, 5)?; // inputs, outputs, layer
    header.frequency_chz = number(words.next()?)?;
    skip(&mut words, 1)?; // measurement frequency
    let encoders: u8 = number(words.next()?)?;
    skip(&mut words, usize::from(encoders).saturating_mul(2))?;
    let channels: u8 = number(words.next()?)?;
    // The first channel must be the first echo's distances in millimetres without offset.
    if channels == 0 || words.next()? != "DIST1" || words.next()? != "3F800000" {
        return None;
    }
    if number::<u32>(words.next()?)? != 0 {
        return None;
    }
    header.start_angle = signed(words.next()?)?;
    header.step = number(words.next()?)?;
    header.count = number(words.next()?)?;
    let mut ranges_mm = [0; RANGES_MAX];
    for slot in ranges_mm.get_mut(..usize::from(header.count))? {
        *slot = number(words.next()?)?;
    }
    // A telegram cut inside its ranges would end here; a whole one goes on.
    words.next()?;
    Some(ScanTelegram { header, ranges_mm })
}

fn skip<'a>(words: &mut impl Iterator<Item = &'a str>, count: usize) -> Option<()> {
    (0..count).try_for_each(|_| words.next().map(drop))
}

fn number<T: TryFrom<u32>>(word: &str) -> Option<T> {
    // `from_str_radix` would take a sign.
    let plain = word.len() <= 8 && word.bytes().all(|byte| byte.is_ascii_hexdigit());
    let value = plain.then(|| u32::from_str_radix(word, 16).ok())??;
    T::try_from(value).ok()
}

/// Two's complement in hexadecimal, or decimal with its sign written out.
fn signed(word: &str) -> Option<i32> {
    if word.starts_with(['+', '-']) {
        return word.parse().ok();
    }
    number::<u32>(word).map(u32::cast_signed)
}

/// Writes everything before the ranges, as a scanner does.
///
/// # Errors
/// Those of `out`.
pub fn header_text(header: &Header, streamed: bool, out: &mut impl Write) -> core::fmt::Result {
    let Header {
        status,
        telegrams,
        scans,
        start_us,
        sent_us,
        frequency_chz,
        start_angle,
        step,
        count,
    } = header;
    let kind = if streamed { "sSN" } else { "sRA" };
    write!(
        out,
        "{kind} LMDscandata 1 1 89A27F 0 {status:X} {telegrams:X} {scans:X} {start_us:X} \
         {sent_us:X} 0 0 7 0 0 {frequency_chz:X} 168 0 1 DIST1 3F800000 00000000 \
         {start_angle:X} {step:X} {count:X}"
    )
}
