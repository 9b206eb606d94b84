//! The faults that the simulator knows: what each is, which assumption it breaks, and where it is shown.
//!
//! `scenarios/FAULTS.md` is this list, written out; a test compares them, and looks for each place named here.

mod list;

pub use list::CATALOGUE;

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
/// The catalogue as `scenarios/FAULTS.md`.
#[must_use]
pub fn table() -> String {
    let mut text = String::from(
        "# Faults\n\n\
         What can go wrong in a scenario, which assumption (`spec/assumptions.md`) that breaks, and where it is shown.\n\
         Where none is broken the kernel must keep its claim; where one is, a contact has a name. `haltline attack`\n\
         draws its faults from this list, and `--break` those that break an assumption.\n\n\
         Written from `scenarios/src/catalogue/list.rs`; a test compares the two\n\
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
