//! The files that come with the project.

use haltline::config::Kinematics;
use haltline::time::Duration;
use haltline::units::{Acceleration, BinaryAngle, Curvature, Length, Speed};

use crate::{EMBEDDED, Robot};

#[test]
fn every_embedded_file_parses() {
    for (name, _) in EMBEDDED {
        if let Err(error) = Robot::embedded(name) {
            panic!("{error}");
        }
    }
}

#[test]
fn an_unknown_name_lists_the_known_ones() {
    let error = Robot::embedded("seekur").unwrap_err();
    assert!(error.to_string().contains("write one of: seekur_jr"));
}

#[test]
fn every_value_of_a_shipped_file_names_its_source() {
    for (name, text) in EMBEDDED {
        for (index, line) in text.lines().enumerate() {
            let is_value = line.contains(" = ") && !line.trim_start().starts_with('#');
            let free_text = line.starts_with("name = ");
            if is_value && !free_text {
                let comment = line.split_once('#').map(|(_, comment)| comment.trim());
                let comment = comment.unwrap_or_default();
                assert!(comment.len() > 5, "{name}.toml:{}: no source", index + 1);
            }
        }
    }
}

/// Pinned figures of the Seekur Jr (design, "Pinned figures").
#[test]
fn seekur_jr_has_its_pinned_figures() {
    let robot = Robot::embedded("seekur_jr").unwrap();
    let c = robot.config;
    assert_eq!(c.footprint.front, Length::from_mm(600));
    assert_eq!(c.footprint.left, Length::from_mm(420));
    assert_eq!(c.limits.speed_forward, Speed::from_um_per_s(1_200_000));
    assert_eq!(c.limits.speed_reverse, Speed::ZERO);
    assert_eq!(c.limits.braking, Acceleration::from_um_per_s2(500_000));
    assert_eq!(c.timing.period, Duration::from_ms(40));
    assert_eq!(c.timing.scan_age_max, Duration::from_ms(60));
    assert_eq!(c.timing.actuation_latency, Duration::from_ms(100));
    assert_eq!(c.tolerances.tracking, Length::from_mm(20));
    assert!((robot.values.limits.angular_speed_radps.to_degrees() - 80.0).abs() < 0.01);
    let laser = c.scanners[0].unwrap();
    assert_eq!(laser.x, Length::from_mm(527));
    assert_eq!(laser.beams, 541);
    // 30 mm + 3 * 12 mm.
    assert_eq!(laser.error, Length::from_mm(66));
    // -135 degrees is 5/8 of a turn; half a degree is 1/720 of one.
    assert_eq!(laser.first_beam, BinaryAngle::from_counts(0xA000_0000));
    assert_eq!(laser.increment, 5_965_232);
    assert!(c.host_death.is_none());
    assert!(c.scanners[1].is_none());
}

/// Pinned figures of the model car.
#[test]
fn pses_car_has_its_pinned_figures() {
    let robot = Robot::embedded("pses_car").unwrap();
    let (c, f) = (robot.config, robot.values.footprint);
    assert!((f.length_m() - 0.36).abs() < 1e-9);
    assert!((f.width_m() - 0.21).abs() < 1e-9);
    assert_eq!(c.limits.speed_forward, Speed::from_um_per_s(800_000));
    assert_eq!(c.limits.speed_reverse, Speed::from_um_per_s(500_000));
    assert_eq!(c.limits.acceleration, Acceleration::from_um_per_s2(600_000));
    assert_eq!(c.timing.period, Duration::from_ms(20));
    let Kinematics::Ackermann {
        curvature_max,
        curvature_tolerance,
        steering_sweep,
    } = c.kinematics
    else {
        panic!("the car steers its front wheels");
    };
    assert_eq!(curvature_max, Curvature::from_urad_per_m(1_000_000));
    assert_eq!(steering_sweep, Duration::from_ms(400));
    // Addition theorem, t = tan(1 deg) = 0.0174551: ((0.25 + t) / (1 - 0.25 t) - 0.25) / 0.25.
    assert!((curvature_tolerance.as_urad_per_m() - 74_509).abs() <= 2);
}

/// Pinned figures of the Jackal.
#[test]
fn jackal_has_its_pinned_figures() {
    let robot = Robot::embedded("jackal").unwrap();
    let (c, f) = (robot.config, robot.values.footprint);
    assert!((f.length_m() - 0.42).abs() < 1e-9);
    assert!((f.width_m() - 0.33).abs() < 1e-9);
    assert_eq!(c.limits.speed_forward, Speed::from_um_per_s(500_000));
    assert_eq!(c.limits.angular_speed.as_urad_per_s(), 1_570_000);
    let lidar = c.scanners[0].unwrap();
    assert_eq!(lidar.beams, 720);
    assert_eq!(lidar.range_max, Length::from_mm(30_000));
    assert_eq!(lidar.x, Length::from_mm(-65));
}

/// What the header of the recorded log says.
#[test]
fn sena_agrees_with_the_header_of_its_log() {
    let robot = Robot::embedded("sena").unwrap();
    let laser = robot.config.scanners[0].unwrap();
    assert_eq!(laser.beams, 361);
    assert_eq!(laser.x, Length::from_mm(780));
    // From -90 degrees in half degrees.
    assert_eq!(laser.first_beam, BinaryAngle::from_counts(0xC000_0000));
    assert_eq!(laser.increment, 5_965_232);
}
