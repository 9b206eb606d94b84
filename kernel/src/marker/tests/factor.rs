//! The factored covariance against the dense one, through long random histories.

use super::dense::Dense;
use crate::marker::{
    FilterRules, Frame, FrameVerdict, Increment, MarkerEkf, MarkerFilter, Pose2, Prediction,
    Sighting, SightingNoise, Verdict, wrap,
};
use crate::time::{Duration, Instant};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use std::vec::Vec;

type Filter = MarkerEkf<4, 1>;

impl Filter {
    /// Of all errors as they are counted.
    fn dense_covariance(&self) -> DMatrix<f64> {
        let size = 3 * (self.covariance.len() + 1);
        DMatrix::from_fn(size, size, |row, column| {
            self.covariance
                .entry((row / 3, row % 3), (column / 3, column % 3))
        })
    }

    /// Of all [x, y, heading].
    fn plain_covariance(&self) -> DMatrix<f64> {
        let counted = self.dense_covariance();
        let mut plain = DMatrix::zeros(counted.nrows(), counted.ncols());
        let markers = (0..self.covariance.len()).map(|slot| self.marker_error(slot));
        let blocks = core::iter::once(self.anchor.error_of(&self.robot)).chain(markers);
        for (at, block) in blocks.enumerate() {
            let block = nalgebra::Matrix3::from(block).transpose();
            plain.view_mut((3 * at, 3 * at), (3, 3)).copy_from(&block);
        }
        &plain * counted * plain.transpose()
    }
}

/// One thing that happens.
#[derive(Clone, Debug)]
enum Event {
    Move(f64, f64),
    See {
        marker: usize,
        off: [f64; 3],
        oriented: bool,
    },
    Forget(usize),
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        3 => (-0.2..0.5, -0.3..0.3).prop_map(|(way, turn)| Event::Move(way, turn)),
        5 => (0..4usize, prop::array::uniform3(-1.0..1.0), any::<bool>())
            .prop_map(|(marker, off, oriented)| Event::See { marker, off, oriented }),
        1 => (0..4usize).prop_map(Event::Forget),
    ]
}

const MARKERS: [Pose2; 4] = [
    Pose2::new(2.0, 1.0, 3.0),
    Pose2::new(-1.0, 2.0, -1.5),
    Pose2::new(3.0, -2.0, 2.0),
    Pose2::new(0.5, -2.5, 1.5),
];

/// Both filters side by side.
struct Pair {
    filter: Filter,
    dense: Dense,
    start: Pose2,
    truth: Pose2,
    now: Instant,
}

impl Pair {
    fn new() -> Self {
        let variances = [0.01, 0.02, 0.005];
        let rules = FilterRules {
            gate_pose: 1e12,
            gate_position: 1e12,
            ..FilterRules::default()
        };
        let start = Pose2::new(0.3, -0.2, 0.7);
        Self {
            filter: Filter::new(rules, start, variances).unwrap(),
            dense: Dense::new(&start, variances),
            start,
            truth: start,
            now: Instant::default(),
        }
    }

    fn take(&mut self, event: &Event) {
        match event {
            Event::Move(way, turn) => self.step(&Increment::arc(*way, *turn)),
            Event::See {
                marker,
                off,
                oriented,
            } => self.see(*marker, *off, *oriented),
            Event::Forget(marker) => {
                let id = u16::try_from(*marker).unwrap();
                if let Some((_, Some(slot))) = self.filter.known(id) {
                    self.filter.remove(slot);
                    self.dense.remove(id);
                }
            }
        }
    }

    fn step(&mut self, increment: &Increment) {
        self.now = self.now.plus(Duration::from_ms(50));
        let noise = self.filter.rules.odometry.of(increment);
        assert_eq!(self.filter.predict(self.now, increment), Prediction::Done);
        self.dense.predict(increment, noise);
        self.truth = self.truth.then(&increment.as_pose());
    }

    fn see(&mut self, marker: usize, off: [f64; 3], oriented: bool) {
        self.step(&Increment::default());
        let id = u16::try_from(marker).unwrap();
        let seen = self
            .truth
            .sees(&MARKERS[marker])
            .corrected(off.map(|e| e * 0.02));
        let noise = SightingNoise {
            xy_m2: 2e-4,
            ..SightingNoise::isotropic(0.02, 0.02)
        };
        let known = self.filter.known(id).is_some();
        let bare = self
            .filter
            .marker(id)
            .is_some_and(|marker| !marker.oriented);
        let mut sighting = Sighting::pose(id, seen, noise);
        if !oriented {
            sighting.heading_rad = None;
        }
        let report = self.filter.correct(&Frame {
            camera: 0,
            stamp: self.now,
            sightings: &[sighting],
        });
        assert_eq!(report.verdict, FrameVerdict::Used);
        let verdict = report.record(0).unwrap().verdict;
        if known {
            assert_eq!(verdict, Verdict::Fused);
            if bare && oriented {
                self.dense.free_heading(id);
            }
            self.dense.update(&sighting);
        } else {
            assert_eq!(verdict, Verdict::Added);
            self.dense.append(&sighting);
        }
    }

    /// Largest difference of any mean, and of any covariance relative to its sigmas.
    fn difference(&self) -> (f64, f64) {
        let mut mean: f64 = 0.0;
        let poses = core::iter::once(self.filter.pose())
            .chain(self.filter.markers().iter().map(|marker| marker.pose));
        for (at, pose) in poses.enumerate() {
            let theirs = self.dense.mean.rows(3 * at, 3);
            mean = mean
                .max((pose.x_m - theirs[0]).abs())
                .max((pose.y_m - theirs[1]).abs())
                .max(wrap(pose.heading_rad - theirs[2]).abs());
        }
        let ours = self.filter.plain_covariance();
        let theirs = self.dense.plain_covariance();
        let mut covariance: f64 = 0.0;
        for row in 0..ours.nrows() {
            for column in 0..ours.ncols() {
                let scale = (ours[(row, row)] * ours[(column, column)]).sqrt();
                let apart = ours[(row, column)] - theirs[(row, column)];
                covariance = covariance.max(apart.abs() / scale);
            }
        }
        (mean, covariance)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    //= spec/ekf.md#ekf-03
    //= type=test
    //# A corrected state and its covariance MUST equal those of the same filter with dense matrices, which keeps every cross-covariance, up to rounding.
    #[test]
    fn factor_and_dense_filter_agree(events in prop::collection::vec(event(), 1..60)) {
        let mut pair = Pair::new();
        for event in &events {
            pair.take(event);
            let (mean, covariance) = pair.difference();
            // The reference differentiates numerically, good to about 1e-9.
            prop_assert!(mean < 1e-7, "mean off by {mean} after {event:?}");
            prop_assert!(covariance < 1e-6, "covariance off by {covariance} after {event:?}");
        }
        prop_assert_eq!(pair.filter.covariance.len(), pair.dense.ids.len());
    }
}

impl Pair {
    /// What is known about a turn of everything about where the robot started, 1/rad².
    fn knowledge_of_the_map(&self) -> f64 {
        let start = self.start;
        let poses = core::iter::once(self.filter.pose())
            .chain(self.filter.markers().iter().map(|marker| marker.pose));
        let turn = poses.flat_map(|p| [start.y_m - p.y_m, p.x_m - start.x_m, 1.0]);
        let turn = DVector::from_iterator(3 * (self.filter.covariance.len() + 1), turn);
        let known = self.filter.plain_covariance().cholesky().unwrap();
        turn.dot(&known.solve(&turn))
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(50))]

    //= spec/ekf.md#ekf-15
    //= type=test
    //# Sightings of learned markers MUST NOT narrow the pose of the map as a whole.
    #[test]
    fn sightings_never_tell_which_way_the_map_is_turned(events in prop::collection::vec(event(), 1..60)) {
        let mut pair = Pair::new();
        let before = pair.knowledge_of_the_map();
        for event in &events {
            pair.take(event);
            let now = pair.knowledge_of_the_map();
            prop_assert!(now < before * (1.0 + 1e-6), "{now} of {before}");
        }
    }
}

#[test]
fn removal_leaves_the_covariance_of_the_others() {
    let mut pair = Pair::new();
    for marker in 0..4 {
        pair.see(marker, [0.3, -0.2, 0.1], true);
        pair.step(&Increment::arc(0.2, 0.1));
        pair.see(marker, [-0.3, 0.2, 0.1], true);
    }
    let before = pair.filter.dense_covariance();
    pair.filter.remove(1);
    let kept: Vec<usize> = (0..15).filter(|at| !(6..9).contains(at)).collect();
    let after = pair.filter.dense_covariance();
    for (row, &old_row) in kept.iter().enumerate() {
        for (column, &old_column) in kept.iter().enumerate() {
            let apart = after[(row, column)] - before[(old_row, old_column)];
            assert!(apart.abs() < 1e-14, "{row} {column}: {apart}");
        }
    }
}
