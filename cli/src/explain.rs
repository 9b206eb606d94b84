//! `haltline explain`: a requirement, what it assumes, and what stands behind it.

use crate::failure::{Exit, Failure};
use crate::proofs::{Proof, Proofs};
use crate::provenance;
use console::style;
use haltline_spec::requirements::{
    Assumption, Requirement, assumption, assumptions, requirement, requirements,
};

/// Prints what is known under `id`; without one, a list of everything.
///
/// # Errors
/// The id is unknown; the message names near ones.
pub fn explain(id: Option<&str>) -> Result<Exit, Failure> {
    let Some(id) = id else {
        print_list(&requirements());
        say!("\nAssumptions:");
        for found in assumptions() {
            say!(
                "  {:<14} {}",
                style(found.id).bold(),
                first_line(&found.text)
            );
        }
        return Ok(Exit::Holds);
    };
    if let Some(found) = requirement(id) {
        print_requirement(&found);
    } else if let Some(found) = assumption(id) {
        print_assumption(&found);
    } else {
        let family: Vec<Requirement> = requirements()
            .into_iter()
            .filter(|r| r.family.prefix().eq_ignore_ascii_case(id))
            .collect();
        if family.is_empty() {
            return Err(unknown(id));
        }
        print_list(&family);
    }
    Ok(Exit::Holds)
}

fn first_line(text: &str) -> String {
    text.split("\n\n")
        .next()
        .unwrap_or_default()
        .replace('\n', " ")
}

fn print_list(list: &[Requirement]) {
    let mut family = None;
    for found in list {
        if family != Some(found.family) {
            family = Some(found.family);
            say!("{}", style(found.family.prefix()).bold().underlined());
        }
        say!("  {:<11} {}", style(found.id).bold(), found.must);
    }
}

fn print_requirement(found: &Requirement) {
    say!("{}  {}:{}", style(found.id).bold(), found.file, found.line);
    say!("\n{}\n", found.text);
    say!("{}", style("Assumes").bold());
    if found.assumes.is_empty() {
        say!("  nothing");
    }
    for id in &found.assumes {
        let text = assumption(id).map_or_else(String::new, |a| first_line(&a.text));
        say!("  {id:<14} {text}");
    }
    say!("{}", style("Evidence").bold());
    for line in evidence(found) {
        say!("  {line}");
    }
}

/// What stands behind a requirement, one sentence each; never stronger than what was done.
#[must_use]
pub fn evidence(found: &Requirement) -> Vec<String> {
    let cited = provenance::citations(found.id);
    let mut lines = Vec::new();
    for (is_test, how) in [(false, "implemented at"), (true, "tested at")] {
        let places: Vec<String> = cited
            .iter()
            .filter(|place| place.is_test == is_test)
            .map(|place| format!("{}:{}", place.file, place.line))
            .collect();
        if !places.is_empty() {
            lines.push(format!("{how} {}", places.join(", ")));
        }
    }
    if !cited.iter().any(|place| place.is_test) {
        lines.push("no test cites it".into());
    }
    let family = found.family.prefix();
    if crate::claims::MONITORED.contains(&family) {
        lines.push(format!(
            "family {family} is monitored at every tick of every scenario run; \
             `haltline certify ROBOT` counts the ticks"
        ));
    }
    let proofs = Proofs::of_ledger();
    let about: Vec<String> = proofs
        .checks
        .iter()
        .filter(|proof| proof.requirements.iter().any(|id| id == found.id))
        .map(Proof::line)
        .collect();
    if about.is_empty() {
        lines.push("no machine-checked proof names it".into());
    }
    lines.extend(about);
    lines
}

fn print_assumption(found: &Assumption) {
    say!("{}  {}:{}", style(found.id).bold(), found.file, found.line);
    say!("\n{}\n", found.text);
    let used: Vec<&str> = requirements()
        .iter()
        .filter(|r| r.assumes.contains(&found.id))
        .map(|r| r.id)
        .collect();
    say!("{}\n  {}", style("Used by").bold(), used.join(" "));
}

fn unknown(id: &str) -> Failure {
    let wanted = id.to_uppercase();
    let all: Vec<String> = requirements()
        .iter()
        .map(|r| r.id.to_owned())
        .chain(assumptions().iter().map(|a| a.id.to_owned()))
        .collect();
    let mut near: Vec<(usize, &String)> = all
        .iter()
        .map(|known| (strsim::damerau_levenshtein(&wanted, known), known))
        .filter(|(distance, _)| *distance <= 4)
        .collect();
    near.sort();
    let near: Vec<&str> = near.iter().take(5).map(|(_, id)| id.as_str()).collect();
    let hint = if near.is_empty() {
        "`haltline explain` lists all".to_owned()
    } else {
        format!("did you mean {}?", near.join(", "))
    };
    Failure::input(format!(
        "no requirement or assumption is called `{id}`; {hint}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_near_miss_is_corrected() {
        let failure = explain(Some("GAURD-01")).expect_err("unknown");
        assert_eq!(failure.exit, Exit::BadInput);
        assert!(failure.message.contains("GUARD-01"), "{}", failure.message);
    }

    #[test]
    fn nonsense_gets_the_list() {
        let failure = explain(Some("xyzzyplugh-and-more")).expect_err("unknown");
        assert!(failure.message.contains("lists all"));
    }

    #[test]
    fn only_a_check_of_the_ledger_is_called_proved() {
        let proofs = Proofs::of_ledger();
        for found in requirements() {
            for line in evidence(&found) {
                let named = proofs.checks.iter().any(|proof| line == proof.line());
                assert!(named || !line.contains("proved"), "{line}");
            }
        }
    }
}
