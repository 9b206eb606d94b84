//! Where structures and numbers come from.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

/// Draws the structure of a scenario: the same seed gives the same scenario on every machine.
#[derive(Clone, Debug)]
pub struct Dice(ChaCha8Rng);

impl Dice {
    /// Dice of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        // The upper 53 bits fill a double's mantissa exactly.
        (self.0.next_u64() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// True with probability `p`.
    pub fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }

    /// Uniform in `0..count`; zero for an empty range.
    pub fn index(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count.saturating_sub(1))
    }

    /// +1 or -1.
    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// A seed for something else.
    pub fn seed(&mut self) -> u64 {
        self.0.next_u64()
    }
}

/// Numbers that an optimiser moves, read one after the other.
#[derive(Clone, Debug)]
pub struct Genes<'a> {
    values: &'a [f64],
    read: usize,
}

impl<'a> Genes<'a> {
    /// Genes in any range; they are folded into [0, 1].
    #[must_use]
    pub const fn new(values: &'a [f64]) -> Self {
        Self { values, read: 0 }
    }

    /// How many were read.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.read
    }

    /// The next gene, mapped to a range and rounded to a thousandth, for people; the middle if there is none.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let gene = self.values.get(self.read).copied().unwrap_or(0.5);
        self.read += 1;
        rounded(low + folded(gene) * (high - low))
    }
}

/// A number to the nearest thousandth.
#[must_use]
pub fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

/// Reflects at 0 and 1, so that an optimiser without bounds stays inside.
fn folded(gene: f64) -> f64 {
    if !gene.is_finite() {
        return 0.5;
    }
    let wave = gene.rem_euclid(2.0);
    if wave > 1.0 { 2.0 - wave } else { wave }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn genes_stay_in_their_range() {
        let values = [-7.3, 0.2, 1.4, f64::NAN, f64::INFINITY, 1e300];
        let mut genes = Genes::new(&values);
        for _ in 0..8 {
            let value = genes.between(-2.0, 3.0);
            assert!((-2.0..=3.0).contains(&value), "{value}");
        }
        assert_eq!(genes.count(), 8);
    }

    #[test]
    fn dice_repeat() {
        let draw = |seed| {
            let mut dice = Dice::new(seed);
            (0..9).map(|_| dice.index(100)).collect::<Vec<_>>()
        };
        assert_eq!(draw(3), draw(3));
        assert_ne!(draw(3), draw(4));
    }
}
