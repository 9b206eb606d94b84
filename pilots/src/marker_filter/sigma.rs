//! Sigma points and their weights (Wan and van der Merwe 2000; Loh A.1, A.2 corrected).

use nalgebra::{DMatrix, DVector};

/// How far sigma points lie from the mean, and what is known about the tails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Distance of the points, in parts of a standard deviation times the root of the size.
    pub alpha: f64,
    /// 2 for normal distributions.
    pub beta: f64,
    /// A second distance, usually 0.
    pub kappa: f64,
}

impl Spread {
    /// The values of the thesis.
    pub const THESIS: Self = Self {
        alpha: 1e-3,
        beta: 2.0,
        kappa: 0.0,
    };
}

/// The weights of `2 n + 1` points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Of the middle point in the mean.
    pub middle_mean: f64,
    /// Of the middle point in the covariance.
    pub middle_covariance: f64,
    /// Of each other point: `1 / (2 (n + λ))`; printed is `λ / (2 (n + λ))`.
    pub other: f64,
    /// Factor of the covariance's root: `√(n + λ)`.
    pub distance: f64,
}

impl Weights {
    /// For a state of `size` numbers.
    #[must_use]
    pub fn new(spread: Spread, size: usize) -> Self {
        let n = size as f64;
        let Spread { alpha, beta, kappa } = spread;
        let total = alpha * alpha * (n + kappa);
        let middle_mean = (total - n) / total;
        Self {
            middle_mean,
            middle_covariance: middle_mean + 1.0 - alpha * alpha + beta,
            other: 1.0 / (2.0 * total),
            distance: total.sqrt(),
        }
    }
}

/// Points around a mean, as differences from it: `2 n` columns, the middle one left out.
///
/// `None` if the covariance is not positive.
pub(super) fn offsets(weights: &Weights, covariance: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let root = covariance.clone().cholesky()?.l() * weights.distance;
    let n = root.ncols();
    Some(DMatrix::from_fn(n, 2 * n, |row, column| {
        if column < n {
            root[(row, column)]
        } else {
            -root[(row, column - n)]
        }
    }))
}

/// Mean and covariance of passed points, as differences from the passed middle.
///
/// The weights are of the order 1/α², so everything is summed as differences from the middle:
/// sums of the points themselves lose half of their digits.
pub(super) fn combine(weights: &Weights, passed: &DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let mean = passed.column_sum() * weights.other;
    let mut covariance = &mean * mean.transpose() * weights.middle_covariance;
    for column in passed.column_iter() {
        let off = column - &mean;
        covariance += &off * off.transpose() * weights.other;
    }
    (mean, covariance)
}

/// Covariance between the points and what they were passed to.
pub(super) fn cross(
    weights: &Weights,
    offsets: &DMatrix<f64>,
    passed: &DMatrix<f64>,
    mean: &DVector<f64>,
) -> DMatrix<f64> {
    let mut sum = DMatrix::zeros(offsets.nrows(), passed.nrows());
    for (from, to) in offsets.column_iter().zip(passed.column_iter()) {
        sum += from * (to - mean).transpose() * weights.other;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total(weights: &Weights, other: f64, size: usize) -> f64 {
        weights.middle_mean + 2.0 * size as f64 * other
    }

    #[test]
    fn weights_of_the_mean_sum_to_one_and_the_printed_ones_do_not() {
        for spread in [
            Spread::THESIS,
            Spread {
                alpha: 0.5,
                ..Spread::THESIS
            },
        ] {
            for size in [3, 6, 63] {
                let weights = Weights::new(spread, size);
                assert!((total(&weights, weights.other, size) - 1.0).abs() < 1e-9);
                // λ/(2(n+λ)), as A.1 and A.2 print it.
                let n = size as f64;
                let lambda = spread.alpha * spread.alpha * (n + spread.kappa) - n;
                let printed = lambda / (2.0 * (n + lambda));
                assert!((total(&weights, printed, size) - 1.0).abs() > 0.5);
            }
        }
    }

    #[test]
    fn a_linear_map_keeps_its_moments() {
        let covariance = DMatrix::from_row_slice(2, 2, &[0.5, 0.2, 0.2, 0.3]);
        let weights = Weights::new(Spread::THESIS, 2);
        let offsets = offsets(&weights, &covariance).unwrap();
        let map = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, -1.0, 0.5]);
        let passed = &map * &offsets;
        let (mean, passed_covariance) = combine(&weights, &passed);
        let exact = &map * &covariance * map.transpose();
        assert!(mean.norm() < 1e-9, "{mean}");
        assert!((passed_covariance - exact).norm() < 1e-9);
        let cross = cross(&weights, &offsets, &passed, &mean);
        assert!((cross - &covariance * map.transpose()).norm() < 1e-9);
    }

    #[test]
    fn a_covariance_that_is_none_has_no_points() {
        let weights = Weights::new(Spread::THESIS, 2);
        let bad = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0]);
        assert!(offsets(&weights, &bad).is_none());
    }
}
