//! Scanners, poses and random scans for the tests, and the same geometry in floats.

use crate::config::{MASKS_MAX, Scanner};
use crate::convert;
use crate::grid::{Echo, GridRules, OccupancyGrid, UpdateRule};
use crate::input::{Beam, Pose};
use crate::time::Duration;
use crate::units::{BinaryAngle, Length, Ppm};
use core::f64::consts::TAU;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use std::vec::Vec;

pub const COLUMNS: usize = 48;
pub const ROWS: usize = 40;
pub type Map = OccupancyGrid<COLUMNS, ROWS>;

pub fn m(metres: f64) -> Length {
    convert::length(metres, convert::Round::Nearest).unwrap()
}

pub fn rules(update: UpdateRule) -> GridRules {
    GridRules {
        update,
        ..GridRules::default()
    }
}

pub fn pose(x_m: f64, y_m: f64, heading_rad: f64) -> Pose {
    Pose {
        x_um: (x_m * 1e6).round() as i64,
        y_um: (y_m * 1e6).round() as i64,
        heading: convert::angle(heading_rad).unwrap(),
    }
}

/// `beams` beams from `first_rad` on, `increment_rad` apart, mounted at the rotation centre.
pub fn scanner(beams: u16, first_rad: f64, increment_rad: f64) -> Scanner {
    Scanner {
        x: Length::ZERO,
        y: Length::ZERO,
        first_beam: convert::angle(first_rad).unwrap(),
        increment: i32::try_from(convert::signed_angle(increment_rad).unwrap()).unwrap(),
        beams,
        scan_duration: Duration::from_ms(20),
        range_min: m(0.1),
        range_max: m(20.0),
        error: m(0.01),
        no_return_clear: m(1.2),
        invalid_max: Ppm::from_ppm(1_000_000),
        invalid_gap_max: u32::MAX,
        masks: [None; MASKS_MAX],
    }
}

/// A scan on the map of the tests.
#[derive(Clone, Debug)]
pub struct Sighting {
    pub origin: Pose,
    pub pose: Pose,
    pub scanner: Scanner,
    pub beams: Vec<Beam>,
}

impl Sighting {
    pub fn map(&self, update: UpdateRule) -> Map {
        Map::new(rules(update), self.origin).unwrap()
    }

    pub fn enter(&self, map: &mut Map) {
        map.update(&self.pose, &self.scanner, &self.beams).unwrap();
    }

    /// Position of the scanner in cells' metres: the grid's frame.
    pub fn scanner_m(&self) -> (f64, f64) {
        let robot = self.place_m();
        let mount = (self.scanner.x.as_um(), self.scanner.y.as_um());
        let (x, y) = turned(
            f64::from(mount.0) * 1e-6,
            f64::from(mount.1) * 1e-6,
            radians(self.pose.heading) - radians(self.origin.heading),
        );
        (robot.0 + x, robot.1 + y)
    }

    fn place_m(&self) -> (f64, f64) {
        let x = (self.pose.x_um - self.origin.x_um) as f64 * 1e-6;
        let y = (self.pose.y_um - self.origin.y_um) as f64 * 1e-6;
        turned(x, y, -radians(self.origin.heading))
    }

    /// Direction of a beam in the grid's frame, radians, and what it measured.
    pub fn echoes(&self) -> Vec<(f64, Option<Echo>)> {
        let first = radians(self.scanner.first_beam) + radians(self.pose.heading)
            - radians(self.origin.heading);
        let increment = f64::from(self.scanner.increment) / 4_294_967_296.0 * TAU;
        let beams = self.beams.iter().enumerate();
        beams
            .map(|(index, beam)| (first + increment * index as f64, self.echo(*beam)))
            .collect()
    }

    fn echo(&self, beam: Beam) -> Option<Echo> {
        let um = |length: Length| length.as_um().unsigned_abs();
        match beam {
            Beam::Hit(mm) => Some(Echo::Hit {
                range_um: u32::from(mm) * 1000,
            }),
            Beam::TooNear => Some(Echo::Hit {
                range_um: um(self.scanner.range_min),
            }),
            Beam::NoReturn => Some(Echo::Clear {
                range_um: um(self.scanner.no_return_clear),
            }),
            Beam::Invalid => None,
        }
    }
}

pub fn radians(angle: BinaryAngle) -> f64 {
    f64::from(angle.as_counts()) / 4_294_967_296.0 * TAU
}

pub fn turned(x: f64, y: f64, angle: f64) -> (f64, f64) {
    let (sin, cos) = angle.sin_cos();
    (cos * x - sin * y, sin * x + cos * y)
}

/// Middle of a cell in the grid's frame, metres.
pub fn middle(index: i32) -> f64 {
    (f64::from(index) + 0.5) * 0.1
}

pub fn any_beam() -> impl Strategy<Value = Beam> {
    prop_oneof![
        12 => (100_u16..6000).prop_map(Beam::Hit),
        1 => Just(Beam::NoReturn),
        1 => Just(Beam::TooNear),
        1 => Just(Beam::Invalid),
    ]
}

prop_compose! {
    /// Scans from on the map and beside it, by fans of up to a full turn, either way round.
    pub fn sighting()(
        beams in prop::collection::vec(any_beam(), 1..120),
        origin in (-30.0..30.0, -30.0..30.0, -3.2..3.2),
        place in (-1.0..5.8, -1.0..5.0),
        mount in (-0.4..0.6, -0.3..0.3),
        headings in (-3.2..3.2, -3.2..3.2),
        fill in prop_oneof![0.01..0.9999, 0.95..0.9999],
        clockwise: bool,
    ) -> Sighting {
        let sign = if clockwise { -1.0 } else { 1.0 };
        // Up to a full turn, where the first and the last beam nearly meet; an increment stays
        // below half a turn, which an i32 of counts holds.
        let steps = (beams.len() - 1).max(2) as f64;
        let mut scanner = scanner(beams.len() as u16, headings.0, sign * fill * TAU / steps);
        (scanner.x, scanner.y) = (m(mount.0), m(mount.1));
        let (x, y) = turned(place.0, place.1, origin.2);
        Sighting {
            origin: pose(origin.0, origin.1, origin.2),
            pose: pose(origin.0 + x, origin.1 + y, headings.1),
            scanner,
            beams,
        }
    }
}

/// The same `count` sightings in every run.
pub fn sample(count: usize) -> Vec<Sighting> {
    let mut runner = TestRunner::deterministic();
    (0..count)
        .map(|_| sighting().new_tree(&mut runner).unwrap().current())
        .collect()
}
