//! The faults that the simulator knows: what each is, which assumption it breaks, and where it is shown.
//!
//! `scenarios/FAULTS.md` is this list, written out; a test compares them, and looks for each place named here.

use core::fmt::Write as _;

use crate::file::fault::FaultKind as F;

/// How a scenario asks for a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// By a `[[fault]]` of this kind.
    Kind(F),
    /// By a key, or by what stands in the world.
    Key(&'static str),
    /// Not at all: markers are no part of scenario files.
    Markers,
}

/// A fault.
#[derive(Clone, Copy, Debug)]
pub struct Fault {
    /// What it befalls.
    pub part: &'static str,
    /// What goes wrong.
    pub what: &'static str,
    /// How a scenario asks for it.
    pub how: How,
    /// The assumption it breaks; none: the kernel must cope with it.
    pub breaks: Option<&'static str>,
    /// A scenario in `scenarios/files`, or `file::test`.
    pub shown: &'static str,
}

const fn fault(
    part: &'static str,
    what: &'static str,
    kind: F,
    breaks: Option<&'static str>,
    shown: &'static str,
) -> Fault {
    Fault {
        part,
        what,
        how: How::Kind(kind),
        breaks,
        shown,
    }
}

const fn keyed(
    part: &'static str,
    what: &'static str,
    key: &'static str,
    breaks: Option<&'static str>,
    shown: &'static str,
) -> Fault {
    Fault {
        part,
        what,
        how: How::Key(key),
        breaks,
        shown,
    }
}

const fn marker(what: &'static str, shown: &'static str) -> Fault {
    Fault {
        part: "markers",
        what,
        how: How::Markers,
        breaks: None,
        shown,
    }
}

const SENSOR: Option<&str> = Some("A-SENSOR");
const CLOCK: Option<&str> = Some("A-CLOCK");
const ODOMETRY: Option<&str> = Some("A-ODOMETRY");

/// All of them.
pub const CATALOGUE: &[Fault] = &[
    fault("sensor", "NaN", F::RangesNan, None, "input_ranges_nan"),
    fault(
        "sensor",
        "infinity",
        F::RangesInfinite,
        None,
        "input_ranges_infinite",
    ),
    fault("sensor", "zero", F::RangesZero, None, "input_ranges_zero"),
    fault(
        "sensor",
        "negative",
        F::RangesNegative,
        None,
        "input_ranges_negative",
    ),
    fault(
        "sensor",
        "infinity that means no return",
        F::RangesInfinite,
        Some("A-NORETURN"),
        "jackal_all_infinite",
    ),
    fault(
        "sensor",
        "no return where a body is",
        F::BeamsLost,
        Some("A-NORETURN"),
        "jackal_beams_lost",
    ),
    fault(
        "sensor",
        "the same, where it says nothing",
        F::BeamsLost,
        None,
        "input_beams_lost",
    ),
    fault(
        "sensor",
        "saturated",
        F::RangesSaturated,
        SENSOR,
        "input_ranges_saturated",
    ),
    fault(
        "sensor",
        "quantised",
        F::RangesQuantised,
        SENSOR,
        "input_ranges_quantised",
    ),
    fault(
        "sensor",
        "scaled",
        F::RangesScaled,
        SENSOR,
        "input_ranges_scaled",
    ),
    fault(
        "sensor",
        "a lost sector",
        F::SectorLost,
        None,
        "input_sector_lost",
    ),
    fault(
        "sensor",
        "spoofed near points",
        F::SectorSpoofed,
        SENSOR,
        "input_spoof_near",
    ),
    fault(
        "sensor",
        "spoofed far points",
        F::SectorSpoofed,
        SENSOR,
        "input_spoof_far",
    ),
    fault(
        "sensor",
        "mirrored",
        F::ScanMirrored,
        SENSOR,
        "input_scan_mirrored",
    ),
    fault(
        "sensor",
        "rotated",
        F::ScanRotated,
        SENSOR,
        "input_scan_rotated",
    ),
    fault(
        "sensor",
        "duplicated",
        F::ScanDuplicated,
        None,
        "input_scan_duplicated",
    ),
    fault(
        "sensor",
        "missing",
        F::ScanMissing,
        None,
        "input_scan_missing",
    ),
    fault(
        "sensor",
        "frozen",
        F::ScanFrozen,
        SENSOR,
        "input_scan_frozen",
    ),
    fault(
        "sensor",
        "too few beams",
        F::ScanShort,
        None,
        "input_scan_short",
    ),
    fault("sensor", "delayed", F::ScanLate, None, "input_scan_late"),
    fault(
        "sensor",
        "reordered",
        F::ScanReordered,
        None,
        "input_scan_reordered",
    ),
    keyed(
        "sensor",
        "beams lost at random",
        "dropout_fraction",
        None,
        "input_dropouts",
    ),
    keyed(
        "sensor",
        "reads too short",
        "bias_m",
        None,
        "input_bias_short",
    ),
    keyed(
        "sensor",
        "thin legs, as thin as assumed",
        "radius_m",
        None,
        "chair_legs",
    ),
    keyed(
        "sensor",
        "a wire thinner than assumed",
        "radius_m",
        Some("A-WIDTH"),
        "broken_thin_wire",
    ),
    keyed(
        "sensor",
        "glass",
        "material",
        Some("A-VISIBLE"),
        "broken_glass",
    ),
    fault(
        "time",
        "stamps in the future",
        F::ScanFuture,
        CLOCK,
        "input_scan_future",
    ),
    fault(
        "time",
        "stamps in the past (skew)",
        F::ScanPast,
        CLOCK,
        "input_scan_past",
    ),
    fault(
        "time",
        "stamps jitter",
        F::ScanJitter,
        CLOCK,
        "input_scan_jitter",
    ),
    fault(
        "time",
        "stamps wrap at 32 bits",
        F::ScanWrapped,
        CLOCK,
        "input_scan_wrapped",
    ),
    fault(
        "time",
        "odometry from the future",
        F::OdometryFuture,
        CLOCK,
        "input_odometry_future",
    ),
    fault(
        "time",
        "commands from the future",
        F::CommandFuture,
        CLOCK,
        "input_command_future",
    ),
    fault(
        "time",
        "the clock jumps back",
        F::ClockBackwards,
        CLOCK,
        "input_clock_backwards",
    ),
    fault(
        "time",
        "the clock jumps ahead",
        F::ClockForwards,
        CLOCK,
        "input_clock_forwards",
    ),
    fault(
        "time",
        "ticks jitter",
        F::HostJitter,
        None,
        "input_host_jitter",
    ),
    fault(
        "time",
        "the host pauses",
        F::HostPause,
        None,
        "input_host_pause",
    ),
    fault(
        "time",
        "the host dies",
        F::HostDeath,
        Some("A-WATCHDOG"),
        "host_death_uncovered",
    ),
    fault(
        "odometry",
        "missing",
        F::OdometryMissing,
        None,
        "input_odometry_missing",
    ),
    fault(
        "odometry",
        "NaN",
        F::OdometryNan,
        None,
        "input_odometry_nan",
    ),
    fault(
        "odometry",
        "jump",
        F::OdometryJump,
        ODOMETRY,
        "input_odometry_jump",
    ),
    fault(
        "odometry",
        "wrong sign",
        F::OdometrySign,
        ODOMETRY,
        "input_odometry_sign",
    ),
    fault(
        "odometry",
        "frozen",
        F::OdometryFrozen,
        ODOMETRY,
        "input_odometry_frozen",
    ),
    fault(
        "odometry",
        "wrong scale",
        F::OdometryScaled,
        ODOMETRY,
        "input_odometry_scaled",
    ),
    fault(
        "odometry",
        "reordered",
        F::OdometryReordered,
        None,
        "input_odometry_reordered",
    ),
    keyed("odometry", "slip", "slip", ODOMETRY, "broken_slip"),
    marker(
        "an ambiguous square is flipped",
        "pilots/tests/experiments.rs::field_test_with_outliers_and_slip",
    ),
    marker(
        "wrong id",
        "pilots/tests/experiments.rs::the_field_test_is_hostile",
    ),
    marker(
        "duplicate id",
        "kernel/src/marker/tests/behaviour.rs::the_gate_decides_between_duplicates",
    ),
    marker(
        "a marker was moved",
        "kernel/src/marker/tests/behaviour.rs::a_marker_that_was_moved_goes_and_comes_back",
    ),
    fault("command", "NaN", F::CommandNan, None, "input_command_nan"),
    fault(
        "command",
        "missing",
        F::CommandMissing,
        None,
        "input_command_missing",
    ),
    fault(
        "command",
        "late",
        F::CommandLate,
        None,
        "input_command_late",
    ),
    fault(
        "command",
        "reordered",
        F::CommandReordered,
        None,
        "input_command_reordered",
    ),
    keyed(
        "drive",
        "weak brake",
        "braking_mps2",
        Some("A-BRAKE"),
        "broken_brakes",
    ),
    keyed("drive", "lag", "lag_s", Some("A-LATENCY"), "broken_lag"),
    keyed(
        "drive",
        "dead time",
        "latency_s",
        Some("A-LATENCY"),
        "broken_latency",
    ),
    keyed("drive", "skid", "skid", Some("A-TRACKING"), "broken_skid"),
    keyed(
        "drive",
        "ramps of its own",
        "separate_ramps",
        Some("A-FOLLOW"),
        "broken_ramps",
    ),
    fault(
        "drive",
        "stuck command",
        F::DriveStuck,
        Some("A-LATENCY"),
        "broken_stuck_drive",
    ),
    fault(
        "drive",
        "ignored stop",
        F::DriveIgnoresStop,
        Some("A-BRAKE"),
        "broken_ignored_stop",
    ),
    keyed(
        "world",
        "a runner faster than the bound",
        "velocity_mps",
        Some("A-OBSTACLE"),
        "broken_fast_object",
    ),
    keyed(
        "world",
        "somebody from behind",
        "velocity_mps",
        None,
        "runner_from_behind",
    ),
    keyed("world", "a closing door", "turn_radps", None, "door_closes"),
    keyed(
        "world",
        "a door hides a runner",
        "velocity_mps",
        None,
        "crossing_hidden",
    ),
    keyed("world", "hit at rest", "velocity_mps", None, "hit_at_rest"),
];

/// The catalogue as `scenarios/FAULTS.md`.
#[must_use]
pub fn table() -> String {
    let mut text = String::from(
        "# Faults\n\n\
         What can go wrong in a scenario, which assumption (`spec/assumptions.md`) that breaks, and where it is shown.\n\
         Where none is broken the kernel must keep its claim; where one is, a contact has a name. `haltline attack`\n\
         draws its faults from this list, and `--break` those that break an assumption.\n\n\
         Written from `scenarios/src/catalogue.rs`; a test compares the two\n\
         (`UPDATE_FAULTS=1 cargo test -p haltline-scenarios --test catalogue` writes it again).\n\n\
         | befalls | fault | in a scenario | breaks | shown by |\n|---|---|---|---|---|\n",
    );
    for fault in CATALOGUE {
        let how = match fault.how {
            How::Kind(kind) => format!("`kind = \"{}\"`", kind.name()),
            How::Key(key) => format!("`{key}`"),
            How::Markers => "tests only".to_owned(),
        };
        let breaks = fault.breaks.unwrap_or("-");
        let shown = if fault.shown.contains("::") {
            format!("`{}`", fault.shown)
        } else {
            format!("[{0}](files/{0}.toml)", fault.shown)
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} | {how} | {breaks} | {shown} |",
            fault.part, fault.what
        );
    }
    text
}
