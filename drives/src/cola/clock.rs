//! From a device's clock to the host's, by the fastest of the recent telegrams.

use haltline::time::Instant;

/// Length of one half of the window, µs.
const HALF_US: u64 = 5_000_000;

/// Maps the microsecond counter of a device (32 bits, wraps) to the host's clock.
///
/// A telegram can only arrive late, never early. The smallest difference of arrival and sending
/// over the last 5 to 10 s is therefore the best estimate of the offset; it errs late by no more
/// than the fastest transport in that time, and follows a drift of 100 ppm within 1 ms.
#[derive(Clone, Copy, Debug, Default)]
pub struct ClockMap {
    /// Unwrapped device time of the last telegram.
    device_us: Option<u64>,
    window_us: u64,
    current: Option<i64>,
    previous: Option<i64>,
}

impl ClockMap {
    /// Host time of `event`, given that `sent` (same device clock) arrived at `now`.
    ///
    /// Never later than `now`; `None` if the event is said to lie after the sending.
    pub fn map(&mut self, event: u32, sent: u32, now: Instant) -> Option<Instant> {
        let before = u64::from(sent.wrapping_sub(event));
        // More than half the counter's range means that the event lies in the future.
        if before > u64::from(u32::MAX / 2) {
            return None;
        }
        let device = self.unwrap(sent, now)?;
        let offset = i64::try_from(now.as_us())
            .ok()?
            .checked_sub(i64::try_from(device).ok()?)?;
        self.take(offset, now);
        let best = self.current.into_iter().chain(self.previous).min()?;
        let event = i64::try_from(device.saturating_sub(before)).ok()?;
        let host = u64::try_from(event.checked_add(best)?).ok()?;
        Some(Instant::from_us(host.min(now.as_us())))
    }

    /// Device time beyond 32 bits; a step back of the counter is a restart and forgets the offset.
    fn unwrap(&mut self, sent: u32, now: Instant) -> Option<u64> {
        let last = self.device_us.unwrap_or(u64::from(sent));
        let low = u32::try_from(last & u64::from(u32::MAX)).ok()?;
        let step = sent.wrapping_sub(low);
        let device = if step > u32::MAX / 2 {
            *self = Self {
                window_us: now.as_us(),
                ..Self::default()
            };
            u64::from(sent)
        } else {
            last.saturating_add(u64::from(step))
        };
        self.device_us = Some(device);
        Some(device)
    }

    fn take(&mut self, offset: i64, now: Instant) {
        if now.as_us().saturating_sub(self.window_us) > HALF_US {
            self.previous = self.current.take();
            self.window_us = now.as_us();
        }
        self.current = Some(self.current.map_or(offset, |best| best.min(offset)));
    }
}
