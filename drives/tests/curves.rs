//! Both calibration curves over every input there is, and the printed form that drives backwards.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use haltline_drives::car::curve::{SPEED, STEER, SpeedCurve};
use haltline_drives::car::wheel_angle;
use haltline_drives::uc::command::{DriveLevel, SteeringLevel};

/// What the enumeration demands of a speed curve; the first broken demand.
fn enumerate(level: impl Fn(i16) -> f64) -> Result<(), String> {
    let mut before = f64::NEG_INFINITY;
    for speed in i16::MIN..=i16::MAX {
        let thrust = level(speed);
        if thrust.partial_cmp(&0.0) != f64::from(speed).partial_cmp(&0.0) {
            return Err(format!("{speed} mm/s becomes level {thrust}"));
        }
        if thrust < before {
            return Err(format!("not monotone at {speed} mm/s"));
        }
        if !(-500.0..=1000.0).contains(&thrust) {
            return Err(format!("{speed} mm/s leaves the range of levels: {thrust}"));
        }
        before = thrust;
    }
    Ok(())
}

//= spec/drive.md#drive-11
//= type=test
//# A speed MUST become a drive level of the same sign, and a larger speed a level that is no smaller, for every speed that can be asked for.
#[test]
fn thrust_has_the_sign_of_the_speed_over_all_65536_speeds() {
    enumerate(|speed| f64::from(SPEED.level(speed).thrust())).unwrap();
    for speed in i16::MIN..=i16::MAX {
        let level = SPEED.level(speed);
        assert_eq!(level.brake(), 0, "{speed} mm/s brakes");
        let wanted = f64::from(speed) * 1e-3;
        let steady = SPEED.speed(level);
        // Never faster than asked, and within one level where it does not saturate.
        assert!(steady.abs() <= wanted.abs() + 1e-12, "{speed}: {steady}");
        assert!(steady * wanted >= 0.0, "{speed}: {steady}");
        let saturated = matches!(level.thrust(), 1000 | -500);
        assert!(
            saturated || (wanted - steady).abs() < 1.0 / 439.0,
            "{speed}: {steady}"
        );
    }
}

/// The false twin: the curve as it was printed.
#[test]
fn the_printed_offsets_drive_backwards_and_are_caught() {
    let printed = |speed: i16| {
        let x = f64::from(speed) * 1e-3;
        match x {
            x if x < 0.0 => 439.8038 * x + 116.136_943,
            x if x > 0.0 => 477.518_514 * x - 104.623_299,
            _ => 0.0,
        }
    };
    assert!((printed(100) + 56.87).abs() < 0.01);
    assert!(enumerate(|speed| printed(speed).clamp(-500.0, 1000.0)).is_err());
    let mirrored = SpeedCurve {
        forward_offset: -104.623_299,
        ..SPEED
    };
    // Even then the map's own clamp keeps the sign; the enumeration of its speed notices.
    let level = mirrored.level(100);
    assert!(level.thrust() > 0);
    assert!((SPEED.speed(level) - 0.1).abs() > 0.05);
}

#[test]
fn every_level_reads_back_to_itself() {
    for level in 1..=1000 {
        let drive = DriveLevel::forward(level).unwrap();
        let speed = SPEED.speed(drive);
        assert!(speed >= 0.0);
        if level > 105 {
            let mmps = (speed * 1e3).floor() as i16;
            assert!((SPEED.level(mmps).thrust() - level).abs() <= 1, "F {level}");
        }
    }
    for level in 1..=500 {
        let drive = DriveLevel::reverse(level).unwrap();
        let speed = SPEED.speed(drive);
        assert!(speed <= 0.0);
        if level > 117 {
            let mmps = (speed * 1e3).ceil() as i16;
            assert!((SPEED.level(mmps).thrust() + level).abs() <= 1, "B {level}");
        }
    }
    for brake in 1..=500 {
        assert!(SPEED.speed(DriveLevel::forward(-brake).unwrap()).abs() < 1e-12);
    }
}

#[test]
fn steering_falls_over_all_65536_angles_and_left_is_less_than_straight() {
    let straight = STEER.level(0).level();
    assert_eq!(straight, 144);
    let mut before = 1001;
    for angle in i16::MIN..=i16::MAX {
        let level = STEER.level(angle).level();
        assert!(level <= before, "not monotone at {angle}");
        before = level;
        if angle > 0 {
            assert!(level <= straight, "left {angle} becomes {level}");
        } else if angle < 0 {
            assert!(level >= straight, "right {angle} becomes {level}");
        }
    }
    assert_eq!(STEER.level(i16::MIN).level(), 1000);
    assert_eq!(STEER.level(i16::MAX).level(), -1000);
    // Where it saturates.
    assert!(STEER.reaches(4035) && !STEER.reaches(4037));
    assert!(STEER.reaches(-3604) && !STEER.reaches(-3606));
}

#[test]
fn every_steering_level_reads_back_to_itself() {
    let mut before = f64::INFINITY;
    for level in -1000..=1000 {
        let angle = STEER.angle(SteeringLevel::new(level).unwrap());
        assert!(angle < before, "not strictly monotone at {level}");
        before = angle;
        let counts = (angle * 1e4).round() as i16;
        let back = STEER.level(counts).level();
        assert!((back - level).abs() <= 1, "{level} comes back as {back}");
    }
}

#[test]
fn the_printed_polynomial_is_used_as_printed() {
    // By hand, term by term, at +-0.2 rad.
    let at = |x: f64| {
        196_814.0 * x.powi(6) - 50_518.0 * x.powi(5) - 47_550.0 * x.powi(4)
            + 5979.7 * x.powi(3)
            + 2459.5 * x.powi(2)
            - 2442.1 * x
            + 143.78
    };
    assert_eq!(
        i16::try_from(at(0.2).round() as i64).unwrap(),
        STEER.level(2000).level()
    );
    assert_eq!(
        i16::try_from(at(-0.2).round() as i64).unwrap(),
        STEER.level(-2000).level()
    );
    // It turns round outside: using it there would steer the wrong way.
    assert!(at(-0.6) > at(-0.5) || at(0.6) > at(0.48));
}

#[test]
fn wheel_angles_of_curvatures_are_odd_and_saturate() {
    for curvature in (-4_000_000..=4_000_000).step_by(977) {
        let angle = wheel_angle(curvature, 0.25);
        assert_eq!(wheel_angle(-curvature, 0.25), -angle);
        let back = (f64::from(angle) * 1e-4).tan() / 0.25;
        assert!(
            (back - f64::from(curvature) * 1e-6).abs() < 5e-4,
            "{curvature}"
        );
    }
    assert_eq!(wheel_angle(i32::MAX, 0.25), 15_689);
    assert_eq!(wheel_angle(i32::MIN, 0.25), -15_689);
}

#[test]
fn the_enumeration_of_the_certificate_says_the_same() {
    let said = haltline_drives::conformance::speed_and_steering().unwrap();
    assert!(said.contains("65536"));
}
