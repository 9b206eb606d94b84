//! Corners of occupied cells against all corners of all cells, in floats.

use super::world::{Map, m, pose, radians, rules, turned};
use crate::geometry::frame::PointMm;
use crate::grid::{CellIndex, GridRules, LogOdds, Occupancy, OccupancyGrid, UpdateRule};
use crate::input::Pose;
use crate::units::Length;
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::vec::Vec;

/// Corners in the body frame, metres, each once.
fn all_corners(map: &Map, robot: &Pose) -> Vec<(f64, f64)> {
    let mut vertices = BTreeSet::new();
    for cell in map.cells() {
        if map.occupancy(cell) == Occupancy::Occupied {
            let (column, row) = (cell.column(), cell.row());
            vertices.extend([
                (column, row),
                (column + 1, row),
                (column, row + 1),
                (column + 1, row + 1),
            ]);
        }
    }
    let origin = map.lower_left();
    let heading = radians(origin.heading);
    let to_body = |(column, row): (i32, i32)| {
        let (x, y) = turned(f64::from(column) * 0.1, f64::from(row) * 0.1, heading);
        let x = x + (origin.x_um - robot.x_um) as f64 * 1e-6;
        let y = y + (origin.y_um - robot.y_um) as f64 * 1e-6;
        turned(x, y, -radians(robot.heading))
    };
    vertices.into_iter().map(to_body).collect()
}

proptest! {
    #[test]
    fn every_near_corner_once(
        occupied in prop::collection::vec((0..48_i32, 0..40_i32), 0..300),
        origin in (-9.0..9.0, -9.0..9.0, -3.2..3.2),
        robot in (-12.0..12.0, -12.0..12.0, -3.2..3.2),
        reach in 0.0..6.0,
    ) {
        let origin = pose(origin.0, origin.1, origin.2);
        let robot = pose(robot.0, robot.1, robot.2);
        let mut map = Map::new(rules(UpdateRule::EveryBeam), origin).unwrap();
        for (column, row) in occupied {
            map.set(CellIndex::new(column, row), LogOdds::from_counts(100));
        }
        let ours: Vec<PointMm> = map.corners_near(&robot, m(reach)).collect();
        let corners = all_corners(&map, &robot);
        let within = |margin: f64| {
            corners.iter().filter(move |(x, y)| x.hypot(*y) <= reach + margin)
        };
        prop_assert!(ours.len() >= within(-1e-4).count());
        prop_assert!(ours.len() <= within(1e-4).count());
        for point in &ours {
            let same = |corner: &&(f64, f64)| {
                (corner.0 * 1e3 - f64::from(point.x)).abs() < 0.6
                    && (corner.1 * 1e3 - f64::from(point.y)).abs() < 0.6
            };
            prop_assert_eq!(within(1e-4).filter(same).count(), 1);
        }
        let distinct: BTreeSet<(i32, i32)> = ours.iter().map(|p| (p.x, p.y)).collect();
        prop_assert_eq!(distinct.len(), ours.len());
    }
}

#[test]
fn one_cell_has_four_corners_and_a_block_shares_them() {
    let mut map: OccupancyGrid<10, 10> =
        OccupancyGrid::new(GridRules::default(), Pose::default()).unwrap();
    let count =
        |map: &OccupancyGrid<10, 10>| map.corners_near(&pose(0.5, 0.5, 0.0), m(5.0)).count();
    assert_eq!(count(&map), 0);
    map.set(CellIndex::new(4, 4), LogOdds::from_counts(100));
    assert_eq!(count(&map), 4);
    map.set(CellIndex::new(5, 4), LogOdds::from_counts(100));
    assert_eq!(count(&map), 6);
    map.set(CellIndex::new(4, 5), LogOdds::from_counts(100));
    map.set(CellIndex::new(5, 5), LogOdds::from_counts(100));
    assert_eq!(count(&map), 9);
    assert_eq!(
        map.corners_near(&pose(0.5, 0.5, 0.0), Length::ZERO).count(),
        1
    );
}
