//! The commands that may still be executing or in flight.

use crate::arith::narrow;
use crate::config::Tolerances;
use crate::guard::hull::Vertex;
use crate::input::Twist;
use crate::time::{Duration, Instant};

/// Number of commands kept.
pub const HISTORY: usize = 64;

/// Ring of sent commands in order of time.
#[derive(Clone, Copy, Debug)]
pub struct Pipeline {
    ring: [(Instant, Vertex); HISTORY],
    newest: usize,
    count: usize,
    /// When standstill was sent after motion, the last time.
    stopped: Option<Instant>,
}

impl Default for Pipeline {
    fn default() -> Self {
        Self {
            ring: [(Instant::default(), Vertex::default()); HISTORY],
            newest: 0,
            count: 0,
            stopped: None,
        }
    }
}

impl Pipeline {
    /// Records what is sent at `now`.
    pub fn push(&mut self, now: Instant, vertex: Vertex) {
        if self.last().twist != Twist::default() && vertex.twist == Twist::default() {
            self.stopped = Some(now);
        }
        let next = self.newest.saturating_add(1);
        self.newest = if next >= HISTORY { 0 } else { next };
        if let Some(slot) = self.ring.get_mut(self.newest) {
            *slot = (now, vertex);
        }
        self.count = self.count.saturating_add(1).min(HISTORY);
    }

    /// The command sent last; rest before the first.
    #[must_use]
    pub fn last(&self) -> Vertex {
        self.newest_first()
            .next()
            .map(|(_, vertex)| *vertex)
            .unwrap_or_default()
    }

    /// Whether nothing but standstill was sent for `span` before `at`; before the first command the drive rested.
    #[must_use]
    pub fn has_stood(&self, at: Instant, span: Duration) -> bool {
        let stood = |stopped| at.since(stopped).is_some_and(|passed| passed >= span);
        self.last().twist == Twist::default() && self.stopped.is_none_or(stood)
    }

    fn newest_first(&self) -> impl Iterator<Item = &(Instant, Vertex)> {
        let (new, old) = self
            .ring
            .split_at(self.newest.saturating_add(1).min(HISTORY));
        new.iter().rev().chain(old.iter().rev()).take(self.count)
    }

    /// Whether the record goes back to before `since`.
    #[must_use]
    pub fn reaches(&self, since: Instant) -> bool {
        self.newest_first()
            .last()
            .is_some_and(|(stamp, _)| *stamp < since)
    }

    /// Whether commands sent after `since` have been overwritten: the host ticks faster than
    /// the configured period.
    #[must_use]
    pub fn has_forgotten(&self, since: Instant) -> bool {
        self.count == HISTORY && !self.reaches(since)
    }

    /// Every command sent since `since`, and the last one before that, newest first.
    ///
    /// # Bound
    /// At most [`HISTORY`] items.
    pub fn since(&self, since: Instant) -> impl Iterator<Item = &Vertex> {
        let mut done = false;
        self.newest_first()
            .take_while(move |(stamp, _)| {
                if done {
                    return false;
                }
                done = *stamp < since;
                true
            })
            .map(|(_, vertex)| vertex)
    }

    /// Whether `measured` lies within tolerance of the hull of the commands since `since`.
    #[must_use]
    pub fn explains(&self, measured: Twist, since: Instant, tolerances: &Tolerances) -> bool {
        let (mut v, mut w) = ((0, 0), (0, 0));
        let mut first = true;
        for vertex in self.since(since) {
            let (linear, angular) = (
                vertex.twist.linear.as_um_per_s(),
                vertex.twist.angular.as_urad_per_s(),
            );
            if first {
                (v, w) = ((linear, linear), (angular, angular));
                first = false;
            }
            v = (v.0.min(linear), v.1.max(linear));
            w = (w.0.min(angular), w.1.max(angular));
        }
        let inside = |value: i32, (low, high): (i32, i32), slack: i32| {
            let value = i64::from(value);
            let slack = i64::from(slack);
            value >= i64::from(low).saturating_sub(slack)
                && value <= i64::from(high).saturating_add(slack)
        };
        inside(
            measured.linear.as_um_per_s(),
            v,
            tolerances.follow_speed.as_um_per_s(),
        ) && inside(
            measured.angular.as_urad_per_s(),
            w,
            narrow(i64::from(tolerances.follow_angular_speed.as_urad_per_s())),
        )
    }
}
