//! Evidence for "occupied" as integer log-odds.
//!
//! Adding evidence is integer addition; no logarithm and no exponential runs in the kernel:
//! the probabilities of all 256 values are computed at compile time.

/// Log-odds `ln(p / (1 - p))` of being occupied, in counts of 1/32 nat (Loh 3.20).
///
/// Zero is the prior 0.5; the representable probabilities span 0.018 to 0.981.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LogOdds(i8);

const VALUES: usize = 256;
/// Probability of each count, from -128 to 127.
const PROBABILITY: [f64; VALUES] = probabilities();

impl LogOdds {
    /// Counts per nat.
    pub const PER_NAT: i8 = 32;
    /// The prior: nothing is known, p = 0.5.
    pub const PRIOR: Self = Self(0);

    /// From a count of 1/32 nat.
    #[must_use]
    pub const fn from_counts(counts: i8) -> Self {
        Self(counts)
    }

    /// As a count of 1/32 nat.
    #[must_use]
    pub const fn as_counts(self) -> i8 {
        self.0
    }

    /// Probability of being occupied, `1 - 1 / (1 + exp(l))` (Loh 3.21).
    #[must_use]
    pub fn probability(self) -> f64 {
        let index = usize::from(self.0.wrapping_sub(i8::MIN).cast_unsigned());
        PROBABILITY.get(index).copied().unwrap_or(0.5)
    }

    /// Least value with at least this probability; `None` if there is none, or for a NaN.
    ///
    /// # Bound
    /// At most 256 comparisons.
    #[must_use]
    pub fn at_least(probability: f64) -> Option<Self> {
        Self::all().find(|value| value.probability() >= probability)
    }

    /// Largest value with at most this probability; `None` if there is none, or for a NaN.
    ///
    /// # Bound
    /// At most 256 comparisons.
    #[must_use]
    pub fn at_most(probability: f64) -> Option<Self> {
        Self::all()
            .rev()
            .find(|value| value.probability() <= probability)
    }

    fn all() -> impl DoubleEndedIterator<Item = Self> {
        (i8::MIN..=i8::MAX).map(Self)
    }
}

#[allow(
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects,
    clippy::cast_precision_loss
)]
const fn probabilities() -> [f64; VALUES] {
    let mut table = [0.0; VALUES];
    let mut index = 0;
    while index < VALUES {
        let nats = (index as f64 - 128.0) / LogOdds::PER_NAT as f64;
        table[index] = 1.0 - 1.0 / (1.0 + exponential(nats));
        index += 1;
    }
    table
}

/// exp(x) for |x| up to 4: a short series for x/64, squared six times.
#[allow(clippy::arithmetic_side_effects)]
const fn exponential(x: f64) -> f64 {
    let small = x / 64.0;
    let (mut term, mut sum, mut order) = (1.0, 1.0, 1.0);
    while order < 14.0 {
        term *= small / order;
        sum += term;
        order += 1.0;
    }
    let mut squarings = 0;
    while squarings < 6 {
        sum *= sum;
        squarings += 1;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_follow_the_logistic_function() {
        for counts in i8::MIN..=i8::MAX {
            let exact = 1.0 - 1.0 / (1.0 + (f64::from(counts) / 32.0).exp());
            let error = (LogOdds::from_counts(counts).probability() - exact).abs();
            assert!(error < 1e-12, "{counts}: {error}");
        }
    }

    #[test]
    fn thresholds_round_towards_less_knowledge() {
        // ln 3 = 35.16 counts: 35 is not yet p = 0.75.
        assert_eq!(LogOdds::at_least(0.75), Some(LogOdds(36)));
        assert_eq!(LogOdds::at_most(0.25), Some(LogOdds(-36)));
        assert_eq!(LogOdds::at_least(0.99), None);
        assert_eq!(LogOdds::at_most(0.01), None);
        assert_eq!(LogOdds::at_least(f64::NAN), None);
        assert_eq!(LogOdds::at_most(f64::NAN), None);
    }
}
