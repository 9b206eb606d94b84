//! The keys of scanners and their self-masks.

use super::Kind::{Choice, Count, Flag, NonNegative, Positive, Signed, Text};
use super::{EDGE, Key, key};

/// Positions of a scanner; where it may stand follows from the footprint.
const METRES: f64 = 100.0;

/// Ranges are kept in 16 bits of millimetres.
const RANGE: f64 = 65.0;
use crate::BEAMS;

pub(super) const SCANNER: &[Key] = &[
    key("name", Text, "\"front laser\"", "Name in reports."),
    key(
        "x_m",
        Signed(METRES),
        "0.527",
        "Position in the body frame, forward.",
    ),
    key(
        "y_m",
        Signed(METRES),
        "0.0",
        "Position in the body frame, left.",
    ),
    key(
        "yaw_deg",
        Signed(360.0),
        "0.0",
        "Direction of the middle of the field of view, counter-clockwise from straight ahead.",
    ),
    key(
        "field_of_view_deg",
        Positive(359.9),
        "270.0",
        "Angle from the first beam to the last; a full turn of n beams has 360 - 360/n.",
    ),
    key(
        "upside_down",
        Flag,
        "false",
        "Mounted upside down: beams run clockwise seen from above.",
    ),
    key(
        "beams",
        Count(2, BEAMS as u32),
        "541",
        "Number of beams of one scan.",
    ),
    key(
        "scan_time_s",
        NonNegative(1.0),
        "0.015",
        "Time from the first beam to the last.",
    ),
    key("rate_hz", Positive(1000.0), "50.0", "Scans each second."),
    key(
        "encoding",
        Choice(&["rep117", "zero_is_none", "zero_is_invalid"]),
        "\"zero_is_invalid\"",
        "How \"no return\" and its like are written. rep117: +inf none, -inf too near, NaN \
         invalid; else what a range of 0 means. \"No return\" may count as free space: choose \
         it only if the scanner tells it apart from a lost measurement.",
    ),
    key(
        "range_min_m",
        NonNegative(10.0),
        "0.05",
        "Shortest range it measures; anything nearer is an obstacle at this range.",
    ),
    key(
        "range_max_m",
        Positive(RANGE),
        "18.0",
        "Longest range it measures; a longer return counts as none.",
    ),
    key(
        "error_systematic_m",
        NonNegative(1.0),
        "0.030",
        "Systematic error of a measured range. With three times the next it is the error bound.",
    ),
    key(
        "error_sigma_m",
        NonNegative(1.0),
        "0.012",
        "Standard deviation of a measured range.",
    ),
    key(
        "no_return_clear_m",
        NonNegative(RANGE),
        "0.0",
        "Up to this range a beam without return is taken as free; a printed assumption.",
    ),
    key(
        "invalid_fraction_max",
        NonNegative(1.0),
        "0.2",
        "More invalid beams than this part stop the robot.",
    ),
    key(
        "invalid_gap_max_deg",
        NonNegative(360.0),
        "10.0",
        "A wider run of neighbouring invalid beams stops the robot.",
    ),
];

pub(super) const MASK: &[Key] = &[
    key("x_min_m", Signed(EDGE), "-0.10", "Rear edge."),
    key("x_max_m", Signed(EDGE), "0.10", "Front edge."),
    key("y_min_m", Signed(EDGE), "-0.10", "Right edge."),
    key("y_max_m", Signed(EDGE), "0.10", "Left edge."),
];
