//! Every table and key of the robot file in one place.
//!
//! The parser, the error messages, the template and the key list in the README
//! all read this description, so they cannot drift apart.

/// What a key's value must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number above zero, at most the bound.
    Positive(f64),
    /// A number from zero to the bound.
    NonNegative(f64),
    /// A number of either sign, its magnitude at most the bound.
    Signed(f64),
    /// A whole number within the bounds.
    Count(u32, u32),
    /// `true` or `false`.
    Flag,
    /// Any non-empty text.
    Text,
    /// One of these words.
    Choice(&'static [&'static str]),
}

impl Kind {
    /// The expected value in words, for messages and the README.
    #[must_use]
    pub fn in_words(&self) -> String {
        match self {
            Self::Positive(max) => format!("a number above 0, at most {max}"),
            Self::NonNegative(max) => format!("a number from 0 to {max}"),
            Self::Signed(max) => format!("a number from -{max} to {max}"),
            Self::Count(min, max) => format!("a whole number from {min} to {max}"),
            Self::Flag => "true or false".to_owned(),
            Self::Text => "a text in quotes".to_owned(),
            Self::Choice(words) => {
                let quoted: Vec<_> = words.iter().map(|word| format!("\"{word}\"")).collect();
                quoted.join(" or ")
            }
        }
    }
}

/// One key of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Name, the unit as its suffix.
    pub name: &'static str,
    /// What its value must be.
    pub kind: Kind,
    /// A plausible value, written as in the file.
    pub example: &'static str,
    /// What it means.
    pub doc: &'static str,
}

/// How often a table occurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occurs {
    /// Exactly once.
    Once,
    /// Once if `robot.kinematics` is `"ackermann"`, never otherwise.
    OnceIfAckermann,
    /// At least once, written `[[name]]`.
    AtLeastOnce,
    /// Any number of times, written `[[name]]`.
    AnyNumber,
}

/// One table of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table {
    /// Name without brackets.
    pub name: &'static str,
    /// How often it occurs.
    pub occurs: Occurs,
    /// What it is about.
    pub doc: &'static str,
    /// Its keys in the order of the template.
    pub keys: &'static [Key],
}

impl Table {
    /// The header line: `[limits]` or `[[scanner]]`.
    #[must_use]
    pub fn header(&self) -> String {
        match self.occurs {
            Occurs::Once | Occurs::OnceIfAckermann => format!("[{}]", self.name),
            Occurs::AtLeastOnce | Occurs::AnyNumber => format!("[[{}]]", self.name),
        }
    }

    /// The key of that name.
    #[must_use]
    pub fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }
}

/// The table of that name.
#[must_use]
pub fn table(name: &str) -> Option<&'static Table> {
    TABLES.iter().find(|table| table.name == name)
}

const fn key(name: &'static str, kind: Kind, example: &'static str, doc: &'static str) -> Key {
    Key {
        name,
        kind,
        example,
        doc,
    }
}

const fn once(name: &'static str, doc: &'static str, keys: &'static [Key]) -> Table {
    Table {
        name,
        occurs: Occurs::Once,
        doc,
        keys,
    }
}

use crate::{BEAMS, SCANNERS};
use Kind::{Choice, Count, Flag, NonNegative, Positive, Signed, Text};

// The largest values below are no limits of any robot: they are where the
// kernel's integers end or where a number can only be a slip of the unit.
const METRES: f64 = 100.0;
const SECONDS: f64 = 60.0;
const RATE: f64 = 100.0;

/// All tables in the order of the template.
pub const TABLES: &[Table] = &[
    once("robot", "The robot as a whole.", ROBOT),
    once(
        "footprint",
        "Outline: a rectangle in the driving plane, distances from the rotation centre \
         (differential: midpoint between the driven wheels; ackermann: midpoint of the rear axle). \
         Everything the robot carries must lie inside.",
        FOOTPRINT,
    ),
    Table {
        name: "steering",
        occurs: Occurs::OnceIfAckermann,
        doc: "Front wheel steering; only with kinematics = \"ackermann\".",
        keys: STEERING,
    },
    once(
        "limits",
        "Speed and acceleration limits of commands, and what the brakes are sure to give.",
        LIMITS,
    ),
    once(
        "timing",
        "Reaction times, and the ages beyond which data are worthless.",
        TIMING,
    ),
    once(
        "tolerances",
        "Bounds of errors; every one is an assumption of the certificate.",
        TOLERANCES,
    ),
    once(
        "zone",
        "Critical zone: a return inside these margins around the footprint stops the robot at once.",
        ZONE,
    ),
    once(
        "memory",
        "What is remembered of bodies and free space out of view.",
        MEMORY,
    ),
    once("obstacles", "What may move around the robot.", OBSTACLES),
    once(
        "host_death",
        "What the drive does by itself when the host falls silent.",
        HOST_DEATH,
    ),
    Table {
        name: "scanner",
        occurs: Occurs::AtLeastOnce,
        doc: "A planar laser scanner, or a scan made from a depth image. Beam 0 is the rightmost \
              beam seen along the scanner's own axis; upside down it becomes the leftmost.",
        keys: SCANNER,
    },
    Table {
        name: "scanner.mask",
        occurs: Occurs::AnyNumber,
        doc: "A rectangle in the body frame (x forward, y left) that holds a part of the robot in \
              the scanner's view; returns inside it are ignored. At most four for each scanner.",
        keys: MASK,
    },
];

const ROBOT: &[Key] = &[
    key("name", Text, "\"My robot\"", "Name in reports."),
    key(
        "kinematics",
        Choice(&["differential", "ackermann"]),
        "\"differential\"",
        "Turns on the spot, or steers its front wheels.",
    ),
];

const FOOTPRINT: &[Key] = &[
    key(
        "front_m",
        NonNegative(METRES),
        "0.60",
        "Rotation centre to the front edge.",
    ),
    key(
        "rear_m",
        NonNegative(METRES),
        "0.60",
        "Rotation centre to the rear edge.",
    ),
    key(
        "left_m",
        NonNegative(METRES),
        "0.42",
        "Rotation centre to the left edge.",
    ),
    key(
        "right_m",
        NonNegative(METRES),
        "0.42",
        "Rotation centre to the right edge.",
    ),
];

const STEERING: &[Key] = &[
    key(
        "wheelbase_m",
        Positive(METRES),
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

const LIMITS: &[Key] = &[
    key(
        "speed_forward_mps",
        Positive(RATE),
        "1.0",
        "Largest forward speed.",
    ),
    key(
        "speed_reverse_mps",
        NonNegative(RATE),
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
        Positive(RATE),
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

const TIMING: &[Key] = &[
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

const TOLERANCES: &[Key] = &[
    key(
        "speed_mps",
        NonNegative(10.0),
        "0.01",
        "Error of measured and of executed speed.",
    ),
    key(
        "angular_speed_radps",
        NonNegative(10.0),
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
        Positive(10.0),
        "0.15",
        "How far the measured speed may leave the hull of recent commands.",
    ),
    key(
        "follow_angular_speed_radps",
        Positive(10.0),
        "0.3",
        "How far the measured turn rate may leave the hull of recent commands.",
    ),
];

const ZONE: &[Key] = &[
    key(
        "front_m",
        NonNegative(10.0),
        "0.050",
        "Margin in front of the front edge.",
    ),
    key(
        "side_m",
        NonNegative(10.0),
        "0.020",
        "Margin at both sides and behind.",
    ),
];

const MEMORY: &[Key] = &[
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
        NonNegative(METRES),
        "1.0",
        "Radius around the rotation centre that the operator vouches for at a reset.",
    ),
    key(
        "skirt_m",
        NonNegative(1.0),
        "0.050",
        "Margin around the resting footprint in which unseen space does not block.",
    ),
    key(
        "body_width_min_m",
        Positive(1.0),
        "0.025",
        "Bodies at least this wide are seen; thinner ones are not claimed.",
    ),
];

const OBSTACLES: &[Key] = &[key(
    "speed_mps",
    NonNegative(10.0),
    "0.0",
    "Largest speed of anything that moves; 0 is a static world. Scenarios and the tables of the \
     certificate set their own.",
)];

const HOST_DEATH: &[Key] = &[
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

const SCANNER: &[Key] = &[
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
        Positive(360.0),
        "270.0",
        "Angle from the first beam to the last.",
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
        NonNegative(SECONDS),
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
        NonNegative(METRES),
        "0.05",
        "Shortest range it measures; anything nearer is an obstacle at this range.",
    ),
    key(
        "range_max_m",
        Positive(METRES),
        "18.0",
        "Longest range it measures.",
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
        NonNegative(METRES),
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

const MASK: &[Key] = &[
    key("x_min_m", Signed(METRES), "-0.10", "Rear edge."),
    key("x_max_m", Signed(METRES), "0.10", "Front edge."),
    key("y_min_m", Signed(METRES), "-0.10", "Right edge."),
    key("y_max_m", Signed(METRES), "0.10", "Left edge."),
];

/// Largest number of scanners in a file.
pub const SCANNERS_MAX: usize = SCANNERS;
