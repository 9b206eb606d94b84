//! Gate, loss and recovery, a full state, contradicted markers, duplicates.

use super::{Drive, Small, noise, small, verdicts};
use crate::marker::{Health, Increment, MarkerEkf, MarkerFilter, Pose2, Sighting, Verdict};
use crate::marker::{linear, model};
use crate::time::Duration;
use std::vec;

const LEFT: Pose2 = Pose2::new(2.0, 1.0, -2.0);
const RIGHT: Pose2 = Pose2::new(2.5, -1.0, 2.0);
const AHEAD: Pose2 = Pose2::new(3.0, 0.0, 3.1);

fn mapped() -> Drive<Small> {
    let mut filter = small(false);
    filter.add_mapped(1, LEFT).unwrap();
    filter.add_mapped(2, RIGHT).unwrap();
    Drive::new(filter)
}

fn shifted(pose: Pose2, x_m: f64, heading_rad: f64) -> Pose2 {
    pose.corrected([x_m, 0.0, heading_rad])
}

//= spec/ekf.md#ekf-05
//= type=test
//# A sighting whose NIS exceeds the gate MUST NOT change the state.
#[test]
fn outliers_are_gated_and_recorded() {
    let mut drive = mapped();
    let before = drive.filter.pose();
    for outlier in [
        shifted(LEFT, 1.0, 0.0),
        shifted(LEFT, 0.0, 117_f64.to_radians()),
    ] {
        let seen = [drive.sees(1, outlier)];
        let report = drive.look(&seen);
        let record = report.record(0).unwrap();
        assert_eq!(record.verdict, Verdict::Gated);
        assert!(record.nis > 16.266 && record.covariance[0][0] > 0.0);
        assert_eq!(drive.filter.pose(), before);
    }
    let good = [drive.sees(1, LEFT)];
    let report = drive.look(&good);
    assert_eq!(verdicts(&report), [Verdict::Fused]);
    assert!(report.record(0).unwrap().nis < 1e-9);
}

//= spec/ekf.md#ekf-13
//= type=test
//# Every sighting of a used frame MUST leave a record with its innovation, the innovation's covariance, its NIS and the verdict.
#[test]
fn records_say_what_was_expected_and_how_far_off_it_was() {
    let mut drive = mapped();
    let mut seen = drive.sees(1, LEFT);
    seen.x_m += 0.01;
    let off = drive.sees(2, shifted(RIGHT, 0.5, 0.0));
    let strange = drive.sees(9, AHEAD);
    let before = drive.filter.covariance.clone();
    let report = drive.look(&[seen, off, strange]);
    let expected = [Verdict::Fused, Verdict::Gated, Verdict::Unknown];
    assert_eq!(verdicts(&report), expected);
    let record = report.record(0).unwrap();
    assert!((record.innovation[0] - 0.01).abs() < 1e-12);
    // At heading 0 the innovation's x is the robot's x, plus lever times heading, plus noise.
    let x = before.entry((0, 0), (0, 0)) + 1e-4 + noise().xx_m2;
    assert!((record.covariance[0][0] - x).abs() < 1e-6, "{record:?}");
    let spread = linear::Ldl::of(&record.covariance);
    assert!((record.nis - spread.distance(record.innovation)).abs() < 1e-12);
    assert_eq!(record.degrees_of_freedom, 3);
}

#[test]
fn unknown_ids_are_not_learned_when_told_so() {
    let mut drive = mapped();
    let seen = [drive.sees(9, AHEAD)];
    assert_eq!(verdicts(&drive.look(&seen)), [Verdict::Unknown]);
    assert_eq!(drive.filter.marker(9), None);
}

#[test]
fn the_gate_decides_between_duplicates() {
    let mut drive = mapped();
    let twice = [drive.sees(1, shifted(LEFT, 2.0, 0.0)), drive.sees(1, LEFT)];
    assert_eq!(
        verdicts(&drive.look(&twice)),
        [Verdict::Gated, Verdict::Fused]
    );
    let near = [drive.sees(1, shifted(LEFT, 0.01, 0.0)), drive.sees(1, LEFT)];
    assert_eq!(verdicts(&drive.look(&near)), [Verdict::Ambiguous; 2]);
    let mut drive = Drive::new(small(true));
    let new = [
        drive.sees(9, LEFT),
        drive.sees(9, RIGHT),
        drive.sees(8, AHEAD),
    ];
    let expected = [Verdict::Ambiguous, Verdict::Ambiguous, Verdict::Added];
    assert_eq!(verdicts(&drive.look(&new)), expected);
}

//= spec/ekf.md#ekf-09
//= type=test
//# The filter MUST say that it is lost when every sighting of a known marker was rejected for `lost_after`.
#[test]
fn lost_after_a_second_of_rejections() {
    let mut drive = mapped();
    // Two sightings that do not even agree with each other.
    for tick in 0..20 {
        let away = if tick % 2 == 0 { 1.0 } else { -1.0 };
        let seen = [drive.sees(1, shifted(LEFT, away, 0.0))];
        let report = drive.look(&seen);
        assert_eq!(verdicts(&report), [Verdict::Gated]);
        assert!(!report.relocated);
        assert_eq!(drive.filter.health(), Health::Tracking, "tick {tick}");
    }
    let seen = [drive.sees(1, shifted(LEFT, 1.0, 0.0))];
    let first = drive.now.minus(Duration::from_ms(950));
    drive.look(&seen);
    assert_eq!(drive.filter.health(), Health::Lost(first));
    // One sighting that fits ends it.
    let seen = [drive.sees(1, LEFT)];
    drive.look(&seen);
    assert_eq!(drive.filter.health(), Health::Tracking);
}

#[test]
fn rare_outliers_do_not_add_up_to_being_lost() {
    let mut drive = mapped();
    for round in 0..20 {
        wait(&mut drive, 41);
        // No two of them agree.
        let seen = [drive.sees(1, shifted(LEFT, 1.0 + f64::from(round), 0.0))];
        assert_eq!(verdicts(&drive.show(&seen)), [Verdict::Gated]);
        assert_eq!(drive.filter.health(), Health::Tracking, "round {round}");
    }
    // Nor do those between which something fits.
    for _ in 0..20 {
        for away in [1.0, 2.0, 3.0, 0.0] {
            wait(&mut drive, 10);
            let seen = [drive.sees(1, shifted(LEFT, away, 0.0))];
            drive.show(&seen);
            assert_eq!(drive.filter.health(), Health::Tracking);
        }
    }
}

/// Cycles of 50 ms at rest.
fn wait(drive: &mut Drive<Small>, cycles: u32) {
    for _ in 0..cycles {
        drive.step(Increment::default());
    }
}

#[test]
fn a_slow_camera_is_lost_too() {
    let mut drive = mapped();
    for round in 1..=5 {
        wait(&mut drive, 20);
        let seen = [drive.sees(1, shifted(LEFT, f64::from(round), 0.0))];
        drive.show(&seen);
        let lost = drive.filter.health() != Health::Tracking;
        assert_eq!(lost, round == 5, "after {round} images, one a second");
    }
}

/// One image cannot say ten times that a marker has moved, nor eight times that the robot has.
#[test]
fn an_id_that_is_read_repeatedly_in_one_frame_says_nothing() {
    let mut drive = Drive::new(small(true));
    for _ in 0..5 {
        let seen = [drive.sees(1, LEFT), drive.sees(2, RIGHT)];
        drive.look(&seen);
    }
    for good_first in [true, false] {
        let mut seen = vec![drive.sees(1, shifted(LEFT, 1.5, 0.0)); 11];
        seen.push(drive.sees(2, RIGHT));
        seen.insert(if good_first { 0 } else { 11 }, drive.sees(1, LEFT));
        for _ in 0..12 {
            let report = drive.look(&seen);
            assert_eq!(report.count(Verdict::Fused), 2);
            assert_eq!(report.count(Verdict::Gated), 11);
        }
        let gone = [
            vec![drive.sees(1, shifted(LEFT, 1.5, 0.0)); 11],
            vec![drive.sees(2, RIGHT)],
        ];
        for _ in 0..12 {
            assert_eq!(drive.look(&gone.concat()).count(Verdict::Removed), 0);
        }
    }
    let before = drive.filter.pose();
    let elsewhere = Pose2::new(0.5, 0.5, 0.0);
    let shown = |at: Pose2, id| Sighting::pose(id, elsewhere.sees(&at), noise());
    let twice = [vec![shown(LEFT, 1); 8], vec![shown(RIGHT, 2); 8]].concat();
    for _ in 0..40 {
        assert!(!drive.look(&twice).relocated);
    }
    assert_eq!(drive.filter.pose(), before);
    assert!(matches!(drive.filter.health(), Health::Lost(_)));
}

/// Whoever is met first by an outlier is forgotten, and the robot stays where it is.
#[test]
fn a_marker_that_was_learned_from_an_outlier_does_not_move_the_robot() {
    let mut drive = Drive::new(small(true));
    let seen = [drive.sees(1, shifted(LEFT, 1.5, 0.0))];
    assert_eq!(verdicts(&drive.look(&seen)), [Verdict::Added]);
    let good = [drive.sees(1, LEFT)];
    for expected in [
        Verdict::Gated,
        Verdict::Gated,
        Verdict::Removed,
        Verdict::Added,
    ] {
        assert_eq!(verdicts(&drive.look(&good)), [expected]);
    }
    assert!(drive.filter.pose().distance_m(&drive.truth) < 1e-9);
    assert!(drive.filter.marker(1).unwrap().pose.distance_m(&LEFT) < 1e-9);
    assert_eq!(drive.filter.health(), Health::Tracking);
}

/// Cycles of driving and looking at these until the pose is taken over.
fn cycles_until_relocated(drive: &mut Drive<Small>, markers: &[(u16, Pose2)]) -> Option<usize> {
    (1..60).find(|_| {
        drive.step(Increment::arc(0.01, 0.0));
        let seen: vec::Vec<Sighting> = markers
            .iter()
            .map(|(id, at)| drive.sees(*id, *at))
            .collect();
        drive.show(&seen).relocated
    })
}

//= spec/ekf.md#ekf-10
//= type=test
//# The filter MUST take another pose over only when at least eight rejected sightings, carried along by odometry, agree on it, and these are of more than one marker or the filter is lost.
#[test]
fn a_slip_is_found_and_mended() {
    for (markers, cycles) in [
        // Two markers: the eighth sighting, in the fourth frame.
        (&[(1, LEFT), (2, RIGHT)][..], 4),
        // One marker: only once lost, after a second.
        (&[(1, LEFT)], 21),
    ] {
        let mut drive = mapped();
        let seen = [drive.sees(1, LEFT), drive.sees(2, RIGHT)];
        drive.look(&seen);
        // The wheels report nothing of this.
        drive.truth = drive.truth.then(&Pose2::new(0.3, 0.4, 10_f64.to_radians()));
        assert_eq!(cycles_until_relocated(&mut drive, markers), Some(cycles));
        assert!(drive.filter.pose().distance_m(&drive.truth) < 1e-6);
        assert_eq!(drive.filter.health(), Health::Tracking);
        let (sigma, noise) = (drive.filter.pose_covariance()[0][0], noise().xx_m2);
        assert!(
            sigma > noise / 30.0,
            "no better than so many sightings: {sigma}"
        );
    }
}

#[test]
fn a_slip_is_mended_from_positions_of_two_markers() {
    let mut drive = mapped();
    drive.truth = drive.truth.then(&Pose2::new(0.3, 0.4, 10_f64.to_radians()));
    let relocated = (0..60).any(|tick| {
        drive.step(Increment::arc(0.01, 0.02));
        // Never both in one image.
        let (id, at) = if tick % 2 == 0 { (1, LEFT) } else { (2, RIGHT) };
        let whole = drive.sees(id, at);
        let only = Sighting::position(id, whole.x_m, whole.y_m, noise());
        drive.show(&[only]).relocated
    });
    assert!(relocated);
    assert!(drive.filter.pose().distance_m(&drive.truth) < 1e-6);
    let turn = drive.filter.pose().heading_rad - drive.truth.heading_rad;
    assert!(turn.abs() < 1e-6, "{turn}");
}

#[test]
fn sightings_that_disagree_are_never_taken_over() {
    let mut drive = mapped();
    for tick in 0..100 {
        let away = f64::from(tick % 7) * 0.3 + 0.8;
        let seen = [
            drive.sees(1, shifted(LEFT, away, 0.0)),
            drive.sees(2, shifted(RIGHT, -away, 0.0)),
        ];
        assert!(!drive.look(&seen).relocated, "tick {tick}");
    }
    assert!(matches!(drive.filter.health(), Health::Lost(_)));
    assert!(drive.filter.pose().distance_m(&drive.truth) < 1e-9);
}

#[test]
fn recovery_ties_the_robot_to_a_learned_marker() {
    let mut drive = Drive::new(small(true));
    for _ in 0..10 {
        let seen = [drive.sees(1, LEFT)];
        drive.look(&seen);
    }
    drive.truth = drive.truth.then(&Pose2::new(0.5, 0.0, 0.0));
    let relocated = (0..30).any(|_| {
        let seen = [drive.sees(1, LEFT)];
        drive.look(&seen).relocated
    });
    assert!(relocated);
    // The robot shares the marker's error, as if the robot were a marker seen from there.
    let marker = drive.filter.marker(1).unwrap();
    let seen = drive.filter.pose().sees(&marker.pose);
    let by_marker = model::located(&marker.pose, &seen).1.marker;
    let expected = linear::times(&by_marker, &marker.covariance);
    for (row, expected) in expected.iter().enumerate() {
        for (column, expected) in expected.iter().enumerate() {
            let entry = drive.filter.covariance.entry((0, row), (1, column));
            assert!((entry - expected).abs() < 1e-12, "{entry} {expected}");
        }
    }
}

#[test]
fn new_markers_wait_while_the_pose_is_in_doubt() {
    let mut filter = small(true);
    filter.add_mapped(1, LEFT).unwrap();
    let mut drive = Drive::new(filter);
    let seen = [drive.sees(1, shifted(LEFT, 1.0, 0.0)), drive.sees(9, AHEAD)];
    let expected = [Verdict::Gated, Verdict::Postponed];
    assert_eq!(verdicts(&drive.look(&seen)), expected);
    // A single outlier is forgotten after a while.
    let new = [drive.sees(9, AHEAD)];
    for _ in 0..9 {
        assert_eq!(verdicts(&drive.look(&new)), [Verdict::Postponed]);
    }
    drive.step(Increment::default());
    assert_eq!(verdicts(&drive.look(&new)), [Verdict::Added]);
}

#[test]
fn it_takes_as_much_memory_as_is_said() {
    let said = |n: usize, m: usize| 72 * n * n + 144 * n + 24 * m + 4096;
    let took = [
        (size_of::<MarkerEkf<1, 1>>(), said(1, 1)),
        (size_of::<MarkerEkf<20, 64>>(), said(20, 64)),
        (size_of::<MarkerEkf<60, 1000>>(), said(60, 1000)),
    ];
    for (took, said) in took {
        assert!(took <= said && took + 1024 > said, "{took} of {said}");
    }
}

//= spec/ekf.md#ekf-11
//= type=test
//# When the state is full, a new marker MUST be refused unless a tentative one that was not seen for five seconds can make room.
#[test]
fn a_full_state_refuses_and_forgets_only_what_is_tentative() {
    let mut drive = Drive::new(small(true));
    let place = |id: u16| Pose2::new(2.0, f64::from(id) * 0.3 - 1.0, 3.0);
    for id in 0..6 {
        // All are seen often, but for number 3.
        for _ in 0..(if id == 3 { 2 } else { 4 }) {
            let seen = [drive.sees(id, place(id))];
            drive.look(&seen);
        }
    }
    let new = [drive.sees(50, AHEAD)];
    assert_eq!(verdicts(&drive.look(&new)), [Verdict::Full]);
    for _ in 0..110 {
        drive.step(Increment::default());
    }
    assert_eq!(verdicts(&drive.look(&new)), [Verdict::Added]);
    let left: vec::Vec<u16> = drive.filter.learned().collect();
    assert_eq!(left, [0, 1, 2, 4, 5, 50]);
    let new = [drive.sees(51, AHEAD)];
    assert_eq!(verdicts(&drive.look(&new)), [Verdict::Full]);
}

//= spec/ekf.md#ekf-12
//= type=test
//# A marker in the state MUST be taken out when its sightings are rejected repeatedly while those of others fit.
#[test]
fn a_marker_that_was_moved_goes_and_comes_back() {
    let mut drive = Drive::new(small(true));
    for _ in 0..5 {
        let seen = [drive.sees(1, LEFT), drive.sees(2, RIGHT)];
        drive.look(&seen);
    }
    let moved = shifted(LEFT, 0.7, 0.0);
    for count in 1..=10 {
        let seen = [drive.sees(1, moved), drive.sees(2, RIGHT)];
        let expected = if count < 10 {
            Verdict::Gated
        } else {
            Verdict::Removed
        };
        assert_eq!(verdicts(&drive.look(&seen)), [expected, Verdict::Fused]);
    }
    assert_eq!(drive.filter.marker(1), None);
    let seen = [drive.sees(1, moved), drive.sees(2, RIGHT)];
    assert_eq!(
        verdicts(&drive.look(&seen)),
        [Verdict::Added, Verdict::Fused]
    );
    assert!(drive.filter.marker(1).unwrap().pose.distance_m(&moved) < 0.05);
}

/// Cameras that never see two markers at once tell as much.
#[test]
fn a_marker_that_was_moved_goes_when_each_camera_sees_one() {
    let mut drive = Drive::new(small(true));
    for _ in 0..5 {
        let seen = [drive.sees(1, LEFT), drive.sees(2, RIGHT)];
        drive.look(&seen);
    }
    let moved = shifted(LEFT, 0.7, 0.0);
    for count in 1..=10 {
        drive.step(Increment::default());
        let (one, other) = ([drive.sees(1, moved)], [drive.sees(2, RIGHT)]);
        let expected = if count < 10 {
            Verdict::Gated
        } else {
            Verdict::Removed
        };
        assert_eq!(verdicts(&drive.show(&one)), [expected], "image {count}");
        assert_eq!(verdicts(&drive.show_by(1, &other)), [Verdict::Fused]);
    }
    assert_eq!(drive.filter.health(), Health::Tracking);
}

#[test]
fn a_position_only_landmark_gets_its_heading_when_it_shows_one() {
    let mut drive = Drive::new(small(true));
    let whole = drive.sees(1, LEFT);
    let only = Sighting::position(1, whole.x_m, whole.y_m, noise());
    assert_eq!(verdicts(&drive.look(&[only])), [Verdict::Added]);
    assert_eq!(verdicts(&drive.look(&[only])), [Verdict::Fused]);
    assert!(!drive.filter.marker(1).unwrap().oriented);
    assert_eq!(verdicts(&drive.look(&[whole])), [Verdict::Fused]);
    let marker = drive.filter.marker(1).unwrap();
    assert!(marker.oriented);
    assert!(
        (marker.pose.heading_rad - LEFT.heading_rad).abs() < 0.01,
        "{marker:?}"
    );
}

#[test]
fn placing_the_robot_leaves_the_markers() {
    let mut drive = Drive::new(small(true));
    let seen = [drive.sees(1, LEFT)];
    drive.look(&seen);
    let before = drive.filter.marker(1).unwrap();
    drive
        .filter
        .place(Pose2::new(5.0, 5.0, 1.0), [0.5; 3])
        .unwrap();
    assert_eq!(drive.filter.marker(1).unwrap(), before);
    let covariance = drive.filter.pose_covariance();
    assert!((covariance[1][1] - 0.5).abs() < 1e-12);
    assert!(drive.filter.covariance.entry((0, 0), (1, 0)).abs() < 1e-15);
}
