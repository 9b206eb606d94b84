//! The host's monotonic clock as the kernel's instants.

use haltline::time::Instant;

/// Counts microseconds from its making on, beginning at one second.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    start: std::time::Instant,
    slowness: u32,
}

impl Default for Clock {
    fn default() -> Self {
        Self::slowed(1)
    }
}

impl Clock {
    /// A clock for tests on busy machines, so many times slower than the world's. An emulator and its
    /// host that share it live the same as ever, and have that much more time to do so.
    #[must_use]
    pub fn slowed(slowness: u32) -> Self {
        Self {
            start: std::time::Instant::now(),
            slowness: slowness.max(1),
        }
    }

    /// Now.
    #[must_use]
    pub fn now(&self) -> Instant {
        let elapsed = self.start.elapsed() / self.slowness;
        let us = u64::try_from(elapsed.as_micros()).unwrap_or(u64::MAX);
        Instant::from_us(us.saturating_add(1_000_000))
    }
}
