//! The runs of the report: one card each, sweeps as a wall of small maps.

use super::claims::case_anchor;
use super::drawing::{self, Subject};
use super::{sweeps, words};
use crate::certificate::{CaseRecord, Certificate};
use crate::picture::svg::{self, escape};
use haltline_scenarios::result::{CaseResult, Outcome, SuiteResult};
use std::fmt::Write as _;

/// The section with all runs: single scenarios first, then sweeps.
pub fn write(page: &mut String, certificate: &Certificate, suite: &SuiteResult) {
    page.push_str(
        "<h2 id=\"runs\">Runs</h2>\n<p class=\"soft\">Every run was driven twice with the same seed: with the guard, \
         and without it (the naked twin). Contacts are judged by exact geometry at every dynamics step, by code that \
         shares nothing with the kernel.</p>\n",
    );
    wall(page, suite);
    legend(page);
    let in_sweep = |case: &CaseResult| suite.groups.iter().any(|group| group.group == case.group);
    let breaks = |case: &CaseResult| !case.guarded.assumptions_broken.is_empty();
    let single: Vec<&CaseResult> = suite.cases.iter().filter(|case| !in_sweep(case)).collect();
    let (breaking, keeping): (Vec<&CaseResult>, Vec<&CaseResult>) =
        single.into_iter().partition(|case| breaks(case));
    let (other, own): (Vec<&CaseResult>, Vec<&CaseResult>) = keeping
        .into_iter()
        .partition(|case| !case.robot_values.is_empty());
    cards(page, &own, certificate);
    for group in &suite.groups {
        sweeps::write(page, group, suite, certificate);
    }
    if !other.is_empty() {
        page.push_str(
            "<h2>Runs with other values of the robot</h2><p class=\"soft\">Each card says which. They are \
             evidence for no claim about this robot; what a monitor objects to in them counts all the same.</p>",
        );
        cards(page, &other, certificate);
    }
    if !breaking.is_empty() {
        page.push_str(
            "<h2>Runs that break an assumption on purpose</h2><p class=\"soft\">What happens when the world does not \
             keep to the contract. They are evidence for no claim; a contact here is the price of the broken \
             assumption, not a failure of the guard.</p>",
        );
        cards(page, &breaking, certificate);
    }
}

fn cards(page: &mut String, cases: &[&CaseResult], certificate: &Certificate) {
    page.push_str("<div class=\"grid\">");
    for case in cases {
        if let Some(record) = certificate
            .cases
            .iter()
            .find(|record| record.name == case.name)
        {
            card(page, case, record);
        }
    }
    page.push_str("</div>\n");
}

/// One small square for each run, to see at a glance how many there are and which failed.
fn wall(page: &mut String, suite: &SuiteResult) {
    page.push_str("<div class=\"wall\">");
    for case in &suite.cases {
        let class = match (
            case.judgement.outcome,
            case.guarded.assumptions_broken.is_empty(),
        ) {
            (Outcome::Fail, _) => "failed",
            (Outcome::Pass, true) => "holds",
            (Outcome::Pass, false) => "not_checkable",
        };
        let name = escape(&case.name);
        let label = escape(&format!("{}: {}", case.title, words::outcome(case)));
        let _ = write!(
            page,
            "<a class=\"{class}\" href=\"#{}\" title=\"{name} – {label}\" aria-label=\"{name}\"></a>",
            case_anchor(&case.name)
        );
    }
    page.push_str(
        "</div><p class=\"small soft\">One square for each run: green as expected, amber as expected with an \
         assumption broken on purpose, red failed.</p>\n",
    );
}

fn legend(page: &mut String) {
    let entries = [
        ("pass", "path, command passed"),
        ("slow", "slowed by the guard"),
        ("brake", "braked by the guard"),
        ("stop", "protective or emergency stop"),
        ("naked", "naked twin"),
        ("trail", "moving body"),
        ("glass", "what a laser cannot see"),
    ];
    page.push_str("<div class=\"legend\">");
    for (class, label) in entries {
        let _ = write!(
            page,
            "<span><svg class=\"hl\" viewBox=\"0 0 26 12\" aria-hidden=\"true\"><path class=\"{class}\" \
             d=\"M1 6L25 6\"/></svg>{label}</span>"
        );
    }
    page.push_str("<span>⊗ contact: of the naked twin; grey: a body ran into the resting robot; red: while moving</span><span>❶ robot came to rest</span><span>▶ click on a picture to play it</span></div>\n");
}

/// The verdict on a run or a sweep.
#[must_use]
pub fn outcome_chip(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Pass => "<span class=\"chip pass\">as expected</span>",
        Outcome::Fail => "<span class=\"chip fail\">FAILED</span>",
    }
}

fn card(page: &mut String, case: &CaseResult, record: &CaseRecord) {
    let _ = write!(
        page,
        "<article class=\"card\" id=\"{}\">",
        case_anchor(&case.name)
    );
    if let Some(picture) = drawing::full(case, Subject::Guarded) {
        page.push_str(&svg::element(&picture));
    }
    let _ = write!(
        page,
        "<div class=\"body\"><h3>{}</h3><div class=\"row\"><span class=\"soft small mono\">{}</span>",
        escape(&case.title),
        escape(&case.name)
    );
    let mut broken: Vec<&str> = case
        .guarded
        .assumptions_broken
        .iter()
        .map(|b| b.id.as_str())
        .collect();
    broken.dedup();
    for id in broken {
        let _ = write!(
            page,
            "<span class=\"chip broken\">breaks {} on purpose</span>",
            escape(id)
        );
    }
    page.push_str(outcome_chip(case.judgement.outcome));
    page.push_str("</div>");
    facts(page, case);
    stops(page, case);
    failure_or_details(page, case, record);
    page.push_str("</div></article>\n");
}

fn facts(page: &mut String, case: &CaseResult) {
    let run = &case.guarded;
    let end = if run.reached {
        "goal after"
    } else {
        "ended after"
    };
    let mut facts = vec![(end, format!("{:.1} s", run.time_s))];
    if case.obstacle_speed_mps > 0.0 {
        facts.push((
            "obstacles up to",
            format!("{:.1} m/s", case.obstacle_speed_mps),
        ));
    }
    facts.push(("contacts while moving", run.moving_contacts().to_string()));
    if let Some(gap_m) = run.min_clearance_moving_m {
        facts.push(("nearest while moving", words::metres(gap_m)));
    }
    if let Some(navigation) = &run.navigation {
        facts.push(("drives itself", words::navigated(navigation)));
    }
    if let Some(values) = words::robot_values(&case.robot_values) {
        facts.push(("not the shipped robot", values));
    }
    let bumps = run.contacts.len() - run.moving_contacts();
    if bumps > 0 {
        facts.push(("bodies that ran into the resting robot", bumps.to_string()));
    }
    let twin = match case.naked.as_ref().map(|naked| naked.contacts.first()) {
        Some(Some(contact)) => format!("touches {} at {:.1} s", contact.body, contact.t_s),
        Some(None) => "does not touch".to_owned(),
        None => "none".to_owned(),
    };
    facts.push(("naked twin", twin));
    page.push_str("<div class=\"facts\">");
    for (label, value) in facts {
        let _ = write!(page, "<span>{label} <b>{}</b></span>", escape(&value));
    }
    page.push_str("</div>");
}

fn stops(page: &mut String, case: &CaseResult) {
    const SHOWN: usize = 4;
    let stops = &case.guarded.stops;
    if stops.is_empty() {
        return;
    }
    page.push_str("<ol class=\"stops\">");
    for stop in stops.iter().take(SHOWN) {
        let gap = stop.clearance_m.map_or(String::new(), |gap| {
            format!(", {} left", words::metres(gap))
        });
        let _ = write!(
            page,
            "<li>{:.1} s: {}{}</li>",
            stop.t_s,
            escape(&words::why_stopped(&case.guarded, stop)),
            escape(&gap)
        );
    }
    page.push_str("</ol>");
    if stops.len() > SHOWN {
        let _ = write!(
            page,
            "<p class=\"small soft\">{} stops in all</p>",
            stops.len()
        );
    }
}

fn failure_or_details(page: &mut String, case: &CaseResult, record: &CaseRecord) {
    let failed = case.judgement.outcome == Outcome::Fail;
    if failed {
        for sentence in &case.judgement.sentences {
            let _ = write!(page, "<p class=\"bad small\">{}</p>", escape(sentence));
        }
        let _ = write!(page, "<pre>{}</pre>", escape(&record.replay));
        return;
    }
    page.push_str("<details><summary>verdict, monitors, replay</summary>");
    for sentence in &case.judgement.sentences {
        let _ = write!(page, "<p class=\"small\">{}</p>", escape(sentence));
    }
    if let Some(reason) = &case.naked_reason {
        let _ = write!(
            page,
            "<p class=\"small\">No naked twin: {}</p>",
            escape(reason)
        );
    }
    for broken in &case.guarded.assumptions_broken {
        let (id, what) = (escape(&broken.id), escape(&broken.what));
        let _ = write!(
            page,
            "<p class=\"small\">Breaks <a href=\"#{id}\">{id}</a> on purpose: {what}</p>"
        );
    }
    page.push_str("<p class=\"small soft\">");
    for monitor in &case.guarded.monitors {
        let _ = write!(
            page,
            "<a href=\"#claim-{id}\">{id}</a> {} / {} ticks · ",
            monitor.engaged,
            monitor.checked,
            id = escape(&monitor.id)
        );
    }
    let _ = write!(
        page,
        "seed {}</p><pre>{}</pre></details>",
        case.seed,
        escape(&record.replay)
    );
}
