//! The claims, the assumptions and the requirements of the report.

use super::{proofs, words};
use crate::certificate::AssumptionRecord;
use crate::claims::{Claim, EvidenceKind, Status, first_of_each_case};
use crate::explain;
use crate::junit;
use crate::picture::svg::escape;
use haltline_spec::requirements::requirements;
use std::fmt::Write as _;

/// Name of a status as CSS class.
const fn class(status: Status) -> &'static str {
    match status {
        Status::Holds => "holds",
        Status::Failed => "failed",
        Status::NotCheckable => "not_checkable",
        Status::NotClaimed => "not_claimed",
    }
}

/// Anchor of a case in the page.
#[must_use]
pub fn case_anchor(name: &str) -> String {
    let clean: String = name
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect();
    format!("run-{clean}")
}

/// The section with all claims: failed first, not claimed last.
pub fn write(page: &mut String, claims: &[Claim]) {
    page.push_str(
        "<h2 id=\"claims\">Claims</h2>\n<p class=\"soft\">Each claim is worded as strongly as its evidence and no \
         stronger: <i>tested</i> means that no run spoke against it, not that none could.</p>\n",
    );
    for claim in claims.iter().filter(|claim| claim.status == Status::Failed) {
        card(page, claim);
    }
    page.push_str("<div class=\"claims\">");
    for status in [Status::NotCheckable, Status::Holds, Status::NotClaimed] {
        for claim in claims.iter().filter(|claim| claim.status == status) {
            card(page, claim);
        }
    }
    page.push_str("</div>\n");
}

fn card(page: &mut String, claim: &Claim) {
    let class = class(claim.status);
    let _ = write!(
        page,
        "<div class=\"card claim {class}{wide}\" id=\"claim-{id}\"><div class=\"body\"><div class=\"row\"><h3 class=\"mono\">\
         {id}</h3><span class=\"chip {class}\">{status}</span></div><p>{statement}</p><p class=\"small soft\">{evidence}",
        id = escape(&claim.id),
        wide = if claim.status == Status::Failed {
            " wide"
        } else {
            ""
        },
        status = claim.status.words(),
        statement = escape(&claim.statement),
        evidence = escape(&claim.evidence.words),
    );
    let driven = matches!(
        claim.evidence.kind,
        EvidenceKind::Tested | EvidenceKind::Searched
    );
    if driven && claim.evidence.ticks_checked > 0 {
        let _ = write!(
            page,
            "; {} ticks judged, {} of them with something to say",
            grouped(claim.evidence.ticks_checked),
            grouped(claim.evidence.ticks_engaged)
        );
    }
    if requirements().iter().any(|r| r.family.prefix() == claim.id) {
        let _ = write!(
            page,
            " · <a href=\"#req-{}\">requirements</a>",
            escape(&claim.id)
        );
    }
    page.push_str("</p>");
    counterexamples(page, claim);
    if !claim.cases.is_empty() {
        let _ = write!(
            page,
            "<details><summary>{}</summary>",
            words::count(claim.cases.len(), "run")
        );
        for name in &claim.cases {
            let (anchor, name) = (case_anchor(name), escape(name));
            let _ = write!(page, "<a class=\"small\" href=\"#{anchor}\">{name}</a> ");
        }
        page.push_str("</details>");
    }
    let behind = &claim.evidence.proofs;
    if !behind.is_empty() {
        let count = words::count(behind.len(), "check");
        let _ = write!(page, "<details><summary>{count} of the ledger</summary>");
        for id in behind {
            let (anchor, id) = (proofs::anchor(id), escape(id));
            let _ = write!(page, "<a class=\"small\" href=\"#{anchor}\">{id}</a> ");
        }
        page.push_str("</details>");
    }
    page.push_str("</div></div>\n");
}

fn counterexamples(page: &mut String, claim: &Claim) {
    const SHOWN: usize = 12;
    let told = first_of_each_case(&claim.counterexamples);
    if told.is_empty() {
        return;
    }
    page.push_str("<div class=\"examples\">");
    for (found, again) in told.iter().take(SHOWN) {
        let when = junit::when(found);
        let when = when.strip_prefix(&found.case).unwrap_or_default();
        let again = match again {
            0 => String::new(),
            more => format!(" (and {more} more times)"),
        };
        // A failing check of the contract has its own row; everything else is a run.
        let anchor = if found.case.starts_with("C-") {
            found.case.clone()
        } else if found.case.contains("::") {
            proofs::anchor(&found.case)
        } else {
            case_anchor(&found.case)
        };
        let _ = write!(
            page,
            "<div><p class=\"bad small\"><a href=\"#{anchor}\">{}</a>{when}: {}{again}</p><pre>{}</pre></div>",
            escape(&found.case),
            escape(&found.what),
            escape(&found.replay)
        );
    }
    page.push_str("</div>");
    let more = told.len().saturating_sub(SHOWN);
    if more > 0 {
        let _ = write!(
            page,
            "<p class=\"small soft\">and {} more; see certificate.json</p>",
            words::count(more, "run")
        );
    }
}

/// The section with all assumptions and the runs that broke them on purpose.
pub fn write_assumptions(page: &mut String, assumptions: &[AssumptionRecord]) {
    page.push_str(
        "<h2 id=\"assumptions\">Assumptions</h2>\n<p class=\"soft\">The claims rest on these. Some runs break one on \
         purpose, to see what happens; what they show is not evidence for the claim it carries.</p>\n\
         <div class=\"card scroll\"><table><tr><th>id</th><th>what is assumed</th><th>broken on purpose in</th></tr>",
    );
    for assumption in assumptions {
        let _ = write!(
            page,
            "<tr id=\"{id}\"><td class=\"mono\">{id}</td><td>{text}</td><td class=\"small\">",
            id = escape(&assumption.id),
            text = paragraphs(&assumption.text)
        );
        for name in &assumption.broken_in {
            let (anchor, name) = (case_anchor(name), escape(name));
            let _ = write!(page, "<a href=\"#{anchor}\">{name}</a> ");
        }
        page.push_str("</td></tr>");
    }
    page.push_str("</table></div>\n");
}

/// All requirements with what stands behind each.
pub fn write_requirements(page: &mut String) {
    page.push_str(
        "<h2 id=\"requirements\">Requirements</h2>\n<p class=\"soft\">The texts the kernel is written against. \
         <code>haltline explain ID</code> prints the same in a terminal.</p>\n",
    );
    let all = requirements();
    let mut family = None;
    for found in &all {
        if family != Some(found.family) {
            if family.is_some() {
                page.push_str("</table></div></details>\n");
            }
            family = Some(found.family);
            let prefix = found.family.prefix();
            let count = all.iter().filter(|r| r.family == found.family).count();
            let _ = write!(
                page,
                "<details id=\"req-{prefix}\"><summary><b>{prefix}</b> · {}</summary><div class=\"card scroll\"><table>",
                words::count(count, "requirement")
            );
        }
        let _ = write!(
            page,
            "<tr id=\"{id}\"><td class=\"mono\">{id}</td><td>{must}<div class=\"soft small\">{assumes} {evidence}</div></td></tr>",
            id = escape(found.id),
            must = escape(&found.must),
            assumes = assumes(&found.assumes),
            evidence = escape(&explain::evidence(found).join("; "))
        );
    }
    if family.is_some() {
        page.push_str("</table></div></details>\n");
    }
}

fn assumes(ids: &[&str]) -> String {
    let links: Vec<String> = ids
        .iter()
        .map(|id| format!("<a href=\"#{id}\">{id}</a>", id = escape(id)))
        .collect();
    if links.is_empty() {
        String::new()
    } else {
        format!("Assumes {}.", links.join(", "))
    }
}

/// Paragraphs of a specification text; back-quoted words become code.
fn paragraphs(text: &str) -> String {
    text.split("\n\n")
        .map(|paragraph| {
            let mut code = false;
            let parts: Vec<String> = paragraph
                .split('`')
                .map(|part| {
                    let part = escape(&part.replace('\n', " "));
                    let out = if code {
                        format!("<code>{part}</code>")
                    } else {
                        part
                    };
                    code = !code;
                    out
                })
                .collect();
            format!("<p>{}</p>", parts.concat())
        })
        .collect()
}

/// A count with thin spaces between groups of three digits.
#[must_use]
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_grouped() {
        assert_eq!(grouped(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(grouped(12), "12");
    }

    #[test]
    fn anchors_hold_only_safe_characters() {
        assert_eq!(case_anchor("crossing/t=-1.5 s"), "run-crossing-t--1-5-s");
    }

    #[test]
    fn specification_text_keeps_its_code() {
        assert_eq!(
            paragraphs("a `b<c`\nd\n\ne"),
            "<p>a <code>b&lt;c</code> d</p><p>e</p>"
        );
    }
}
