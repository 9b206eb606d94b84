//! GUARD-02: nobody drives, however slowly, into space that nobody has seen.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

mod common;

use common::check;
use common::episode::{CLEAR_M, Style, episodes};
use common::run::run_in;
use common::tamper::{Raw, Scene, Tamper};
use haltline::convert;
use haltline_spec::draw::Draw;
use proptest::prelude::*;
use std::cell::Cell;

/// Reverses for ever; remembers how far it came.
struct Reversing {
    speed_mps: f64,
    steered: bool,
    farthest_m: f64,
}

impl Tamper for Reversing {
    fn alter(&mut self, raw: &mut Raw, _draw: &mut Draw) {
        raw.command = if self.steered {
            convert::arc_command(raw.now, -self.speed_mps, 0.0)
        } else {
            convert::twist_command(raw.now, -self.speed_mps, 0.0)
        };
    }

    fn judge(&mut self, scene: &Scene<'_>) -> Option<String> {
        let pose = scene.recent.last()?.pose;
        self.farthest_m = self.farthest_m.max(pose.x_m.hypot(pose.y_m));
        None
    }
}

//= spec/guard.md#guard-02
//= type=test
//# The guard MUST refuse a motion when one of its samples, inflated by every term but sensor and moving, contains the
//# centre of an unknown cell to which the nominal footprint comes nearer there than it is at the start.
#[test]
fn reversing_ends_where_the_vouched_area_ends() {
    let strategy = episodes(vec![Style::Creep], false).prop_map(|mut episode| {
        // The scanner looks ahead; nobody sees what is behind.
        episode.full_circle = false;
        episode
    });
    let (farthest_m, runs) = (Cell::new(0.0_f64), Cell::new(0));
    check(common::cases(16), &strategy, |episode| {
        for speed_mps in [0.03_f64, 0.1, 0.5] {
            let mut reversing = Reversing {
                speed_mps: speed_mps.min(episode.speed_mps),
                steered: episode.steered,
                farthest_m: 0.0,
            };
            run_in(&episode, Vec::new(), 40.0, &mut reversing);
            runs.set(runs.get() + 1);
            farthest_m.set(farthest_m.get().max(reversing.farthest_m));
            // The rear edge may reach the end of the vouched disc, the skirt and a cell.
            let limit_m = CLEAR_M - episode.edges_m[1] + 0.05 + 0.1;
            prop_assert!(
                reversing.farthest_m < limit_m,
                "at {speed_mps} m/s the rotation centre came {} m back, more than {limit_m}",
                reversing.farthest_m
            );
        }
        Ok(())
    });
    println!(
        "{} runs, the farthest {:.2} m back",
        runs.get(),
        farthest_m.get()
    );
}
