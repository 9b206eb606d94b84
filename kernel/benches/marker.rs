//! Wall-clock benchmarks of the marker filter (`cargo bench -p haltline --bench marker`).
//!
//! One pose sighting, and one prediction, by the number of markers in the state.
#![allow(missing_docs, clippy::unwrap_used)]
#![allow(clippy::arithmetic_side_effects)]

use divan::{Bencher, black_box};
use haltline::marker::{
    FilterRules, Frame, Increment, MarkerEkf, MarkerFilter, Pose2, Prediction, Sighting,
    SightingNoise, Verdict,
};
use haltline::time::{Duration, Instant};

const COUNTS: [usize; 8] = [0, 1, 5, 10, 20, 30, 40, 60];

/// Room for the largest count, so that all run the same code.
type Filter = MarkerEkf<60, 4>;
/// Room for just what the requirement asks.
type Twenty = MarkerEkf<20, 64>;

fn main() {
    divan::main();
}

fn noise() -> SightingNoise {
    SightingNoise {
        xy_m2: 1e-4,
        ..SightingNoise::isotropic(0.03, 0.02)
    }
}

/// Where marker `id` hangs: along both walls of a corridor.
fn place(id: u16) -> Pose2 {
    let side = if id.is_multiple_of(2) { 1.5 } else { -1.5 };
    Pose2::new(f64::from(id) * 0.75 + 1.0, side, 3.0)
}

/// A filter that has learned markers, all correlated with each other.
fn met<const N: usize, const M: usize>(count: usize) -> (Box<MarkerEkf<N, M>>, Instant) {
    let start = [1e-4, 1e-4, 1e-5];
    let filter = MarkerEkf::new(FilterRules::default(), Pose2::default(), start).unwrap();
    let mut filter = Box::new(filter);
    filter.add_mapped(1000, place(1)).unwrap();
    let mut now = Instant::from_us(0);
    for id in 0..count {
        for _ in 0..2 {
            now = now.plus(Duration::from_ms(50));
            assert_eq!(
                filter.predict(now, &Increment::arc(0.01, 0.001)),
                Prediction::Done
            );
            let id = u16::try_from(id).unwrap();
            let sighting = Sighting::pose(id, filter.pose().sees(&place(id)), noise());
            let sightings = [sighting];
            let report = filter.correct(&Frame {
                camera: 0,
                stamp: now,
                sightings: &sightings,
            });
            assert!(report.count(Verdict::Added) + report.count(Verdict::Fused) == 1);
        }
    }
    (filter, now)
}

/// One cycle: a prediction and a frame with one sighting of marker `id`.
fn cycle<const N: usize, const M: usize>(bencher: Bencher<'_, '_>, count: usize, id: u16) {
    let (mut filter, mut now) = met::<N, M>(count);
    bencher.bench_local(|| {
        now = now.plus(Duration::from_ms(50));
        let moved = filter.predict(now, black_box(&Increment::default()));
        assert_eq!(moved, Prediction::Done);
        let known = filter.marker(id).map_or(place(id), |marker| marker.pose);
        let sightings = [Sighting::pose(id, filter.pose().sees(&known), noise())];
        let report = filter.correct(black_box(&Frame {
            camera: 0,
            stamp: now,
            sightings: &sightings,
        }));
        assert_eq!(report.count(Verdict::Fused), 1);
    });
}

/// The requirement: prediction, one pose sighting of a learned marker, 20 in the state.
#[divan::bench]
fn twenty_markers_cycle(bencher: Bencher<'_, '_>) {
    cycle::<20, 64>(bencher, 20, 7);
}

/// The correction alone.
#[divan::bench]
fn twenty_markers_sighting(bencher: Bencher<'_, '_>) {
    let (filter, now) = met::<20, 64>(20);
    let now = now.plus(Duration::from_ms(50));
    bencher
        .with_inputs(|| -> Box<Twenty> {
            let mut filter = filter.clone();
            assert_eq!(filter.predict(now, &Increment::default()), Prediction::Done);
            filter
        })
        .bench_local_refs(|filter| {
            let sightings = [Sighting::pose(7, filter.pose().sees(&place(7)), noise())];
            filter.correct(black_box(&Frame {
                camera: 0,
                stamp: now,
                sightings: &sightings,
            }))
        });
}

/// A cycle with a learned marker, by markers in the state.
#[divan::bench(args = COUNTS[1..].iter().copied())]
fn cycle_learned(bencher: Bencher<'_, '_>, count: usize) {
    cycle::<60, 4>(bencher, count, 0);
}

/// A cycle with a marker of the map, by markers in the state.
#[divan::bench(args = COUNTS)]
fn cycle_mapped(bencher: Bencher<'_, '_>, count: usize) {
    cycle::<60, 4>(bencher, count, 1000);
}

/// A prediction, by markers in the state.
#[divan::bench(args = COUNTS)]
fn predict(bencher: Bencher<'_, '_>, count: usize) {
    let (mut filter, mut now): (Box<Filter>, _) = met(count);
    bencher.bench_local(|| {
        now = now.plus(Duration::from_ms(50));
        filter.predict(now, black_box(&Increment::arc(1e-9, 0.0)))
    });
}
