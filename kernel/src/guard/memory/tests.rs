//! The life of remembered points: kept, shown again, looked past, too many, too old.

use super::*;
use crate::guard::sweep::tests::scanner;
use crate::time::Duration;

type Small = Memory<1, 181, 200>;

fn model() -> MemoryModel {
    MemoryModel {
        clear_after_scans: 3,
        age_max: Duration::from_ms(60_000),
        drift_linear_ppm: 5_000,
        drift_angular_ppm: 10_000,
        obstacle_speed: 0,
        sensor_um: 10_000,
        join_mm: 500,
        body_width_um: 60_000,
    }
}

/// One scan at `ms` whose beam at `a` degrees returns `beam(a)`; the robot rests at the anchor.
fn see(memory: &mut Small, ms: u64, beam: impl Fn(i32) -> Beam) {
    let beams: std::vec::Vec<Beam> = (-90..=90).map(beam).collect();
    let setup = scanner();
    let arrival = Arrival {
        scanner: 0,
        setup: &setup,
        beams: &beams,
        stamp: Instant::from_us(ms * 1000),
        poses: (LocalPose::default(), LocalPose::default()),
    };
    memory.accept(&model(), arrival, Odometer::default());
}

fn wall(_: i32) -> Beam {
    Beam::Hit(2500)
}

fn pole(angle: i32) -> Beam {
    Beam::Hit(if angle == 0 { 1000 } else { 2500 })
}

fn blind(_: i32) -> Beam {
    Beam::Invalid
}

/// Number of remembered points where the pole stood. (The outermost beams have one neighbour
/// only, so their returns are always remembered, too.)
fn pole_points(memory: &Small) -> usize {
    let at_pole = |point: &&Remembered| (900..1100).contains(&point.x_mm);
    memory.remembered().iter().filter(at_pole).count()
}

#[test]
fn a_point_is_kept_until_three_scans_in_a_row_look_past_it() {
    let mut memory = Small::default();
    see(&mut memory, 0, pole);
    see(&mut memory, 1, wall);
    assert_eq!(pole_points(&memory), 1, "one scan looked past it");
    see(&mut memory, 2, wall);
    assert_eq!(pole_points(&memory), 1, "two");
    see(&mut memory, 3, wall);
    assert_eq!(pole_points(&memory), 0, "three");
}

#[test]
fn a_scan_that_cannot_tell_starts_the_count_anew() {
    let mut memory = Small::default();
    see(&mut memory, 0, pole);
    see(&mut memory, 1, wall);
    see(&mut memory, 2, wall);
    see(&mut memory, 3, |angle| {
        if angle == 0 {
            Beam::Invalid
        } else {
            wall(angle)
        }
    });
    see(&mut memory, 4, wall);
    see(&mut memory, 5, wall);
    assert_eq!(pole_points(&memory), 1);
}

//= spec/memory.md#memory-01
//= type=test
//# A return within the range of the memory MUST be remembered until it is cleared, confirmed, expired or turned into
//# unknown space.
#[test]
fn what_blind_scans_replace_is_remembered_and_shown_again_it_is_not_kept_twice() {
    let mut memory = Small::default();
    see(&mut memory, 0, wall);
    see(&mut memory, 1, blind);
    assert_eq!(memory.remembered().len(), 181);
    see(&mut memory, 2, wall);
    assert!(
        memory.remembered().len() <= 2,
        "{}",
        memory.remembered().len()
    );
}

//= spec/memory.md#memory-05
//= type=test
//# When the store is full, the surroundings of a hit that finds no place MUST become unknown.
#[test]
fn what_finds_no_room_becomes_unknown_space() {
    let mut memory = Small::default();
    for (layer, range) in [2400_u16, 2200, 2000].into_iter().enumerate() {
        see(&mut memory, layer as u64, |_| Beam::Hit(range));
    }
    let place = PointMm { x: 2190, y: 0 };
    memory.seen.mark(&[u128::MAX; CELLS]);
    assert!(memory.seen.is_known(place));
    see(&mut memory, 3, |_| Beam::Hit(1800));
    assert_eq!(memory.remembered().len(), 200);
    assert!(memory.overflows() > 0);
    assert!(!memory.seen.is_known(PointMm { x: 2000, y: 0 }) || !memory.seen.is_known(place));
}

//= spec/memory.md#memory-09
//= type=test
//# A remembered hit older than `age_max` MUST NOT become free, only unknown.
#[test]
fn what_is_too_old_becomes_unknown_not_free() {
    let mut memory = Small::default();
    see(&mut memory, 0, pole);
    see(&mut memory, 1, blind);
    let kept = memory.remembered().len();
    memory.seen.mark(&[u128::MAX; CELLS]);
    see(&mut memory, 61_000, blind);
    assert!(kept > 0 && memory.remembered().is_empty());
    assert!(!memory.seen.is_known(PointMm { x: 1000, y: 0 }));
}

#[test]
fn a_points_inflation_grows_with_distance_turn_and_time() {
    let mut memory = Small::default();
    see(&mut memory, 0, pole);
    see(&mut memory, 1, blind);
    let later = Instant::from_us(1_001_000);
    let far = Odometer {
        travelled_um: 4_000_000,
        turned_urad: 2_000_000,
    };
    let mut moving = model();
    moving.obstacle_speed = 500_000;
    let mut inflation = |model: &MemoryModel, odometer: Odometer| {
        memory.refresh(model, LocalPose::default(), later, odometer);
        memory
            .clouds()
            .flatten()
            .find(|point| point.x_mm == 1000)
            .map(|point| point.extra_mm)
            .unwrap()
    };
    let fresh = inflation(&model(), Odometer::default());
    // 4 m at 5 mm/m, and 0.02 rad at 1 m, which rounds up.
    assert_eq!(inflation(&model(), far), fresh + 41);
    // A second at 0.5 m/s; the point's own second.
    assert_eq!(inflation(&moving, Odometer::default()), fresh + 501);
}

#[test]
fn the_anchor_moves_and_everything_stays_where_it_is() {
    let mut memory = Small::default();
    see(&mut memory, 0, pole);
    see(&mut memory, 1, blind);
    let moved = LocalPose {
        x_um: -2_048_000,
        ..LocalPose::default()
    };
    let now = Instant::from_us(2000);
    memory.refresh(&model(), LocalPose::default(), now, Odometer::default());
    let before: std::vec::Vec<_> = memory.clouds().flatten().copied().collect();
    memory.reanchor(AnchorShift {
        x_mm: 2048,
        y_mm: 0,
    });
    memory.refresh(&model(), moved, now, Odometer::default());
    let after: std::vec::Vec<_> = memory.clouds().flatten().copied().collect();
    assert_eq!(before, after);
}

//= spec/guard.md#guard-15
//= type=test
//# A return MUST be inflated by no less than its own lateral beam gap, range times angle to the neighbouring beam.
#[test]
fn a_return_is_inflated_by_its_own_beam_gap() {
    let mut memory = Small::default();
    for (ms, range) in [500_u16, 1000, 2000, 2900].into_iter().enumerate() {
        let ms = ms as u64;
        see(&mut memory, ms, |_| Beam::Hit(range));
        let now = Instant::from_us(ms * 1000);
        memory.refresh(&model(), LocalPose::default(), now, Odometer::default());
        let newest = memory.clouds().next().unwrap();
        assert_eq!(newest.len(), 181);
        // One degree between beams, and 10 mm of the sensor.
        let gap = f64::from(range) * 1_f64.to_radians();
        for point in newest {
            let extra = f64::from(point.extra_mm);
            assert!(extra >= gap + 10.0 && extra < gap + 12.0, "{point:?}");
        }
    }
}

//= spec/memory.md#memory-07
//= type=test
//# The known region MUST shrink from its unwatched borders no slower than the obstacle speed bound and the odometry drift demand.
#[test]
fn known_space_shrinks_as_fast_as_obstacles_move_and_odometry_drifts() {
    let border = |obstacle_speed: u64, odometer: Odometer| {
        let mut memory = Small::default();
        // A square of 2 m that nobody looks at any more.
        let outline = Rect {
            front: 8_000,
            rear: 8_000,
            left: 8_000,
            right: 8_000,
        };
        memory.occupy(LocalPose::default(), outline);
        let mut model = model();
        model.obstacle_speed = obstacle_speed;
        let mut now = 0;
        for step in 1..=10 {
            now += 40_000;
            let part = |total: u64| total * step / 10;
            let odometer = Odometer {
                travelled_um: part(odometer.travelled_um),
                turned_urad: part(odometer.turned_urad),
            };
            memory.age(&model, Instant::from_us(now), odometer);
        }
        (0..1_100)
            .rev()
            .find(|&x| memory.seen.is_known(PointMm { x, y: 0 }))
            .unwrap_or(0)
    };
    let still = border(0, Odometer::default());
    assert!((900..=1_024).contains(&still), "{still}");
    // 0.4 s at 0.5 m/s are 200 mm, that is three whole cells; the rest stays owed.
    assert!(border(500_000, Odometer::default()) <= still - 3 * 64);
    // 40 m at 5 mm/m, and 2 rad at 10 mrad/rad with a lever of 3.8 m.
    let driven = Odometer {
        travelled_um: 40_000_000,
        turned_urad: 0,
    };
    assert!(border(0, driven) <= still - 3 * 64);
    let turned = Odometer {
        travelled_um: 0,
        turned_urad: 6_000_000,
    };
    assert!(border(0, turned) <= still - 3 * 64);
}
