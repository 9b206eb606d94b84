//! Which frames may correct (Loh 3.2.4).

use super::{Drive, noise, small};
use crate::marker::{Frame, FrameVerdict, Increment, MarkerFilter, Pose2, Prediction, Sighting};
use crate::time::{Duration, Instant};

const MARKER: Pose2 = Pose2::new(3.0, 0.5, 3.0);

fn frame(camera: u8, stamp: Instant, sightings: &[Sighting]) -> Frame<'_> {
    Frame {
        camera,
        stamp,
        sightings,
    }
}

//= spec/ekf.md#ekf-07
//= type=test
//# Between two odometry samples at most one frame per camera MUST correct: the first with a usable sighting.
#[test]
fn one_correction_per_camera_and_cycle() {
    let mut drive = Drive::new(small(true));
    let seen = [drive.sees(1, MARKER)];
    let late = |ms| drive.now.plus(Duration::from_ms(ms));
    let (now, soon, later) = (drive.now, late(1), late(2));
    let filter = &mut drive.filter;
    let empty = filter.correct(&frame(0, now, &[]));
    assert_eq!(empty.verdict, FrameVerdict::Empty);
    assert_eq!(
        filter.correct(&frame(0, soon, &seen)).verdict,
        FrameVerdict::Used
    );
    let again = filter.correct(&frame(0, later, &seen));
    assert_eq!(again.verdict, FrameVerdict::AwaitsOdometry);
    assert_eq!(
        filter.correct(&frame(31, now, &seen)).verdict,
        FrameVerdict::Used
    );
    assert_eq!(
        filter.correct(&frame(32, now, &seen)).verdict,
        FrameVerdict::UnknownCamera
    );
    drive.step(Increment::default());
    let (now, filter) = (drive.now, &mut drive.filter);
    assert_eq!(
        filter.correct(&frame(0, now, &seen)).verdict,
        FrameVerdict::Used
    );
}

#[test]
fn a_frame_of_nothing_usable_does_not_take_the_cameras_turn() {
    let mut drive = Drive::new(small(true));
    let good = drive.sees(1, MARKER);
    let bad = Sighting {
        x_m: f64::NAN,
        ..good
    };
    drive.show(&[bad]);
    assert_eq!(drive.show(&[good]).verdict, FrameVerdict::Used);
}

//= spec/ekf.md#ekf-08
//= type=test
//# A frame or an odometry sample that is out of order, too old or from the future MUST be refused and leave the state as it is.
#[test]
fn frames_out_of_time_are_refused() {
    let mut drive = Drive::new(small(true));
    drive.step(Increment::default());
    let seen = [drive.sees(1, MARKER)];
    let (now, filter) = (drive.now, &mut drive.filter);
    let before = (filter.pose(), filter.pose_covariance());
    let at = |ms| now.plus(Duration::from_ms(ms));
    let old = now.minus(Duration::from_ms(101));
    assert_eq!(
        filter.correct(&frame(0, old, &seen)).verdict,
        FrameVerdict::Stale
    );
    assert_eq!(
        filter.correct(&frame(0, at(101), &seen)).verdict,
        FrameVerdict::Future
    );
    let increment = Increment::arc(0.1, 0.0);
    assert_eq!(filter.predict(now, &increment), Prediction::Reordered);
    assert_eq!(filter.predict(old, &increment), Prediction::Reordered);
    assert_eq!((filter.pose(), filter.pose_covariance()), before);
    assert_eq!(
        filter.correct(&frame(0, at(0), &seen)).verdict,
        FrameVerdict::Used
    );
    assert_eq!(filter.predict(at(50), &increment), Prediction::Done);
    assert_eq!(
        filter.correct(&frame(0, at(0), &seen)).verdict,
        FrameVerdict::Reordered
    );
}

#[test]
fn nothing_corrects_before_the_first_odometry() {
    let mut filter = small(true);
    let seen = [Sighting::pose(1, MARKER, noise())];
    let report = filter.correct(&frame(0, Instant::from_us(1), &seen));
    assert_eq!(report.verdict, FrameVerdict::AwaitsOdometry);
}

/// A slow camera beside fast odometry: the way back is the one that was driven.
#[test]
fn late_images_are_moved_along_the_way_that_was_driven() {
    let mut filter = small(false);
    filter.add_mapped(1, MARKER).unwrap();
    let mut drive = Drive::new(filter);
    let mut truths = std::vec::Vec::new();
    for step in 0..30 {
        truths.push((drive.now, drive.truth));
        drive.now = drive.now.plus(Duration::from_ms(10));
        // Speeding up and swerving, so that no single motion tells where it was.
        let part = f64::from(step) / 30.0;
        let increment = Increment::arc(0.01 * part, 0.05 * (part - 0.5));
        drive.truth = drive.truth.then(&increment.as_pose());
        assert_eq!(
            drive.filter.predict(drive.now, &increment),
            Prediction::Done
        );
    }
    for (camera, late) in (0..).zip([10, 9, 3, 1]) {
        let (stamp, there) = truths[truths.len() - late];
        let seen = [Sighting::pose(1, there.sees(&MARKER), noise())];
        let report = drive.filter.correct(&frame(camera, stamp, &seen));
        assert_eq!(report.verdict, FrameVerdict::Used);
        let innovation = report.record(0).unwrap().innovation;
        let off = innovation
            .iter()
            .fold(0.0_f64, |most, part| most.max(part.abs()));
        assert!(off < 1e-9, "{late} samples late: {innovation:?}");
    }
}

#[test]
fn frames_beyond_the_remembered_motions_are_refused() {
    let mut drive = Drive::new(small(true));
    let seen = [drive.sees(1, MARKER)];
    for _ in 0..40 {
        drive.now = drive.now.plus(Duration::from_ms(1));
        let done = drive.filter.predict(drive.now, &Increment::arc(0.001, 0.0));
        assert_eq!(done, Prediction::Done);
    }
    let at = |ms: i64| {
        let span = Duration::from_ms(ms.unsigned_abs());
        if ms < 0 {
            drive.now.minus(span)
        } else {
            drive.now.plus(span)
        }
    };
    let mut verdict = |ms| drive.filter.correct(&frame(0, at(ms), &seen)).verdict;
    assert_eq!(verdict(-17), FrameVerdict::Stale);
    assert_eq!(verdict(17), FrameVerdict::Future);
    assert_eq!(verdict(-16), FrameVerdict::Used);
}

/// A camera between two odometry samples sees the marker from farther on.
#[test]
fn frames_are_moved_to_the_last_odometry() {
    let mut filter = small(false);
    filter.add_mapped(1, MARKER).unwrap();
    let mut drive = Drive::new(filter);
    drive.step(Increment::arc(0.05, 0.02));
    drive.step(Increment::arc(0.05, 0.02));
    let half = Increment::arc(0.025, 0.01);
    let there = drive
        .truth
        .then(&Pose2::new(half.forward_m, half.left_m, half.turn_rad));
    let seen = Sighting::pose(1, there.sees(&MARKER), noise());
    let stamp = drive.now.plus(Duration::from_ms(25));
    let report = drive.filter.correct(&frame(0, stamp, &[seen]));
    let innovation = report.record(0).unwrap().innovation;
    assert!(
        innovation.iter().all(|part| part.abs() < 1e-6),
        "{innovation:?}"
    );
}
