//! Floats become integers: every bit pattern.

use haltline::convert::{BeamEncoding, Round, angle, beam, duration, round};
use haltline::input::Beam;
use haltline::units::Length;

const EXACT: f64 = 4_503_599_627_370_496.0;

fn outward(fault: bool) {
    let value: f64 = kani::any();
    let (up, down) = (round(value, Round::Up), round(value, Round::Down));
    kani::cover!(up.is_some() && value > 0.5);
    kani::cover!(up.is_none());
    assert!(up.is_some() == (value > -EXACT && value < EXACT));
    assert!(up.is_some() == down.is_some());
    if let (Some(up), Some(down)) = (up, down) {
        // Whole numbers below 2⁵³ are exact as floats.
        let (high, low) = (up as f64, down as f64);
        assert!(low <= value && value <= high && high <= low + 1.0);
        assert!(!fault || high == low);
    }
}

/// What enlarges rounds up, what promises rounds down, by less than one; what is not finite or too
/// large is refused; every bit pattern of an f64.
//= spec/guard.md#guard-21
//= type=proof
//# Every rounding in the computation of a tube MUST enlarge the tube or be covered by the
//# rounding term of its budget.
//= spec/input.md#input-09
//= type=proof
//# A number that is not finite or out of range MUST make the value it belongs to malformed.
#[kani::proof]
#[kani::solver(cadical)]
fn rounding_is_outward_or_refused() {
    outward(false);
}

#[kani::proof]
#[kani::should_panic]
fn rounding_is_outward_or_refused_twin() {
    outward(true);
}

fn nearest(slack: f64) {
    let value: f64 = kani::any();
    kani::assume(value > -1e9 && value < 1e9);
    let rounded = round(value, Round::Nearest);
    kani::cover!(rounded.is_some());
    assert!(rounded.is_some());
    if let Some(rounded) = rounded {
        let error = rounded as f64 - value;
        assert!(error <= slack && error >= -slack);
    }
}

/// A measured value is rounded by at most 0.500001 counts; every f64 within 10⁹ counts.
//= spec/guard.md#guard-21
//= type=proof
//# Every rounding in the computation of a tube MUST enlarge the tube or be covered by the
//# rounding term of its budget.
#[kani::proof]
#[kani::solver(cadical)]
fn measured_values_round_to_nearest() {
    nearest(0.500_001);
}

#[kani::proof]
#[kani::should_panic]
fn measured_values_round_to_nearest_twin() {
    nearest(0.49);
}

fn total_durations(fault: bool) {
    let value: f64 = kani::any();
    let answer = duration(value, Round::Up);
    kani::cover!(answer.is_some());
    if let Some(span) = answer {
        assert!(value > -1e-6 && (!fault || span.as_us() > 0));
    }
    let turned = angle(value);
    kani::cover!(turned.is_some());
    assert!(turned.is_none() || (value > -1e6 && value < 1e6));
}

/// Durations and angles: not finite or out of range is refused; every bit pattern of an f64.
//= spec/input.md#input-09
//= type=proof
//# A number that is not finite or out of range MUST make the value it belongs to malformed.
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
    match answer {
        Beam::Hit(mm) => assert!(mm >= 20 && mm <= 30_000 && range > 0.0 && !fault),
        Beam::TooNear => assert!(range < 0.021),
        Beam::NoReturn => assert!(range > 29.9 || range == 0.0),
        Beam::Invalid => assert!(range.is_nan() || range <= 0.0 || range > 1e6),
    }
    // Bad numbers are never free space, but for the encodings that say so.
    assert!(!range.is_nan() || answer == Beam::Invalid);
    assert!(!(range < -1e-6) || answer != Beam::NoReturn);
}

/// Every bit pattern of a range is one of hit, no return, too near and invalid, and hits
/// lie within the scanner's range (0.02 m to 30 m).
//= spec/input.md#input-01
//= type=proof
//# Every bit pattern of a beam MUST be classified as exactly one of hit, no-return, too-near and
//# invalid.
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
