//! What the kernel's own navigator says of its route, tick by tick, as a run leaves it behind.

use serde::Serialize;

use crate::math::Pose;
use crate::result::PoseRecord;
use crate::world::pose_record;

/// How far the route is, in the words of the kernel.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ProgressRecord {
    /// `idle`, `driving`, `arrived`, `blocked` or `held`.
    pub kind: String,
    /// Via points passed so far, while it drives.
    pub via: Option<usize>,
    /// Why it cannot go on, as the kernel names it.
    pub reason: Option<String>,
    /// The point that ends the way, in the world; none if the kernel names none.
    pub point_m: Option<[f64; 2]>,
    /// Since when it cannot go on, on the simulator's clock.
    pub since_s: Option<f64>,
}

/// A change of the progress.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProgressChange {
    /// Time of the tick.
    pub t_s: f64,
    /// True pose at the tick.
    pub pose: PoseRecord,
    /// The progress from then on.
    pub progress: ProgressRecord,
}

/// A tick in which the guard refused what the planner proposed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RefusalRecord {
    /// Time of the tick.
    pub t_s: f64,
    /// True pose at the tick.
    pub pose: PoseRecord,
    /// Candidates refused.
    pub refused: u32,
}

/// The navigator's account of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct NavigationRecord {
    /// Progress at the end.
    pub end: ProgressRecord,
    /// Via points of the route.
    pub via_points: usize,
    /// Changes of the progress in order of time.
    pub changes: Vec<ProgressChange>,
    /// Candidates of the planner that the guard refused, over the whole run.
    pub refused: u64,
    /// Ticks in which it refused one.
    pub refused_ticks: u64,
    /// The first of these ticks.
    pub refusals: Vec<RefusalRecord>,
}

/// What a certificate keeps of the account.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NavigationBrief {
    /// Progress at the end.
    pub end: ProgressRecord,
    /// Via points of the route.
    pub via_points: usize,
    /// Candidates of the planner that the guard refused.
    pub refused: u64,
    /// Ticks in which it refused one.
    pub refused_ticks: u64,
}

impl From<&NavigationRecord> for NavigationBrief {
    fn from(record: &NavigationRecord) -> Self {
        Self {
            end: record.end.clone(),
            via_points: record.via_points,
            refused: record.refused,
            refused_ticks: record.refused_ticks,
        }
    }
}

/// Refusals kept in full; the rest is only counted.
const KEPT: usize = 20;

/// What a tick of the navigator said.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Said {
    /// Its progress; the point is in the world.
    pub progress: ProgressRecord,
    /// Candidates refused in this tick.
    pub refused: u32,
}

impl NavigationRecord {
    /// An empty account of a route with this many via points.
    #[must_use]
    pub fn new(via_points: usize) -> Self {
        Self {
            via_points,
            ..Self::default()
        }
    }

    /// Notes one tick.
    pub fn note(&mut self, t_s: f64, pose: &Pose, said: Said) {
        let pose = pose_record(pose);
        if said.refused > 0 {
            self.refused += u64::from(said.refused);
            self.refused_ticks += 1;
            if self.refusals.len() < KEPT {
                self.refusals.push(RefusalRecord {
                    t_s,
                    pose,
                    refused: said.refused,
                });
            }
        }
        let moved_on = !same(&self.end, &said.progress);
        self.end = said.progress;
        if moved_on {
            self.changes.push(ProgressChange {
                t_s,
                pose,
                progress: self.end.clone(),
            });
        }
    }
}

/// Whether two records tell the same; the blocking point may jitter with the scan.
fn same(one: &ProgressRecord, other: &ProgressRecord) -> bool {
    one.kind == other.kind && one.via == other.via && one.reason == other.reason
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(kind: &str, refused: u32) -> Said {
        Said {
            progress: ProgressRecord {
                kind: kind.to_owned(),
                ..ProgressRecord::default()
            },
            refused,
        }
    }

    #[test]
    fn changes_and_refusals_are_counted() {
        let mut log = NavigationRecord::new(2);
        for (t_s, kind, refused) in [(0.0, "idle", 0), (0.1, "driving", 2), (0.2, "driving", 1)] {
            log.note(t_s, &Pose::default(), said(kind, refused));
        }
        assert_eq!(
            (log.refused, log.refused_ticks, log.refusals.len()),
            (3, 2, 2)
        );
        let times: Vec<f64> = log.changes.iter().map(|change| change.t_s).collect();
        assert_eq!(times, [0.0, 0.1]);
        assert_eq!(log.end.kind, "driving");
    }

    #[test]
    fn only_the_first_refusals_are_kept_in_full() {
        let mut log = NavigationRecord::new(0);
        for tick in 0..100 {
            log.note(f64::from(tick), &Pose::default(), said("driving", 1));
        }
        assert_eq!((log.refused, log.refusals.len()), (100, KEPT));
    }
}
