//! One column of a factor changes: by a measurement, or by a marker that is taken out.
//!
//! Both multiply or grow the column's pivot by something positive; neither subtracts from it.

use super::linear::PIVOT_MIN;

/// One column of Bierman's correction.
pub(super) struct Step {
    pub(super) gain: f64,
    slope: f64,
}

impl Step {
    /// `f` is the row times this column; the pivot shrinks by a ratio between 0 and 1.
    pub(super) fn new(f: f64, pivot: &mut f64, total: &mut f64) -> Self {
        let (gain, before) = (*pivot * f, *total);
        *total = before + f * gain;
        *pivot = (*pivot * (before / *total)).max(PIVOT_MIN);
        Self {
            gain,
            slope: -f / before,
        }
    }

    pub(super) fn rotate_one(&self, entry: &mut f64, gain: &mut f64) {
        let old = *entry;
        *entry = old + self.slope * *gain;
        *gain += self.gain * old;
    }

    pub(super) fn rotate(&self, entries: &mut [f64], gains: &mut [f64]) {
        for (entry, gain) in entries.iter_mut().zip(gains) {
            self.rotate_one(entry, gain);
        }
    }
}

/// One column of a change of rank one with a positive weight.
pub(super) struct Fold {
    own: f64,
    slope: f64,
}

impl Fold {
    pub(super) fn new(own: f64, pivot: &mut f64, weight: &mut f64) -> Self {
        let before = *pivot;
        *pivot = before + *weight * own * own;
        let slope = *weight * own / *pivot;
        *weight *= before / *pivot;
        Self { own, slope }
    }

    pub(super) fn apply(&self, entries: &mut [f64], rest: &mut [f64]) {
        for (entry, rest) in entries.iter_mut().zip(rest) {
            *rest -= self.own * *entry;
            *entry += self.slope * *rest;
        }
    }
}
