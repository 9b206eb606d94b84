//! Reads the requirements and assumptions out of the Markdown files beside this crate.
//!
//! The files are embedded at build time, so `haltline explain` needs no checkout.

use std::fmt;

/// One family of requirements, one file each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Family {
    /// No accepted tube contains a known point or enters unknown space.
    Guard,
    /// An accepted tube always exists or the robot is at rest.
    Brake,
    /// Every accepted set point lies in the limits and in the dynamic window.
    Limit,
    /// A point in the critical zone starts a stop in the same tick.
    Zone,
    /// No motion on old data.
    Fresh,
    /// Silence means stop.
    Silent,
    /// Stops hold; release never replays an old command.
    Latch,
    /// Bad input is classified, never ignored.
    Input,
    /// A hit is never lost but by rule; unknown is never free.
    Memory,
    /// Work per tick has a declared bound.
    Time,
    /// The marker filter is finite, symmetric positive and gated.
    Ekf,
}

impl Family {
    /// The prefix of the family's ids, for instance `GUARD`.
    #[must_use]
    pub const fn prefix(self) -> &'static str {
        match self {
            Self::Guard => "GUARD",
            Self::Brake => "BRAKE",
            Self::Limit => "LIMIT",
            Self::Zone => "ZONE",
            Self::Fresh => "FRESH",
            Self::Silent => "SILENT",
            Self::Latch => "LATCH",
            Self::Input => "INPUT",
            Self::Memory => "MEMORY",
            Self::Time => "TIME",
            Self::Ekf => "EKF",
        }
    }
}

impl fmt::Display for Family {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.prefix())
    }
}

/// One requirement: a heading with its id and one checkable MUST below it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Requirement {
    /// Bare id, for instance `GUARD-01`.
    pub id: &'static str,
    /// Path from the root of the repository, for instance `spec/guard.md`.
    pub file: &'static str,
    /// Line of the heading, from 1.
    pub line: usize,
    /// The whole text below the heading, without the `Assumes:` lines.
    pub text: String,
    /// The first paragraph, which holds the MUST, as one line.
    pub must: String,
    /// Ids of the assumptions it rests on.
    pub assumes: Vec<&'static str>,
    /// The family it belongs to.
    pub family: Family,
}

/// One assumption of `spec/assumptions.md`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assumption {
    /// Bare id, for instance `A-BRAKE`.
    pub id: &'static str,
    /// Path from the root of the repository.
    pub file: &'static str,
    /// Line of the heading, from 1.
    pub line: usize,
    /// The whole text below the heading, with its run-time check.
    pub text: String,
}

/// Every file of requirements: family, path from the repository root, content.
const FILES: [(Family, &str, &str); 11] = [
    (Family::Guard, "spec/guard.md", include_str!("../guard.md")),
    (Family::Brake, "spec/brake.md", include_str!("../brake.md")),
    (Family::Limit, "spec/limit.md", include_str!("../limit.md")),
    (Family::Zone, "spec/zone.md", include_str!("../zone.md")),
    (Family::Fresh, "spec/fresh.md", include_str!("../fresh.md")),
    (
        Family::Silent,
        "spec/silent.md",
        include_str!("../silent.md"),
    ),
    (Family::Latch, "spec/latch.md", include_str!("../latch.md")),
    (Family::Input, "spec/input.md", include_str!("../input.md")),
    (
        Family::Memory,
        "spec/memory.md",
        include_str!("../memory.md"),
    ),
    (Family::Time, "spec/time.md", include_str!("../time.md")),
    (Family::Ekf, "spec/ekf.md", include_str!("../ekf.md")),
];

const ASSUMPTIONS_FILE: &str = "spec/assumptions.md";
const ASSUMPTIONS: &str = include_str!("../assumptions.md");

/// All requirements, in the order of the files.
#[must_use]
pub fn requirements() -> Vec<Requirement> {
    FILES
        .iter()
        .flat_map(|&(family, file, content)| {
            sections(content)
                .into_iter()
                .map(move |section| section.into_requirement(family, file))
        })
        .collect()
}

/// All assumptions, in the order of the file.
#[must_use]
pub fn assumptions() -> Vec<Assumption> {
    sections(ASSUMPTIONS)
        .into_iter()
        .map(|section| Assumption {
            id: section.id,
            file: ASSUMPTIONS_FILE,
            line: section.line,
            text: section.body.join("\n").trim().to_owned(),
        })
        .collect()
}

/// The requirement with this id; upper or lower case.
#[must_use]
pub fn requirement(id: &str) -> Option<Requirement> {
    requirements()
        .into_iter()
        .find(|found| found.id.eq_ignore_ascii_case(id))
}

/// The assumption with this id; upper or lower case.
#[must_use]
pub fn assumption(id: &str) -> Option<Assumption> {
    assumptions()
        .into_iter()
        .find(|found| found.id.eq_ignore_ascii_case(id))
}

/// What stands below one second-level heading.
struct Section {
    id: &'static str,
    line: usize,
    body: Vec<&'static str>,
}

/// Splits a file at its `## ` headings; what comes before the first belongs to none.
fn sections(content: &'static str) -> Vec<Section> {
    let mut found: Vec<Section> = Vec::new();
    for (index, line) in content.lines().enumerate() {
        if let Some(heading) = line.strip_prefix("## ") {
            found.push(Section {
                id: heading.trim(),
                line: index + 1,
                body: Vec::new(),
            });
        } else if let Some(section) = found.last_mut() {
            section.body.push(line);
        }
    }
    found
}

impl Section {
    fn into_requirement(self, family: Family, file: &'static str) -> Requirement {
        let mut assumes = Vec::new();
        let mut text = Vec::new();
        for line in self.body {
            match line.strip_prefix("Assumes:") {
                Some(list) => assumes.extend(
                    list.split(',')
                        .map(|id| id.trim().trim_end_matches('.'))
                        .filter(|id| !id.is_empty()),
                ),
                None => text.push(line),
            }
        }
        let text = text.join("\n").trim().to_owned();
        let must = text
            .split("\n\n")
            .next()
            .unwrap_or_default()
            .replace('\n', " ");
        Requirement {
            id: self.id,
            file,
            line: self.line,
            text,
            must,
            assumes,
            family,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn ids_are_unique_and_carry_their_family() {
        let all = requirements();
        let ids: HashSet<_> = all.iter().map(|r| r.id).collect();
        assert_eq!(ids.len(), all.len());
        for r in &all {
            let number = r.id.strip_prefix(r.family.prefix()).and_then(|rest| {
                let digits = rest.strip_prefix('-')?;
                (digits.len() == 2)
                    .then(|| digits.parse::<u32>().ok())
                    .flatten()
            });
            assert!(number.is_some(), "{}:{}: odd id {}", r.file, r.line, r.id);
        }
    }

    #[test]
    fn each_requirement_has_exactly_one_must_in_its_first_paragraph() {
        for r in requirements() {
            assert_eq!(r.text.matches("MUST").count(), 1, "{}", r.id);
            assert_eq!(r.must.matches("MUST").count(), 1, "{}", r.id);
            assert!(r.must.ends_with('.'), "{}: {}", r.id, r.must);
        }
    }

    #[test]
    fn every_assumption_named_exists_and_every_one_is_used() {
        let known: HashSet<_> = assumptions().iter().map(|a| a.id).collect();
        let used: HashSet<_> = requirements().into_iter().flat_map(|r| r.assumes).collect();
        assert_eq!(known, used);
    }

    #[test]
    fn every_family_has_requirements_and_lookup_ignores_case() {
        for (family, _, _) in FILES {
            let first = format!("{}-01", family.prefix().to_lowercase());
            assert_eq!(requirement(&first).map(|r| r.family), Some(family));
        }
        assert!(assumption("a-brake").is_some());
        assert!(requirement("GUARD-99").is_none());
    }

    #[test]
    fn lines_point_at_the_headings() {
        let r = requirement("GUARD-01").unwrap();
        let line = include_str!("../guard.md").lines().nth(r.line - 1);
        assert_eq!(line, Some("## GUARD-01"));
    }
}
