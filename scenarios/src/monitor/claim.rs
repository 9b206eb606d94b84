//! CLAIM: the robot never touches, while it moves, a body that it knew of when it accepted the
//! manoeuvre being executed.
//!
//! Stricter than the claim: a body counts as known once a beam has returned it, whether or not the
//! kernel's memory was allowed to forget it since; the words say which ([`FORGOTTEN`]). Whatever
//! stands still counts even if no beam ever returned it, because then it stands in unknown space,
//! which no tube may enter.

use haltline::decision::Action;

use haltline_robots::{Robot, Scanner};

use super::{Ledger, Standing, Tick, Touch};
use crate::assumption::Broken;
use crate::math::seconds;

/// In the words of a violation: memory was allowed to forget the body before the manoeuvre was accepted (MEMORY-08), so
/// the claim does not speak of it.
pub const FORGOTTEN: &str = "which memory had forgotten by age";

/// In the words of a violation: the body stood inside the inflation of the place where the robot rested, in a static world,
/// and was not left behind yet. For it nothing but GUARD-19 is promised, so the claim does not speak of it.
pub const EXCUSED: &str = "beside which it had rested";

/// In the words of a violation: the body bumped into the robot while that stood, and they have not come apart since. Seen,
/// it lies in the critical zone, and ZONE judges; unseen, the claim does not speak of it.
pub const BUMPED: &str = "which had bumped into the standing robot";

/// In the words of a violation: a body that can move was not in the newest scan when the manoeuvre was accepted. Unseen space
/// does not attack (CAVEATS.md): whether memory held the body or had rightly looked past the place it left, only the
/// kernel could say, and it is not asked.
pub const OUT_OF_SIGHT: &str = "which had gone out of sight";

/// Bodies that may have moved so far since they were seen are nowhere in particular (MEMORY-08), metres.
const NOWHERE_M: f64 = 1.0;

pub(super) struct Claim {
    pub(super) ledger: Ledger,
    names: Vec<String>,
    moves: Vec<bool>,
    /// When the scan began in which a valid beam last returned each body.
    seen_s: Vec<Option<f64>>,
    /// Bodies that the newest scan of each scanner returned.
    in_sight: Vec<Vec<usize>>,
    /// Whether each body was in none of them at the tick that accepted the manoeuvre being executed.
    hidden: Vec<bool>,
    /// For how long before the tick that accepted the manoeuvre being executed; none: never.
    known_s: Vec<Option<f64>>,
    /// How long memory must hold what moves.
    memory_s: f64,
    /// A body nearer than this at rest is inside the inflation there, whatever the other terms are, m; zero where
    /// bodies move, because then nothing is excused.
    beside_m: f64,
    /// Bodies beside which the robot rested and that it has not left behind.
    beside: Vec<bool>,
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
            seen_s: vec![None; names.len()],
            in_sight: vec![Vec::new(); values.scanners.len()],
            hidden: vec![true; names.len()],
            known_s: vec![None; names.len()],
            memory_s: values.memory.age_max_s.min(nowhere_s),
            beside_m: if values.obstacle_speed_mps > 0.0 {
                0.0
            } else {
                beside_m
            },
            beside: vec![false; names.len()],
            bumped: vec![false; names.len()],
            names,
            moves,
        }
    }

    pub(super) fn tick(&mut self, tick: &Tick<'_>, fresh_scans: &[usize]) {
        for scan in fresh_scans.iter().filter_map(|i| tick.inputs.scans.get(*i)) {
            for body in scan.bodies.iter().flatten() {
                if let Some(seen) = self.seen_s.get_mut(*body) {
                    *seen = Some(seconds(scan.begun_us));
                }
            }
            if let Some(bodies) = self.in_sight.get_mut(scan.scanner) {
                *bodies = scan.bodies.iter().flatten().copied().collect();
            }
        }
        if tick.decision.action < Action::Brake {
            for (known, seen) in self.known_s.iter_mut().zip(&self.seen_s) {
                *known = seen.map(|seen| tick.t_s - seen);
            }
            for (body, hidden) in self.hidden.iter_mut().enumerate() {
                *hidden = !self.in_sight.iter().any(|seen| seen.contains(&body));
            }
        }
        self.ledger.judged(tick.decision.moves());
    }

    /// Hears how far each body is from the footprint at a tick, and how the robot stands there.
    pub(super) fn stands(&mut self, distances_m: &[f64], standing: Standing) {
        let marks = self.beside.iter_mut().zip(&mut self.bumped);
        for ((beside, bumped), distance_m) in marks.zip(distances_m) {
            let rested = standing == Standing::Rested;
            *beside = (rested || *beside) && *distance_m < self.beside_m;
            *bumped = (standing != Standing::Moving || *bumped) && *distance_m <= 0.0;
        }
    }

    pub(super) fn touch(&mut self, touch: Touch, broken: &[Broken]) {
        let excused = broken.iter().any(|b| b.covers(touch.body, touch.t_s));
        let known_s = self.known_s.get(touch.body).copied().flatten();
        let can_move = self.moves.get(touch.body).copied().unwrap_or(false);
        // A body at rest can only be unseen in unknown space, which no tube may enter.
        if excused || (can_move && known_s.is_none()) {
            return;
        }
        let name = self.names.get(touch.body).map_or("?", String::as_str);
        let how = match known_s {
            Some(age) if can_move && age > self.memory_s => {
                format!("{FORGOTTEN}: last returned {age:.2} s before it accepted its manoeuvre")
            }
            Some(_) if can_move && self.bumped.get(touch.body) == Some(&true) => BUMPED.to_owned(),
            Some(_) if self.beside.get(touch.body) == Some(&true) => {
                format!("{EXCUSED} and which it had not left behind")
            }
            Some(_) if can_move && self.hidden.get(touch.body) == Some(&true) => {
                format!("{OUT_OF_SIGHT} when it accepted its manoeuvre")
            }
            Some(_) => "which it knew of when it accepted its manoeuvre".to_owned(),
            None => "which no beam had ever returned: it drove through unknown space".to_owned(),
        };
        self.ledger
            .violated(touch.t_s, format!("the moving robot touched {name}, {how}"));
    }
}
