//! The keys of the robot itself: outline, steering, limits, times.

use super::Kind::{Choice, Flag, NonNegative, Positive, Text};
use super::{EDGE, Key, RATE, SECONDS, SPEED, key};

pub(super) const ROBOT: &[Key] = &[
    key("name", Text, "\"My robot\"", "Name in reports."),
    key(
        "kinematics",
        Choice(&["differential", "ackermann"]),
        "\"differential\"",
        "Turns on the spot, or steers its front wheels.",
    ),
];

pub(super) const FOOTPRINT: &[Key] = &[
    key(
        "front_m",
        NonNegative(EDGE),
        "0.60",
        "Rotation centre to the front edge.",
    ),
    key(
        "rear_m",
        NonNegative(EDGE),
        "0.60",
        "Rotation centre to the rear edge.",
    ),
    key(
        "left_m",
        NonNegative(EDGE),
        "0.42",
        "Rotation centre to the left edge.",
    ),
    key(
        "right_m",
        NonNegative(EDGE),
        "0.42",
        "Rotation centre to the right edge.",
    ),
];

pub(super) const STEERING: &[Key] = &[
    key(
        "wheelbase_m",
        Positive(EDGE),
        "0.25",
        "Rear axle to front axle.",
    ),
    key(
        "turning_radius_m",
        Positive(1000.0),
        "1.0",
        "Least radius of the path of the rear axle's midpoint.",
    ),
    key(
        "sweep_s",
        NonNegative(SECONDS),
        "0.6",
        "Longest time the wheels need from one stop to the other.",
    ),
    key(
        "tolerance_deg",
        NonNegative(30.0),
        "1.0",
        "Error of the wheel angle, play included.",
    ),
];

pub(super) const LIMITS: &[Key] = &[
    key(
        "speed_forward_mps",
        Positive(SPEED),
        "1.0",
        "Largest forward speed.",
    ),
    key(
        "speed_reverse_mps",
        NonNegative(SPEED),
        "0.0",
        "Largest reverse speed as a magnitude; 0 forbids reverse.",
    ),
    key(
        "reverse_into_memory",
        Flag,
        "false",
        "Allows reverse although no scanner sees the rear: only into space remembered as free.",
    ),
    key(
        "angular_speed_radps",
        Positive(SPEED),
        "1.4",
        "Largest turn rate.",
    ),
    key(
        "acceleration_mps2",
        Positive(RATE),
        "0.5",
        "Largest acceleration of a command.",
    ),
    key(
        "braking_mps2",
        Positive(RATE),
        "0.5",
        "Least deceleration the brakes are sure to give on this floor with this load.",
    ),
    key(
        "angular_acceleration_radps2",
        Positive(RATE),
        "1.0",
        "Largest angular acceleration of a command.",
    ),
    key(
        "angular_braking_radps2",
        Positive(RATE),
        "1.0",
        "Least angular deceleration the brakes are sure to give.",
    ),
    key(
        "ramps",
        Choice(&["together", "separate"]),
        "\"together\"",
        "Whether the drive keeps the ratio of speed and turn rate between two commands, or ramps \
         each by itself.",
    ),
];

pub(super) const TIMING: &[Key] = &[
    key("period_s", Positive(SECONDS), "0.040", "Control period."),
    key(
        "jitter_s",
        NonNegative(SECONDS),
        "0.002",
        "How much later than one period a tick may come; later counts as a pause of the host.",
    ),
    key(
        "actuation_latency_s",
        NonNegative(SECONDS),
        "0.100",
        "Longest time from a decision to its effect at the wheels.",
    ),
    key(
        "scan_age_max_s",
        Positive(SECONDS),
        "0.060",
        "Oldest usable scan, counted from its first beam.",
    ),
    key(
        "odometry_age_max_s",
        Positive(SECONDS),
        "0.100",
        "Oldest usable odometry.",
    ),
    key(
        "command_age_max_s",
        Positive(SECONDS),
        "0.200",
        "Oldest usable command.",
    ),
    key(
        "rest_s",
        NonNegative(SECONDS),
        "0.2",
        "How long the measured twist must be near zero to count as rest.",
    ),
    key(
        "clear_s",
        NonNegative(SECONDS),
        "0.5",
        "How long a hazard must be gone before a protective stop releases.",
    ),
    key(
        "tracking_window_s",
        Positive(SECONDS),
        "0.4",
        "Window of recent commands that the measured twist must have followed.",
    ),
];
