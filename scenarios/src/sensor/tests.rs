//! Skew, bounds of the error and what the formats write.

use super::*;
use crate::noise::Stream;
use crate::world::{Body, Course, Shape, Trigger};

fn scanner() -> Scanner {
    Robot::embedded("seekur_jr")
        .expect("the shipped robot is good")
        .values
        .scanners[0]
        .clone()
}

fn wall_ahead() -> World {
    World::new(vec![Body {
        name: "wall".to_owned(),
        shape: Shape::Segment([0.0, -50.0], [0.0, 50.0]),
        home: Pose::new(5.527, 0.0, 0.0),
        invisible: false,
        trigger: Trigger::At(0.0),
        course: Course::Still,
    }])
}

fn exact(sweep_us: u64) -> ScannerModel {
    ScannerModel {
        sigma_m: 0.0,
        bias_m: 0.0,
        sweep_us,
        interval_us: 20_000,
        delay_us: 0,
        dropout: 0.0,
        range_min_m: 0.05,
        range_max_m: 18.0,
    }
}

fn middle(model: &ScannerModel, speed_mps: f64) -> f64 {
    let mut noise = Noise::new(1, Stream::Sensor);
    let pose_at = |us: u64| Pose::new(seconds(us) * speed_mps, 0.0, 0.0);
    let scan = take(0, &scanner(), model, 0, &wall_ahead(), &pose_at, &mut noise);
    assert_eq!(scan.bodies[270], Some(0));
    f64::from(scan.ranges_m[270])
}

#[test]
fn standing_robot_sees_the_wall_where_it_is() {
    assert!((middle(&exact(15_000), 0.0) - 5.0).abs() < 1e-6);
}

#[test]
fn each_beam_is_cast_at_its_own_time() {
    // The middle beam leaves 7.5 ms after the first: 7.5 mm nearer at 1 m/s.
    assert!((middle(&exact(15_000), 1.0) - 4.9925).abs() < 1e-6);
    assert!((middle(&exact(0), 1.0) - 5.0).abs() < 1e-6);
}

#[test]
fn error_stays_within_systematic_plus_three_sigma() {
    let model = ScannerModel {
        sigma_m: 0.012,
        bias_m: 0.030,
        ..exact(0)
    };
    let mut noise = Noise::new(3, Stream::Sensor);
    let mut seen = (f64::INFINITY, f64::NEG_INFINITY);
    for _ in 0..50 {
        let scan = take(
            0,
            &scanner(),
            &model,
            0,
            &wall_ahead(),
            &|_| Pose::default(),
            &mut noise,
        );
        for (beam, range) in scan.ranges_m.iter().enumerate().skip(200).take(140) {
            let angle = (beam as f64 - 270.0) * 0.5_f64.to_radians();
            let error = f64::from(*range) - 5.0 / angle.cos();
            assert!(error.abs() <= 0.066 + 1e-6, "{error}");
            seen = (seen.0.min(error), seen.1.max(error));
        }
    }
    assert!(
        seen.0 < 0.0 && seen.1 > 0.06,
        "the noise is really there: {seen:?}"
    );
}

#[test]
fn sweeps_come_at_their_rate_and_not_before_their_last_beam() {
    let robot = Robot::embedded("seekur_jr").expect("the shipped robot is good");
    let model = exact(15_000);
    let mut sensors = Sensors {
        turned: Vec::new(),
        scanners: vec![(robot.values.scanners[0].clone(), model)],
        next_us: vec![0],
        noise: Noise::new(1, Stream::Sensor),
    };
    let still = |_| Pose::default();
    assert!(sensors.sweep(10_000, &wall_ahead(), &still).is_empty());
    let stamps: Vec<u64> = sensors
        .sweep(60_000, &wall_ahead(), &still)
        .iter()
        .map(|(_, scan)| scan.stamp_us)
        .collect();
    assert_eq!(stamps, [0, 20_000, 40_000]);
}

#[test]
fn formats_write_nothing_in_their_own_way() {
    assert!(no_return(Encoding::Rep117).is_infinite());
    assert!(no_return(Encoding::ZeroIsNone).abs() < f32::MIN_POSITIVE);
    assert!(lost_range(Encoding::Rep117).is_nan());
    assert!(lost_range(Encoding::ZeroIsInvalid).abs() < f32::MIN_POSITIVE);
}

#[test]
fn a_knocked_scanner_looks_elsewhere_for_a_while() {
    use crate::testing::{ROOM, robot, scenario};
    let knock =
        "\n[[fault]]\nkind = \"scan_rotated\"\nfrom_s = 0.1\nuntil_s = 0.2\nturn_deg = 60.0\n";
    let scene = scenario(&format!(
        "{ROOM}\n[sensor]\nnoise_sigma_m = 0.0\nbias_m = 0.0\n{knock}"
    ));
    let mut sensors = Sensors::new(&robot(), &scene, Noise::new(1, Stream::Sensor));
    let still = |_| Pose::default();
    let scans = sensors.sweep(400_000, &wall_ahead(), &still);
    // The wall is 5 m ahead of the scanner: 10 m at 60 degrees.
    for (_, scan) in scans {
        let knocked = (100_000..200_000).contains(&scan.begun_us);
        let expected = if knocked { 10.0 } else { 5.0 };
        assert!(
            (f64::from(scan.ranges_m[270]) - expected).abs() < 0.01,
            "{} us: {}",
            scan.begun_us,
            scan.ranges_m[270]
        );
    }
}
