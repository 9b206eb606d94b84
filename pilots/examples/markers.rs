//! The thesis' marker experiments: `cargo run --release -p haltline-pilots --example markers`.
//!
//! Prints a table for the kernel's EKF, the dense EKF, the UKF and the mixture. Parts can be named:
//! `corridor`, `consistency`, `field`, `loop`; without a name all run, about five minutes.
#![allow(clippy::unwrap_used)]

use haltline::marker::{MarkerEkf, MarkerFilter, Pose2};
use haltline_pilots::marker_filter::{Augmentation, DenseFilter, Method};
use haltline_scenarios::marker_world::{self as world, Chance, Setup, Trace, score};

type Kernel = MarkerEkf<24, 24>;

/// Knows its start to 1 mm and 0.01°.
const KNOWN_START: [f64; 3] = [1e-6, 1e-6, 3e-8];
const SEEDS: u64 = 20;

#[derive(Clone, Copy)]
enum Which {
    Kernel,
    Dense(Method),
}

const FILTERS: [(&str, Which); 4] = [
    ("EKF (kernel)", Which::Kernel),
    ("EKF (dense)", Which::Dense(Method::EKF)),
    ("UKF", Which::Dense(Method::UKF)),
    ("UKF, EKF", Which::Dense(Method::MIXED)),
];

fn filter(
    which: Which,
    setup: &Setup,
    mapped: bool,
    start: Pose2,
    spread: [f64; 3],
) -> Box<dyn MarkerFilter> {
    let rules = world::filter_rules(setup, !mapped);
    let markers = setup.markers.iter().filter(|_| mapped);
    match which {
        Which::Kernel => {
            let mut filter = Box::new(Kernel::new(rules, start, spread).unwrap());
            for marker in markers {
                filter
                    .add_mapped(marker.id, world::planar(&marker.pose))
                    .unwrap();
            }
            filter
        }
        Which::Dense(method) => {
            let mut filter = Box::new(DenseFilter::new(method, rules, start, spread));
            for marker in markers {
                filter.add_mapped(marker.id, world::planar(&marker.pose));
            }
            filter
        }
    }
}

fn corridor(name: &str, setup: &Setup, mapped: bool) {
    println!("\n{name}: median over {SEEDS} seeds (worst)");
    println!(
        "{:14} {:>20} {:>20} {:>20} {:>22}",
        "", "position m", "heading deg", "marker m", "marker rad"
    );
    for (label, which) in FILTERS {
        let mut all = [const { Vec::new() }; 4];
        for seed in 0..SEEDS {
            let start = world::planar(&setup.path.start);
            let mut filter = filter(which, setup, mapped, start, KNOWN_START);
            let trace = world::run(setup, seed, filter.as_mut());
            let (place, turn) = score::worst(&trace);
            let (marker, marker_turn, _) = score::marker_errors(&setup.markers, filter.as_ref());
            for (values, value) in
                all.iter_mut()
                    .zip([place, turn.to_degrees(), marker, marker_turn])
            {
                values.push(value);
            }
        }
        let show = |values: &Vec<f64>| {
            let worst = values.iter().copied().fold(0.0, f64::max);
            format!("{:.4} ({worst:.4})", score::median(values.clone()))
        };
        let [a, b, c, d] = &all;
        println!(
            "{label:14} {:>20} {:>20} {:>20} {:>22}",
            show(a),
            show(b),
            show(c),
            show(d)
        );
    }
}

fn consistency(name: &str, setup: &Setup, mapped: bool, spread: [f64; 3]) {
    let runs = 100;
    let printed = Method {
        augmentation: Augmentation::Printed,
        ..Method::EKF
    };
    let filters = FILTERS
        .into_iter()
        .chain([("printed 3.19", Which::Dense(printed))]);
    let band = score::nees_band(runs);
    println!(
        "\n{name}: NEES over {runs} runs, 95 % band {:.2} to {:.2}",
        band.0, band.1
    );
    for (label, which) in filters {
        let traces: Vec<Trace> = (0..runs as u64)
            .map(|seed| {
                let mut chance = Chance::new(seed, 9);
                let mut off = |variance: f64| variance.sqrt() * chance.normal();
                let truth = world::planar(&setup.path.start);
                let start = Pose2::new(
                    truth.x_m + off(spread[0]),
                    truth.y_m + off(spread[1]),
                    truth.heading_rad + off(spread[2]),
                );
                let mut filter = filter(which, setup, mapped, start, spread);
                world::run(setup, seed, filter.as_mut())
            })
            .collect();
        let nees = score::mean_nees(&traces);
        let mean = nees.iter().sum::<f64>() / nees.len() as f64;
        let inside = 100.0 * score::part_inside(&nees, band);
        println!(
            "{label:14} inside {inside:5.1} % of {} steps, mean {mean:.2}, last {:.2}",
            nees.len(),
            nees[nees.len() - 1]
        );
    }
}

fn field() {
    println!("\nfield test, kernel EKF");
    let setup = world::field_setup();
    for seed in 0..SEEDS {
        let start = world::planar(&setup.path.start);
        let mut filter = filter(Which::Kernel, &setup, true, start, [1e-4, 1e-4, 1e-5]);
        let trace = world::run(&setup, seed, filter.as_mut());
        let mended = trace.frames.iter().find(|f| f.report.relocated);
        let slip_m = setup.slips[0].at_m;
        let until_m = mended.map_or(f64::INFINITY, |f| f.way_m);
        let calm = |way: f64| way < slip_m || way > until_m;
        let all = score::fates(&trace, |_| true);
        let quiet = score::fates(&trace, calm);
        let worst = trace
            .steps
            .iter()
            .filter(|s| calm(s.way_m))
            .map(|s| score::error(s).0)
            .fold(0.0, f64::max);
        let jump = trace
            .frames
            .iter()
            .filter(|f| !f.report.relocated)
            .map(|f| f.jump_m)
            .fold(0.0, f64::max);
        println!(
            "seed {seed:2}: taken {}/{} outliers, good rejected {}/{} ({:.2} %), outside the slip {}/{} ({:.2} %), worst {worst:.3} m, jump {jump:.3} m, mended after {:.2} m",
            all.outliers_taken,
            all.outliers,
            all.good_rejected,
            all.good,
            100.0 * all.good_rejected as f64 / all.good as f64,
            quiet.good_rejected,
            quiet.good,
            100.0 * quiet.good_rejected as f64 / quiet.good as f64,
            until_m - slip_m,
        );
    }
}

fn long_loop() {
    println!("\n200 m loop, 20 unknown markers, realistic");
    let setup = world::loop_setup(world::realistic());
    for seed in 0..5 {
        for (label, which) in FILTERS {
            let start = world::planar(&setup.path.start);
            let mut filter = filter(which, &setup, false, start, KNOWN_START);
            let trace = world::run(&setup, seed, filter.as_mut());
            let (place, turn) = score::worst(&trace);
            let last = trace.steps.last().unwrap();
            let (off, off_turn) = score::error(last);
            let (marker, _, count) = score::marker_errors(&setup.markers, filter.as_ref());
            println!(
                "seed {seed} {label:14} worst {place:.2} m {:.2} deg, end {off:.3} m {:.2} deg, {count} markers within {marker:.2} m, NEES at the end {:.2}",
                turn.to_degrees(),
                off_turn.to_degrees(),
                score::nees(last)
            );
        }
    }
}

fn corridors() {
    let (ideal, real) = (world::idealised(), world::realistic());
    corridor(
        "6.1.2 static map, idealised",
        &world::corridor_setup(ideal),
        true,
    );
    corridor(
        "6.1.1 dynamic markers, idealised",
        &world::corridor_setup(ideal),
        false,
    );
    corridor(
        "6.1.2 static map, realistic",
        &world::corridor_setup(real),
        true,
    );
    corridor(
        "6.1.1 dynamic markers, realistic",
        &world::corridor_setup(real),
        false,
    );
}

fn consistencies() {
    let spread = [0.01, 0.01, 0.0025];
    let (straight, round) = (
        world::corridor_setup(world::realistic()),
        world::roomy_setup(world::realistic()),
    );
    consistency("corridor, dynamic", &straight, false, spread);
    consistency("corridor, static", &straight, true, spread);
    consistency("circles, dynamic, known start", &round, false, KNOWN_START);
    consistency(
        "circles, dynamic, start heading within 3 deg",
        &round,
        false,
        spread,
    );
}

fn main() {
    let parts: Vec<String> = std::env::args().skip(1).collect();
    for (name, part) in [
        ("corridor", corridors as fn()),
        ("consistency", consistencies),
        ("field", field),
        ("loop", long_loop),
    ] {
        if parts.is_empty() || parts.iter().any(|wanted| wanted == name) {
            part();
        }
    }
}
