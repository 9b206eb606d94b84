//! The files that come with the project.

use haltline::time::Duration;
use haltline::units::{Acceleration, BinaryAngle, Length, Speed};

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
