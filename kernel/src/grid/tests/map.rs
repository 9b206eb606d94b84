//! Reading, clamping, changing back, refusing.

use super::world::{Map, m, pose, rules, scanner};
use crate::config::MaskRect;
use crate::grid::{
    CellIndex, GridError, GridRules, LogOdds, Occupancy, OccupancyGrid, POSE_MAX_UM, ScanRefused,
    SensorModel, UpdateRule,
};
use crate::input::{Beam, Pose};
use crate::units::{BinaryAngle, Length};
use core::f64::consts::PI;

/// Robot in the middle of cell (10, 10), looking along the row with a single beam.
fn corridor(update: UpdateRule) -> (Map, Pose) {
    let map = Map::new(rules(update), Pose::default()).unwrap();
    (map, pose(1.05, 1.05, 0.0))
}

fn look(map: &mut Map, from: &Pose, beam: Beam) {
    map.update(from, &scanner(1, 0.0, 0.01), &[beam]).unwrap();
}

const WALL: CellIndex = CellIndex::new(20, 10);

/// Scans until `WALL` is as wanted.
fn scans_until(map: &mut Map, from: &Pose, beam: Beam, wanted: impl Fn(Occupancy) -> bool) -> i32 {
    let mut scans = 0;
    while !wanted(map.occupancy(WALL)) {
        look(map, from, beam);
        scans += 1;
        assert!(scans < 100);
    }
    scans
}

//= spec/grid.md#grid-01
//= type=test
//# The value of every cell MUST stay between floor and ceiling.
#[test]
fn cells_change_back_within_the_time_that_the_clamps_promise() {
    let defaults = GridRules::default();
    let counts = |value: LogOdds| i32::from(value.as_counts());
    let (near, far) = (Beam::Hit(1000), Beam::Hit(2000));
    let rise = counts(defaults.occupied_from) - counts(defaults.floor);
    let fall = counts(defaults.ceiling) - counts(defaults.free_to);
    for update in [UpdateRule::EveryBeam, UpdateRule::NearestBeam] {
        let (mut map, from) = corridor(update);
        for _ in 0..1000 {
            look(&mut map, &from, far);
        }
        assert_eq!(map.log_odds(WALL), Some(defaults.floor));
        let scans = scans_until(&mut map, &from, near, |is| is == Occupancy::Occupied);
        let expected = match update {
            UpdateRule::EveryBeam => 1,
            UpdateRule::NearestBeam => (rise + 26) / 27,
        };
        assert_eq!(scans, expected, "{update:?}");
        for _ in 0..1000 {
            look(&mut map, &from, near);
        }
        assert_eq!(map.log_odds(WALL), Some(defaults.ceiling));
        let scans = scans_until(&mut map, &from, far, |is| is == Occupancy::Free);
        assert_eq!(scans, (fall + 12) / 13, "{update:?}");
    }
}

#[test]
fn one_beam_along_a_row() {
    for update in [UpdateRule::EveryBeam, UpdateRule::NearestBeam] {
        let (mut map, from) = corridor(update);
        for _ in 0..3 {
            look(&mut map, &from, Beam::Hit(1000));
        }
        let row: std::string::String = (8..26)
            .map(|column| match map.occupancy(CellIndex::new(column, 10)) {
                Occupancy::Free => '.',
                Occupancy::Occupied => '#',
                Occupancy::Unknown => '?',
            })
            .collect();
        // The hit lies in the middle of cell 20; cell 21 is 0.1 m behind it, cell 22 is past
        // delta_3. What is behind the scanner stays unknown.
        assert_eq!(row, "??..........##????", "{update:?}");
        assert_eq!(map.occupancy(CellIndex::new(15, 11)), Occupancy::Unknown);
    }
}

#[test]
fn no_return_frees_only_what_the_operator_vouches_for() {
    for update in [UpdateRule::EveryBeam, UpdateRule::NearestBeam] {
        let (mut map, from) = corridor(update);
        for _ in 0..3 {
            look(&mut map, &from, Beam::NoReturn);
        }
        // no_return_clear is 1.2 m: up to the middle of cell 22.
        assert_eq!(map.occupancy(CellIndex::new(22, 10)), Occupancy::Free);
        assert_eq!(map.log_odds(CellIndex::new(23, 10)), Some(LogOdds::PRIOR));
        for _ in 0..3 {
            look(&mut map, &from, Beam::TooNear);
        }
        // Nearer than range_min, 0.1 m: the next cell.
        assert_eq!(map.occupancy(CellIndex::new(11, 10)), Occupancy::Occupied);
        let before = map.clone();
        look(&mut map, &from, Beam::Invalid);
        assert!(
            before
                .cells()
                .all(|cell| before.log_odds(cell) == map.log_odds(cell))
        );
    }
}

#[test]
fn the_robots_own_parts_leave_no_trace() {
    for update in [UpdateRule::EveryBeam, UpdateRule::NearestBeam] {
        let (mut map, from) = corridor(update);
        let mut scanner = scanner(1, 0.0, 0.01);
        scanner.masks[1] = Some(MaskRect {
            x_min: m(0.4),
            x_max: m(0.6),
            y_min: m(-0.1),
            y_max: m(0.1),
        });
        map.update(&from, &scanner, &[Beam::Hit(500)]).unwrap();
        assert!(
            map.cells()
                .all(|cell| map.log_odds(cell) == Some(LogOdds::PRIOR))
        );
        map.update(&from, &scanner, &[Beam::Hit(601)]).unwrap();
        assert_ne!(map.log_odds(CellIndex::new(16, 10)), Some(LogOdds::PRIOR));
    }
}

//= spec/grid.md#grid-03
//= type=test
//# A place off the grid MUST be unknown.
#[test]
fn off_the_map_is_unknown_and_cannot_be_set() {
    let (mut map, _) = corridor(UpdateRule::EveryBeam);
    for cell in map.cells() {
        assert!(map.set(cell, LogOdds::from_counts(127)));
        assert_eq!(map.log_odds(cell), Some(map.rules().ceiling));
        assert_eq!(map.occupancy(cell), Occupancy::Occupied);
    }
    for (column, row) in [
        (-1, 0),
        (0, -1),
        (48, 0),
        (0, 40),
        (i32::MIN, i32::MAX),
        (i32::MAX, 3),
    ] {
        let cell = CellIndex::new(column, row);
        assert_eq!(map.occupancy(cell), Occupancy::Unknown);
        assert!(!map.set(cell, LogOdds::from_counts(127)));
    }
    map.clear();
    assert!(
        map.cells()
            .all(|cell| map.occupancy(cell) == Occupancy::Unknown)
    );
    assert_eq!(map.cells().count(), 48 * 40);
}

#[test]
fn the_map_of_the_thesis_lies_turned_by_half() {
    // Loh 6.3: origin (-20, 20), turned by 180 degrees, cells of 0.1 m.
    let map = Map::new(GridRules::default(), pose(-20.0, 20.0, PI)).unwrap();
    let at = |x_m: f64, y_m: f64| map.cell_at((x_m * 1e6) as i64, (y_m * 1e6) as i64);
    assert_eq!(at(-20.25, 19.95), Some(CellIndex::new(2, 0)));
    assert_eq!(at(-19.95, 20.05), Some(CellIndex::new(-1, -1)));
    assert_eq!(
        map.corner_um(CellIndex::new(2, 3)),
        (-20_200_000, 19_700_000)
    );
    assert_eq!(map.lower_left(), pose(-20.0, 20.0, PI));
}

//= spec/grid.md#grid-04
//= type=test
//# A scan that cannot be placed MUST NOT change any cell.
#[test]
fn what_cannot_be_entered_changes_nothing() {
    let (mut map, from) = corridor(UpdateRule::EveryBeam);
    let fan = scanner(3, 0.0, 0.1);
    let beams = [Beam::Hit(500); 3];
    assert_eq!(
        map.update(&from, &fan, &beams[..2]),
        Err(ScanRefused::BeamCount)
    );
    let beyond = Pose {
        x_um: POSE_MAX_UM + 1,
        ..from
    };
    assert_eq!(map.update(&beyond, &fan, &beams), Err(ScanRefused::Pose));
    let over = scanner(3, 0.0, PI - 1e-9);
    assert_eq!(map.update(&from, &over, &beams), Ok(()));
    map.clear();
    let over = crate::config::Scanner {
        increment: i32::MIN,
        ..over
    };
    assert_eq!(map.update(&from, &over, &beams), Err(ScanRefused::Fan));
    assert!(
        map.cells()
            .all(|cell| map.log_odds(cell) == Some(LogOdds::PRIOR))
    );
}

#[test]
fn rules_that_cannot_work_are_refused() {
    let refused = |change: fn(&mut GridRules)| {
        let mut rules = GridRules::default();
        change(&mut rules);
        rules.check(10, 10).err()
    };
    assert_eq!(refused(|_| ()), None);
    assert_eq!(
        refused(|r| r.cell = Length::from_um(9_999)),
        Some(GridError::Cell)
    );
    assert_eq!(
        refused(|r| r.cell = Length::from_um(1_000_001)),
        Some(GridError::Cell)
    );
    assert_eq!(
        refused(|r| r.model.delta_1 = Length::from_um(-1)),
        Some(GridError::Deltas)
    );
    assert_eq!(
        refused(|r| r.model.delta_2 = Length::from_mm(201)),
        Some(GridError::Deltas)
    );
    assert_eq!(
        refused(|r| r.model.delta_3 = Length::from_mm(1001)),
        Some(GridError::Deltas)
    );
    assert_eq!(
        refused(|r| r.model.free = LogOdds::PRIOR),
        Some(GridError::Evidence)
    );
    assert_eq!(
        refused(|r| r.model.occupied = LogOdds::from_counts(127)),
        Some(GridError::Evidence)
    );
    assert_eq!(
        refused(|r| r.floor = LogOdds::from_counts(-35)),
        Some(GridError::Thresholds)
    );
    assert_eq!(
        refused(|r| r.free_to = LogOdds::PRIOR),
        Some(GridError::Thresholds)
    );
    assert_eq!(
        refused(|r| r.ceiling = LogOdds::from_counts(35)),
        Some(GridError::Thresholds)
    );
    assert_eq!(
        OccupancyGrid::<0, 1>::new(GridRules::default(), Pose::default()).err(),
        Some(GridError::Size)
    );
    let far = Pose {
        y_um: i64::MIN,
        heading: BinaryAngle::ZERO,
        x_um: 0,
    };
    assert_eq!(
        Map::new(GridRules::default(), far).err(),
        Some(GridError::Origin)
    );
}

#[test]
fn default_thresholds_are_those_of_the_thesis() {
    let rules = GridRules::default();
    assert_eq!(Some(rules.occupied_from), LogOdds::at_least(0.75));
    assert_eq!(Some(rules.free_to), LogOdds::at_most(0.25));
    let model = SensorModel::default();
    assert!((model.occupied.probability() - 0.7).abs() < 0.004);
    assert!((model.free.probability() - 0.4).abs() < 0.004);
}
