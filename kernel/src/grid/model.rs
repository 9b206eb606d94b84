//! What one beam says about a cell at a distance: the inverse sensor model (Loh Fig. 3.9).
//!
//! One-dimensional on purpose; which beam speaks about which cell is the business of the
//! update rules.

use super::log_odds::LogOdds;
use crate::units::Length;

/// What one beam measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Echo {
    /// Something returned the beam at this range, µm.
    Hit {
        /// Measured range, µm.
        range_um: u32,
    },
    /// Nothing returned it up to this range, µm; beyond it nothing is known.
    Clear {
        /// Range taken as free, µm.
        range_um: u32,
    },
}

/// The inverse sensor model of a range `z`.
///
/// The thesis gives Fig. 3.9 in words: low before the measurement, highest directly behind
/// it, the prior far behind. With `s` the distance of the cell minus `z`, this is
///
/// ```text
///   s < -delta_1             free
///   -delta_1 <= s < 0        linear from free to occupied
///   0 <= s <= delta_2        occupied
///   delta_2 < s < delta_3    linear from occupied to the prior
///   delta_3 <= s             no evidence
/// ```
///
/// in log-odds, rounded to the nearest count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SensorModel {
    /// How far before the measurement free evidence ends.
    pub delta_1: Length,
    /// How far behind the measurement full evidence for occupied ends.
    pub delta_2: Length,
    /// How far behind the measurement all evidence ends.
    pub delta_3: Length,
    /// Evidence of a return, positive.
    pub occupied: LogOdds,
    /// Evidence of being looked through, negative.
    pub free: LogOdds,
}

impl Default for SensorModel {
    /// Loh 6.3 for the distances; p_occ = 0.7 and p_free = 0.4, which the thesis leaves open.
    fn default() -> Self {
        Self {
            delta_1: Length::from_mm(50),
            delta_2: Length::from_mm(150),
            delta_3: Length::from_mm(200),
            occupied: LogOdds::from_counts(27),
            free: LogOdds::from_counts(-13),
        }
    }
}

impl SensorModel {
    /// Evidence about a cell at `distance_um` along the beam; `None` where the beam says nothing.
    ///
    /// A distance may be negative (behind the scanner): still before the measurement.
    /// # Bound
    /// O(1), at most one division.
    /// # Source
    /// Loh Fig. 3.9, `inverse_sensor_model(m_i, x_t, z_t) - l_0` of Alg. 3.3.
    #[must_use]
    pub fn evidence(&self, distance_um: i64, echo: Echo) -> Option<LogOdds> {
        let range_um = match echo {
            Echo::Clear { range_um } => {
                return (distance_um <= i64::from(range_um)).then_some(self.free);
            }
            Echo::Hit { range_um } => range_um,
        };
        let beyond = distance_um.saturating_sub(i64::from(range_um));
        let [delta_1, delta_2, delta_3] =
            [self.delta_1, self.delta_2, self.delta_3].map(|delta| i64::from(delta.as_um()));
        if beyond < delta_1.saturating_neg() {
            Some(self.free)
        } else if beyond < 0 {
            let into = beyond.saturating_add(delta_1);
            Some(blend(self.free, self.occupied, into, delta_1))
        } else if beyond <= delta_2 {
            Some(self.occupied)
        } else if beyond < delta_3 {
            let into = beyond.saturating_sub(delta_2);
            let span = delta_3.saturating_sub(delta_2);
            Some(blend(self.occupied, LogOdds::PRIOR, into, span))
        } else {
            None
        }
    }

    /// Distance at which the evidence of `echo` ends, µm.
    #[must_use]
    pub(super) fn reach_um(&self, echo: Echo) -> u32 {
        match echo {
            Echo::Clear { range_um } => range_um,
            Echo::Hit { range_um } => {
                range_um.saturating_add(self.delta_3.as_um().max(0).unsigned_abs())
            }
        }
    }

    /// Distance up to which the evidence of `echo` is plainly free, µm.
    #[must_use]
    pub(super) fn free_um(&self, echo: Echo) -> u32 {
        match echo {
            Echo::Clear { range_um } => range_um,
            Echo::Hit { range_um } => {
                range_um.saturating_sub(self.delta_1.as_um().max(0).unsigned_abs())
            }
        }
    }
}

/// `from` at 0, `to` at `span`, linear in between, rounded to nearest; `to` for an empty span.
fn blend(from: LogOdds, to: LogOdds, into: i64, span: i64) -> LogOdds {
    let (from, to) = (i64::from(from.as_counts()), i64::from(to.as_counts()));
    let twice = to
        .saturating_sub(from)
        .saturating_mul(into)
        .saturating_mul(2)
        .saturating_add(span);
    let rise = match span.saturating_mul(2) {
        0 => to.saturating_sub(from),
        twice_span => twice.checked_div_euclid(twice_span).unwrap_or(0),
    };
    // Lies between two 8-bit values.
    i8::try_from(from.saturating_add(rise)).map_or(LogOdds::PRIOR, LogOdds::from_counts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Fig. 3.9 in floats, counts of 1/32 nat; written from the table in the docs alone.
    fn transcription(model: &SensorModel, distance_m: f64, range_m: f64) -> Option<f64> {
        let metres = |length: Length| f64::from(length.as_um()) * 1e-6;
        let (d1, d2, d3) = (
            metres(model.delta_1),
            metres(model.delta_2),
            metres(model.delta_3),
        );
        let (free, occupied) = (
            f64::from(model.free.as_counts()),
            f64::from(model.occupied.as_counts()),
        );
        let s = distance_m - range_m;
        match s {
            _ if s >= d3 => None,
            _ if s > d2 => Some(occupied * (d3 - s) / (d3 - d2)),
            _ if s >= 0.0 => Some(occupied),
            _ if s >= -d1 => Some(free + (occupied - free) * (s + d1) / d1),
            _ => Some(free),
        }
    }

    #[test]
    fn edges_of_the_zones() {
        let model = SensorModel::default();
        let at = |distance_um| {
            model
                .evidence(
                    distance_um,
                    Echo::Hit {
                        range_um: 2_000_000,
                    },
                )
                .map(LogOdds::as_counts)
        };
        assert_eq!(at(0), Some(-13));
        assert_eq!(at(-500_000), Some(-13));
        assert_eq!(at(1_949_999), Some(-13));
        assert_eq!(at(1_950_000), Some(-13));
        assert_eq!(at(1_975_000), Some(7));
        assert_eq!(at(2_000_000), Some(27));
        assert_eq!(at(2_150_000), Some(27));
        assert_eq!(at(2_175_000), Some(14));
        assert_eq!(at(2_200_000), None);
        let clear = Echo::Clear {
            range_um: 3_000_000,
        };
        assert_eq!(model.evidence(3_000_000, clear), Some(model.free));
        assert_eq!(model.evidence(3_000_001, clear), None);
    }

    #[test]
    fn without_ramps_it_is_a_step() {
        let model = SensorModel {
            delta_1: Length::ZERO,
            delta_2: Length::ZERO,
            delta_3: Length::ZERO,
            ..SensorModel::default()
        };
        let echo = Echo::Hit {
            range_um: 1_000_000,
        };
        assert_eq!(model.evidence(999_999, echo), Some(model.free));
        assert_eq!(model.evidence(1_000_000, echo), Some(model.occupied));
        assert_eq!(model.evidence(1_000_001, echo), None);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]

        #[test]
        fn follows_the_transcription(
            range_um in 0_u32..4_000_000,
            offset_um in -400_000_i64..400_000,
            deltas in [0_i32..200_000, 0..200_000, 0..200_000],
            occupied in 1_i8..=126,
            free in -127_i8..=-1,
        ) {
            let model = SensorModel {
                delta_1: Length::from_um(deltas[0]),
                delta_2: Length::from_um(deltas[1]),
                delta_3: Length::from_um(deltas[1] + deltas[2]),
                occupied: LogOdds::from_counts(occupied),
                free: LogOdds::from_counts(free),
            };
            let distance_um = i64::from(range_um) + offset_um;
            // At a jump of the model floats may fall on either side.
            let jump = [-i64::from(deltas[0]), 0, i64::from(deltas[1] + deltas[2])];
            prop_assume!(!jump.contains(&offset_um));
            let exact = transcription(&model, distance_um as f64 * 1e-6, f64::from(range_um) * 1e-6);
            let ours = model.evidence(distance_um, Echo::Hit { range_um });
            match (ours, exact) {
                (None, None) => {}
                (Some(ours), Some(exact)) => {
                    let error = (f64::from(ours.as_counts()) - exact).abs();
                    prop_assert!(error <= 0.5 + 1e-3, "{ours:?} for {exact}");
                }
                other => prop_assert!(false, "{other:?}"),
            }
        }

        #[test]
        fn is_total(distance_um: i64, range_um: u32, deltas: [i32; 3], occupied: i8, free: i8) {
            let model = SensorModel {
                delta_1: Length::from_um(deltas[0]),
                delta_2: Length::from_um(deltas[1]),
                delta_3: Length::from_um(deltas[2]),
                occupied: LogOdds::from_counts(occupied),
                free: LogOdds::from_counts(free),
            };
            for echo in [Echo::Hit { range_um }, Echo::Clear { range_um }] {
                let _ = model.evidence(distance_um, echo);
                let _ = (model.reach_um(echo), model.free_um(echo));
            }
        }
    }
}
