//! CLAIM: the robot never touches, while it moves, a body that it knew of when it accepted the
//! manoeuvre being executed; and it brakes at once for a new return on its way.
//!
//! Stricter than the claim: a body counts as known once a beam has returned it, whether or not the
//! kernel's memory was allowed to forget it since; the words say which ([`FORGOTTEN`]). Whatever
//! stands still counts even if no beam ever returned it, because then it stands in unknown space,
//! which no tube may enter.

use haltline::decision::Action;

use haltline_robots::{Robot, Scanner};

use super::news::News;
use super::sight::{Known, Sight};
use super::{Judged, Ledger, Standing, Tick, Touch};
use crate::assumption::{Broken, START};
use crate::sensor::RawScan;

/// In the words of a violation: memory was allowed to forget the body before the manoeuvre was accepted (MEMORY-08), so
/// the claim does not speak of it.
pub const FORGOTTEN: &str = "which memory had forgotten by age";

/// In the words of a violation: the body stood inside the inflation of the place where the robot rested, in a static world,
/// so near that what the drive may be off by lets them touch, and was not left behind yet. For it nothing but GUARD-19 is
/// promised, so the claim does not speak of it.
pub const EXCUSED: &str = "beside which it had rested";

/// In the words of a violation: the body bumped into the robot while that stood, and they have not come apart since. Seen,
/// it lies in the critical zone, and ZONE judges; unseen, the claim does not speak of it.
pub const BUMPED: &str = "which had bumped into the standing robot";

/// In the words of a violation: a body that can move was not in the newest scan when the manoeuvre was accepted, and a beam
/// had looked past the place where it was seen last: memory may take it for gone. Unseen space does not attack (CAVEATS.md).
pub const OUT_OF_SIGHT: &str = "which had gone out of sight";

/// Of a body that can move, no beam had ever returned, and which came to where it was touched too late to make that
/// place unknown. No violation: unseen space does not attack (CAVEATS.md).
pub const UNSEEN: &str = "which can move and no beam had returned";

/// Whether these are words about a contact of which the claim does not speak.
#[must_use]
pub fn is_outside(what: &str) -> bool {
    outside(what).is_some()
}

fn outside(what: &str) -> Option<&'static str> {
    let kinds = [BUMPED, EXCUSED, FORGOTTEN, OUT_OF_SIGHT, UNSEEN];
    kinds.into_iter().find(|words| what.contains(words))
}

/// Bodies that may have moved so far since they were seen are nowhere in particular (MEMORY-08), metres.
const NOWHERE_M: f64 = 1.0;

/// By then at the latest a place that a body came to is unknown to the kernel, if it was not seen there: known space
/// shrinks in steps of a cell, and scans are some ticks old, seconds.
const SETTLED_S: f64 = 0.3;

/// A robot comes nearer than where it rested by no more than this, metres (GUARD-19): rounding, twice.
const NEARER_M: f64 = 0.004;

pub(super) struct Claim {
    pub(super) ledger: Ledger,
    names: Vec<String>,
    moves: Vec<bool>,
    sight: Sight,
    news: News,
    /// When the manoeuvre being executed was accepted, and what was known of each body then.
    accepted: Option<(f64, Vec<Known>)>,
    /// How long memory must hold what moves.
    memory_s: f64,
    /// A body nearer than this at rest is inside the inflation there, whatever the other terms are, m; zero where
    /// bodies move, because then nothing is excused.
    beside_m: f64,
    /// How far the drive may be off, m.
    tracking_m: f64,
    /// How near the robot rested beside each body that it has not left behind.
    beside: Vec<Option<f64>>,
    /// Bodies that bumped into the standing robot and touch it still.
    bumped: Vec<bool>,
}

impl Claim {
    pub(super) fn new(robot: &Robot, names: Vec<String>, moves: Vec<bool>) -> Self {
        let values = &robot.values;
        let nowhere_s = NOWHERE_M / values.obstacle_speed_mps;
        let errors = values.scanners.iter().map(Scanner::error_m);
        let beside_m = errors.fold(f64::INFINITY, f64::min) + values.tolerances.tracking_m;
        Self {
            ledger: Ledger::new("CLAIM"),
            sight: Sight::new(&moves, values.scanners.len()),
            news: News::new(values.scanners.len()),
            accepted: None,
            memory_s: values.memory.age_max_s.min(nowhere_s),
            beside_m: if values.obstacle_speed_mps > 0.0 {
                0.0
            } else {
                beside_m
            },
            tracking_m: values.tolerances.tracking_m,
            beside: vec![None; names.len()],
            bumped: vec![false; names.len()],
            names,
            moves,
        }
    }

    pub(super) fn tick(&mut self, robot: &Robot, tick: &Tick<'_>, fresh_scans: &[usize]) {
        let scans = fresh_scans.iter().filter_map(|i| tick.inputs.scans.get(*i));
        scans.for_each(|scan: &RawScan| self.sight.take(robot, tick, scan));
        if tick.decision.action < Action::Brake {
            self.accepted = Some((tick.t_s, self.sight.known(tick.t_s)));
        }
        if let Some(what) = self.news.tick(robot, tick, fresh_scans) {
            self.ledger.violated(tick.t_s, what);
        }
        self.ledger.judged(tick.decision.moves());
    }

    /// Hears how far each body is from the footprint at a tick, and how the robot stands there.
    pub(super) fn stands(&mut self, distances_m: &[f64], standing: Standing) {
        let marks = self.beside.iter_mut().zip(&mut self.bumped);
        for ((beside, bumped), distance_m) in marks.zip(distances_m) {
            let rested = standing == Standing::Rested;
            let before = if rested { Some(*distance_m) } else { *beside };
            *beside = before.filter(|_| *distance_m < self.beside_m);
            *bumped = (standing != Standing::Moving || *bumped) && *distance_m <= 0.0;
        }
    }

    pub(super) fn vouched(&mut self, bodies: &[usize]) {
        self.sight.vouched(bodies);
    }

    pub(super) fn settled_s(&self) -> Option<f64> {
        let (accepted_s, _) = self.accepted.as_ref()?;
        Some(accepted_s - SETTLED_S).filter(|then_s| *then_s >= 0.0)
    }

    pub(super) fn touch(&mut self, robot: &Robot, touch: Touch, broken: &[Broken]) -> Judged {
        let known = self.accepted.as_ref();
        let known = known.and_then(|(_, known)| known.get(touch.body));
        let known = known.cloned().unwrap_or_default();
        let covering = broken.iter().filter(|one| {
            one.covers(touch.body, touch.t_s) && !self.is_over(robot, one, &touch, &known)
        });
        let assumptions: Vec<String> = covering.map(|one| one.id.to_owned()).collect();
        let how = self.how(&touch, &known);
        let outside = outside(&how);
        // What came out of unseen space is no violation, the others are, so that scenarios show them.
        if assumptions.is_empty() && outside != Some(UNSEEN) {
            let name = self.names.get(touch.body).map_or("?", String::as_str);
            self.ledger
                .violated(touch.t_s, format!("the moving robot touched {name}, {how}"));
        }
        Judged {
            assumptions,
            outside,
        }
    }

    /// The operator's word explains nothing any more once the part of the body that is touched, or a body that can move,
    /// was seen before the manoeuvre was accepted.
    fn is_over(&self, robot: &Robot, broken: &Broken, touch: &Touch, known: &Known) -> bool {
        let can_move = self.moves.get(touch.body).copied().unwrap_or(false);
        let seen = if can_move {
            known.in_sight
        } else {
            self.sight.shown(robot, touch.body, known, &touch.pose)
        };
        broken.id == START && seen
    }

    /// What was known of the body that is touched.
    fn how(&self, touch: &Touch, known: &Known) -> String {
        let can_move = self.moves.get(touch.body).copied().unwrap_or(false);
        let rested_m = self.beside.get(touch.body).copied().flatten();
        let bumped = self.bumped.get(touch.body) == Some(&true);
        match known.age_s {
            Some(_) if can_move && bumped => BUMPED.to_owned(),
            // A body at rest can only be unseen in unknown space, which no tube may enter.
            None if can_move && (bumped || !touch.stood) => UNSEEN.to_owned(),
            Some(age) if can_move && age > self.memory_s && !touch.stood => {
                format!("{FORGOTTEN}: last returned {age:.2} s before it accepted its manoeuvre")
            }
            Some(_) if rested_m.is_some_and(|far_m| far_m <= self.tracking_m + NEARER_M) => {
                format!("{EXCUSED} and which it had not left behind")
            }
            Some(_) if can_move && !known.in_sight && known.passed && !touch.stood => {
                format!("{OUT_OF_SIGHT} when it accepted its manoeuvre")
            }
            Some(_) => "which it knew of when it accepted its manoeuvre".to_owned(),
            None => "which no beam had ever returned: it drove through unknown space".to_owned(),
        }
    }
}
