//! The certificate in a terminal.

use crate::certificate::Certificate;
use crate::claims::{Claim, Status, first_of_each_case};
use crate::junit;
use crate::measured::{self, Standing};
use crate::proofs::{self, Proofs};
use crate::report::words;
use crate::timing::Timing;
use console::{StyledObject, style};
use haltline_attack::hostile::Hostile;
use haltline_robots::Robot;
use haltline_robots::contract::{Contract, Finding};
use haltline_scenarios::result::{Outcome, SuiteResult};
use std::path::PathBuf;

fn part(name: &str) -> StyledObject<String> {
    style(format!("{name:<11}")).bold()
}

/// Robot and contract, before the runs begin.
pub fn contract(robot: &Robot, contract: &Contract) {
    say!(
        "{}  {}\n",
        style(&robot.name).bold(),
        style(&robot.file).dim()
    );
    let count = |finding| {
        contract
            .checks
            .iter()
            .filter(|c| c.finding == finding)
            .count()
    };
    say!(
        "{}{} hold, {} fail, {} not covered",
        part("contract"),
        words::count(count(Finding::Holds), "check"),
        count(Finding::Fails),
        count(Finding::NotCovered)
    );
    for check in contract
        .checks
        .iter()
        .filter(|c| c.finding != Finding::Holds)
    {
        let mark = match check.finding {
            Finding::Fails => style("fails").red().bold(),
            _ => style("not covered").dim(),
        };
        say!("{:11}{mark} {}: {}", "", check.id, check.sentence);
    }
    say!(
        "{:11}{}",
        "",
        style("obstacles up to    top speed   decides                 smallest gap   decides")
            .dim()
    );
    for (speed, gap) in contract.speed_table.iter().zip(&contract.gap_table) {
        let narrowest = gap
            .gap_m
            .map_or_else(|| "none".to_owned(), |gap| format!("{gap:.2} m"));
        say!(
            "{:11}{:>11.1} m/s {:>8.2} m/s   {:<22} {:>13}   {}",
            "",
            speed.obstacle_speed_mps,
            speed.top_speed_mps,
            speed.decides,
            narrowest,
            gap.decides
        );
    }
}

/// How many checks of the ledger hold.
pub fn proofs(proofs: &Proofs) {
    let holding = proofs
        .checks
        .iter()
        .filter(|proof| proof.finding == proofs::Finding::Holds)
        .count();
    match &proofs.trouble {
        Some(trouble) => say!("{}not checkable: {trouble}", part("proofs")),
        None => say!(
            "{}{holding} of {} hold ({})",
            part("proofs"),
            words::count(proofs.checks.len(), "check"),
            proofs.origin
        ),
    }
}

/// How well tests see the safety core.
pub fn measured(standing: &Standing) {
    for (index, sentence) in measured::sentences(standing).iter().enumerate() {
        let begin = part(if index == 0 { "measured" } else { "" });
        say!("{begin}{sentence}");
    }
}

/// What came out.
pub fn summary(
    certificate: &Certificate,
    suite: &SuiteResult,
    timing: &Timing,
    written: &[PathBuf],
) {
    let as_expected = suite
        .cases
        .iter()
        .filter(|c| c.judgement.outcome == Outcome::Pass)
        .count();
    let naked = suite.cases.iter().filter_map(|c| c.naked.as_ref());
    let touched = naked.clone().filter(|n| !n.contacts.is_empty()).count();
    say!(
        "{}{}, {as_expected} as expected; {}, {touched} touched",
        part("scenarios"),
        words::count(suite.cases.len(), "run"),
        words::count(naked.count(), "naked twin")
    );
    adversary(&certificate.adversary);
    match &timing.tick {
        Some(tick) => say!(
            "{}tick {:.0} us (median), {:.0} us (99 %), {:.0} us (longest of {}) on this machine; not a claim",
            part("timing"),
            tick.median_us,
            tick.p99_us,
            tick.max_us,
            tick.ticks
        ),
        None => say!(
            "{}not measured: the kernel refuses this robot",
            part("timing")
        ),
    }
    say!("");
    print_claims(&certificate.claims);
    for claim in &certificate.claims {
        counterexamples(claim);
    }
    say!("");
    for path in written {
        say!("wrote {}", path.display());
    }
    say!("\n{}", verdict(certificate));
}

/// What attacks on the assumptions came to.
fn adversary(hostile: &Hostile) {
    let [runs, contacts] = hostile.broken_runs();
    say!(
        "{}{} within the assumptions, {} violated a claim; {runs} broke one each, {contacts} touched",
        part("adversary"),
        words::count(usize::try_from(hostile.kept).unwrap_or(usize::MAX), "run"),
        hostile.violations.len()
    );
    let touched = hostile
        .broken
        .iter()
        .filter(|(_, broken)| broken.contacts > 0);
    let touched: Vec<String> = touched
        .map(|(name, broken)| format!("{name} {} of {}", broken.contacts, broken.runs))
        .collect();
    if !touched.is_empty() {
        say!("{:11}contacts with {}", "", touched.join(", "));
    }
}

fn print_claims(claims: &[Claim]) {
    let (unclaimed, made): (Vec<&Claim>, Vec<&Claim>) = claims
        .iter()
        .partition(|claim| claim.status == Status::NotClaimed);
    for claim in made {
        let (id, words) = (&claim.id, &claim.evidence.words);
        say!("  {id:<12} {}  {words}", status(claim.status));
    }
    // What the contract does not cover was said above.
    let names: Vec<&str> = unclaimed
        .iter()
        .map(|claim| claim.id.as_str())
        .filter(|id| !id.starts_with("C-"))
        .collect();
    say!("  {}  {}", style("not claimed yet").dim(), names.join(", "));
}

fn status(status: Status) -> StyledObject<String> {
    let padded = format!("{:<15}", status.words());
    match status {
        Status::Holds => style(padded).green(),
        Status::Failed => style(padded).red().bold(),
        Status::NotCheckable => style(padded).yellow(),
        Status::NotClaimed => style(padded).dim(),
    }
}

fn counterexamples(claim: &Claim) {
    const SHOWN: usize = 5;
    if claim.status != Status::Failed {
        return;
    }
    say!("\n{} does not hold:", style(&claim.id).red().bold());
    let told = first_of_each_case(&claim.counterexamples);
    for (found, again) in told.iter().take(SHOWN) {
        let again = match again {
            0 => String::new(),
            more => format!(" (and {more} more times)"),
        };
        say!("  {}{again}", junit::when(found));
        say!("    {}", found.what);
        say!("    replay: {}", found.replay);
    }
    let more = told.len().saturating_sub(SHOWN);
    if more > 0 {
        say!("  and {} more; see report.html", words::count(more, "run"));
    }
}

fn verdict(certificate: &Certificate) -> StyledObject<String> {
    let verdict = &certificate.verdict;
    match verdict.result {
        "holds" => style("Every claim that is made holds.".to_owned())
            .green()
            .bold(),
        "failed" => style(format!("{} failed.", words::count(verdict.failed, "claim")))
            .red()
            .bold(),
        _ => style(format!(
            "Not checkable: evidence is missing for {}.",
            words::count(verdict.not_checkable, "claim")
        ))
        .yellow()
        .bold(),
    }
}

/// What to do when no scenario is for the robot.
pub fn no_scenario(robot: &str, folder: &str) {
    eprintln!(
        "No scenario in {folder} is for this robot. Scenarios name their robot by the stem of its file: write some \
         with `robot = \"{robot}\"` and give their folder with --scenarios."
    );
}
