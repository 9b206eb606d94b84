//! Every table and key of the robot file in one place.
//!
//! The parser, the error messages, the template and the key list in the README
//! all read this description, so they cannot drift apart.

mod bounds;
mod motion;
mod scanner;

use bounds::{HOST_DEATH, MEMORY, OBSTACLES, TOLERANCES, ZONE};
use motion::{FOOTPRINT, LIMITS, ROBOT, STEERING, TIMING};
use scanner::{MASK, SCANNER};

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

// The largest values are no limits of any robot: they are where the kernel's integers and
// windows end, or where a number can only be a slip of the unit.
const EDGE: f64 = 2.0;
const SPEED: f64 = 20.0;
const RATE: f64 = 100.0;
const SECONDS: f64 = 10.0;
const TOLERANCE: f64 = 2.0;

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
