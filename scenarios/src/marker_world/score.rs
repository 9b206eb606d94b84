//! Figures of runs: errors, consistency, and how outliers fared.

use super::outlier::Label;
use super::places::Marker;
use super::run::{StepSample, Trace, planar};
use crate::math::wrap;
use haltline::marker::{MarkerFilter, Verdict};

/// Error of one estimate: distance m, |heading| rad.
#[must_use]
pub fn error(step: &StepSample) -> (f64, f64) {
    let truth = planar(&step.truth);
    let turn = wrap(step.estimate.heading_rad - truth.heading_rad).abs();
    (truth.distance_m(&step.estimate), turn)
}

/// Largest position (m) and heading (rad) error of a run.
#[must_use]
pub fn worst(trace: &Trace) -> (f64, f64) {
    trace
        .steps
        .iter()
        .map(error)
        .fold((0.0, 0.0), |a, b| (a.0.max(b.0), a.1.max(b.1)))
}

/// The middle of some numbers, the upper of two; zero of none.
#[must_use]
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}

/// Normalised estimation error squared, 3 degrees of freedom; infinite for a singular
/// covariance.
#[must_use]
pub fn nees(step: &StepSample) -> f64 {
    let truth = planar(&step.truth);
    let [a, b, c] = [
        step.estimate.x_m - truth.x_m,
        step.estimate.y_m - truth.y_m,
        wrap(step.estimate.heading_rad - truth.heading_rad),
    ];
    let p = step.covariance;
    // Elimination by hand: a Cholesky factor of three rows.
    let l00 = p[0][0].sqrt();
    let (l10, l20) = (p[1][0] / l00, p[2][0] / l00);
    let l11 = (p[1][1] - l10 * l10).sqrt();
    let l21 = (p[2][1] - l20 * l10) / l11;
    let l22 = (p[2][2] - l20 * l20 - l21 * l21).sqrt();
    let x = a / l00;
    let y = (b - l10 * x) / l11;
    let z = (c - l20 * x - l21 * y) / l22;
    let sum = x * x + y * y + z * z;
    if sum.is_finite() { sum } else { f64::INFINITY }
}

/// Mean NEES of each step over several runs of the same length.
#[must_use]
pub fn mean_nees(traces: &[Trace]) -> Vec<f64> {
    let steps = traces
        .iter()
        .map(|t| t.steps.len())
        .min()
        .unwrap_or_default();
    let mean = |at: usize| {
        let sum: f64 = traces.iter().map(|t| nees(&t.steps[at])).sum();
        sum / traces.len() as f64
    };
    (0..steps).map(mean).collect()
}

/// The two-sided 95 % band of the mean of `runs` NEES values of three degrees of freedom.
///
/// By the Wilson-Hilferty approximation of the chi-square quantiles, better than 0.1 % here.
#[must_use]
pub fn nees_band(runs: usize) -> (f64, f64) {
    let degrees = 3.0 * runs as f64;
    let quantile = |z: f64| {
        let part = 2.0 / (9.0 * degrees);
        let root = 1.0 - part + z * part.sqrt();
        degrees * root * root * root
    };
    let z = 1.959_963_984_540_054;
    (quantile(-z) / runs as f64, quantile(z) / runs as f64)
}

/// Part of the values inside a band.
#[must_use]
pub fn part_inside(values: &[f64], (low, high): (f64, f64)) -> f64 {
    let inside = values.iter().filter(|v| (low..=high).contains(*v)).count();
    inside as f64 / values.len().max(1) as f64
}

/// Worst position (m) and heading (rad) error of the markers that a filter knows, and how many.
#[must_use]
pub fn marker_errors(markers: &[Marker], filter: &dyn MarkerFilter) -> (f64, f64, usize) {
    let found = markers
        .iter()
        .filter_map(|m| Some((m, filter.marker(m.id)?)));
    found.fold((0.0, 0.0, 0), |(place, turn, count), (marker, estimate)| {
        let truth = planar(&marker.pose);
        let off = truth.distance_m(&estimate.pose);
        let heading = wrap(estimate.pose.heading_rad - truth.heading_rad).abs();
        (f64::max(place, off), f64::max(turn, heading), count + 1)
    })
}

/// How the sightings of a run fared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fates {
    /// Good ones that were judged: fused, added or rejected.
    pub good: usize,
    /// Good ones that were rejected.
    pub good_rejected: usize,
    /// Outliers that were judged.
    pub outliers: usize,
    /// Outliers that were fused or added.
    pub outliers_taken: usize,
}

/// Counts the fates of sightings in the frames that `which` selects by the way driven, m.
#[must_use]
pub fn fates(trace: &Trace, which: impl Fn(f64) -> bool) -> Fates {
    let mut fates = Fates::default();
    for frame in trace.frames.iter().filter(|frame| which(frame.way_m)) {
        for (label, record) in frame.labels.iter().zip(frame.report.records()) {
            let taken = matches!(record.verdict, Verdict::Fused | Verdict::Added);
            if *label == Label::Good {
                fates.good += 1;
                fates.good_rejected += usize::from(!taken);
            } else {
                fates.outliers += 1;
                fates.outliers_taken += usize::from(taken);
            }
        }
    }
    fates
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_band_is_that_of_the_tables() {
        // Chi-square quantiles of 300 degrees: 253.912 and 349.874.
        let (low, high) = nees_band(100);
        assert!((low - 2.539).abs() < 2e-3, "{low}");
        assert!((high - 3.499).abs() < 2e-3, "{high}");
    }

    #[test]
    fn median_of_few() {
        assert!((median(vec![3.0, 1.0, 2.0]) - 2.0).abs() < 1e-12);
        assert!(median(Vec::new()).abs() < 1e-12);
    }
}
