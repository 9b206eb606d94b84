//! Families of runs: a wall of small maps.

use super::cases::outcome_chip;
use super::claims::case_anchor;
use super::drawing;
use super::words;
use crate::certificate::{CaseRecord, Certificate};
use crate::picture::svg::{self, escape};
use haltline_scenarios::result::{CaseResult, GroupResult, Outcome, SuiteResult};
use std::fmt::Write as _;

/// Size of a map, pixels.
const THUMB: [f64; 2] = [260.0, 180.0];

/// The section of one sweep.
pub fn write(
    page: &mut String,
    group: &GroupResult,
    suite: &SuiteResult,
    certificate: &Certificate,
) {
    let cases: Vec<&CaseResult> = suite
        .cases
        .iter()
        .filter(|c| c.group == group.group)
        .collect();
    let title = cases
        .first()
        .map_or(group.group.as_str(), |case| case.title.as_str());
    let _ = write!(
        page,
        "<h2 id=\"{}\">{} {}</h2><div class=\"facts\"><span>variants <b>{}</b></span><span>guarded runs that touched \
         while moving <b>{}</b></span><span>naked runs that touched <b>{}</b> (at least {} must)</span></div>",
        case_anchor(&group.group),
        escape(title),
        outcome_chip(group.judgement.outcome),
        group.variants,
        group.guarded_touched,
        group.naked_touched,
        group.naked_required
    );
    for sentence in &group.judgement.sentences {
        let class = match group.judgement.outcome {
            Outcome::Fail => "bad small",
            Outcome::Pass => "soft small",
        };
        let _ = write!(page, "<p class=\"{class}\">{}</p>", escape(sentence));
    }
    if let Some(values) = cases
        .first()
        .and_then(|case| words::robot_values(&case.robot_values))
    {
        let _ = write!(
            page,
            "<p class=\"small\">Not the shipped robot, and evidence for no claim about it: {}</p>",
            escape(&values)
        );
    }
    page.push_str("<div class=\"thumbs\">");
    for case in cases {
        let record = certificate
            .cases
            .iter()
            .find(|record| record.name == case.name);
        thumb(page, case, record);
    }
    page.push_str("</div>\n");
}

fn thumb(page: &mut String, case: &CaseResult, record: Option<&CaseRecord>) {
    let variant = case.name.rsplit('/').next().unwrap_or(&case.name);
    let _ = write!(
        page,
        "<article class=\"card\" id=\"{}\">",
        case_anchor(&case.name)
    );
    if let Some(picture) = drawing::thumbnail(case, THUMB) {
        page.push_str(&svg::element(&picture));
    }
    let failed = case.judgement.outcome == Outcome::Fail;
    let _ = write!(
        page,
        "<div class=\"body\"><b>{}</b> {}<div class=\"soft\">{}</div>",
        escape(variant),
        if failed {
            outcome_chip(Outcome::Fail)
        } else {
            ""
        },
        escape(&words::outcome(case))
    );
    if let Some(record) = record.filter(|_| failed) {
        let sentences = record.sentences.join(" ");
        let _ = write!(
            page,
            "<p class=\"bad\">{}</p><pre>{}</pre>",
            escape(&sentences),
            escape(&record.replay)
        );
    }
    page.push_str("</div></article>");
}
