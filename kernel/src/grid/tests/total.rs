//! Anything may come in: no panic, no overflow, and always an answer.
//!
//! Tests run with overflow checks.

use super::world::{any_beam, rules};
use crate::config::{MASKS_MAX, MaskRect, Scanner};
use crate::grid::{
    CellIndex, GridRules, LogOdds, Occupancy, OccupancyGrid, POSE_MAX_UM, RollingGrid, SensorModel,
    UpdateRule,
};
use crate::input::{Beam, Pose};
use crate::time::Duration;
use crate::units::{BinaryAngle, Length, Ppm};
use proptest::prelude::*;
use std::vec::Vec;

type Map = OccupancyGrid<13, 9>;

/// Any number, often an extreme or a small one.
fn wild() -> impl Strategy<Value = i64> {
    prop_oneof![
        any::<i64>(),
        -3_000_000_i64..3_000_000,
        prop::sample::select(
            &[
                i64::MIN,
                i64::MAX,
                0,
                POSE_MAX_UM,
                -POSE_MAX_UM,
                i32::MAX as i64,
                i32::MIN as i64,
            ][..]
        ),
    ]
}

fn length() -> impl Strategy<Value = Length> {
    wild().prop_map(|um| Length::from_um(um as i32))
}

fn wild_pose() -> impl Strategy<Value = Pose> {
    (wild(), wild(), any::<u32>()).prop_map(|(x_um, y_um, heading)| Pose {
        x_um,
        y_um,
        heading: BinaryAngle::from_counts(heading),
    })
}

fn wild_beams() -> impl Strategy<Value = Vec<Beam>> {
    let beam = prop_oneof![any_beam(), any::<u16>().prop_map(Beam::Hit)];
    prop::collection::vec(beam, 0..40)
}

prop_compose! {
    fn wild_scanner()(
        lengths in prop::collection::vec(length(), 9),
        first: u32,
        increment in prop_oneof![any::<i32>(), -200_000_000..200_000_000_i32, Just(0), Just(i32::MIN)],
        beams: u16,
        masked: bool,
    ) -> Scanner {
        let mask = MaskRect { x_min: lengths[0], x_max: lengths[1], y_min: lengths[2], y_max: lengths[3] };
        Scanner {
            x: lengths[4],
            y: lengths[5],
            first_beam: BinaryAngle::from_counts(first),
            increment,
            beams,
            scan_duration: Duration::ZERO,
            range_min: lengths[6],
            range_max: lengths[7],
            error: Length::ZERO,
            no_return_clear: lengths[8],
            invalid_max: Ppm::ZERO,
            invalid_gap_max: 0,
            masks: [masked.then_some(mask); MASKS_MAX],
        }
    }
}

prop_compose! {
    fn wild_rules()(
        lengths in prop::collection::vec(length(), 4),
        counts: [i8; 6],
        nearest: bool,
    ) -> GridRules {
        let [occupied, free, floor, ceiling, occupied_from, free_to] = counts.map(LogOdds::from_counts);
        GridRules {
            cell: lengths[0],
            model: SensorModel {
                delta_1: lengths[1],
                delta_2: lengths[2],
                delta_3: lengths[3],
                occupied,
                free,
            },
            update: if nearest { UpdateRule::NearestBeam } else { UpdateRule::EveryBeam },
            floor,
            ceiling,
            occupied_from,
            free_to,
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn any_scan_from_anywhere(
        origin in wild_pose(),
        pose in wild_pose(),
        scanner in wild_scanner(),
        beams in wild_beams(),
        cell: (i32, i32),
        reach in -1_000_000..2_000_000_i32,
        tiny: bool,
    ) {
        for rule in [UpdateRule::EveryBeam, UpdateRule::NearestBeam] {
            let cell_um = if tiny { 10_000 } else { 1_000_000 };
            let rules = GridRules { cell: Length::from_um(cell_um), ..rules(rule) };
            let scanner = Scanner { beams: beams.len() as u16, ..scanner };
            let mut rolling = RollingGrid::<13, 9>::new(rules).unwrap();
            let _ = rolling.update(&pose, &scanner, &beams);
            let Ok(mut map) = Map::new(rules, origin) else { continue };
            let _ = map.update(&pose, &scanner, &beams);
            let _ = (map.corner_um(CellIndex::new(cell.0, cell.1)), map.cell_at(pose.x_um, pose.y_um));
            let _ = map.corners_near(&pose, Length::from_um(reach)).count();
            for grid in [&map, rolling.grid()] {
                let wanted = CellIndex::new(cell.0, cell.1);
                if grid.log_odds(wanted).is_none() {
                    prop_assert_eq!(grid.occupancy(wanted), Occupancy::Unknown);
                }
                for cell in grid.cells() {
                    let value = grid.log_odds(cell).unwrap();
                    prop_assert!(grid.rules().floor <= value && value <= grid.rules().ceiling);
                }
            }
        }
    }

    /// Any rules are either refused or work.
    #[test]
    fn any_rules(rules in wild_rules(), pose in wild_pose(), beams in wild_beams()) {
        if let Ok(mut map) = Map::new(rules, Pose::default()) {
            let scanner = super::world::scanner(beams.len() as u16, 0.0, 0.05);
            let _ = map.update(&pose, &scanner, &beams);
        }
    }
}
