//! The model car's curves over every input there is.

use super::Failure;
use super::checks::fail;
use crate::car::curve::{SPEED, STEER};

/// Enumerates all 65 536 speeds and all 65 536 wheel angles: sign, monotony, range, saturation.
///
/// # Errors
/// The first input that breaks a demand.
pub fn speed_and_steering() -> Result<String, Failure> {
    let broken = |seen: String| Err(fail("DRIVE-11", seen));
    let straight = STEER.level(0).level();
    let (mut thrust_before, mut steer_before) = (i16::MIN, i16::MAX);
    for input in i16::MIN..=i16::MAX {
        let level = SPEED.level(input);
        let thrust = level.thrust();
        if thrust.signum() != input.signum() || level.brake() != 0 {
            return broken(format!("{input} mm/s becomes {level:?}"));
        }
        let asked = f64::from(input) * 1e-3;
        if thrust < thrust_before || SPEED.speed(level).abs() > asked.abs() + 1e-12 {
            return broken(format!("{input} mm/s: not monotone, or faster than asked"));
        }
        let steer = STEER.level(input).level();
        let wrong_side = (steer - straight).signum() * input.signum() > 0;
        if steer > steer_before || wrong_side {
            return broken(format!("{input} x 0.1 mrad becomes steering level {steer}"));
        }
        (thrust_before, steer_before) = (thrust, steer);
    }
    Ok("65536 speeds and 65536 wheel angles: sign kept, monotone, saturating".to_owned())
}
