//! Floats become integers: every bit pattern.

use haltline::convert::{BeamEncoding, Round, angle, beam, duration, length, speed};
use haltline::input::Beam;
use haltline::units::Length;

/// Micro-units as the kernel computes them; the product is one rounding away from the exact one.
fn micro(value: f64) -> f64 {
    value * 1e6
}

fn up(slack: f64) {
    let value: f64 = kani::any();
    let product = micro(value);
    let answer = length(value, Round::Up);
    kani::cover!(answer.is_some() && product > 0.5);
    kani::cover!(answer.is_none());
    match answer {
        Some(length) => {
            let counts = f64::from(length.as_um());
            assert!(counts >= product + slack && counts <= product + 1.0);
        }
        // NaN fails both comparisons.
        None => assert!(!(product > -2_147_483_649.0 && product <= 2_147_483_647.0)),
    }
}

/// A length that enlarges the tube rounds outward or is refused; every bit pattern of an f64.
//= spec/guard.md#guard-21
//= type=proof
//= spec/input.md#input-09
//= type=proof
#[kani::proof]
#[kani::solver(cadical)]
fn lengths_round_up_or_are_refused() {
    up(0.0);
}

#[kani::proof]
#[kani::should_panic]
fn lengths_round_up_or_are_refused_twin() {
    up(0.25);
}

fn down(slack: f64) {
    let value: f64 = kani::any();
    let product = micro(value);
    let answer = speed(value, Round::Down);
    kani::cover!(answer.is_some() && product < -0.5);
    match answer {
        Some(speed) => {
            let counts = f64::from(speed.as_um_per_s());
            assert!(counts + slack <= product && counts >= product - 1.0);
        }
        None => assert!(!(product >= -2_147_483_648.0 && product < 2_147_483_648.0)),
    }
}

/// A speed that promises something rounds down or is refused; every bit pattern of an f64.
//= spec/limit.md#limit-01
//= type=proof
//= spec/input.md#input-09
//= type=proof
#[kani::proof]
#[kani::solver(cadical)]
fn speeds_round_down_or_are_refused() {
    down(0.0);
}

#[kani::proof]
#[kani::should_panic]
fn speeds_round_down_or_are_refused_twin() {
    down(0.25);
}

fn total_durations(fault: bool) {
    let value: f64 = kani::any();
    let answer = duration(value, Round::Up);
    kani::cover!(answer.is_some());
    if let Some(span) = answer {
        assert!(micro(value) > -1.0 && (!fault || span.as_us() > 0));
    }
    let turned = angle(value);
    kani::cover!(turned.is_some());
    assert!(turned.is_none() || (value > -1e6 && value < 1e6));
}

/// Durations and angles: not finite or out of range is refused; every bit pattern of an f64.
//= spec/input.md#input-09
//= type=proof
#[kani::proof]
#[kani::solver(cadical)]
fn durations_and_angles_are_total() {
    total_durations(false);
}

#[kani::proof]
#[kani::should_panic]
fn durations_and_angles_are_total_twin() {
    total_durations(true);
}

fn classified(fault: bool) {
    let bits: u32 = kani::any();
    let range = f32::from_bits(bits);
    let least = Length::from_um(20_000);
    let most = Length::from_um(30_000_000);
    let encoding = match kani::any::<u8>() {
        0 => BeamEncoding::Rep117,
        1 => BeamEncoding::ZeroIsNone,
        _ => BeamEncoding::ZeroIsInvalid,
    };
    let answer = beam(range, encoding, least, most);
    kani::cover!(matches!(answer, Beam::Hit(_)));
    kani::cover!(answer == Beam::TooNear);
    kani::cover!(answer == Beam::NoReturn);
    kani::cover!(answer == Beam::Invalid);
    let metres = f64::from(range);
    match answer {
        Beam::Hit(mm) => {
            let error = f64::from(mm) - metres * 1000.0;
            assert!(error <= 0.501 && error >= -0.501);
            assert!(metres >= 0.02 - 1e-6 && metres <= 30.0 + 1e-6 && !fault);
        }
        Beam::TooNear => assert!(metres < 0.02 + 1e-6),
        Beam::NoReturn => assert!(metres > 30.0 - 1e-6 || metres == 0.0 || range.abs() < 1e-30),
        Beam::Invalid => assert!(metres.is_nan() || metres < 1e-6 || metres > 1e6),
    }
    // Bad numbers are never free space, but for the encodings that say so.
    assert!(!range.is_nan() || answer == Beam::Invalid);
    assert!(!(range < -1e-6) || answer != Beam::NoReturn);
}

/// Every bit pattern of a range is one of hit, no return, too near and invalid, a hit within half a
/// millimetre (range limits 0.02 m and 30 m).
//= spec/input.md#input-01
//= type=proof
#[kani::proof]
#[kani::solver(cadical)]
fn every_range_is_classified() {
    classified(false);
}

#[kani::proof]
#[kani::should_panic]
fn every_range_is_classified_twin() {
    classified(true);
}
