//! Ready setups: the thesis' experiments and a long loop.

use super::camera::{Camera, SightErrors};
use super::outlier::Outliers;
use super::path::{Leg, Path};
use super::places::{Marker, corridor, field, ring};
use super::run::{Setup, Slip};
use crate::math::Pose;
use core::f64::consts::TAU;
use haltline::marker::{FilterRules, OdometryNoise};

/// 20 Hz.
const PERIOD_US: u64 = 50_000;

/// Errors of the thesis' idealised simulation.
#[must_use]
pub fn idealised() -> SightErrors {
    SightErrors {
        position_per_range: 0.001,
        heading_rad: 0.1_f64.to_radians(),
    }
}

/// Errors measured on rendered markers: 1.7 % of the range, 1.4°.
#[must_use]
pub fn realistic() -> SightErrors {
    SightErrors {
        position_per_range: 0.017,
        heading_rad: 1.4_f64.to_radians(),
    }
}

/// 0.5 % and 0.003 rad after one metre, growing with the root of the way.
fn odometry() -> OdometryNoise {
    OdometryNoise {
        along_m2_per_m: 0.005 * 0.005,
        across_m2_per_m: 0.0,
        heading_rad2_per_m: 0.003 * 0.003,
        heading_rad2_per_rad: 0.0,
        position_m2_per_sample: 0.0,
        heading_rad2_per_sample: 0.0,
    }
}

/// Rules that state exactly the odometry errors of a setup.
#[must_use]
pub fn filter_rules(setup: &Setup, learn: bool) -> FilterRules {
    FilterRules {
        odometry: setup.odometry,
        learn,
        ..FilterRules::default()
    }
}

/// Three cameras that look ahead and to both sides, 50° each, at this rate.
fn cameras(range_m: f64, period_us: u64, stagger_us: u64) -> Vec<Camera> {
    let mount = [(0.55, 0.0, 0.0), (0.45, 0.3, 50.0), (0.45, -0.3, -50.0)];
    mount
        .into_iter()
        .enumerate()
        .map(|(number, (x, y, yaw_deg))| Camera {
            mount: Pose::new(x, y, f64::to_radians(yaw_deg)),
            opening_rad: 50.0_f64.to_radians(),
            range_m,
            period_us,
            offset_us: number as u64 * stagger_us,
        })
        .collect()
}

fn setup(markers: Vec<Marker>, cameras: Vec<Camera>, legs: Vec<Leg>, sights: SightErrors) -> Setup {
    Setup {
        markers,
        cameras,
        path: Path {
            start: Pose::default(),
            legs,
        },
        sights,
        odometry: odometry(),
        odometry_period_us: PERIOD_US,
        slips: Vec::new(),
        outliers: Outliers::default(),
    }
}

const fn leg(speed_mps: f64, turn_radps: f64, time_s: f64) -> Leg {
    Leg {
        speed_mps,
        turn_radps,
        time_s,
    }
}

/// Loh 6.1: 7 s straight at 0.5 m/s, markers to 3.5 m, all at 20 Hz.
#[must_use]
pub fn corridor_setup(sights: SightErrors) -> Setup {
    let cameras = cameras(3.5, PERIOD_US, 0);
    setup(corridor(), cameras, vec![leg(0.5, 0.0, 7.0)], sights)
}

/// Three rounds of a room with markers on a circle of 4 m round the way: turns and revisits.
#[must_use]
pub fn roomy_setup(sights: SightErrors) -> Setup {
    let way_m = TAU * 1.5;
    let speed = 0.5;
    let legs = vec![leg(speed, speed / 1.5, 3.0 * way_m / speed)];
    setup(ring(12, way_m), cameras(3.5, PERIOD_US, 0), legs, sights)
}

/// Loh 6.4: the whole corridor of table B.4, 34 m, with gaps between the markers, cameras at
/// 30 Hz beside 20 Hz of odometry, a slip of 0.5 m and 10° after 12 m, and one sighting in ten
/// an outlier.
#[must_use]
pub fn field_setup() -> Setup {
    let mut setup = setup(
        field(),
        cameras(4.0, 33_333, 7_000),
        vec![leg(0.6, 0.0, 34.0 / 0.6)],
        realistic(),
    );
    setup.slips = vec![Slip {
        at_m: 12.0,
        distance_m: 0.5,
        turn_rad: 10.0_f64.to_radians(),
    }];
    setup.outliers = Outliers {
        displaced: 0.04,
        flipped: 0.02,
        wrong_id: 0.02,
        duplicate: 0.02,
    };
    setup
}

/// A ring of 200 m with 20 unknown markers, driven once and a quarter.
#[must_use]
pub fn loop_setup(sights: SightErrors) -> Setup {
    let (way_m, speed) = (200.0, 0.8);
    let turn = speed * TAU / way_m;
    let legs = vec![leg(speed, turn, 1.25 * way_m / speed)];
    setup(ring(20, way_m), cameras(5.0, PERIOD_US, 0), legs, sights)
}
