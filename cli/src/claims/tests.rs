use super::*;
use haltline_scenarios::result::{
    BrokenAssumption, Contact, FootprintRecord, Judgement, PoseRecord, RunResult, Violation,
    WorldRecord,
};

fn run(monitors: Vec<MonitorReport>) -> RunResult {
    RunResult {
        guarded: true,
        time_s: 1.0,
        reached: true,
        travelled_m: 1.0,
        turned_rad: 0.0,
        at_rest: true,
        contacts: Vec::new(),
        min_clearance_m: Some(0.5),
        min_clearance_moving_m: Some(0.5),
        stops: Vec::new(),
        decisions: Vec::new(),
        samples: Vec::new(),
        world: WorldRecord::default(),
        remembered_m: Vec::new(),
        monitors,
        navigation: None,
        assumptions_broken: Vec::new(),
    }
}

fn monitor(id: &str, engaged: u64, violations: &[f64]) -> MonitorReport {
    MonitorReport {
        margin: None,
        id: id.into(),
        checked: 100,
        engaged,
        violation_count: violations.len() as u64,
        violations: violations
            .iter()
            .map(|t_s| Violation {
                t_s: *t_s,
                what: "seen, not wanted".into(),
            })
            .collect(),
    }
}

fn suite(guarded: RunResult, naked: Option<RunResult>) -> SuiteResult {
    SuiteResult {
        cases: vec![CaseResult {
            name: "poles/gap=0.9".into(),
            group: "poles".into(),
            title: "Poles".into(),
            requirements: vec![],
            robot: "seekur_jr".into(),
            robot_values: Vec::new(),
            seed: 1,
            obstacle_speed_mps: 0.0,
            footprint: FootprintRecord::default(),
            guarded,
            naked,
            naked_reason: None,
            judgement: Judgement {
                outcome: Outcome::Pass,
                sentences: vec![],
            },
        }],
        groups: vec![],
        failed: 0,
    }
}

fn replay() -> Replay {
    Replay {
        folder: "my".into(),
        robot: None,
        period_s: 0.04,
    }
}

fn find<'a>(claims: &'a [Claim], id: &str) -> &'a Claim {
    claims.iter().find(|claim| claim.id == id).expect("claim")
}

#[test]
fn an_engaged_monitor_without_violations_holds_and_is_only_tested() {
    let claims = from_suite(&suite(run(vec![monitor("ZONE", 3, &[])]), None), &replay());
    let zone = find(&claims, "ZONE");
    assert_eq!(zone.status, Status::Holds);
    assert_eq!(zone.evidence.words, "tested (1 run)");
}

#[test]
fn a_vacuous_or_missing_monitor_is_not_checkable() {
    let claims = from_suite(&suite(run(vec![monitor("ZONE", 0, &[])]), None), &replay());
    assert_eq!(find(&claims, "ZONE").status, Status::NotCheckable);
    assert_eq!(find(&claims, "LATCH").status, Status::NotCheckable);
    assert_eq!(find(&claims, "TWINS").status, Status::NotCheckable);
}

#[test]
fn a_violation_names_time_tick_and_replay() {
    let claims = from_suite(
        &suite(run(vec![monitor("ZONE", 3, &[0.4])]), None),
        &replay(),
    );
    let zone = find(&claims, "ZONE");
    assert_eq!(zone.status, Status::Failed);
    let found = &zone.counterexamples[0];
    assert_eq!((found.t_s, found.tick), (Some(0.4), Some(10)));
    assert_eq!(
        found.replay,
        "haltline run my/poles.toml --variant 'gap=0.9'"
    );
}

#[test]
fn a_robot_of_ones_own_is_named_in_the_replay() {
    let own = Replay {
        robot: Some("my.toml".into()),
        ..replay()
    };
    let suite = suite(run(vec![]), None);
    let command = own.command(&suite.cases[0]);
    assert_eq!(
        command,
        "haltline run my/poles.toml --variant 'gap=0.9' --robot my.toml"
    );
}

#[test]
fn a_violation_outside_the_engaged_ticks_still_fails() {
    let claims = from_suite(
        &suite(run(vec![monitor("ZONE", 0, &[0.4])]), None),
        &replay(),
    );
    assert_eq!(find(&claims, "ZONE").status, Status::Failed);
}

#[test]
fn a_run_that_breaks_an_assumption_is_no_evidence() {
    let mut broken = run(vec![monitor("CLAIM", 3, &[])]);
    broken.assumptions_broken.push(BrokenAssumption {
        id: "A-BRAKE".into(),
        what: "half the brakes".into(),
    });
    let claims = from_suite(&suite(broken.clone(), None), &replay());
    assert_eq!(find(&claims, "CLAIM").status, Status::NotCheckable);
    broken.monitors = vec![monitor("CLAIM", 3, &[0.4])];
    let claims = from_suite(&suite(broken, None), &replay());
    assert_eq!(find(&claims, "CLAIM").status, Status::Failed);
}

#[test]
fn many_ticks_of_one_case_are_told_once() {
    let claims = from_suite(
        &suite(run(vec![monitor("ZONE", 3, &[0.4, 0.44])]), None),
        &replay(),
    );
    let told = first_of_each_case(&find(&claims, "ZONE").counterexamples);
    assert_eq!(told.len(), 1);
    assert_eq!(told[0].1, 1);
}

#[test]
fn an_empty_suite_claims_nothing() {
    let empty = SuiteResult {
        cases: vec![],
        groups: vec![],
        failed: 0,
    };
    let claims = from_suite(&empty, &replay());
    assert!(
        claims
            .iter()
            .all(|claim| claim.status == Status::NotCheckable)
    );
}

#[test]
fn a_naked_twin_that_touches_is_counted() {
    let mut naked = run(vec![]);
    naked.contacts.push(Contact {
        assumptions: Vec::new(),
        outside: None,
        t_s: 0.5,
        body: "pole".into(),
        robot_moving: true,
        v_mps: 1.0,
        omega_radps: 0.0,
        pose: PoseRecord::default(),
    });
    let claims = from_suite(&suite(run(vec![]), Some(naked)), &replay());
    let twins = find(&claims, "TWINS");
    assert_eq!(twins.status, Status::Holds);
    assert_eq!(
        twins.evidence.words,
        "tested (1 naked run, of which 1 touched)"
    );
}

#[test]
fn a_failed_case_fails_the_scenarios() {
    let mut suite = suite(run(vec![]), None);
    suite.cases[0].judgement.outcome = Outcome::Fail;
    suite.cases[0].judgement.sentences = vec!["It touched the pole.".into()];
    let claims = from_suite(&suite, &replay());
    assert_eq!(find(&claims, "SCENARIOS").status, Status::Failed);
}

#[test]
fn nothing_is_worded_as_proof() {
    let mut claims = from_suite(&suite(run(vec![]), None), &replay());
    claims.extend(not_claimed());
    assert!(
        claims
            .iter()
            .all(|claim| !claim.evidence.words.contains("proved"))
    );
}

#[test]
fn a_run_with_other_values_of_the_robot_is_no_evidence_but_can_speak_against() {
    let changed = |violations: &[f64]| {
        let mut suite = suite(run(vec![monitor("CLAIM", 10, violations)]), None);
        let mut change = haltline_robots::Change::new("tolerances.tracking_m", "0.005");
        change.before = "0.020".to_owned();
        suite.cases[0].robot_values = vec![change];
        let claims = from_suite(&suite, &replay());
        claims
            .into_iter()
            .find(|claim| claim.id == "CLAIM")
            .expect("it is made")
    };
    let quiet = changed(&[]);
    assert_eq!(
        (quiet.status, quiet.evidence.runs),
        (Status::NotCheckable, 0)
    );
    assert_eq!(changed(&[0.4]).status, Status::Failed);
}
