//! Wall-clock benchmarks of the planner (`cargo bench -p haltline --bench dwa`).
//!
//! Read them as ratios within one run.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use divan::{Bencher, black_box};
use haltline::dwa::{
    Arrival, CURVATURES, Clearance, Course, Direction, Footprint, Goal, Limits, Margin, Obstacle,
    Point, Situation, Tuning, Velocity, clearance, plan,
};

fn main() {
    divan::main();
}

const SEEKUR: Footprint = Footprint {
    front_m: 0.60,
    rear_m: 0.60,
    left_m: 0.42,
    right_m: 0.42,
};

/// 541 beams over 270 degrees in a corridor of `width_m`, and 200 remembered points of its walls.
fn points(width_m: f64) -> Vec<Point> {
    let half = width_m / 2.0;
    let mut points: Vec<Point> = (0..541)
        .map(|beam| {
            let angle = (f64::from(beam) * 0.5 - 135.0).to_radians();
            let range = (half / angle.sin().abs().max(1e-3)).min(15.0);
            [0.527 + range * angle.cos(), range * angle.sin()]
        })
        .collect();
    points.extend((0..100).flat_map(|step| {
        let x = -f64::from(step) * 0.05;
        [[x, half], [x, -half]]
    }));
    points
}

/// Every point just outside of the outline's margin: nothing can be skipped early.
fn crowded() -> Vec<Point> {
    (0..741)
        .map(|index| {
            let angle = f64::from(index) * 0.008_5;
            [1.05 * angle.cos(), 1.05 * angle.sin()]
        })
        .collect()
}

fn scene(name: &str) -> Vec<Point> {
    match name {
        "narrow" => points(1.1),
        "crowded" => crowded(),
        _ => points(3.0),
    }
}

fn situation(speed_mps: f64, period_s: f64) -> Situation<'static> {
    Situation {
        footprint: SEEKUR,
        limits: Limits {
            speed_mps: 1.2,
            acceleration_mps2: 0.5,
            braking_mps2: 0.5,
            angular_speed_radps: 1.396,
            angular_acceleration_radps2: 1.0,
            angular_braking_radps2: 1.0,
            period_s,
            reaction_s: 0.14,
            curvature_max_per_m: None,
        },
        margin: Margin {
            fixed_m: 0.02,
            speed_tolerance_mps: 0.01,
            turn_tolerance_radps: 0.01,
            obstacle_speed_mps: 0.0,
            near_m: 0.05,
            separate_ramps: false,
        },
        tuning: Tuning::default(),
        velocity: Velocity {
            linear_mps: speed_mps,
            angular_radps: 0.05,
        },
        in_flight: &[],
        goal: Goal {
            position: [6.0, 0.3],
            heading_rad: None,
            arrival: Arrival::Stop,
            position_tolerance_m: 0.1,
            heading_tolerance_rad: 0.1,
        },
    }
}

/// Arc distances of 61 curvatures to 541 + 200 points, one by one, without any shortcut.
#[divan::bench(args = ["corridor", "narrow", "crowded"])]
fn arc_distances(bencher: Bencher<'_, '_>, name: &str) {
    let points = scene(name);
    bencher.bench_local(|| {
        let mut nearest = Clearance::Free;
        for index in 0..CURVATURES {
            let course = Course::Arc {
                curvature_per_m: (index as f64 - 30.0) / 20.0,
                direction: Direction::Forward,
            };
            let one = clearance(&SEEKUR, course, black_box(&points).iter().copied());
            nearest = nearest.nearer(one);
        }
        nearest
    });
}

/// A whole plan, 61 curvatures × 11 speeds, against the same points.
#[divan::bench(args = ["corridor", "narrow", "crowded"])]
fn plan_at_speed(bencher: Bencher<'_, '_>, name: &str) {
    let points: Vec<Obstacle> = scene(name).into_iter().map(Obstacle::from).collect();
    let situation = situation(0.6, 0.04);
    bencher.bench_local(|| plan(black_box(&situation), points.iter().copied()));
}

/// The same from rest, with a window that spans all curvatures and both turns on the spot.
#[divan::bench(args = ["corridor", "narrow", "crowded"])]
fn plan_wide_window(bencher: Bencher<'_, '_>, name: &str) {
    let points: Vec<Obstacle> = scene(name).into_iter().map(Obstacle::from).collect();
    let mut situation = situation(0.0, 0.5);
    situation.velocity = Velocity::default();
    bencher.bench_local(|| plan(black_box(&situation), points.iter().copied()));
}
