//! The whole page from made-up runs: it must stand alone, be well-formed and come out the same twice.

use super::{page, words};
use crate::certificate::{Certificate, Parts};
use crate::claims::{self, Replay, Status};
use crate::proofs::Proofs;
use haltline_robots::Robot;
use haltline_robots::contract::Contract;
use haltline_scenarios::result::{
    BodyPose, BodyRecord, BrokenAssumption, CaseResult, Contact, DecisionChange, FootprintRecord,
    GroupResult, Judgement, MonitorReport, Outcome, PoseRecord, RunResult, Sample, ShapeRecord,
    Stop, SuiteResult, Violation, WorldRecord,
};

fn at(x_m: f64, y_m: f64) -> PoseRecord {
    PoseRecord {
        x_m,
        y_m,
        theta_rad: 0.1 * y_m,
    }
}

fn body(name: &str, shape: ShapeRecord, poses: Vec<BodyPose>, invisible: bool) -> BodyRecord {
    BodyRecord {
        name: name.into(),
        shape,
        invisible,
        poses,
    }
}

fn world() -> WorldRecord {
    let here = |pose| vec![BodyPose { t_s: 0.0, pose }];
    let crossing = (0..60)
        .map(|i| BodyPose {
            t_s: f64::from(i) * 0.1,
            pose: at(4.6, 3.0 - 0.1 * f64::from(i)),
        })
        .collect();
    let wall = |y| ShapeRecord::Segment {
        from_m: [-2.0, y],
        to_m: [9.0, y],
    };
    WorldRecord {
        bodies: vec![
            body("left wall", wall(1.6), here(at(0.0, 0.0)), false),
            body("right wall", wall(-1.6), here(at(0.0, 0.0)), true),
            body(
                "box",
                ShapeRecord::Box { size_m: [0.5, 0.4] },
                here(at(5.8, -0.9)),
                false,
            ),
            body(
                "<ball>",
                ShapeRecord::Circle { radius_m: 0.25 },
                crossing,
                false,
            ),
        ],
        goal_m: Some([7.0, 0.3]),
        goal_radius_m: Some(0.25),
        via_m: vec![[5.0, 0.2]],
    }
}

fn run(guarded: bool, stop_at: f64) -> RunResult {
    let mut x = 0.0;
    let samples: Vec<Sample> = (0..80)
        .map(|i| {
            let t_s = f64::from(i) * 0.1;
            let v = (1.2 * t_s)
                .min(1.2)
                .min((2.0 * (stop_at - x)).max(0.0).sqrt());
            x += v * 0.1;
            Sample {
                t_s,
                pose: at(x, 0.2 * (x / 2.0).sin()),
                v_mps: v,
                omega_radps: 0.0,
                clearance_m: Some((4.4 - x).abs().min(1.1) + 0.03),
            }
        })
        .collect();
    let change = |t_s: f64, decision: &str, reason: &str| DecisionChange {
        t_s,
        decision: decision.into(),
        reason: reason.into(),
        pose: at(0.0, 0.0),
        point_m: None,
    };
    let end = samples.last().map_or(at(0.0, 0.0), |s| s.pose);
    RunResult {
        guarded,
        time_s: 8.0,
        reached: false,
        travelled_m: x,
        turned_rad: 0.0,
        at_rest: true,
        contacts: if guarded {
            vec![]
        } else {
            vec![Contact {
                assumptions: Vec::new(),
                outside: None,
                t_s: 4.0,
                body: "<ball>".into(),
                robot_moving: true,
                v_mps: 1.2,
                omega_radps: 0.0,
                pose: at(4.0, 0.2),
            }]
        },
        min_clearance_m: Some(0.031),
        min_clearance_moving_m: Some(0.034),
        stops: if guarded {
            vec![Stop {
                t_s: 4.4,
                decision: "protective_stop".into(),
                reason: "critical_zone".into(),
                pose: end,
                clearance_m: Some(0.031),
            }]
        } else {
            vec![]
        },
        decisions: if guarded {
            vec![
                change(0.0, "pass", "none"),
                change(2.0, "slow", "guard_limited"),
                change(3.0, "brake", "guard_blocked"),
                change(4.2, "protective_stop", "critical_zone"),
            ]
        } else {
            vec![change(0.0, "naked", "none")]
        },
        samples,
        world: world(),
        remembered_m: vec![[1.0, 1.0]],
        monitors: ["CLAIM", "LIMIT", "ZONE", "FRESH", "SILENT", "LATCH"]
            .iter()
            .map(|id| MonitorReport {
                margin: None,
                id: (*id).into(),
                checked: 200,
                engaged: 40,
                violation_count: 0,
                violations: vec![],
            })
            .collect(),
        navigation: None,
        assumptions_broken: vec![BrokenAssumption {
            id: "A-OBSTACLE".into(),
            what: "a ball at 3 m/s".into(),
        }],
    }
}

fn case(name: &str, group: &str, stop_at: f64) -> CaseResult {
    CaseResult {
        name: name.into(),
        group: group.into(),
        title: "A ball crosses the corridor & hides".into(),
        requirements: vec!["ZONE-01".into()],
        robot: "seekur_jr".into(),
        robot_values: Vec::new(),
        seed: 7,
        obstacle_speed_mps: 1.0,
        footprint: FootprintRecord {
            front_m: 0.6,
            rear_m: 0.6,
            left_m: 0.42,
            right_m: 0.42,
        },
        guarded: run(true, stop_at),
        naked: Some(run(false, 6.5)),
        naked_reason: None,
        judgement: Judgement {
            outcome: Outcome::Pass,
            sentences: vec!["It stopped in time.".into()],
        },
    }
}

fn suite() -> SuiteResult {
    let mut cases: Vec<CaseResult> = vec![case("ball", "ball", 3.2), case("late", "late", 4.0)];
    cases.extend((0..8).map(|i| {
        let name = format!("crossing/t_{i:02}");
        case(&name, "crossing", 2.0 + 0.4 * f64::from(i))
    }));
    SuiteResult {
        cases,
        groups: vec![GroupResult {
            group: "crossing".into(),
            variants: 8,
            naked_touched: 8,
            naked_required: 4,
            guarded_touched: 0,
            judgement: Judgement {
                outcome: Outcome::Pass,
                sentences: vec!["No guarded run touched.".into()],
            },
        }],
        failed: 0,
    }
}

fn certificate(robot: &Robot, suite: &SuiteResult) -> Certificate {
    let replay = Replay {
        folder: "scenarios/files".into(),
        robot: None,
        period_s: 0.04,
    };
    let proofs = Proofs::of_ledger();
    let mut claims = claims::from_suite(suite, &replay);
    claims.extend(claims::from_proofs(&proofs));
    claims.extend(claims::not_claimed());
    claims::attach(&mut claims, &proofs);
    Certificate::new(Parts {
        adversary: haltline_attack::hostile::Hostile::default(),
        robot,
        contract: Contract::of(robot),
        suite,
        scenario_files: vec![],
        claims,
        replay: &replay,
        proofs,
    })
}

#[test]
fn the_page_is_the_same_twice_and_stands_alone() {
    let robot = Robot::embedded("seekur_jr").expect("robot");
    let suite = suite();
    let certificate = certificate(&robot, &suite);
    let html = page::write(&certificate, &robot, &suite);
    assert_eq!(html, page::write(&certificate, &robot, &suite));
    for outside in [
        "http://", "https://", "<script", "<link", "src=", "@import", "url(",
    ] {
        assert!(!html.contains(outside), "the page refers to `{outside}`");
    }
    assert!(!html.contains("<ball>"), "names must be escaped");
    if let Some(folder) = std::env::var_os("HALTLINE_TEST_PAGE") {
        std::fs::write(folder, &html).expect("written");
    }
}

#[test]
fn every_link_in_the_page_has_its_target() {
    let robot = Robot::embedded("seekur_jr").expect("robot");
    let suite = suite();
    let html = page::write(&certificate(&robot, &suite), &robot, &suite);
    let mut targets = 0;
    for link in html.split("href=\"#").skip(1) {
        let anchor = link.split('"').next().unwrap_or_default();
        assert!(
            html.contains(&format!("id=\"{anchor}\"")),
            "no target for #{anchor}"
        );
        targets += 1;
    }
    assert!(targets > 20, "only {targets} links");
}

#[test]
fn a_rest_is_explained_by_the_objection_just_before() {
    let mut run = run(true, 3.2);
    let mut stop = run.stops[0].clone();
    assert_eq!(
        words::why_stopped(&run, &stop),
        "critical zone (protective stop)"
    );
    (stop.decision, stop.reason) = ("Pass".into(), "None".into());
    run.decisions[3].t_s = 4.2;
    run.decisions.push(DecisionChange {
        t_s: 4.3,
        decision: "Pass".into(),
        reason: "None".into(),
        ..run.decisions[0].clone()
    });
    assert_eq!(
        words::why_stopped(&run, &stop),
        "critical zone (protective stop)"
    );
    stop.t_s = 6.0;
    assert_eq!(words::why_stopped(&run, &stop), "as commanded");
}

#[test]
fn a_failed_claim_names_time_tick_and_command() {
    let robot = Robot::embedded("seekur_jr").expect("robot");
    let mut suite = suite();
    suite.cases[0].guarded.monitors[2].violation_count = 1;
    suite.cases[0].guarded.monitors[2]
        .violations
        .push(Violation {
            t_s: 1.2,
            what: "a point in the zone, no stop".into(),
        });
    let certificate = certificate(&robot, &suite);
    assert!(
        certificate
            .claims
            .iter()
            .any(|claim| claim.status == Status::Failed)
    );
    let html = page::write(&certificate, &robot, &suite);
    for part in [
        "at 1.200 s (tick 30)",
        "haltline run scenarios/files/ball.toml",
        "1 claim failed",
    ] {
        assert!(html.contains(part), "the page lacks `{part}`");
    }
    let junit = crate::junit::write(&certificate).expect("junit");
    assert!(junit.contains("a point in the zone, no stop"), "{junit}");
    assert!(!junit.contains("timestamp"), "{junit}");
}
