//! What the robot's drive adapter shows against its emulator, in virtual time.

use super::{Claim, Counterexample, Evidence, EvidenceKind, Status};
use crate::report::words;
use haltline_drives::conformance::{
    Bench, CHECKS, CarBench, Check, Failure, FileBench, SeekurBench, TWINS, Twin,
    speed_and_steering,
};
use haltline_drives::robots::Kind;
use haltline_drives::seekur::Wheels;
use haltline_robots::Robot;
use rayon::prelude::*;

/// The check that is a claim of its own: what happens when nobody commands any more.
const SILENCE: &str = "DRIVE-14";

const CONFORMANCE: &str = "The drive adapter holds back motion until it may move, puts every stop on the wire in \
                           time and on its curvature, and takes no hostile bytes for a motion (DRIVE-01 to DRIVE-09).";
const HOST_DEATH: &str = "When the host falls silent, the emulated robot rests within the file's dead-man time plus \
                          v / b_silent (DRIVE-14).";
const CURVES: &str = "Every speed and every steering angle becomes a level of the same sign, monotonically (DRIVE-11).";

/// Claims about the adapter that a robot of this name has; a robot without one has none.
pub fn claims(robot: &Robot) -> Vec<Claim> {
    let Some(kind) = Kind::of(robot) else {
        return vec![Claim {
            id: "DRIVE".to_owned(),
            statement: CONFORMANCE.to_owned(),
            status: Status::NotClaimed,
            evidence: Evidence::none("this robot has no drive adapter here"),
            counterexamples: Vec::new(),
            cases: Vec::new(),
        }];
    };
    let benches = benches(kind);
    let (silence, others): (Vec<&Check>, Vec<&Check>) = CHECKS
        .iter()
        .partition(|check| check.requirements.contains(&SILENCE));
    // Times and decelerations of this file, not of a bench.
    let own: [Bed; 1] = [Box::new(FileBench::new(kind, robot))];
    let mut claims = vec![
        tested("DRIVE", CONFORMANCE, &benches, &others),
        host_death(&own, &silence, &FileBench::without_watchdog(kind, robot)),
    ];
    if kind == Kind::PsesCar {
        claims.push(curves());
    }
    claims
}

type Bed = Box<dyn Bench + Send + Sync>;

fn benches(kind: Kind) -> Vec<Bed> {
    let seekur = |wheels, skid| -> Bed { Box::new(SeekurBench { wheels, skid }) };
    match kind {
        Kind::SeekurJr => vec![
            seekur(Wheels::VelRvel, 1.0),
            seekur(Wheels::VelRvel, 0.6),
            seekur(Wheels::Vel2, 1.0),
        ],
        Kind::PsesCar => vec![
            Box::new(CarBench { stx: true }),
            Box::new(CarBench { stx: false }),
        ],
    }
}

/// Runs checks on every bench, and on the first one the broken adapters that these checks must catch.
fn tested(id: &str, statement: &str, benches: &[Bed], checks: &[&Check]) -> Claim {
    let runs: Vec<(&Bed, &Check)> = benches
        .iter()
        .flat_map(|bench| checks.iter().map(move |check| (bench, *check)))
        .collect();
    let mut wrong: Vec<Counterexample> = runs
        .par_iter()
        .filter_map(|(bench, check)| {
            let failure = (check.run)(bench.as_ref(), None).err()?;
            Some(failed(bench.name(), check, &failure))
        })
        .collect();
    let broken: Vec<(Twin, &Check)> = TWINS
        .iter()
        .filter_map(|(twin, name)| {
            let check = checks.iter().find(|check| check.name == *name)?;
            Some((*twin, *check))
        })
        .collect();
    let first = benches.first();
    wrong.par_extend(broken.par_iter().filter_map(|(twin, check)| {
        let caught = (check.run)(first?.as_ref(), Some(*twin)).is_err();
        (!caught).then(|| missed(*twin, check))
    }));
    let mut words = format!(
        "tested ({} against the emulator",
        words::count(runs.len(), "check")
    );
    if !broken.is_empty() {
        words += &format!(", {} caught", words::count(broken.len(), "broken adapter"));
    }
    Claim {
        id: id.to_owned(),
        statement: statement.to_owned(),
        status: status(&wrong),
        evidence: Evidence {
            kind: EvidenceKind::Tested,
            runs: runs.len(),
            ..Evidence::none(words + ")")
        },
        counterexamples: wrong,
        cases: Vec::new(),
    }
}

/// The silence of the host, and a robot without watchdog that the same check must find.
fn host_death(own: &[Bed], checks: &[&Check], lying: &dyn Bench) -> Claim {
    let mut claim = tested("HOST-DEATH", HOST_DEATH, own, checks);
    for check in checks {
        if (check.run)(lying, None).is_ok() {
            claim.counterexamples.push(Counterexample {
                case: "a robot without watchdog".to_owned(),
                t_s: None,
                tick: None,
                what: format!(
                    "passes the check {:?}, which shows nothing then",
                    check.name
                ),
                replay: REPLAY.to_owned(),
            });
        }
    }
    claim.status = status(&claim.counterexamples);
    if claim.counterexamples.is_empty() {
        claim.evidence.words =
            claim
                .evidence
                .words
                .replacen(')', ", a robot without watchdog caught)", 1);
    }
    claim
}

fn curves() -> Claim {
    let (words, wrong) = match speed_and_steering() {
        Ok(words) => (format!("enumerated ({words})"), Vec::new()),
        Err(failure) => (
            "enumerated".to_owned(),
            vec![counterexample("both curves".to_owned(), &failure)],
        ),
    };
    Claim {
        id: "CURVES".to_owned(),
        statement: CURVES.to_owned(),
        status: status(&wrong),
        evidence: Evidence {
            kind: EvidenceKind::Enumerated,
            ..Evidence::none(words)
        },
        counterexamples: wrong,
        cases: Vec::new(),
    }
}

const fn status(wrong: &[Counterexample]) -> Status {
    if wrong.is_empty() {
        Status::Holds
    } else {
        Status::Failed
    }
}

fn failed(bench: &str, check: &Check, failure: &Failure) -> Counterexample {
    counterexample(format!("{bench}: {}", check.name), failure)
}

fn missed(twin: Twin, check: &Check) -> Counterexample {
    Counterexample {
        case: format!("broken adapter {twin:?}"),
        t_s: None,
        tick: None,
        what: format!(
            "passes the check {:?}, which shows nothing then",
            check.name
        ),
        replay: REPLAY.to_owned(),
    }
}

const REPLAY: &str = "cargo test --release -p haltline-drives --test conformance";

fn counterexample(case: String, failure: &Failure) -> Counterexample {
    Counterexample {
        case,
        t_s: None,
        tick: None,
        what: format!("{}: {}", failure.requirement, failure.seen),
        replay: REPLAY.to_owned(),
    }
}
