//! What greys and numbers mean, and the way to a grid and back.

use super::any_map;
use crate::{
    Description, EnterError, Map, Picture, parse_pgm, parse_yaml, render_pgm, render_yaml,
};
use haltline::grid::{
    CellIndex, GridError, GridRules, LogOdds, Occupancy, OccupancyGrid, RollingGrid,
};
use haltline::input::Pose;
use haltline::units::BinaryAngle;
use proptest::prelude::*;

use Occupancy::{Free, Occupied, Unknown};

fn two_by_two() -> Map {
    Map {
        width: 2,
        height: 2,
        resolution_m: 0.05,
        origin: [-1.5, 2.0, 0.0],
        // Lowest row first.
        cells: vec![Free, Unknown, Occupied, Free],
    }
}

#[test]
fn files_are_those_of_map_server() {
    let map = two_by_two();
    let bytes = render_pgm(&map.picture(), map.resolution_m);
    // The highest row comes first.
    assert_eq!(
        bytes,
        b"P5\n# occupancy grid, 0.05 m per pixel\n2 2\n255\n\x00\xfe\xfe\xcd"
    );
    let yaml = render_yaml(&Description::new("map.pgm", map.resolution_m, map.origin));
    assert_eq!(
        yaml,
        "image: map.pgm\nmode: trinary\nresolution: 0.05\norigin: [-1.5, 2.0, 0.0]\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    );
}

#[test]
fn a_file_as_others_write_it_is_read() {
    let text = "# by hand\r\n---\nimage: \"./office map.pgm\"   # beside\nresolution: 0.050000\n\
                origin: [ -10.000000, -1e1, 0 ]\nnegate: 0\noccupied_thresh: 0.65\n\
                free_thresh: 0.25\n\n";
    let description = parse_yaml(text, "office.yaml").unwrap();
    assert_eq!(description.image, "./office map.pgm");
    let expected = [-10.0, -10.0, 0.0];
    assert!(
        description
            .origin
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 1e-12)
    );
    assert!((description.free_thresh - 0.25).abs() < 1e-12);
    let picture = parse_pgm(
        b"P5 # by hand\n#more\n 3\n2 #\n 100\n\x00\x32\x64\x64\x00\x32",
        "a",
    )
    .unwrap();
    assert_eq!((picture.width, picture.height), (3, 2));
    assert_eq!(picture.greys, [0, 128, 255, 255, 0, 128]);
}

#[test]
fn greys_mean_what_map_server_takes_them_for() {
    let mut description = Description::new("map.pgm", 0.1, [0.0; 3]);
    // p = (255 - grey) / 255: above 0.65 up to 89, below 0.196 from 206 on.
    let of = |description: &Description, greys: &[u8]| -> Vec<Occupancy> {
        greys
            .iter()
            .map(|grey| description.occupancy(*grey))
            .collect()
    };
    let greys = [0, 89, 90, 205, 206, 254, 255];
    let expected = [Occupied, Occupied, Unknown, Unknown, Free, Free, Free];
    assert_eq!(of(&description, &greys), expected);
    description.negate = true;
    assert_eq!(of(&description, &greys.map(|grey| 255 - grey)), expected);
}

#[test]
fn thresholds_may_be_missing_but_not_the_rest() {
    let full = "image: a.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n";
    let description = parse_yaml(full, "a.yaml").unwrap();
    assert_eq!(description, Description::new("a.pgm", 0.1, [0.0; 3]));
    for key in ["image", "resolution", "origin"] {
        let without: String = full
            .lines()
            .filter(|line| !line.starts_with(key))
            .map(|line| format!("{line}\n"))
            .collect();
        let error = parse_yaml(&without, "a.yaml").unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("a.yaml: has no {key}; write `{key}: ")),
            "{error}"
        );
    }
}

#[test]
fn a_grid_becomes_a_map_of_its_window() {
    let mut grid: OccupancyGrid<4, 3> = OccupancyGrid::new(
        GridRules::default(),
        Pose {
            x_um: -2_500_000,
            y_um: 7_100_000,
            heading: BinaryAngle::from_counts(3 << 30),
        },
    )
    .unwrap();
    grid.set(CellIndex::new(0, 0), LogOdds::from_counts(100));
    grid.set(CellIndex::new(3, 2), LogOdds::from_counts(-60));
    grid.set(CellIndex::new(1, 1), LogOdds::from_counts(20));
    let map = Map::from_grid(&grid);
    assert_eq!((map.width, map.height), (4, 3));
    assert!((map.resolution_m - 0.1).abs() < 1e-12);
    let expected = [-2.5, 7.1, -core::f64::consts::FRAC_PI_2];
    assert!(
        map.origin
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 1e-9)
    );
    assert_eq!(map.occupancy(0, 0), Occupied);
    assert_eq!(map.occupancy(3, 2), Free);
    assert_eq!(map.occupancy(1, 1), Unknown);
    assert_eq!(map.occupancy(4, 0), Unknown);
    assert_eq!(map.picture().greys[3], 254, "the highest row comes first");
    assert_eq!(map.picture().greys[8], 0);

    let mut rolling = RollingGrid::<4, 3>::new(GridRules::default()).unwrap();
    let robot = Pose {
        x_um: 5_050_000,
        y_um: -3_050_000,
        ..Pose::default()
    };
    rolling.follow(&robot).unwrap();
    let origin = Map::from_grid(rolling.grid()).origin;
    assert!(
        (origin[0] - 4.8).abs() < 1e-9 && (origin[1] + 3.2).abs() < 1e-9,
        "{origin:?}"
    );
}

#[test]
fn what_does_not_fit_a_grid_is_refused() {
    let map = two_by_two();
    let refused = |map: &Map| map.to_grid::<2, 1>(GridRules::default()).err();
    let too_large = EnterError::TooLarge {
        width: 2,
        height: 2,
    };
    assert_eq!(refused(&map), Some(too_large));
    let narrow = |change: fn(&mut Map)| {
        let mut map = two_by_two();
        change(&mut map);
        map.to_grid::<2, 2>(GridRules::default()).err()
    };
    assert_eq!(narrow(|_| ()), None);
    assert_eq!(
        narrow(|map| map.origin[2] = f64::NAN),
        Some(EnterError::Numbers)
    );
    assert_eq!(narrow(|map| map.origin[0] = 1e9), Some(EnterError::Numbers));
    assert_eq!(
        narrow(|map| map.resolution_m = 2.0),
        Some(EnterError::Grid(GridError::Cell))
    );
}

proptest! {
    #[test]
    fn a_picture_survives(width in 1_usize..40, height in 1_usize..40, seed: u8) {
        let greys: Vec<u8> = (0..width * height).map(|i| seed.wrapping_mul(i as u8)).collect();
        let picture = Picture { width, height, greys };
        prop_assert_eq!(parse_pgm(&render_pgm(&picture, 0.1), "a.pgm").unwrap(), picture);
    }

    #[test]
    fn a_description_survives(
        image in "[^\\p{Cc}]{1,30}",
        resolution_m in 0.001..1000.0,
        origin: [f64; 3],
        thresholds in (0.0..0.5, 0.5..1.0),
        negate: bool,
    ) {
        prop_assume!(origin.iter().all(|number| number.is_finite()));
        let description = Description {
            image,
            resolution_m,
            origin,
            occupied_thresh: thresholds.1,
            free_thresh: thresholds.0,
            negate,
        };
        prop_assert_eq!(parse_yaml(&render_yaml(&description), "a.yaml").unwrap(), description);
    }

    #[test]
    fn a_map_survives_the_grid(map in any_map()) {
        let grid: OccupancyGrid<30, 30> = map.to_grid(GridRules::default()).unwrap();
        let back = Map::from_grid(&grid);
        for row in 0..30 {
            for column in 0..30 {
                let expected = if row < map.height { map.occupancy(column, row) } else { Unknown };
                prop_assert_eq!(back.occupancy(column, row), expected);
            }
        }
        prop_assert!((back.resolution_m - map.resolution_m).abs() <= 0.6e-6);
        for (a, b) in back.origin.iter().zip(map.origin) {
            prop_assert!((a - b).abs() <= 0.6e-6);
        }
    }
}
