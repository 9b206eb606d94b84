//! Rounding is outward and scanners point where the file says.

use haltline::units::Length;

use crate::{EMBEDDED, Robot};

fn seekur_with(from: &str, to: &str) -> Robot {
    assert_eq!(
        EMBEDDED[0].1.matches(from).count(),
        1,
        "`{from}` must be unique"
    );
    Robot::parse(&EMBEDDED[0].1.replace(from, to), "changed.toml").unwrap()
}

/// Values between two counts: what enlarges the tube rounds up, what promises rounds down.
#[test]
fn rounding_is_outward() {
    let odd = |key: &str, value: &str| {
        seekur_with(
            &format!("{key} = {value}"),
            &format!("{key} = {value}0000005"),
        )
    };
    let up = odd("tracking_m", "0.020").config.tolerances.tracking;
    assert_eq!(up.as_um(), 20_001);
    let down = odd("speed_forward_mps", "1.200".trim_end_matches('0'))
        .config
        .limits;
    assert_eq!(down.speed_forward.as_um_per_s(), 1_200_000);
    let latency = odd("actuation_latency_s", "0.100").config.timing;
    assert_eq!(latency.actuation_latency.as_us(), 100_001);
    let age = odd("scan_age_max_s", "0.060").config.timing;
    assert_eq!(age.scan_age_max.as_us(), 60_000);
    let sigma = odd("error_systematic_m", "0.030").config.scanners[0].unwrap();
    assert_eq!(sigma.error, Length::from_um(66_001));
}

#[test]
fn an_upside_down_scanner_runs_clockwise_from_the_left() {
    let upright = Robot::embedded("seekur_jr").unwrap();
    let turned = seekur_with("upside_down = false", "upside_down = true");
    let (a, b) = (&upright.values.scanners[0], &turned.values.scanners[0]);
    let last = a.first_beam_rad() + 540.0 * a.increment_rad();
    assert!((b.first_beam_rad() - last).abs() < 1e-9);
    assert!((b.increment_rad() + a.increment_rad()).abs() < 1e-12);
    let (a, b) = (
        upright.config.scanners[0].unwrap(),
        turned.config.scanners[0].unwrap(),
    );
    assert_eq!(a.increment, -b.increment);
    // +135 degrees is 3/8 of a turn.
    assert_eq!(b.first_beam.as_counts(), 0x6000_0000);
}

#[test]
fn a_yawed_scanner_sees_to_its_side() {
    let robot = seekur_with("yaw_deg = 0.0", "yaw_deg = 90.0");
    let laser = &robot.values.scanners[0];
    assert!(laser.sees(0.527, 2.0));
    assert!(laser.sees(-2.0, 0.0));
    assert!(!laser.sees(0.527, -2.0));
    assert!(!laser.sees(0.527, 0.01), "nearer than range_min_m");
    assert!(!laser.sees(0.527, 19.0), "beyond range_max_m");
}

#[test]
fn obstacle_speed_can_be_set_by_a_scenario() {
    let robot = Robot::embedded("seekur_jr").unwrap();
    let crossing = robot.with_obstacle_speed(1.0).unwrap();
    assert_eq!(crossing.config.obstacle_speed.as_um_per_s(), 1_000_000);
    for impossible in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(robot.with_obstacle_speed(impossible).is_none());
    }
}

#[test]
fn host_death_reaches_the_kernel_only_where_it_is_covered() {
    let robot = Robot::embedded("seekur_jr").unwrap();
    assert!(robot.config.host_death.is_none());
    let covered = robot.with_cover_host_death(true).unwrap();
    let host_death = covered.config.host_death.unwrap();
    assert_eq!(host_death.watchdog.as_us(), 2_000_000);
    assert_eq!(host_death.braking.as_um_per_s2(), 300_000);
    assert_eq!(
        covered.with_cover_host_death(false).unwrap().config,
        robot.config
    );
}
