//! The proofs of the report: requirement → code → proof, one row for each check of the ledger.

use crate::measured::{self, Standing};
use crate::picture::svg::escape;
use crate::proofs::{Finding, Proof, Proofs};
use std::fmt::Write as _;

/// Anchor of a check in the page.
#[must_use]
pub fn anchor(id: &str) -> String {
    format!("proof-{}", id.replace("::", "-"))
}

/// The section with all checks.
pub fn write(page: &mut String, proofs: &Proofs) {
    page.push_str(
        "<h2 id=\"proofs\">Proofs</h2>\n<p class=\"soft\"><i>Proved</i>: model checking of the compiled function, \
         bit by bit, within the bounds stated. <i>Enumerated</i>: every case of the domain stated. <i>Lemma</i>: \
         mathematics, not code. Each has a false twin, the same with one thing wrong, that fails.",
    );
    if let Some(trouble) = &proofs.trouble {
        let _ = write!(page, "</p><p class=\"bad\">{}</p>", escape(trouble));
        return;
    }
    let _ = write!(
        page,
        " {}</p>\n<details><summary>{} checks</summary><div class=\"card scroll\"><table><tr><th>check</th><th>shows</th>\
         <th>requirements</th><th>code</th><th>bounds</th></tr>",
        match proofs.origin {
            "ledger" =>
                "From the ledger, which speaks of exactly these sources; nothing was run again.",
            _ => "All were run again for this certificate.",
        },
        proofs.checks.len()
    );
    for proof in &proofs.checks {
        row(page, proof);
    }
    page.push_str("</table></div></details>\n");
}

/// Coverage and mutants of the safety core.
pub fn measured(page: &mut String, standing: &Standing) {
    page.push_str("<h3>What tests see of the safety core</h3>\n<p class=\"soft\">Figures, no evidence: no claim rests on them.</p><ul>");
    for sentence in measured::sentences(standing) {
        let _ = write!(page, "<li>{}</li>", escape(&sentence));
    }
    page.push_str("</ul>\n");
}

fn row(page: &mut String, proof: &Proof) {
    let requirements: Vec<String> = proof
        .requirements
        .iter()
        .map(|id| {
            let id = escape(id);
            format!("<a href=\"#{id}\">{id}</a>")
        })
        .collect();
    let words = if proof.finding == Finding::Holds {
        proof.means.clone()
    } else {
        proof.finding.words().to_owned()
    };
    let sources: Vec<String> = proof.sources.iter().map(|file| escape(file)).collect();
    let _ = write!(
        page,
        "<tr id=\"{anchor}\"><td class=\"mono\">{id}<div class=\"soft small\">{place}</div></td>\
         <td><b>{words}</b>: {claim}<div class=\"soft small\">{twin}</div></td><td class=\"mono\">{requirements}</td>\
         <td class=\"mono small\">{sources}</td><td class=\"small\">{bounds}</td></tr>",
        anchor = anchor(&proof.id),
        id = escape(&proof.id),
        place = escape(&proof.place),
        words = escape(&words),
        claim = escape(&proof.claim),
        twin = escape(&proof.twin),
        requirements = requirements.join(" "),
        sources = sources.join("<br>"),
        bounds = escape(&proof.bounds),
    );
}
