//! Seeded noise: the same seed gives the same numbers on every machine.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

/// Which part of the simulator draws; each has its own independent stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// Range noise and lost beams.
    Sensor = 1,
    /// Odometry errors.
    Odometry = 2,
    /// Which beams a fault hits.
    Fault = 3,
}

/// A source of noise.
#[derive(Clone, Debug)]
pub struct Noise(ChaCha8Rng);

impl Noise {
    /// The stream of one part of the simulator.
    #[must_use]
    pub fn new(seed: u64, stream: Stream) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream as u64);
        Self(generator)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        // The upper 53 bits fill a double's mantissa exactly.
        (self.0.next_u64() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Uniform in [−1, 1).
    pub fn symmetric(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Standard normal, truncated to three standard deviations by drawing again.
    pub fn normal(&mut self) -> f64 {
        loop {
            let radius = (-2.0 * libm::log(1.0 - self.unit())).sqrt();
            let value = radius * libm::cos(core::f64::consts::TAU * self.unit());
            if value.abs() <= 3.0 {
                return value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_repeat_and_differ() {
        let draw = |seed, stream| -> Vec<f64> {
            let mut noise = Noise::new(seed, stream);
            (0..8).map(|_| noise.unit()).collect()
        };
        assert_eq!(draw(1, Stream::Sensor), draw(1, Stream::Sensor));
        assert_ne!(draw(1, Stream::Sensor), draw(1, Stream::Odometry));
        assert_ne!(draw(1, Stream::Sensor), draw(2, Stream::Sensor));
    }

    #[test]
    fn normal_has_its_moments_and_its_bound() {
        let mut noise = Noise::new(7, Stream::Sensor);
        let values: Vec<f64> = (0..20_000).map(|_| noise.normal()).collect();
        let mean = values.iter().sum::<f64>() / 20_000.0;
        let variance = values.iter().map(|v| v * v).sum::<f64>() / 20_000.0;
        assert!(mean.abs() < 0.03, "{mean}");
        // Truncation at three sigma takes 2.7 % off the variance.
        assert!((variance - 0.973).abs() < 0.04, "{variance}");
        assert!(values.iter().all(|v| v.abs() <= 3.0));
        assert!(values.iter().any(|v| v.abs() > 2.5));
    }
}
