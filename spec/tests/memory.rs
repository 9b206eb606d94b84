//! MEMORY and GUARD-19: what was seen is not forgotten but by rule; leaving a tight place.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

mod common;

use common::check;
use common::episode::{Episode, Lie, Style, episodes};
use common::run::{run, run_in};
use common::tamper::{Raw, Scene, Tamper};
use haltline::convert;
use haltline::decision::{Action, StopStatus};
use haltline::input::{Beam, Reading};
use haltline_spec::draw::Draw;
use haltline_spec::plane::{Body, Pose};
use haltline_spec::world::Mover;
use proptest::prelude::*;
use std::cell::{Cell, RefCell};

/// What the scans show of a body that the first scans showed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Vanishing {
    /// Returns from far behind it.
    LookedPast,
    /// No return at all, which counts as free up to the clear distance.
    NoReturn,
    /// Nothing can be said about the rays straight ahead.
    Invalid,
    /// Every third scan shows it again.
    Flickering,
}

/// Wants to drive on for ever; lets the body vanish after a while.
struct Vanisher {
    how: Vanishing,
    /// Scans since the body vanished.
    scans: usize,
    ticks: usize,
    moved_before: bool,
    /// Scans it took until the kernel drove on.
    drove_after: Option<usize>,
}

/// Ticks until the body vanishes.
const SEEN_TICKS: usize = 40;

impl Tamper for Vanisher {
    fn alter(&mut self, raw: &mut Raw, _draw: &mut Draw) {
        self.ticks += 1;
        let stamp = raw.now;
        raw.command = convert::twist_command(stamp, 0.15, 0.0);
        if self.ticks <= SEEN_TICKS {
            return;
        }
        for scan in &mut raw.scans {
            self.scans += 1;
            if self.how == Vanishing::Flickering && self.scans.is_multiple_of(3) {
                continue;
            }
            let count = scan.beams.len();
            for (index, beam) in scan.beams.iter_mut().enumerate() {
                if matches!(beam, Beam::Hit(_)) {
                    // Few enough invalid beams that the scan stays usable.
                    let ahead = index.abs_diff(count / 2) <= count / 50;
                    *beam = match self.how {
                        Vanishing::NoReturn => Beam::NoReturn,
                        Vanishing::Invalid if ahead => Beam::Invalid,
                        _ => Beam::Hit(5000),
                    };
                }
            }
        }
    }

    fn judge(&mut self, scene: &Scene<'_>) -> Option<String> {
        let drives = matches!(scene.decision.action, Action::Pass | Action::Slow)
            && scene.decision.verdict.is_some();
        if drives && self.ticks <= SEEN_TICKS {
            self.moved_before = true;
        } else if drives {
            self.drove_after.get_or_insert(self.scans);
        }
        None
    }
}

/// A robot that stands just in front of a box.
fn before_a_box(episode: &Episode) -> Vec<Mover> {
    let half_m = 0.12;
    // Outside the zone, inside every inflation.
    let gap_m = 0.015;
    let centre = Pose::new(episode.edges_m[0] + gap_m + half_m, 0.0, 0.0);
    vec![Mover {
        body: Body::rectangle(centre, half_m, half_m),
        velocity_mps: [0.0; 2],
    }]
}

fn quiet(episode: &mut Episode) {
    episode.steered = false;
    episode.full_circle = true;
    episode.edges_m[0] = episode.edges_m[0].max(0.4);
    episode.sensor_m = 0.005;
    episode.tracking_m = 0.02;
    episode.speed_mps = 0.2;
}

/// For each way to vanish: how many scans it took until the robot drove on, least and most.
fn vanish(how: Vanishing, lie: Lie, cases: u32) -> (Option<usize>, Option<usize>) {
    // Where bodies may move nothing is excused: the robot stands until the hit is gone.
    let strategy = episodes(vec![Style::Creep], true).prop_map(move |mut episode| {
        quiet(&mut episode);
        episode.lie = lie;
        // Slow enough that a hit does not dissolve into unknown space within the run.
        episode.obstacle_mps = 0.1;
        episode
    });
    let (least, most) = (Cell::new(None::<usize>), Cell::new(None::<usize>));
    let stayed = Cell::new(0);
    check(cases, &strategy, |episode| {
        let mut vanisher = Vanisher {
            how,
            scans: 0,
            ticks: 0,
            moved_before: false,
            drove_after: None,
        };
        run_in(&episode, before_a_box(&episode), 6.0, &mut vanisher);
        prop_assert!(!vanisher.moved_before, "drove towards a body in sight");
        match vanisher.drove_after {
            Some(scans) => {
                least.set(Some(least.get().map_or(scans, |one| one.min(scans))));
                most.set(Some(most.get().map_or(scans, |one| one.max(scans))));
            }
            None => stayed.set(stayed.get() + 1),
        }
        Ok(())
    });
    println!(
        "{how:?}: drove on after {:?} to {:?} scans, stayed in {} of {cases} runs",
        least.get(),
        most.get(),
        stayed.get()
    );
    (least.get(), most.get())
}

//= spec/memory.md#memory-02
//= type=test
//# A remembered hit MUST NOT be cleared before the configured number of consecutive scans had at least one beam through
//# its error disc and all of these beams pass beyond it.
#[test]
fn a_hit_is_cleared_by_enough_scans_in_a_row_and_by_nothing_less() {
    for how in [Vanishing::LookedPast, Vanishing::NoReturn] {
        let (least, most) = vanish(how, Lie::None, 12);
        assert!(
            least.is_some_and(|scans| scans >= 3),
            "{how:?} cleared too early"
        );
        assert!(
            most.is_some_and(|scans| scans < 60),
            "{how:?} is never cleared"
        );
    }
    for how in [Vanishing::Invalid, Vanishing::Flickering] {
        assert_eq!(
            vanish(how, Lie::None, 12),
            (None, None),
            "{how:?} cleared a hit"
        );
    }
}

#[test]
fn false_twin_that_clears_after_one_scan() {
    let (least, _) = vanish(Vanishing::LookedPast, Lie::ClearAfter, 12);
    assert!(least.is_some_and(|scans| scans < 3));
}

/// Contacts of robots that remember what they can no longer see, with drifting odometry.
fn turning_blind(lie: Lie, cases: u32, drift: f64) -> (usize, usize, Vec<String>) {
    let strategy = episodes(vec![Style::Spot], false).prop_map(move |mut episode| {
        episode.lie = lie;
        episode.full_circle = false;
        episode.steered = false;
        episode.tol_v_mps = 0.0;
        episode.tol_omega_radps = 0.0;
        episode.tracking_m = 0.0;
        episode.sensor_m = 0.0;
        episode.beams = 700;
        episode.odometry_linear = drift;
        episode.odometry_angular = drift;
        episode.bodies = 9;
        // Long behind the axis: a turn sweeps what the scanner no longer sees.
        episode.edges_m[1] = 0.55;
        episode
    });
    let (accepted, refused) = (Cell::new(0), Cell::new(0));
    let contacts = RefCell::new(Vec::new());
    check(cases, &strategy, |episode| {
        // One contact shows what is to be shown.
        if !contacts.borrow().is_empty() {
            return Ok(());
        }
        let report = run(&episode, 12.0);
        accepted.set(accepted.get() + report.accepted);
        refused.set(refused.get() + report.refused);
        contacts.borrow_mut().extend(report.contacts);
        contacts.borrow_mut().extend(report.crashes);
        Ok(())
    });
    (accepted.get(), refused.get(), contacts.into_inner())
}

//= spec/memory.md#memory-04
//= type=test
//# The error of a remembered hit MUST grow by at least the odometry error over the distance driven and the angle turned
//# since it was seen.
#[test]
fn turns_beside_what_is_out_of_sight_touch_nothing() {
    let (accepted, refused, contacts) = turning_blind(Lie::None, common::cases(30), 0.05);
    println!("blind turns: {accepted} accepted, {refused} refused");
    assert!(accepted > 500 && refused > 50);
    assert_eq!(contacts.first(), None);
}

#[test]
fn false_twin_that_trusts_its_odometry() {
    let (accepted, _, contacts) = turning_blind(Lie::Drift, 90, 0.3);
    println!(
        "false twin Drift: {accepted} accepted, {} contacts",
        contacts.len()
    );
    assert!(!contacts.is_empty());
}

/// Between the robot and the wall beside which it rests, metres.
const GAP_M: f64 = 0.02;

/// Wants one twist for ever.
struct Wants {
    v_mps: f64,
    omega_radps: f64,
    /// True distance to the only body over time.
    nearest_m: f64,
    drove: usize,
    /// Ticks that braked between two that drove.
    broke_off: usize,
    braking: usize,
    body: Body,
    episode: Episode,
}

impl Tamper for Wants {
    fn alter(&mut self, raw: &mut Raw, _draw: &mut Draw) {
        raw.command = convert::twist_command(raw.now, self.v_mps, self.omega_radps);
        let _: &Reading<_> = &raw.command;
    }

    fn judge(&mut self, scene: &Scene<'_>) -> Option<String> {
        let pose = scene.recent.last()?.pose;
        let distance_m = self.body.distance_m(&self.episode.outline(), pose)?;
        self.nearest_m = self.nearest_m.min(distance_m);
        let decision = scene.decision;
        let drives = matches!(decision.action, Action::Pass | Action::Slow)
            && decision.verdict.is_some()
            && decision.status == StopStatus::Running;
        self.drove += usize::from(drives);
        if drives {
            self.broke_off += self.braking;
            self.braking = 0;
        } else if self.drove > 0 {
            self.braking += 1;
        }
        None
    }
}

/// A robot that starts beside a long wall and wants `(v, omega)`.
fn beside_a_wall(episode: &Episode, v_mps: f64, omega_radps: f64) -> Wants {
    let body = Body::rectangle(
        Pose::new(0.0, episode.edges_m[2] + GAP_M + 0.1, 0.0),
        4.0,
        0.1,
    );
    let mut wants = Wants {
        v_mps,
        omega_radps,
        nearest_m: f64::INFINITY,
        drove: 0,
        broke_off: 0,
        braking: 0,
        body,
        episode: episode.clone(),
    };
    let world = vec![Mover {
        body,
        velocity_mps: [0.0; 2],
    }];
    run_in(episode, world, 8.0, &mut wants);
    wants
}

//= spec/guard.md#guard-19
//= type=test
//# In a static world, a known point outside footprint and critical zone but inside the inflation of the place where the
//# robot rests or rested last MUST block every motion that brings the footprint nearer to it by more than rounding.
#[test]
fn a_robot_beside_a_wall_leaves_along_it_and_never_towards_it() {
    let strategy = episodes(vec![Style::Creep], false).prop_map(|mut episode| {
        quiet(&mut episode);
        episode.zone_m = [0.01, 0.01];
        // A scanner that sees the wall all along, an inflation that contains it.
        episode.beams = 700;
        episode.tol_v_mps = 0.0;
        episode.tol_omega_radps = 0.0;
        episode.tracking_m = 0.03;
        episode.sensor_m = 0.0;
        episode
    });
    let (along, all) = (Cell::new(0), Cell::new(0));
    let (drove, broke_off) = (Cell::new(0), Cell::new(0));
    check(12, &strategy, |episode| {
        all.set(all.get() + 1);
        let wants = beside_a_wall(&episode, 0.15, 0.0);
        along.set(along.get() + usize::from(wants.drove > 20));
        drove.set(drove.get() + wants.drove);
        broke_off.set(broke_off.get() + wants.broke_off);
        let nearer_m = GAP_M - wants.nearest_m;
        prop_assert!(nearer_m < 0.004, "nearer by {nearer_m}");
        for (v_mps, omega_radps) in [(0.15, 0.2), (0.0, 0.3), (0.0, -0.3), (0.15, -0.2)] {
            // Rounding lets it creep, but not past the critical zone.
            let nearest_m = beside_a_wall(&episode, v_mps, omega_radps).nearest_m;
            prop_assert!(nearest_m > 0.008, "{v_mps} {omega_radps}: {nearest_m} left");
        }
        Ok(())
    });
    println!(
        "left along the wall in {} of {} runs, drove in {} ticks, broke off in {}",
        along.get(),
        all.get(),
        drove.get(),
        broke_off.get()
    );
    assert!(along.get() * 2 > all.get(), "the robot could not leave");
    // Parts of the wall that it had not rested beside make it rest again. Without an excuse in motion it would have to
    // for each step: it drove in a fifth of the ticks then.
    assert!(
        drove.get() * 3 > drove.get() + broke_off.get(),
        "the excuse ended at once"
    );
}
