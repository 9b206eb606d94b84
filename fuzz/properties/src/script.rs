//! Bytes as numbers and choices; when they run out, everything is at its least.

use arbitrary::Unstructured;
use haltline_spec::draw::Draw;

/// Reads a case from bytes.
pub struct Script<'a>(Unstructured<'a>);

impl<'a> Script<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(Unstructured::new(bytes))
    }

    /// Whether nothing is left.
    pub fn is_over(&self) -> bool {
        self.0.is_empty()
    }

    pub fn byte(&mut self) -> u8 {
        self.0.arbitrary().unwrap_or_default()
    }

    pub fn bits(&mut self) -> u64 {
        self.0.arbitrary().unwrap_or_default()
    }

    /// Any double: not a number, infinite and denormal ones as well.
    pub fn any(&mut self) -> f64 {
        match self.byte() {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => f64::NEG_INFINITY,
            3 => f64::from_bits(self.bits()),
            4 => -0.0,
            5 => f64::MIN_POSITIVE,
            _ => (f64::from(self.word()) - 32_768.0) * 10_f64.powi(i32::from(self.byte() % 12) - 8),
        }
    }

    pub fn word(&mut self) -> u16 {
        self.0.arbitrary().unwrap_or_default()
    }

    /// Between both ends, which are reached.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.word()) / 65_535.0
    }

    /// As [`Self::between`] from a single byte; both ends are likely.
    pub fn extreme(&mut self, low: f64, high: f64) -> f64 {
        match self.byte() {
            ..64 => low,
            192.. => high,
            byte => low + (high - low) * f64::from(byte - 64) / 127.0,
        }
    }

    /// A whole number between both ends.
    pub fn count(&mut self, low: usize, high: usize) -> usize {
        self.0.int_in_range(low..=high).unwrap_or(low)
    }

    pub fn flag(&mut self) -> bool {
        self.byte() & 1 == 1
    }

    /// True for `of` of 256 bytes.
    pub fn chance(&mut self, of: u8) -> bool {
        self.byte() > 255 - of
    }

    pub fn one_of<T: Copy, const N: usize>(&mut self, all: [T; N]) -> T {
        all[usize::from(self.byte()) % N]
    }
}

/// Drawn bytes of a drawn length.
pub fn noise<const LEAST: usize, const MOST: usize>(draw: &mut Draw) -> Vec<u8> {
    let count = LEAST + draw.index(MOST - LEAST);
    (0..count).map(|_| (draw.bits() >> 56) as u8).collect()
}
