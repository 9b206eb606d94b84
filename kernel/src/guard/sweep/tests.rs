//! Scans placed by hand: a scanner at the origin with 1 degree between its beams.

use super::*;
use crate::config::MASKS_MAX;
use crate::guard::seen::Seen;
use crate::time::Duration;
use crate::units::{Length, Ppm};

pub(in crate::guard) fn scanner() -> Scanner {
    Scanner {
        x: Length::ZERO,
        y: Length::ZERO,
        first_beam: degrees(-90),
        increment: (u32::MAX / 360).cast_signed(),
        beams: 181,
        scan_duration: Duration::ZERO,
        range_min: Length::from_mm(50),
        range_max: Length::from_mm(30_000),
        error: Length::from_mm(10),
        no_return_clear: Length::from_mm(4_000),
        invalid_max: Ppm::from_ppm(0),
        invalid_gap_max: 0,
        masks: [None; MASKS_MAX],
    }
}

pub(in crate::guard) fn degrees(angle: i32) -> BinaryAngle {
    BinaryAngle::from_counts((angle * (u32::MAX / 360).cast_signed()).cast_unsigned())
}

const RULES: SweepRules = SweepRules {
    join_mm: 500,
    clear_max_mm: 3_000,
};

/// A scan whose beam at `a` degrees returns `beam(a)`.
fn scan(beam: impl Fn(i32) -> Beam) -> Sweep<181> {
    let beams: std::vec::Vec<Beam> = (-90..=90).map(beam).collect();
    let mut sweep = Sweep::default();
    let rest = (LocalPose::default(), LocalPose::default());
    sweep.place(
        &scanner(),
        RULES,
        &beams,
        Instant::from_us(1),
        rest,
        Odometer::default(),
    );
    sweep
}

/// The place `range` mm away at `tenths` of a degree.
fn place(tenths: i32, range: i32) -> PointMm {
    let step = (u32::MAX / 3600).cast_signed();
    polar(
        range,
        BinaryAngle::from_counts((tenths * step).cast_unsigned()),
    )
}

#[test]
fn beams_become_points_where_they_hit() {
    let sweep = scan(|angle| match angle {
        0 => Beam::Hit(2000),
        90 => Beam::Hit(1000),
        -90 => Beam::TooNear,
        _ => Beam::NoReturn,
    });
    let seen: std::vec::Vec<_> = sweep.points().iter().map(|p| (p.x_mm, p.y_mm)).collect();
    assert_eq!(seen, [(0, -50), (2000, 0), (0, 1000)]);
    // One degree at 2 m is 34.9 mm.
    assert_eq!(sweep.points()[1].gap_mm, 35);
}

#[test]
fn neighbours_on_one_surface_are_joined_and_others_are_not() {
    let sweep = scan(|angle| match angle {
        0..=5 => Beam::Hit(2000),
        6 => Beam::Hit(2600),
        8 => Beam::Hit(2600),
        _ => Beam::NoReturn,
    });
    let joined: std::vec::Vec<_> = sweep.points().iter().map(|p| p.joined).collect();
    // 5 to 6 are 600 mm apart, between 6 and 8 a beam is missing.
    assert_eq!(joined, [true, true, true, true, true, false, false, false]);
}

//= spec/memory.md#memory-03
//= type=test
//# A remembered hit MUST NOT be replaced by a new return unless the inflation of that return covers the error disc of
//# the hit.
#[test]
fn a_return_shows_a_place_only_on_the_beams_beside_it() {
    let sweep = scan(|angle| match angle {
        ..=10 => Beam::Hit(2000),
        _ => Beam::Hit(3000),
    });
    assert_eq!(sweep.look_at(place(52, 2005), 100, 50), Sight::Confirmed);
    assert_eq!(sweep.look_at(place(105, 2005), 100, 50), Sight::Confirmed);
    // Two beams to the side the same surface shows nothing about this place, although it lies
    // within the error disc (100 mm are 2.9 degrees): a box at the edge of view was once
    // forgotten this way.
    assert_eq!(sweep.look_at(place(125, 2005), 100, 50), Sight::Unclear);
    assert_eq!(sweep.look_at(place(925, 2005), 100, 50), Sight::Unclear);
}

#[test]
fn only_all_beams_through_the_error_disc_look_past_a_place() {
    let clear = scan(|_| Beam::Hit(3000));
    assert_eq!(clear.look_at(place(0, 2000), 100, 50), Sight::LookedPast);
    assert_eq!(clear.look_at(place(0, 2950), 100, 20), Sight::Unclear);
    let obstructed = scan(|angle| Beam::Hit(if angle == 2 { 1000 } else { 3000 }));
    assert_eq!(obstructed.look_at(place(0, 2000), 100, 50), Sight::Unclear);
    // The obstructed beam lies outside a smaller disc (30 mm are 0.9 degrees).
    assert_eq!(
        obstructed.look_at(place(0, 2000), 30, 50),
        Sight::LookedPast
    );
    let blind = scan(|angle| match angle {
        1 => Beam::Invalid,
        _ => Beam::Hit(3000),
    });
    assert_eq!(blind.look_at(place(0, 2000), 100, 50), Sight::Unclear);
}

#[test]
fn silence_looks_past_a_place_only_as_far_as_it_is_vouched_for() {
    let silent = scan(|_| Beam::NoReturn);
    assert_eq!(silent.look_at(place(0, 3000), 100, 50), Sight::LookedPast);
    assert_eq!(silent.look_at(place(0, 3950), 100, 50), Sight::Unclear);
}

#[test]
fn what_lies_behind_or_beside_the_view_is_out_of_view() {
    let sweep = scan(|_| Beam::Hit(3000));
    assert_eq!(sweep.look_at(place(1800, 1000), 50, 50), Sight::OutOfView);
    assert_eq!(sweep.look_at(place(1000, 1000), 50, 50), Sight::OutOfView);
    // Half in view: neither confirmed nor refuted.
    assert_eq!(sweep.look_at(place(900, 1000), 50, 50), Sight::Unclear);
}

#[test]
fn an_upside_down_scanner_sees_the_same_world() {
    let mut setup = scanner();
    setup.first_beam = degrees(90);
    setup.increment = -setup.increment;
    let beams: std::vec::Vec<Beam> = (-90..=90)
        .rev()
        .map(|angle| {
            if angle == 30 {
                Beam::Hit(2000)
            } else {
                Beam::Hit(3000)
            }
        })
        .collect();
    let mut sweep = Sweep::<181>::default();
    let rest = (LocalPose::default(), LocalPose::default());
    let stamp = Instant::from_us(1);
    sweep.place(&setup, RULES, &beams, stamp, rest, Odometer::default());
    assert_eq!(sweep.look_at(place(300, 2000), 20, 20), Sight::Confirmed);
    assert_eq!(sweep.look_at(place(200, 2000), 20, 20), Sight::LookedPast);
}

//= spec/memory.md#memory-06
//= type=test
//# A cell MUST be unknown unless its centre was inside the visible region of a usable scan or the area cleared at
//# start.
//= spec/input.md#input-03
//= type=test
//# The ray of an invalid beam MUST leave the space it crosses unknown.
#[test]
fn seen_space_ends_at_returns_and_leaves_shadows_unknown() {
    let sweep = scan(|angle| match angle {
        -5..=5 => Beam::Hit(1000),
        40..=50 => Beam::Invalid,
        _ => Beam::Hit(2500),
    });
    let mut seen = Seen::default();
    sweep.mark_seen(&scanner(), RULES, &mut seen);
    assert!(seen.is_known(place(0, 900)));
    assert!(!seen.is_known(place(0, 1200)), "behind a return");
    assert!(seen.is_known(place(200, 2300)));
    assert!(!seen.is_known(place(200, 2700)), "behind the far returns");
    assert!(!seen.is_known(place(450, 1000)), "on invalid beams");
    assert!(!seen.is_known(place(1800, 500)), "behind the scanner");
}

//= spec/guard.md#guard-16
//= type=test
//# Every beam MUST be moved from the robot's pose at its own beam time to the start pose of the tube, its odometry error
//# over that interval being part of its inflation.
#[test]
fn every_beam_is_placed_from_the_pose_of_its_own_time() {
    let mut setup = scanner();
    (setup.x, setup.y) = (Length::from_mm(300), Length::from_mm(-100));
    let beams = [Beam::Hit(2000); 181];
    // 80 mm ahead and 6 degrees to the left during the sweep.
    let (ahead, left) = (0.08_f64, 6_f64.to_radians());
    let end = LocalPose {
        x_um: 80_000,
        y_um: 0,
        heading: degrees(6),
    };
    let mut sweep = Sweep::<181>::default();
    sweep.place(
        &setup,
        RULES,
        &beams,
        Instant::from_us(1),
        (LocalPose::default(), end),
        Odometer::default(),
    );
    assert_eq!(sweep.points().len(), 181);
    for (index, point) in sweep.points().iter().enumerate() {
        let part = index as f64 / 180.0;
        let (sin, cos) = (left * part).sin_cos();
        let (mount_x, mount_y) = (0.3 * cos + 0.1 * sin, 0.3 * sin - 0.1 * cos);
        let bearing = (index as f64 - 90.0).to_radians() + left * part;
        let x = ahead * part + mount_x + 2.0 * bearing.cos();
        let y = mount_y + 2.0 * bearing.sin();
        let off = (f64::from(point.x_mm) - x * 1e3).hypot(f64::from(point.y_mm) - y * 1e3);
        // Half a millimetre of storing along each axis, and the arc of the scanner for its chord.
        assert!(off < 1.5, "beam {index}: {off} mm");
    }
}

#[test]
fn an_anchor_that_moves_out_of_all_bounds_takes_points_out_of_all_horizons() {
    for by in [i32::MIN, i32::MAX] {
        let mut sweep = scan(|_| Beam::Hit(2000));
        sweep.reanchor(AnchorShift { x_mm: by, y_mm: by });
        let far = |point: &SweepPoint| (point.x_mm, point.y_mm) == (i16::MAX, i16::MAX);
        assert!(sweep.points().iter().all(far));
    }
}
