//! ZONE: a return in the critical zone stops in the same tick; one just outside does not.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

mod common;

use common::check;
use common::episode::{Episode, Lie, Style, episodes};
use common::run::run_in;
use common::tamper::{Raw, Scene, Tamper};
use haltline::decision::{Action, Reason, StopStatus};
use haltline::input::Beam;
use haltline_spec::draw::Draw;
use proptest::prelude::*;
use std::cell::Cell;

/// Plants a single return beside the robot, just inside or just outside the zone.
struct Planter<'e> {
    episode: &'e Episode,
    planted: Option<bool>,
    status: StopStatus,
    pause: usize,
    inside: usize,
    outside: usize,
}

impl Planter<'_> {
    /// Distance from the scanner along a beam to the edge of the zone of the body frame, m.
    ///
    /// The scanner stands inside the zone, so every ray leaves it exactly once.
    fn edge_m(&self, beam: usize) -> f64 {
        let scanner = self.episode.scanner();
        let angle = scanner.mount.theta_rad + scanner.increment_rad * beam as f64;
        let (sin, cos) = angle.sin_cos();
        let [front, side] = self.episode.zone_m;
        let [f, r, l, t] = self.episode.edges_m;
        let along = |direction: f64, from: f64, ahead: f64, behind: f64| {
            if direction > 0.0 {
                (ahead - from) / direction
            } else if direction < 0.0 {
                (behind + from) / -direction
            } else {
                f64::INFINITY
            }
        };
        along(cos, scanner.mount.x_m, f + front, r + side).min(along(sin, 0.0, l + side, t + side))
    }
}

impl Tamper for Planter<'_> {
    fn alter(&mut self, raw: &mut Raw, draw: &mut Draw) {
        self.planted = None;
        let Some(scan) = raw.scans.last_mut() else {
            return;
        };
        // A planted return is remembered for a while: the next one waits.
        self.pause = self.pause.saturating_sub(1);
        if self.status != StopStatus::Running || self.pause > 0 || !draw.chance(0.3) {
            return;
        }
        self.pause = 30;
        let beam = draw.index(scan.beams.len());
        let inside = draw.chance(0.5);
        // Rounding, and the robot's motion since the sweep began.
        let range_m = self.edge_m(beam) + if inside { -0.02 } else { 0.02 };
        let mm = (range_m * 1e3) as u16;
        scan.beams[beam] = Beam::Hit(mm);
        self.planted = Some(inside);
    }

    fn judge(&mut self, scene: &Scene<'_>) -> Option<String> {
        self.status = scene.decision.status;
        let decision = scene.decision;
        match self.planted? {
            true => {
                self.inside += 1;
                (decision.action < Action::ProtectiveStop)
                    .then(|| format!("ZONE-01: {:?}, {:?}", decision.action, decision.reason))
            }
            false => {
                self.outside += 1;
                (decision.reason == Reason::CriticalZone)
                    .then(|| "ZONE-02: stopped for a point outside".to_owned())
            }
        }
    }
}

/// Runs episodes with planted returns; `(inside, outside, broken)`.
fn plant(lie: Lie, cases: u32) -> (usize, usize, Option<String>) {
    let strategy = episodes(vec![Style::Wander], false).prop_map(move |mut episode| {
        episode.lie = lie;
        episode.steered = false;
        episode.speed_mps = 0.05;
        episode.turn_radps = 0.05;
        episode.sensor_m = 0.0;
        episode.zone_m = [0.25, 0.1];
        episode
    });
    let (inside, outside) = (Cell::new(0), Cell::new(0));
    let first = std::cell::RefCell::new(None);
    check(cases, &strategy, |episode| {
        let mut planter = Planter {
            episode: &episode,
            planted: None,
            status: StopStatus::Latched,
            pause: 0,
            inside: 0,
            outside: 0,
        };
        let report = run_in(&episode, Vec::new(), 20.0, &mut planter);
        inside.set(inside.get() + planter.inside);
        outside.set(outside.get() + planter.outside);
        first
            .borrow_mut()
            .get_or_insert_with(Vec::new)
            .extend(report.faults);
        Ok(())
    });
    let broken = first.into_inner().unwrap_or_default();
    (inside.get(), outside.get(), broken.into_iter().next())
}

//= spec/zone.md#zone-01
//= type=test
//# A return of a new scan in the critical zone MUST start a protective stop in the tick that receives the scan.
//= spec/zone.md#zone-02
//= type=test
//# The critical zone MUST be the footprint grown by the front margin ahead of the front edge and by the side margin on
//# every other side.
#[test]
fn a_return_in_the_zone_stops_in_the_same_tick() {
    let (inside, outside, broken) = plant(Lie::None, 40);
    println!("{inside} returns planted inside, {outside} outside");
    assert!(inside > 100 && outside > 100);
    assert_eq!(broken, None);
}

#[test]
fn false_twin_without_a_zone() {
    let (_, _, broken) = plant(Lie::Zone, 10);
    println!("false twin Zone: {broken:?}");
    assert!(broken.is_some_and(|text| text.starts_with("ZONE-01")));
}
