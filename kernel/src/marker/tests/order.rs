//! The order of sightings in a frame is irrelevant.

use super::{Drive, Small, small};
use crate::marker::{Increment, MarkerFilter, Pose2, Sighting, wrap};
use proptest::prelude::*;
use std::vec::Vec;

const MARKERS: [(u16, Pose2); 5] = [
    (3, Pose2::new(2.0, 1.0, 3.0)),
    (1000, Pose2::new(3.0, -1.0, -2.5)),
    (17, Pose2::new(1.0, 2.0, -1.5)),
    (5, Pose2::new(2.5, 0.2, 3.1)),
    (80, Pose2::new(4.0, 0.5, 2.9)),
];

/// Three learned markers and two of the map.
fn met() -> Drive<Small> {
    let mut filter = small(true);
    for (id, pose) in &MARKERS[3..] {
        filter.add_mapped(*id, *pose).unwrap();
    }
    let mut drive = Drive::new(filter);
    let first: Vec<Sighting> = MARKERS[..3]
        .iter()
        .map(|(id, at)| drive.sees(*id, *at))
        .collect();
    drive.look(&first);
    drive.step(Increment::arc(0.3, 0.1));
    drive
}

fn apart(a: &Small, b: &Small) -> f64 {
    let poses = |filter: &Small| -> Vec<Pose2> {
        let markers = filter.markers().iter().map(|marker| marker.pose);
        core::iter::once(filter.pose()).chain(markers).collect()
    };
    let mean = poses(a).into_iter().zip(poses(b)).map(|(a, b)| {
        a.distance_m(&b)
            .max(wrap(a.heading_rad - b.heading_rad).abs())
    });
    let covariance = a
        .pose_covariance()
        .into_iter()
        .flatten()
        .zip(b.pose_covariance().into_iter().flatten());
    mean.chain(covariance.map(|(a, b)| (a - b).abs()))
        .fold(0.0, f64::max)
}

proptest! {
    //= spec/ekf.md#ekf-06
    //= type=test
    //# The sightings of one frame MUST be judged and linearised at the same prior, so that their order is irrelevant.
    #[test]
    fn order_is_irrelevant(
        order in Just((0..5_usize).collect::<Vec<_>>()).prop_shuffle(),
        off in prop::collection::vec(prop::array::uniform3(-0.05..0.05_f64), 5),
        oriented in prop::collection::vec(any::<bool>(), 5),
    ) {
        let mut first = met();
        let mut second = met();
        let sightings: Vec<Sighting> = MARKERS.iter().zip(off).zip(oriented).map(|(((id, at), off), oriented)| {
            let mut sighting = first.sees(*id, *at);
            sighting.x_m += off[0];
            sighting.y_m += off[1];
            sighting.heading_rad = sighting.heading_rad.filter(|_| oriented).map(|h| h + off[2]);
            sighting
        }).collect();
        let shuffled: Vec<Sighting> = order.iter().map(|&at| sightings[at]).collect();
        let one = first.show(&sightings);
        let other = second.show(&shuffled);
        for (place, &at) in order.iter().enumerate() {
            let verdicts = (one.record(at).map(|r| r.verdict), other.record(place).map(|r| r.verdict));
            prop_assert_eq!(verdicts.0, verdicts.1);
        }
        prop_assert!(apart(&first.filter, &second.filter) < 1e-9);
    }
}
