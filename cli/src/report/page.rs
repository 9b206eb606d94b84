//! `report.html`: one self-contained file, readable on light and dark paper, without scripts.

use super::{cases, claims, contract, proofs, robot, words};
use crate::certificate::Certificate;
use crate::picture::{style, svg, svg::escape};
use haltline_robots::Robot;
use haltline_scenarios::result::SuiteResult;
use std::fmt::Write as _;

const PAGE_CSS: &str = include_str!("page.css");

/// The page.
#[must_use]
pub fn write(certificate: &Certificate, robot: &Robot, suite: &SuiteResult) -> String {
    let mut page = String::new();
    let title = escape(&format!("Haltline certificate: {}", certificate.robot.name));
    let _ = write!(
        page,
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <title>{title}</title>\n<style>\n{PAGE_CSS}{}</style></head>\n<body>\n",
        style::style_sheet()
    );
    page.push_str(
        "<nav><div><b>Haltline</b><a href=\"#claims\">Claims</a><a href=\"#contract\">Contract</a>\
         <a href=\"#proofs\">Proofs</a>\
         <a href=\"#runs\">Runs</a><a href=\"#assumptions\">Assumptions</a>\
         <a href=\"#requirements\">Requirements</a><a href=\"#reproduce\">Reproduce</a></div></nav>\n",
    );
    page.push_str("<header class=\"top\"><div class=\"hero\">");
    banner(&mut page, certificate, suite);
    let _ = write!(
        page,
        "<div class=\"card\">{}</div></div></header>\n<main>\n",
        svg::element(&robot::plan(robot))
    );
    claims::write(&mut page, &certificate.claims);
    contract::write(&mut page, &certificate.contract);
    proofs::write(&mut page, &certificate.proofs);
    proofs::measured(&mut page, &certificate.measured);
    cases::write(&mut page, certificate, suite);
    claims::write_assumptions(&mut page, &certificate.assumptions);
    claims::write_requirements(&mut page);
    reproduce(&mut page, certificate);
    page.push_str("</main>\n<footer>Software alone earns no performance level. What is proved, assumed and not \
         covered is said claim by claim above; nothing here is stronger than its evidence.</footer>\n</body></html>\n");
    page
}

fn banner(page: &mut String, certificate: &Certificate, suite: &SuiteResult) {
    let verdict = &certificate.verdict;
    let sentence = match verdict.result {
        "holds" => "Every claim that is made holds.".to_owned(),
        "failed" => format!("{} failed.", words::count(verdict.failed, "claim")),
        _ => format!(
            "Not checkable: evidence is missing for {}.",
            words::count(verdict.not_checkable, "claim")
        ),
    };
    let runs = suite.cases.len();
    // Runs that break an assumption on purpose say nothing about the claim.
    let kept = || {
        suite
            .cases
            .iter()
            .filter(|c| c.guarded.assumptions_broken.is_empty())
    };
    let broken = runs - kept().count();
    let touched: usize = kept().map(|c| c.guarded.moving_contacts()).sum();
    let naked = suite.cases.iter().filter_map(|c| c.naked.as_ref());
    let hurt = naked.clone().filter(|n| !n.contacts.is_empty()).count();
    let nearest = kept()
        .filter_map(|c| c.guarded.min_clearance_moving_m)
        .min_by(f64::total_cmp)
        .map_or_else(|| "–".to_owned(), words::metres);
    let _ = write!(
        page,
        "<div class=\"banner {}\"><div class=\"soft small\">Navigation safety certificate</div><h1>{}</h1>\
         <div class=\"result\">{}</div><p class=\"soft\">Evidence: simulation with monitors and exact contact \
         geometry; proofs where a claim names them. Attack search is not claimed yet.</p><div class=\"tiles\">",
        verdict.result,
        escape(&certificate.robot.name),
        escape(&sentence)
    );
    let tiles = [
        (verdict.holds.to_string(), "claims hold"),
        (runs.to_string(), "guarded runs"),
        (touched.to_string(), "contacts while moving"),
        (format!("{hurt} / {}", naked.count()), "naked twins touched"),
        (nearest, "nearest while moving"),
        (
            broken.to_string(),
            "runs that break an assumption on purpose (apart)",
        ),
        (verdict.not_claimed.to_string(), "parts not claimed yet"),
    ];
    for (value, label) in tiles {
        let _ = write!(
            page,
            "<div class=\"tile\"><b>{value}</b><span>{label}</span></div>"
        );
    }
    page.push_str("</div></div>");
}

fn reproduce(page: &mut String, certificate: &Certificate) {
    page.push_str("<h2 id=\"reproduce\">Reproduce</h2>\n<div class=\"card\"><div class=\"body\">");
    let _ = write!(
        page,
        "<p>The same inputs give this file byte for byte (wall times are kept apart in <code>timing.json</code>).</p>\
         <pre>haltline certify {}</pre>\
         <p>One run alone, with its picture and its trace: the command stands below each run. \
         Add <code>--naked</code> to drive it without the guard.</p>",
        escape(&certificate.robot.file)
    );
    page.push_str("<div class=\"scroll\"><table><tr><th>input</th><th>SHA-256</th></tr>");
    let mut row = |what: &str, hash: &str| {
        let (what, hash) = (escape(what), escape(hash));
        let _ = write!(
            page,
            "<tr><td>{what}</td><td class=\"mono\">{hash}</td></tr>"
        );
    };
    row(
        &format!("kernel, {} files", certificate.kernel.files.len()),
        &certificate.kernel.sources_sha256,
    );
    row(&certificate.robot.file, &certificate.robot.sha256);
    for file in &certificate.scenario_files {
        row(&file.file, &file.sha256);
    }
    let _ = write!(
        page,
        "</table></div><p class=\"soft small\">haltline {}, schema {}. Every hash, seed and number: \
         <code>certificate.json</code>.</p></div></div>",
        certificate.tool_version, certificate.schema
    );
}
