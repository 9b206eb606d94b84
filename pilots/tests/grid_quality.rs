//! Loh 6.3: passage 1 mapped with the exact pose and with the filter's.

#![allow(clippy::unwrap_used, clippy::panic)] // Tests may fail loudly.

use haltline::config::Scanner;
use haltline::convert;
use haltline::grid::{CellIndex, GridRules, Occupancy, OccupancyGrid};
use haltline::input::{Beam, Pose as GridPose, Reading};
use haltline::marker::{MarkerEkf, Pose2};
use haltline::time::Instant;
use haltline_robots::Robot;
use haltline_scenarios::marker_world::{self as world, Chance, Leg, SightErrors, StepSample};
use haltline_scenarios::math::Pose;
use haltline_scenarios::raycast::{Ray, range_to};
use haltline_scenarios::world::Shape;

/// 0.1 m cells over 40 m, its origin in a corner and turned by 180° as the thesis' map.
type Map = OccupancyGrid<400, 400>;

/// Corridor walls of 3 m, and two boxes that leave 1.1 m.
fn shapes() -> Vec<(Shape, Pose)> {
    let wall = |y: f64| (Shape::Segment([-6.0, y], [10.0, y]), Pose::default());
    let side = |y: f64| (Shape::Box([0.25, 0.475]), Pose::new(3.5, y, 0.0));
    let end = |x: f64| (Shape::Segment([x, -1.5], [x, 1.5]), Pose::default());
    vec![
        wall(1.5),
        wall(-1.5),
        side(1.025),
        side(-1.025),
        end(-6.0),
        end(10.0),
    ]
}

/// What the laser sees from a pose; `noise` in standard deviations of 12 mm.
fn scan(
    scanner: &Scanner,
    robot: &Pose,
    chance: &mut Chance,
    sigma_m: f64,
) -> Vec<(Beam, [f64; 2])> {
    let laser = robot.then(Pose::new(f64::from(scanner.x.as_um()) * 1e-6, 0.0, 0.0));
    let turns = |counts: f64| counts / 4_294_967_296.0 * core::f64::consts::TAU;
    let first = turns(f64::from(scanner.first_beam.as_counts().cast_signed()));
    (0..scanner.beams)
        .map(|beam| {
            let angle = laser.theta + first + turns(f64::from(scanner.increment)) * f64::from(beam);
            let ray = Ray::new([laser.x, laser.y], angle);
            let hits = shapes()
                .into_iter()
                .filter_map(|(shape, pose)| range_to(&ray, &shape, &pose));
            let range = hits.fold(60.0, f64::min);
            let [dx, dy] = ray.direction;
            let point = [laser.x + range * dx, laser.y + range * dy];
            let seen = range + sigma_m * chance.normal();
            (Beam::Hit((seen * 1000.0).round() as u16), point)
        })
        .collect()
}

fn grid_pose(pose: &Pose2) -> GridPose {
    let at = [pose.x_m, pose.y_m, pose.heading_rad];
    match convert::odometry(Instant::default(), at, [0.0; 2], None) {
        Reading::Value(odometry) => odometry.pose,
        _ => panic!("{pose:?}"),
    }
}

fn empty_map() -> Box<Map> {
    let origin = grid_pose(&Pose2::new(20.0, 20.0, core::f64::consts::PI));
    Box::new(Map::new(GridRules::default(), origin).unwrap())
}

/// Maps the drive at the poses that `pick` tells.
fn mapped(
    scanner: &Scanner,
    steps: &[StepSample],
    pick: impl Fn(&StepSample) -> Pose2,
) -> Box<Map> {
    let mut map = empty_map();
    let mut chance = Chance::new(5, 0);
    for step in steps {
        let beams: Vec<Beam> = scan(scanner, &step.truth, &mut chance, 0.012)
            .into_iter()
            .map(|(b, _)| b)
            .collect();
        map.update(&grid_pose(&pick(step)), scanner, &beams)
            .unwrap();
    }
    map
}

fn cell_of(map: &Map, [x, y]: [f64; 2]) -> CellIndex {
    map.cell_at((x * 1e6) as i64, (y * 1e6) as i64).unwrap()
}

fn occupied_near(map: &Map, cell: CellIndex, reach: i32) -> bool {
    let around = -reach..=reach;
    around.clone().any(|dx| {
        around.clone().any(|dy| {
            let near = CellIndex::new(cell.column() + dx, cell.row() + dy);
            map.occupancy(near) == Occupancy::Occupied
        })
    })
}

/// How a map compares with what is there.
#[derive(Debug)]
struct Quality {
    /// Part of the cells with a surface that was seen, that are occupied or have an occupied
    /// neighbour.
    found: f64,
    /// Part of the occupied cells that have no surface within two cells: the sensor model takes
    /// 0.15 m behind a hit for occupied.
    wrong: f64,
    /// Cells of the free passage that are occupied.
    blocked: usize,
}

fn quality(map: &Map, surface: &[CellIndex]) -> Quality {
    let mut truth = empty_map();
    for cell in surface {
        assert!(truth.set(*cell, GridRules::default().ceiling));
    }
    let found = surface
        .iter()
        .filter(|cell| occupied_near(map, **cell, 1))
        .count();
    let occupied: Vec<CellIndex> = map
        .cells()
        .filter(|cell| map.occupancy(*cell) == Occupancy::Occupied)
        .collect();
    let wrong = occupied
        .iter()
        .filter(|cell| !occupied_near(&truth, **cell, 2))
        .count();
    // The middle of the passage, 0.7 m of its 1.1 m.
    let passage = (0..70)
        .flat_map(|y| (0..5).map(move |x| [3.3 + 0.1 * f64::from(x), -0.35 + 0.01 * f64::from(y)]));
    let blocked = passage
        .filter(|at| map.occupancy(cell_of(map, *at)) == Occupancy::Occupied)
        .count();
    Quality {
        found: found as f64 / surface.len() as f64,
        wrong: wrong as f64 / occupied.len().max(1) as f64,
        blocked,
    }
}

/// Maps passage 1 by the filter's pose, and with `exact` by the true one.
fn passage(sights: SightErrors) -> (Quality, Quality) {
    let robot = Robot::embedded("seekur_jr").unwrap();
    let scanner = robot.config.scanners[0].unwrap();
    let mut setup = world::corridor_setup(sights);
    setup.path.legs = vec![Leg {
        speed_mps: 0.5,
        turn_radps: 0.0,
        time_s: 11.0,
    }];
    let rules = world::filter_rules(&setup, false);
    let mut filter = Box::new(MarkerEkf::<4, 24>::new(rules, Pose2::default(), [1e-6; 3]).unwrap());
    for marker in &setup.markers {
        filter
            .add_mapped(marker.id, world::planar(&marker.pose))
            .unwrap();
    }
    let trace = world::run(&setup, 1, filter.as_mut());
    let exact = mapped(&scanner, &trace.steps, |step| world::planar(&step.truth));
    let estimated = mapped(&scanner, &trace.steps, |step| step.estimate);
    let mut surface: Vec<CellIndex> = trace
        .steps
        .iter()
        .flat_map(|step| scan(&scanner, &step.truth, &mut Chance::new(0, 0), 0.0))
        .map(|(_, point)| cell_of(&exact, point))
        .collect();
    surface.sort_by_key(|cell| (cell.row(), cell.column()));
    surface.dedup();
    (quality(&exact, &surface), quality(&estimated, &surface))
}

#[test]
fn passage_1_is_mapped_as_well_with_the_filters_pose() {
    for (name, sights) in [
        ("idealised", world::idealised()),
        ("realistic", world::realistic()),
    ] {
        let (exact, estimated) = passage(sights);
        println!("{name}: exact {exact:.3?}, estimated {estimated:.3?}");
        for quality in [&exact, &estimated] {
            assert!(quality.found > 0.95, "{name}: {quality:?}");
            assert!(quality.wrong < 0.05, "{name}: {quality:?}");
            assert_eq!(quality.blocked, 0, "{name}");
        }
    }
}

/// With the pose of odometry alone, and a bad one, the same measure shows the damage.
#[test]
fn the_measure_sees_a_bad_pose() {
    let robot = Robot::embedded("seekur_jr").unwrap();
    let scanner = robot.config.scanners[0].unwrap();
    let steps: Vec<StepSample> = (0..220)
        .map(|at| {
            let x = f64::from(at) * 0.025;
            StepSample {
                time_s: 0.0,
                way_m: x,
                truth: Pose::new(x, 0.0, 0.0),
                estimate: Pose2::new(x, 0.1 * x, 0.1),
                covariance: [[0.0; 3]; 3],
                in_sight: true,
            }
        })
        .collect();
    let map = mapped(&scanner, &steps, |step| step.estimate);
    let surface: Vec<CellIndex> = scan(&scanner, &steps[0].truth, &mut Chance::new(0, 0), 0.0)
        .into_iter()
        .map(|(_, point)| cell_of(&map, point))
        .collect();
    let quality = quality(&map, &surface);
    assert!(quality.wrong > 0.2, "{quality:?}");
}
