//! Straight lines through ramps, and how far repetitions lie apart.

use super::Sample;

/// A straight change of speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    /// Where the line leaves the speed before, seconds.
    pub begin_s: f64,
    /// Slope, m/s² or rad/s².
    pub rate: f64,
    /// Samples on it.
    pub samples: usize,
}

/// Least-squares line through the first change from `from` to `to`, between a fifth and four fifths
/// of it, where neither lag nor overshoot bend it.
///
/// - `axis`: 0 speed, 1 turn rate
///
/// `None` if the change is not complete or has fewer than three samples.
#[must_use]
pub fn ramp(samples: &[Sample], axis: usize, from: f64, to: f64) -> Option<Ramp> {
    let part = |sample: &Sample| {
        let value = sample.twist.get(axis).copied().unwrap_or_default();
        (value - from) / (to - from)
    };
    let first = samples.iter().position(|sample| part(sample) > 0.2)?;
    let last = samples.iter().position(|sample| part(sample) > 0.8)?;
    let on = samples.get(first..last)?;
    if on.len() < 3 {
        return None;
    }
    let count = on.len() as f64;
    let middle_s = on.iter().map(|sample| sample.at_s).sum::<f64>() / count;
    let middle = on.iter().map(part).sum::<f64>() / count;
    let (mut up, mut square) = (0.0, 0.0);
    for sample in on {
        let dt = sample.at_s - middle_s;
        up += dt * (part(sample) - middle);
        square += dt * dt;
    }
    let slope = up / square;
    (slope.is_finite() && slope > 0.0).then(|| Ramp {
        begin_s: middle_s - middle / slope,
        rate: slope * (to - from),
        samples: on.len(),
    })
}

/// Mean and standard deviation of a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Standard deviation (n − 1).
    pub deviation: f64,
    /// Size of the sample.
    pub count: usize,
}

impl Spread {
    /// Of at least two values.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        if values.len() < 2 {
            return None;
        }
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let square: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        Some(Self {
            mean,
            deviation: (square / (count - 1.0)).sqrt(),
            count: values.len(),
        })
    }
}
