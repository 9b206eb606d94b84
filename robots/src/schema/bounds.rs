//! The keys of what is assumed and allowed: tolerances, zone, memory, obstacles, silence.

use super::Kind::{Choice, Count, Flag, NonNegative, Positive};
use super::{EDGE, Key, RATE, SECONDS, TOLERANCE, key};

pub(super) const TOLERANCES: &[Key] = &[
    key(
        "speed_mps",
        NonNegative(TOLERANCE),
        "0.01",
        "Error of measured and of executed speed.",
    ),
    key(
        "angular_speed_radps",
        NonNegative(TOLERANCE),
        "0.01",
        "Error of measured and of executed turn rate.",
    ),
    key(
        "tracking_m",
        NonNegative(1.0),
        "0.020",
        "Distance of the drive from the commanded arc.",
    ),
    key(
        "odometry_m_per_m",
        NonNegative(1.0),
        "0.005",
        "Odometry position error for each metre driven; bounds also the drift of remembered points.",
    ),
    key(
        "odometry_rad_per_rad",
        NonNegative(1.0),
        "0.01",
        "Odometry heading error for each radian turned; bounds also the drift of remembered points.",
    ),
    key(
        "rest_speed_mps",
        Positive(1.0),
        "0.005",
        "Speed below which the robot counts as resting.",
    ),
    key(
        "rest_angular_speed_radps",
        Positive(1.0),
        "0.005",
        "Turn rate below which the robot counts as resting.",
    ),
    key(
        "follow_speed_mps",
        Positive(TOLERANCE),
        "0.15",
        "How far the measured speed may leave the hull of recent commands.",
    ),
    key(
        "follow_angular_speed_radps",
        Positive(TOLERANCE),
        "0.3",
        "How far the measured turn rate may leave the hull of recent commands.",
    ),
];

pub(super) const ZONE: &[Key] = &[
    key(
        "front_m",
        NonNegative(EDGE),
        "0.050",
        "Margin in front of the front edge.",
    ),
    key(
        "side_m",
        NonNegative(EDGE),
        "0.020",
        "Margin at both sides and behind.",
    ),
];

pub(super) const MEMORY: &[Key] = &[
    key(
        "clear_after_scans",
        Count(1, 255),
        "3",
        "Consecutive scans that must look past a remembered point before it is forgotten.",
    ),
    key(
        "age_max_s",
        Positive(3600.0),
        "30.0",
        "Age at which remembered points and free space become unknown.",
    ),
    key(
        "clear_at_start_m",
        NonNegative(10.0),
        "1.0",
        "Radius around the rotation centre that the operator vouches for at a reset.",
    ),
    key(
        "skirt_m",
        NonNegative(1.0),
        "0.050",
        "Margin around the footprint that the operator vouches for at a reset, beyond the disc.",
    ),
    key(
        "body_width_min_m",
        Positive(1.0),
        "0.025",
        "Bodies at least this wide are seen; thinner ones are not claimed.",
    ),
];

pub(super) const OBSTACLES: &[Key] = &[key(
    "speed_mps",
    NonNegative(10.0),
    "0.0",
    "Largest speed of anything that moves; 0 is a static world. Scenarios and the tables of the \
     certificate set their own.",
)];

pub(super) const HOST_DEATH: &[Key] = &[
    key(
        "watchdog_s",
        Positive(SECONDS),
        "2.0",
        "Time until the drive notices the silence.",
    ),
    key(
        "behaviour",
        Choice(&["coast", "brake"]),
        "\"coast\"",
        "What the drive does then. Unless it was measured to brake, it coasts.",
    ),
    key(
        "braking_mps2",
        Positive(RATE),
        "0.3",
        "Least deceleration of the silent drive.",
    ),
    key(
        "angular_braking_radps2",
        Positive(RATE),
        "0.5",
        "Least angular deceleration of the silent drive.",
    ),
    key(
        "cover_host_death",
        Flag,
        "false",
        "Whether the guard keeps room for it. If false, the certificate says: host failure: not covered.",
    ),
];
