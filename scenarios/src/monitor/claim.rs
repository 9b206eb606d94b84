//! CLAIM: the robot never touches, while it moves, a body that it knew of when it accepted the
//! manoeuvre being executed.
//!
//! Stricter than the claim: a body counts as known once a beam has returned it, whether or not the
//! kernel's memory was allowed to forget it since. Whatever stands still counts even if no beam
//! ever returned it, because then it stands in unknown space, which no tube may enter.

use haltline::decision::Action;

use super::{Ledger, Tick, Touch};
use crate::assumption::Broken;

pub(super) struct Claim {
    pub(super) ledger: Ledger,
    names: Vec<String>,
    moves: Vec<bool>,
    /// When a valid beam of a delivered scan last returned each body.
    seen_s: Vec<Option<f64>>,
    /// The same at the tick that accepted the manoeuvre being executed.
    known: Vec<bool>,
}

impl Claim {
    pub(super) fn new(names: Vec<String>, moves: Vec<bool>) -> Self {
        Self {
            ledger: Ledger::new("CLAIM"),
            seen_s: vec![None; names.len()],
            known: vec![false; names.len()],
            names,
            moves,
        }
    }

    pub(super) fn tick(&mut self, tick: &Tick<'_>, fresh_scans: &[usize]) {
        let scans = fresh_scans.iter().filter_map(|i| tick.inputs.scans.get(*i));
        for body in scans.flat_map(|scan| scan.bodies.iter().flatten()) {
            if let Some(seen) = self.seen_s.get_mut(*body) {
                *seen = Some(tick.t_s);
            }
        }
        if tick.decision.action < Action::Brake {
            for (known, seen) in self.known.iter_mut().zip(&self.seen_s) {
                *known = seen.is_some();
            }
        }
        self.ledger.judged(tick.decision.moves());
    }

    pub(super) fn touch(&mut self, touch: Touch, broken: &[Broken]) {
        let excused = broken.iter().any(|b| b.covers(touch.body, touch.t_s));
        let known = self.known.get(touch.body).copied().unwrap_or(false);
        let can_move = self.moves.get(touch.body).copied().unwrap_or(false);
        // A body at rest can only be unseen in unknown space, which no tube may enter.
        if excused || (can_move && !known) {
            return;
        }
        let name = self.names.get(touch.body).map_or("?", String::as_str);
        let how = if known {
            "which it knew of when it accepted its manoeuvre"
        } else {
            "which no beam had ever returned: it drove through unknown space"
        };
        self.ledger
            .violated(touch.t_s, format!("the moving robot touched {name}, {how}"));
    }
}
