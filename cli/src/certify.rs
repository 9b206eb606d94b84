//! `haltline certify`: contract, scenarios, timing; report and certificate.

use crate::args::CertifyArgs;
use crate::certificate::{Certificate, Parts};
use crate::claims::{self, Claim, Counterexample, Evidence, Replay, Status};
use crate::failure::{Exit, Failure, prepare, write_file};
use crate::library::{self, Library};
use crate::measured;
use crate::proofs::Proofs;
use crate::provenance::FileHash;
use crate::report::page;
use crate::timing::{self, Timing};
use crate::{junit, sarif, terminal};
use haltline_attack::hostile::{Hostile, hostile};
use haltline_robots::Robot;
use haltline_robots::contract::{Contract, Finding};
use haltline_scenarios::batch::{Case, equip, run_suite};
use haltline_scenarios::result::SuiteResult;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The robot that plain `haltline` certifies.
const DEFAULT_ROBOT: &str = "seekur_jr";

/// Certifies the default robot with the default scenarios into `out/`.
///
/// # Errors
/// As [`certify`].
pub fn default_robot() -> Result<Exit, Failure> {
    let robot = library::robot_by_name(DEFAULT_ROBOT)?;
    certify_robot(&robot, None, Path::new("out"), false)
}

/// Certifies a robot.
///
/// # Errors
/// A file is unusable, or the output cannot be written.
pub fn certify(args: &CertifyArgs) -> Result<Exit, Failure> {
    let robot = library::robot(&args.robot)?;
    certify_robot(&robot, args.scenarios.as_deref(), &args.out, args.prove)
}

fn certify_robot(
    robot: &Robot,
    folder: Option<&Path>,
    out: &Path,
    prove: bool,
) -> Result<Exit, Failure> {
    let library = library::scenarios(folder)?;
    prepare(out)?;
    let start = Instant::now();
    let contract = Contract::of(robot);
    let contract_s = start.elapsed().as_secs_f64();
    terminal::contract(robot, &contract);
    let proofs = if prove {
        Proofs::run_again()
    } else {
        Proofs::of_ledger()
    };
    terminal::proofs(&proofs);
    terminal::measured(&measured::standing());
    let name = library::robot_name(robot);
    let cases = cases_for(&library, robot, &name)?;
    let start = Instant::now();
    let suite = drive(&cases);
    let scenarios_s = start.elapsed().as_secs_f64();
    if suite.cases.len() != cases.len() {
        return Err(Failure::not_checkable("some scenarios could not be run"));
    }
    let adversary = attacked(robot)?;
    let replay = replay_of(robot, &name, &library);
    let certificate = Certificate::new(Parts {
        robot,
        scenario_files: used_files(&library, &cases),
        claims: all_claims(
            robot,
            &contract,
            &suite,
            &replay,
            &proofs,
            (&adversary, out),
        ),
        contract,
        suite: &suite,
        replay: &replay,
        proofs,
        adversary,
    });
    let timing = Timing {
        note: "wall times of one machine; they bound nothing and no claim rests on them",
        contract_s,
        scenarios_s,
        runs_per_s: suite.cases.len() as f64 / scenarios_s.max(1e-9),
        tick: timing::ticks(robot),
    };
    for one in &certificate.adversary.violations {
        let path = out.join(claims::adversary::file(one.number));
        write_file(&path, one.text.as_bytes())?;
    }
    let written = write_all(out, &certificate, robot, &suite, &timing)?;
    terminal::summary(&certificate, &suite, &timing, &written);
    if suite.cases.is_empty() {
        terminal::no_scenario(&name, &library.folder);
    }
    Ok(certificate.exit())
}

/// The scenarios that name this robot, ready to run.
fn cases_for(library: &Library, robot: &Robot, name: &str) -> Result<Vec<Case>, Failure> {
    library
        .scenarios
        .iter()
        .filter(|scenario| scenario.robot == name)
        .map(|scenario| {
            equip(scenario.clone(), robot).map_err(|error| Failure::input(error.to_string()))
        })
        .collect()
}

/// Hashes of the files that at least one run came from.
fn used_files(library: &Library, cases: &[Case]) -> Vec<FileHash> {
    let is_used = |file: &&FileHash| {
        cases
            .iter()
            .any(|case| file.file == format!("{}.toml", case.scenario.group))
    };
    library.files.iter().filter(is_used).cloned().collect()
}

/// Runs all cases behind a progress bar on standard error, hidden where that is no terminal.
fn drive(cases: &[Case]) -> SuiteResult {
    let bar = ProgressBar::with_draw_target(Some(cases.len() as u64), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{bar:28} {pos}/{len} runs  {wide_msg}") {
        bar.set_style(style);
    }
    let suite = run_suite(cases, &|progress| {
        bar.set_position(progress.done as u64);
        bar.set_message(progress.name.to_owned());
    });
    bar.finish_and_clear();
    suite
}

fn replay_of(robot: &Robot, name: &str, library: &Library) -> Replay {
    // A robot that `haltline run` finds by itself need not be named.
    let known = library::robot_by_name(name).is_ok_and(|found| found.text == robot.text);
    Replay {
        folder: library.folder.clone(),
        robot: (!known).then(|| robot.file.clone()),
        period_s: robot.values.timing.period_s,
    }
}

fn all_claims(
    robot: &Robot,
    contract: &Contract,
    suite: &SuiteResult,
    replay: &Replay,
    proofs: &Proofs,
    (hostile, out): (&Hostile, &Path),
) -> Vec<Claim> {
    let mut claims = vec![contract_claim(robot, contract)];
    claims.extend(claims::from_suite(suite, replay));
    let out = out.display().to_string();
    claims.push(claims::adversary::from_hostile(hostile, &out));
    claims.extend(claims::from_proofs(proofs));
    claims.extend(adapter_claims(robot));
    claims.extend(claims::not_claimed());
    claims::attach(&mut claims, proofs);
    claims.extend(not_covered(contract));
    claims
}

/// Hostile runs, which take some seconds; says so on standard error, if that is a terminal.
fn attacked(robot: &Robot) -> Result<Hostile, Failure> {
    let spinner = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    spinner.set_message("hostile runs");
    spinner.enable_steady_tick(Duration::from_millis(100));
    let hostile = hostile(robot).map_err(Failure::input);
    spinner.finish_and_clear();
    hostile
}

/// The drive part takes some seconds; says so on standard error, if that is a terminal.
fn adapter_claims(robot: &Robot) -> Vec<Claim> {
    let spinner = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    spinner.set_message("drive adapter against its emulator");
    spinner.enable_steady_tick(Duration::from_millis(100));
    let claims = claims::drive::claims(robot);
    spinner.finish_and_clear();
    claims
}

fn contract_claim(robot: &Robot, contract: &Contract) -> Claim {
    let failing = contract
        .checks
        .iter()
        .filter(|check| check.finding == Finding::Fails);
    let counterexamples: Vec<Counterexample> = failing
        .map(|check| Counterexample {
            case: check.id.to_owned(),
            t_s: None,
            tick: None,
            what: check.sentence.clone(),
            replay: format!("haltline certify {}", robot.file),
        })
        .collect();
    let holding = contract.checks.iter().filter(|check| check.holds()).count();
    let uncovered = contract
        .checks
        .iter()
        .filter(|check| check.finding == Finding::NotCovered)
        .count();
    Claim {
        id: "CONTRACT".to_owned(),
        statement: "The limits of the robot file are consistent: it can stop within what it sees."
            .to_owned(),
        status: match (counterexamples.is_empty(), holding) {
            (false, _) => Status::Failed,
            (true, 0) => Status::NotCheckable,
            (true, _) => Status::Holds,
        },
        evidence: Evidence::computed(format!(
            "computed from the robot file ({} checks: {holding} hold, {uncovered} not covered)",
            contract.checks.len()
        )),
        counterexamples,
        cases: Vec::new(),
    }
}

/// What the contract says it does not cover, so that nobody takes it for covered.
fn not_covered(contract: &Contract) -> Vec<Claim> {
    contract
        .checks
        .iter()
        .filter(|check| check.finding == Finding::NotCovered)
        .map(|check| Claim {
            id: check.id.to_owned(),
            statement: format!("{}.", check.title),
            status: Status::NotClaimed,
            evidence: Evidence::none(format!("not covered: {}", check.sentence)),
            counterexamples: Vec::new(),
            cases: Vec::new(),
        })
        .collect()
}

fn write_all(
    out: &Path,
    certificate: &Certificate,
    robot: &Robot,
    suite: &SuiteResult,
    timing: &Timing,
) -> Result<Vec<PathBuf>, Failure> {
    let json = |what: &str, result: Result<Vec<u8>, serde_json::Error>| {
        result.map_err(|error| Failure::not_checkable(format!("{what}: {error}")))
    };
    let files = [
        (
            "report.html",
            page::write(certificate, robot, suite).into_bytes(),
        ),
        (
            "certificate.json",
            json("certificate.json", serde_json::to_vec_pretty(certificate))?,
        ),
        ("junit.xml", junit::write(certificate)?.into_bytes()),
        (
            "claims.sarif",
            json("claims.sarif", sarif::write(certificate))?,
        ),
        (
            "timing.json",
            json("timing.json", serde_json::to_vec_pretty(timing))?,
        ),
    ];
    let mut written = Vec::new();
    for (name, bytes) in files {
        let path = out.join(name);
        write_file(&path, &bytes)?;
        written.push(path);
    }
    Ok(written)
}
