//! The certificate as JUnit XML for CI servers; no time stamps, so the same inputs give the same bytes.

use crate::certificate::Certificate;
use crate::claims::{Claim, Counterexample, Status};
use crate::failure::Failure;
use haltline_scenarios::result::Outcome;
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

/// The XML text.
///
/// # Errors
/// The document cannot be serialised.
pub fn write(certificate: &Certificate) -> Result<String, Failure> {
    let mut report = Report::new(format!("haltline {}", certificate.robot.name));
    let mut claims = TestSuite::new("claims");
    for claim in &certificate.claims {
        claims.add_test_case(claim_case(claim));
    }
    report.add_test_suite(claims);
    let mut scenarios = TestSuite::new("scenarios");
    for case in &certificate.cases {
        let status = if case.outcome == Outcome::Pass {
            TestCaseStatus::success()
        } else {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            status.set_message(case.sentences.join(" "));
            status.set_description(case.replay.clone());
            status
        };
        let mut test = TestCase::new(case.name.clone(), status);
        test.set_classname(format!("scenarios.{}", case.group));
        scenarios.add_test_case(test);
    }
    report.add_test_suite(scenarios);
    report
        .to_string()
        .map_err(|error| Failure::not_checkable(format!("junit.xml: {error}")))
}

fn claim_case(claim: &Claim) -> TestCase {
    let status = match claim.status {
        Status::Holds => TestCaseStatus::success(),
        Status::Failed => {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            let lines: Vec<String> = claim.counterexamples.iter().map(sentence).collect();
            status.set_message(format!("{} does not hold", claim.id));
            status.set_description(lines.join("\n"));
            status
        }
        Status::NotCheckable => {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Error);
            status.set_message(format!("not checkable: {}", claim.evidence.words));
            status
        }
        Status::NotClaimed => {
            let mut status = TestCaseStatus::skipped();
            status.set_message(format!("not claimed yet: {}", claim.evidence.words));
            status
        }
    };
    let mut test = TestCase::new(claim.id.clone(), status);
    test.set_classname("claims");
    test
}

/// Where and when a counterexample was found.
#[must_use]
pub fn when(found: &Counterexample) -> String {
    match (found.t_s, found.tick) {
        (Some(t_s), Some(tick)) => format!("{} at {t_s:.3} s (tick {tick})", found.case),
        (Some(t_s), None) => format!("{} at {t_s:.3} s", found.case),
        _ => found.case.clone(),
    }
}

/// A counterexample in one line.
fn sentence(found: &Counterexample) -> String {
    format!(
        "{}: {} -- replay: {}",
        when(found),
        found.what,
        found.replay
    )
}
