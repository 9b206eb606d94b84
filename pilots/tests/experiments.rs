//! The thesis' marker experiments with the figures they must reach.

#![allow(clippy::unwrap_used, clippy::panic)] // Tests may fail loudly.

use haltline::marker::{MarkerEkf, MarkerFilter, Pose2};
use haltline_pilots::marker_filter::{Augmentation, DenseFilter, Method};
use haltline_scenarios::marker_world::{self as world, Chance, Label, Setup, Trace, score};

type Kernel = MarkerEkf<24, 24>;

/// Knows its start to 1 mm and 0.01°.
const KNOWN_START: [f64; 3] = [1e-6, 1e-6, 3e-8];
/// Knows its start to 0.1 m and 3°.
const VAGUE_START: [f64; 3] = [0.01, 0.01, 0.0025];
const SEEDS: u64 = 20;

fn kernel(setup: &Setup, mapped: bool, start: Pose2, spread: [f64; 3]) -> Box<Kernel> {
    let rules = world::filter_rules(setup, !mapped);
    let mut filter = Box::new(Kernel::new(rules, start, spread).unwrap());
    for marker in setup.markers.iter().filter(|_| mapped) {
        let pose = world::planar(&marker.pose);
        filter.add_mapped(marker.id, pose).unwrap();
    }
    filter
}

fn dense(
    method: Method,
    setup: &Setup,
    mapped: bool,
    start: Pose2,
    spread: [f64; 3],
) -> DenseFilter {
    let rules = world::filter_rules(setup, !mapped);
    let mut filter = DenseFilter::new(method, rules, start, spread);
    for marker in setup.markers.iter().filter(|_| mapped) {
        filter.add_mapped(marker.id, world::planar(&marker.pose));
    }
    filter
}

/// Medians over the seeds of a run's worst position m, heading deg, marker m, marker rad.
fn medians(setup: &Setup, mapped: bool) -> [f64; 4] {
    let mut all = [const { Vec::new() }; 4];
    for seed in 0..SEEDS {
        let mut filter = kernel(setup, mapped, Pose2::default(), KNOWN_START);
        let trace = world::run(setup, seed, filter.as_mut());
        let (place, turn) = score::worst(&trace);
        let (marker, marker_turn, _) = score::marker_errors(&setup.markers, filter.as_ref());
        let values = [place, turn.to_degrees(), marker, marker_turn];
        for (list, value) in all.iter_mut().zip(values) {
            list.push(value);
        }
    }
    let medians = all.map(score::median);
    println!("{medians:.5?}");
    medians
}

#[test]
fn static_map_idealised_beats_the_thesis() {
    let [place, turn, ..] = medians(&world::corridor_setup(world::idealised()), true);
    assert!(place <= 0.009 && turn <= 0.15, "{place} m, {turn} deg");
}

#[test]
fn dynamic_markers_idealised_beat_the_thesis() {
    let setup = world::corridor_setup(world::idealised());
    let [place, turn, marker, marker_turn] = medians(&setup, false);
    let way = setup.path.at(f64::INFINITY).1;
    assert!((way - 3.5).abs() < 1e-9);
    assert!(place <= 0.01 * way && turn <= 0.13, "{place} m, {turn} deg");
    assert!(
        marker <= 0.045 && marker_turn <= 0.0065,
        "{marker} m, {marker_turn} rad"
    );
}

#[test]
fn static_map_realistic_stays_within_25_mm() {
    let [place, ..] = medians(&world::corridor_setup(world::realistic()), true);
    assert!(place <= 0.025, "{place}");
}

/// Runs that begin where chance puts them, as uncertain as the filter is told.
fn runs(
    setup: &Setup,
    spread: [f64; 3],
    mut filter: impl FnMut(Pose2) -> Box<dyn MarkerFilter>,
) -> Vec<Trace> {
    (0..100)
        .map(|seed| {
            let mut chance = Chance::new(seed, 9);
            let [x, y, turn] = spread.map(|variance| variance.sqrt() * chance.normal());
            let start = world::planar(&setup.path.start);
            let start = Pose2::new(start.x_m + x, start.y_m + y, start.heading_rad + turn);
            world::run(setup, seed, filter(start).as_mut())
        })
        .collect()
}

fn inside(traces: &[Trace]) -> f64 {
    let nees = score::mean_nees(traces);
    let inside = score::part_inside(&nees, score::nees_band(traces.len()));
    println!("NEES inside its band in {:.1} % of steps", 100.0 * inside);
    inside
}

#[test]
fn the_filter_is_as_certain_as_it_should_be() {
    let real = world::realistic();
    for (name, setup, mapped, spread) in [
        (
            "corridor, dynamic",
            world::corridor_setup(real),
            false,
            VAGUE_START,
        ),
        (
            "corridor, static",
            world::corridor_setup(real),
            true,
            VAGUE_START,
        ),
        (
            "circles, dynamic",
            world::roomy_setup(real),
            false,
            KNOWN_START,
        ),
    ] {
        let traces = runs(&setup, spread, |start| {
            kernel(&setup, mapped, start, spread)
        });
        let part = inside(&traces);
        assert!(part >= 0.9, "{name}: {part}");
    }
}

//= spec/ekf.md#ekf-15
//= type=test
//# Sightings of learned markers MUST NOT narrow the pose of the map as a whole.
/// After turns with a vague start heading the textbook filter believes that markers have told it
/// the heading, which they cannot. The kernel's does not.
#[test]
fn a_vague_heading_and_turns_do_not_make_it_overconfident() {
    let setup = world::roomy_setup(world::realistic());
    let ours = |start| -> Box<dyn MarkerFilter> { kernel(&setup, false, start, VAGUE_START) };
    let textbook = |start| -> Box<dyn MarkerFilter> {
        Box::new(dense(Method::EKF, &setup, false, start, VAGUE_START))
    };
    assert!(inside(&runs(&setup, VAGUE_START, ours)) >= 0.9);
    assert!(inside(&runs(&setup, VAGUE_START, textbook)) < 0.5);
}

//= spec/ekf.md#ekf-03
//= type=test
//# every cross-covariance
#[test]
fn printed_3_19_is_overconfident() {
    let printed = Method {
        augmentation: Augmentation::Printed,
        ..Method::EKF
    };
    let setup = world::corridor_setup(world::realistic());
    let run = |method| {
        let filter = |start| -> Box<dyn MarkerFilter> {
            Box::new(dense(method, &setup, false, start, VAGUE_START))
        };
        inside(&runs(&setup, VAGUE_START, filter))
    };
    // The same code with the corrected augmentation is inside.
    assert!(run(Method::EKF) >= 0.9);
    assert!(run(printed) < 0.1);
}

/// Largest difference between two filters' estimates on the same run.
fn apart(setup: &Setup, mapped: bool, method: Method) -> f64 {
    let start = Pose2::default();
    let ours = world::run(setup, 3, kernel(setup, mapped, start, KNOWN_START).as_mut());
    let theirs = world::run(
        setup,
        3,
        &mut dense(method, setup, mapped, start, KNOWN_START),
    );
    let pairs = ours.steps.iter().zip(&theirs.steps);
    pairs
        .map(|(a, b)| a.estimate.distance_m(&b.estimate))
        .fold(0.0, f64::max)
}

/// The thesis' filters, and the kernel's that counts errors as motions of the plane, from a start
/// that is known.
#[test]
fn all_filters_are_near_each_other() {
    for mapped in [true, false] {
        let setup = world::roomy_setup(world::realistic());
        let others = [Method::EKF, Method::UKF, Method::MIXED];
        let apart = others.map(|method| apart(&setup, mapped, method));
        println!("textbook EKF, UKF, mixed: {apart:?} m");
        // They differ in second order only, but differ they must.
        for apart in apart {
            assert!(apart > 1e-9 && apart < 0.05, "{apart}");
        }
    }
}

#[test]
fn field_test_with_outliers_and_slip() {
    let setup = world::field_setup();
    let slip_m = setup.slips[0].at_m;
    for seed in 0..SEEDS {
        let start = [1e-4, 1e-4, 1e-5];
        let mut filter = kernel(&setup, true, Pose2::default(), start);
        let trace = world::run(&setup, seed, filter.as_mut());
        let mended: Vec<f64> = trace
            .frames
            .iter()
            .filter(|f| f.report.relocated)
            .map(|f| f.way_m)
            .collect();
        let [mended_m] = mended[..] else {
            panic!("seed {seed}: one slip, taken over at {mended:?}");
        };
        assert!(
            mended_m > slip_m && mended_m < slip_m + 0.7,
            "seed {seed}: {mended_m}"
        );

        let fates = score::fates(&trace, |_| true);
        assert!(fates.outliers > 50, "seed {seed}: {fates:?}");
        assert_eq!(fates.outliers_taken, 0, "seed {seed}");
        let rejected = fates.good_rejected as f64 / fates.good as f64;
        assert!(rejected <= 0.02, "seed {seed}: {rejected}");

        // Taking a pose over is a jump by design, from several sightings.
        let single = trace.frames.iter().filter(|f| !f.report.relocated);
        let jump = single.map(|f| f.jump_m).fold(0.0, f64::max);
        assert!(jump <= 0.1, "seed {seed}: {jump}");
        let known = |way: f64| way < slip_m || way > mended_m;
        let steps = trace.steps.iter().filter(|step| known(step.way_m));
        let worst = steps.map(|step| score::error(step).0).fold(0.0, f64::max);
        println!("seed {seed}: rejected {rejected:.4}, jump {jump:.3} m, worst {worst:.3} m");
        assert!(worst < 0.15, "seed {seed}: {worst}");
    }
}

/// The setup of the field test does what its test needs: outliers of every kind, gaps, a slip.
#[test]
fn the_field_test_is_hostile() {
    let setup = world::field_setup();
    let mut filter = kernel(&setup, true, Pose2::default(), KNOWN_START);
    let trace = world::run(&setup, 0, filter.as_mut());
    let labels: Vec<Label> = trace.frames.iter().flat_map(|f| f.labels.clone()).collect();
    for kind in [
        Label::Displaced,
        Label::Flipped,
        Label::WrongId,
        Label::Duplicate,
    ] {
        let count = labels.iter().filter(|label| **label == kind).count();
        assert!(count >= 5, "{kind:?}: {count}");
    }
    let blind = trace.steps.iter().filter(|step| !step.in_sight).count();
    assert!(
        blind * 50 >= trace.steps.len(),
        "{blind} of {}",
        trace.steps.len()
    );
    let gaps = trace.steps.split(|step| step.in_sight);
    let gap_m = gaps
        .filter_map(|gap| Some(gap.last()?.way_m - gap.first()?.way_m))
        .fold(0.0, f64::max);
    println!(
        "no marker in sight in {blind} of {} cycles, {gap_m:.2} m at most",
        trace.steps.len()
    );
    // A filter without a gate follows the outliers.
    let mut open = world::filter_rules(&setup, false);
    open.gate_pose = 1e12;
    let mut naked = Kernel::new(open, Pose2::default(), KNOWN_START).unwrap();
    for marker in &setup.markers {
        naked
            .add_mapped(marker.id, world::planar(&marker.pose))
            .unwrap();
    }
    let trace = world::run(&setup, 0, &mut naked);
    let (worst, _) = score::worst(&trace);
    assert!(worst > 0.5, "{worst}");
}

#[test]
fn a_loop_of_200_m_closes() {
    let setup = world::loop_setup(world::realistic());
    for seed in 0..5 {
        let mut filter = kernel(&setup, false, Pose2::default(), KNOWN_START);
        let trace = world::run(&setup, seed, filter.as_mut());
        let before = |way: f64| {
            trace
                .steps
                .iter()
                .filter(|s| s.way_m < way)
                .map(|s| score::error(s).0)
                .fold(0.0, f64::max)
        };
        let last = trace.steps.last().unwrap();
        let (drift, end) = (before(200.0), score::error(last).0);
        let (_, _, found) = score::marker_errors(&setup.markers, filter.as_ref());
        println!("seed {seed}: {drift:.2} m before the loop closes, {end:.2} m at the end");
        assert_eq!(found, 20);
        // Half a percent of the way, and never worse than before the first marker came back.
        assert!(end < 1.0 && end < drift, "seed {seed}: {end} {drift}");
    }
}
