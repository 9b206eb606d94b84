//! The host's monotonic clock as the kernel's instants.

use haltline::time::Instant;

/// Counts microseconds from its making on, beginning at one second.
#[derive(Clone, Copy, Debug)]
pub struct Clock(std::time::Instant);

impl Default for Clock {
    fn default() -> Self {
        Self(std::time::Instant::now())
    }
}

impl Clock {
    /// Now.
    #[must_use]
    pub fn now(&self) -> Instant {
        let us = u64::try_from(self.0.elapsed().as_micros()).unwrap_or(u64::MAX);
        Instant::from_us(us.saturating_add(1_000_000))
    }
}
