//! Wall-clock benchmarks of the planning grid (`cargo bench -p haltline --bench grid`).
//!
//! One scan of 541 beams on a map of 20 m x 20 m with cells of 0.1 m.
#![allow(missing_docs, clippy::unwrap_used)]
#![allow(
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

#[path = "../tests/common/mod.rs"]
mod common;

use divan::{Bencher, black_box};
use haltline::grid::{GridRules, OccupancyGrid, RollingGrid, UpdateRule};
use haltline::input::{Beam, Pose};

type Map = OccupancyGrid<200, 200>;

const RULES: [UpdateRule; 2] = [UpdateRule::EveryBeam, UpdateRule::NearestBeam];

fn main() {
    divan::main();
}

fn rules(update: UpdateRule) -> GridRules {
    GridRules {
        update,
        ..GridRules::default()
    }
}

fn at(x_um: i64, y_um: i64) -> Pose {
    Pose {
        x_um,
        y_um,
        ..Pose::default()
    }
}

/// A room: the walls of the map itself, 9.5 m from the scanner.
fn hall() -> Vec<Beam> {
    walls(9.5, 9.5)
}

/// A corridor 3 m wide.
fn corridor() -> Vec<Beam> {
    walls(15.0, 1.5)
}

fn walls(half_length: f64, half_width: f64) -> Vec<Beam> {
    (0..541)
        .map(|beam| {
            let bearing = (f64::from(beam) * 0.5 - 135.0).to_radians();
            let across = half_width / bearing.sin().abs().max(1e-9);
            let ahead = half_length / bearing.cos().abs().max(1e-9);
            Beam::Hit((across.min(ahead) * 1000.0) as u16)
        })
        .collect()
}

fn update(bencher: Bencher<'_, '_>, rule: UpdateRule, beams: &[Beam]) {
    let mut map = Box::new(Map::new(rules(rule), at(-10_000_000, -10_000_000)).unwrap());
    let scanner = common::scanner();
    bencher.bench_local(|| map.update(black_box(&at(0, 0)), &scanner, beams));
}

/// Everything visible: the largest area a scan can speak about on this map.
#[divan::bench(args = RULES)]
fn hall_scan(bencher: Bencher<'_, '_>, rule: UpdateRule) {
    update(bencher, rule, &hall());
}

/// A corridor, the usual case.
#[divan::bench(args = RULES)]
fn corridor_scan(bencher: Bencher<'_, '_>, rule: UpdateRule) {
    update(bencher, rule, &corridor());
}

/// A rolling map that moves by one cell with every scan.
#[divan::bench(args = RULES)]
fn rolling_corridor_scan(bencher: Bencher<'_, '_>, rule: UpdateRule) {
    let mut map = Box::new(RollingGrid::<200, 200>::new(rules(rule)).unwrap());
    let (scanner, beams) = (common::scanner(), corridor());
    let mut x_um = 0;
    bencher.bench_local(|| {
        x_um += 100_000;
        map.update(black_box(&at(x_um, 0)), &scanner, &beams)
    });
}

/// The corners of occupied cells within 4 m, in a corridor.
#[divan::bench]
fn corners(bencher: Bencher<'_, '_>) {
    let mut map =
        Box::new(Map::new(rules(UpdateRule::EveryBeam), at(-10_000_000, -10_000_000)).unwrap());
    map.update(&at(0, 0), &common::scanner(), &corridor())
        .unwrap();
    bencher.bench_local(|| {
        map.corners_near(black_box(&at(0, 0)), common::m(4.0))
            .count()
    });
}
