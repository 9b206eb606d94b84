//! The rolling grid against a fixed one that is large enough never to roll.

use super::world::{any_beam, m, rules, scanner};
use crate::grid::{
    CellIndex, LogOdds, Occupancy, OccupancyGrid, POSE_MAX_UM, RollingGrid, ScanRefused, UpdateRule,
};
use crate::input::{Beam, Pose};
use proptest::prelude::*;
use std::boxed::Box;

type Small = RollingGrid<31, 24>;
type Large = OccupancyGrid<100, 100>;
const LARGE_LOW: i32 = -50;

fn held(small: &Small, cell: CellIndex) -> bool {
    small.grid().log_odds(cell).is_some()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Both see the same scans; the large one forgets what the small one has left behind.
    #[test]
    fn content_stays_and_what_leaves_is_unknown(
        stations in prop::collection::vec((-3.3..3.3, -3.3..3.3, -3.0..3.0), 1..12),
        beams in prop::collection::vec(any_beam(), 60),
        near in 0.05..1.0,
        nearest: bool,
    ) {
        let rule = if nearest { UpdateRule::NearestBeam } else { UpdateRule::EveryBeam };
        let mut small = Small::new(rules(rule)).unwrap();
        let origin = Pose { x_um: -5_000_000, y_um: -5_000_000, ..Pose::default() };
        let mut large = Box::new(Large::new(rules(rule), origin).unwrap());
        let mut fan = scanner(60, -1.5, 0.05);
        fan.x = m(0.3);
        for (x, y, heading) in stations {
            let robot = super::world::pose(near * x, near * y, heading);
            small.update(&robot, &fan, &beams).unwrap();
            large.update(&robot, &fan, &beams).unwrap();
            let all = large.cells();
            for cell in all {
                let world = CellIndex::new(cell.column() + LARGE_LOW, cell.row() + LARGE_LOW);
                if held(&small, world) {
                    prop_assert_eq!(small.grid().log_odds(world), large.log_odds(cell));
                } else {
                    large.set(cell, LogOdds::PRIOR);
                }
            }
        }
    }

    #[test]
    fn the_robot_is_in_the_middle_wherever_it_is(x in -9e11..9e11_f64, y in -9e11..9e11_f64) {
        let mut small = Small::new(rules(UpdateRule::EveryBeam)).unwrap();
        let robot = Pose { x_um: x as i64, y_um: y as i64, ..Pose::default() };
        small.follow(&robot).unwrap();
        let cell = small.grid().cell_at(robot.x_um, robot.y_um).unwrap();
        let low = small.grid().lowest();
        prop_assert_eq!((cell.column() - low.column(), cell.row() - low.row()), (15, 12));
        prop_assert_eq!(small.grid().corner_um(low), {
            let corner = small.grid().lower_left();
            (corner.x_um, corner.y_um)
        });
        prop_assert!(small.grid().cells().all(|cell| held(&small, cell)));
    }
}

//= spec/grid.md#grid-05
//= type=test
//# Cells that enter a rolling grid MUST be unknown, while cells that stay keep their value.
#[test]
fn a_wall_left_behind_is_forgotten_on_return() {
    let mut small = Small::new(rules(UpdateRule::EveryBeam)).unwrap();
    let wall = small.grid().cell_at(1_000_000, 50_000).unwrap();
    let look = |small: &mut Small, x_um: i64, beam: Beam| {
        let robot = Pose {
            x_um,
            y_um: 50_000,
            ..Pose::default()
        };
        small
            .update(&robot, &scanner(1, 0.0, 0.1), &[beam])
            .unwrap();
    };
    look(&mut small, 0, Beam::Hit(1000));
    assert_eq!(small.grid().occupancy(wall), Occupancy::Occupied);
    look(&mut small, -500_000, Beam::Invalid);
    assert_eq!(small.grid().occupancy(wall), Occupancy::Occupied);
    look(&mut small, -800_000, Beam::Invalid);
    assert_eq!(small.grid().log_odds(wall), None);
    look(&mut small, 0, Beam::Invalid);
    assert_eq!(small.grid().log_odds(wall), Some(LogOdds::PRIOR));
}

#[test]
fn an_absurd_pose_moves_nothing() {
    let mut small = Small::new(rules(UpdateRule::EveryBeam)).unwrap();
    let low = small.grid().lowest();
    let absurd = Pose {
        x_um: -POSE_MAX_UM - 1,
        ..Pose::default()
    };
    assert_eq!(small.follow(&absurd), Err(ScanRefused::Pose));
    assert_eq!(small.grid().lowest(), low);
}
