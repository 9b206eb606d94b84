//! Failed claims as SARIF 2.1.0, for code scanning; no time stamps, so the same inputs give the same bytes.

use crate::certificate::Certificate;
use crate::claims::{Claim, Counterexample, Status, first_of_each_case};
use crate::junit;
use haltline_spec::requirements::requirements;
use serde_json::{Value, json};

/// The document, with one result for each case that spoke against a claim.
///
/// # Errors
/// The document cannot be serialised.
pub fn write(certificate: &Certificate) -> Result<Vec<u8>, serde_json::Error> {
    let failed: Vec<&Claim> = certificate
        .claims
        .iter()
        .filter(|claim| claim.status == Status::Failed)
        .collect();
    let rules: Vec<Value> = failed
        .iter()
        .map(|claim| json!({ "id": claim.id, "shortDescription": { "text": claim.statement } }))
        .collect();
    let results: Vec<Value> = failed
        .iter()
        .flat_map(|claim| results_of(certificate, claim))
        .collect();
    let mut bytes = serde_json::to_vec_pretty(&json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "haltline",
                "version": certificate.tool_version,
                "rules": rules,
            } },
            "results": results,
        }],
    }))?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// A failed claim always has a result, even where nobody wrote down what spoke against it.
fn results_of(certificate: &Certificate, claim: &Claim) -> Vec<Value> {
    let told = first_of_each_case(&claim.counterexamples);
    if told.is_empty() {
        let place = place_of(certificate, claim, "");
        return vec![result(
            claim,
            &format!("{} does not hold.", claim.id),
            place,
        )];
    }
    told.into_iter()
        .map(|(found, again)| {
            let text = sentence(found, again);
            result(claim, &text, place_of(certificate, claim, &found.case))
        })
        .collect()
}

fn sentence(found: &Counterexample, again: usize) -> String {
    let again = match again {
        0 => String::new(),
        more => format!(" (and {more} more times)"),
    };
    format!(
        "{}{again}: {} Replay: {}",
        junit::when(found),
        found.what,
        found.replay
    )
}

fn result(claim: &Claim, text: &str, (file, line): (String, usize)) -> Value {
    json!({
        "ruleId": claim.id,
        "level": "error",
        "message": { "text": text },
        "locations": [{ "physicalLocation": {
            "artifactLocation": { "uri": uri(&file) },
            "region": { "startLine": line },
        } }],
    })
}

/// The file to look at: of a proof its harness, of a requirement its text, else the robot file.
fn place_of(certificate: &Certificate, claim: &Claim, case: &str) -> (String, usize) {
    let proof = certificate.proofs.checks.iter().find(|p| p.id == case);
    if let Some((file, line)) = proof.and_then(|proof| proof.place.rsplit_once(':')) {
        return (file.to_owned(), line.parse().unwrap_or(1));
    }
    requirements()
        .iter()
        .find(|found| found.family.prefix() == claim.id)
        .map_or_else(
            || (certificate.robot.file.clone(), 1),
            |found| (found.file.to_owned(), found.line),
        )
}

/// A path as a relative reference, or as a `file:` address if it begins at the root.
fn uri(path: &str) -> String {
    let mut out = String::new();
    if path.starts_with('/') {
        out.push_str("file://");
    }
    for byte in path.replace('\\', "/").bytes() {
        if byte.is_ascii_alphanumeric() || b"/._-~".contains(&byte) {
            out.push(char::from(byte));
        } else {
            out.push_str(&format!("%{byte:02X}"));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_become_addresses() {
        assert_eq!(uri("robots/my robot.toml"), "robots/my%20robot.toml");
        assert_eq!(uri("/tmp/a.toml"), "file:///tmp/a.toml");
    }
}
