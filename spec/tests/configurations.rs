//! Where a configuration becomes impossible: the last value that is accepted and the first that is refused.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

#[path = "../../kernel/tests/common/mod.rs"]
mod room;

use haltline::checked::ConfigError;
use haltline::config::{Config, HostDeath, Kinematics, Scanner};
use haltline::time::Duration;
use haltline::units::{
    Acceleration, AngularAcceleration, AngularSpeed, Curvature, Length, Ppm, Speed,
};
use room::{Robot, config};

/// Puts a value into a configuration.
type Put = fn(&mut Config<1>, i32);

/// What is refused, by which name, how it is set, the last value accepted, the first refused.
type Bound = (&'static str, ConfigError, Put, i32, i32);

fn um(value: i32) -> Length {
    Length::from_um(value)
}

fn mps(value: i32) -> Speed {
    Speed::from_um_per_s(value)
}

fn radps(value: i32) -> AngularSpeed {
    AngularSpeed::from_urad_per_s(value)
}

fn mps2(value: i32) -> Acceleration {
    Acceleration::from_um_per_s2(value.cast_unsigned())
}

fn radps2(value: i32) -> AngularAcceleration {
    AngularAcceleration::from_urad_per_s2(value.cast_unsigned())
}

fn us(value: i32) -> Duration {
    Duration::from_us(value.cast_unsigned().into())
}

fn ppm(value: i32) -> Ppm {
    Ppm::from_ppm(value.cast_unsigned())
}

fn scanner(config: &mut Config<1>) -> &mut Scanner {
    config.scanners[0].as_mut().unwrap()
}

fn refused(bounds: &[Bound]) {
    for (what, error, put, good, bad) in bounds {
        for (value, expected) in [(*good, None), (*bad, Some(*error))] {
            let mut changed = config();
            put(&mut changed, value);
            let found = Robot::new(changed).err();
            assert_eq!(found, expected, "{what} of {value}");
        }
    }
}

const METRES: i32 = 1_000_000;
const SECOND: i32 = 1_000_000;

//= spec/input.md#input-14
//= type=test
//# A configuration that contains an impossible combination MUST be refused before the first tick.
#[test]
#[rustfmt::skip] // Tables.
fn bodies_and_speeds() {
    use ConfigError as E;
    let coast: Put = |c, v| {
        c.host_death = Some(HostDeath {
            watchdog: Duration::from_ms(100),
            braking: mps2(v),
            angular_braking: radps2(1_000_000),
        });
    };
    let spin: Put = |c, v| {
        c.host_death = Some(HostDeath {
            watchdog: Duration::from_ms(100),
            braking: mps2(500_000),
            angular_braking: radps2(v),
        });
    };
    refused(&[
        ("front", E::Footprint, |c, v| c.footprint.front = um(v), 2 * METRES, 2 * METRES + 1),
        ("rear", E::Footprint, |c, v| c.footprint.rear = um(v), 0, -1),
        ("left", E::Footprint, |c, v| c.footprint.left = um(v), 2 * METRES, 2 * METRES + 1),
        ("right", E::Footprint, |c, v| c.footprint.right = um(v), 0, -1),
        ("length", E::Footprint, |c, v| (c.footprint.front, c.footprint.rear) = (um(v), um(0)), 1, 0),
        ("width", E::Footprint, |c, v| (c.footprint.left, c.footprint.right) = (um(0), um(v)), 1, 0),
        ("forward", E::SpeedLimit, |c, v| c.limits.speed_forward = mps(v), 20 * METRES, 20 * METRES + 1),
        ("reverse", E::SpeedLimit, |c, v| c.limits.speed_reverse = mps(v), 0, -1),
        ("turn", E::SpeedLimit, |c, v| c.limits.angular_speed = radps(v), 20 * METRES, 20 * METRES + 1),
        ("acceleration", E::Acceleration, |c, v| c.limits.acceleration = mps2(v), 1, 0),
        ("braking", E::Acceleration, |c, v| (c.limits.braking, c.limits.acceleration) = (mps2(v), mps2(1)), 1, 0),
        ("angular acceleration", E::Acceleration, |c, v| c.limits.angular_acceleration = radps2(v), 1, 0),
        ("angular braking", E::Acceleration, |c, v| { (c.limits.angular_braking, c.limits.angular_acceleration) = (radps2(v), radps2(1)) }, 1, 0),
        ("braking of a silent drive", E::Acceleration, coast, 1, 0),
        ("turn braking of a silent drive", E::Acceleration, spin, 1, 0),
        ("faster than it brakes", E::Ramps, |c, v| c.limits.acceleration = mps2(v), 500_000, 500_001),
        ("turn faster than it brakes", E::Ramps, |c, v| c.limits.angular_acceleration = radps2(v), 1_000_000, 1_000_001),
        ("obstacles", E::ObstacleSpeed, |c, v| c.obstacle_speed = mps(v), 20 * METRES, 20 * METRES + 1),
        ("curvature", E::Curvature, |c, v| c.kinematics = steered(v, 0, 0), 1, 0),
        ("curvature's tolerance", E::Curvature, |c, v| c.kinematics = steered(1, v, 0), 0, -1),
        ("zone before", E::Zone, |c, v| c.zone.front = um(v), 2 * METRES, 2 * METRES + 1),
        ("zone beside", E::Zone, |c, v| c.zone.side = um(v), 0, -1),
    ]);
}

fn steered(curvature: i32, tolerance: i32, sweep_us: i32) -> Kinematics {
    Kinematics::Ackermann {
        curvature_max: Curvature::from_urad_per_m(curvature),
        curvature_tolerance: Curvature::from_urad_per_m(tolerance),
        steering_sweep: us(sweep_us),
    }
}

#[test]
#[rustfmt::skip] // Tables.
fn tolerances_and_memory() {
    use ConfigError as E;
    let two = 2 * METRES;
    refused(&[
        ("speed", E::Tolerance, |c, v| c.tolerances.speed = mps(v), two, two + 1),
        ("turn", E::Tolerance, |c, v| c.tolerances.angular_speed = radps(v), two, two + 1),
        ("tracking", E::Tolerance, |c, v| c.tolerances.tracking = um(v), 0, -1),
        ("rest", E::Tolerance, |c, v| c.tolerances.rest_speed = mps(v), two, two + 1),
        ("rest's turn", E::Tolerance, |c, v| c.tolerances.rest_angular_speed = radps(v), two, two + 1),
        ("following", E::Tolerance, |c, v| c.tolerances.follow_speed = mps(v), two, two + 1),
        ("following turns", E::Tolerance, |c, v| c.tolerances.follow_angular_speed = radps(v), two, two + 1),
        ("drift", E::Tolerance, |c, v| c.tolerances.odometry_linear = ppm(v), METRES, METRES + 1),
        ("turn's drift", E::Tolerance, |c, v| c.tolerances.odometry_angular = ppm(v), METRES, METRES + 1),
        ("scans", E::Memory, |c, v| c.memory.clear_after_scans = u8::try_from(v).unwrap(), 1, 0),
        ("age", E::Memory, |c, v| c.memory.age_max = us(v), 1, 0),
        ("vouched", E::Memory, |c, v| c.memory.clear_at_start = um(v), 10 * METRES, 10 * METRES + 1),
        ("skirt", E::Memory, |c, v| c.memory.skirt = um(v), METRES, METRES + 1),
        ("width", E::Memory, |c, v| c.memory.body_width_min = um(v), METRES, METRES + 1),
    ]);
}

#[test]
#[rustfmt::skip] // Tables.
fn times() {
    use ConfigError as E;
    let ten = 10 * SECOND;
    refused(&[
        ("period", E::Timing, |c, v| c.timing.period = us(v), ten, ten + 1),
        ("no period", E::Timing, |c, v| c.timing.period = us(v), 100_000, 0),
        ("jitter", E::Timing, |c, v| c.timing.jitter = us(v), ten, ten + 1),
        ("scans", E::Timing, |c, v| c.timing.scan_age_max = us(v), ten, ten + 1),
        ("commands", E::Timing, |c, v| c.timing.command_age_max = us(v), ten, ten + 1),
        ("rest", E::Timing, |c, v| c.timing.rest = us(v), ten, ten + 1),
        ("clear", E::Timing, |c, v| c.timing.clear = us(v), ten, ten + 1),
        ("tracking", E::Timing, |c, v| c.timing.tracking_window = us(v), ten, ten + 1),
        // 60 ms of odometry's age and this latency in periods of 40 ms: 34 of them and 6 more fill the hull.
        ("in flight", E::Pipeline, |c, v| c.timing.actuation_latency = us(v), 1_300_000, 1_300_001),
        ("age in flight", E::Pipeline, |c, v| c.timing.odometry_age_max = us(v), 1_260_000, 1_260_001),
        ("sweep in flight", E::Pipeline, |c, v| c.kinematics = steered(1, 0, v), 1_200_000, 1_200_001),
        ("latency", E::Timing, |c, v| (c.timing.period, c.timing.actuation_latency) = (us(10 * SECOND), us(v)), ten, ten + 1),
        ("odometry", E::Timing, |c, v| (c.timing.period, c.timing.odometry_age_max) = (us(10 * SECOND), us(v)), ten, ten + 1),
    ]);
}

#[test]
#[rustfmt::skip] // Tables.
fn scanners() {
    use ConfigError as E;
    let (beams, range) = (E::ScannerBeams(0), E::ScannerRange(0));
    let far = 65 * METRES;
    refused(&[
        ("few beams", beams, |c, v| scanner(c).beams = u16::try_from(v).unwrap(), 2, 1),
        ("many beams", beams, |c, v| scanner(c).beams = u16::try_from(v).unwrap(), 541, 542),
        ("one direction", beams, |c, v| scanner(c).increment = v, -1, 0),
        // 540 steps of 2^32 counts a turn.
        ("more than a turn", beams, |c, v| scanner(c).increment = v, 7_953_643, 7_953_644),
        ("exactly a turn", beams, |c, v| (scanner(c).beams, scanner(c).increment) = (513, v), (1 << 23) - 1, 1 << 23),
        ("nearest", range, |c, v| scanner(c).range_min = um(v), 10 * METRES, 10 * METRES + 1),
        ("no nearest", range, |c, v| scanner(c).range_min = um(v), 0, -1),
        ("farthest", range, |c, v| scanner(c).range_max = um(v), far, far + 1),
        ("empty", range, |c, v| scanner(c).range_max = um(v), 20_001, 20_000),
        ("error", range, |c, v| scanner(c).error = um(v), METRES, METRES + 1),
        ("no return", range, |c, v| scanner(c).no_return_clear = um(v), far, far + 1),
        ("duration", range, |c, v| scanner(c).scan_duration = us(v), SECOND, SECOND + 1),
        ("mounted ahead", range, |c, v| (scanner(c).x, scanner(c).y) = (um(v), um(0)), MOUNT, MOUNT + 1),
        ("mounted behind", range, |c, v| (scanner(c).x, scanner(c).y) = (um(-v), um(0)), MOUNT, MOUNT + 1),
        ("mounted aside", range, |c, v| (scanner(c).x, scanner(c).y) = (um(-METRES), um(-v)), MOUNT - METRES, MOUNT - METRES + 1),
    ]);
}

/// The farthest that a scanner may be mounted from the centre, um: half of the square that memory covers.
const MOUNT: i32 = haltline::guard::seen::COVER_MM / 2 * 1000 - 1;
