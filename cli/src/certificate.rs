//! `certificate.json`: what was checked, on which inputs, with which result.
//!
//! The schema is documented in `cli/CERTIFICATE.md`. No wall time, no host name, no absolute path
//! gets in here: the same inputs give the same bytes.

use crate::claims::{Claim, Replay, Status};
use crate::failure::Exit;
use crate::measured::{self, Standing};
use crate::proofs::Proofs;
use crate::provenance::{self, FileHash};
use haltline_attack::hostile::Hostile;
use haltline_robots::contract::Contract;
use haltline_robots::{Change, Robot};
use haltline_scenarios::navigation::NavigationBrief;
use haltline_scenarios::result::{
    BrokenAssumption, CaseResult, Contact, GroupResult, MonitorReport, Outcome, RunResult, Stop,
    SuiteResult,
};
use serde::Serialize;

/// Name and version of the schema.
pub const SCHEMA: &str = "haltline-certificate/1";

/// The whole certificate.
#[derive(Clone, Debug, Serialize)]
pub struct Certificate {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// The overall result.
    pub verdict: Verdict,
    /// The robot.
    pub robot: RobotRecord,
    /// The kernel that ran.
    pub kernel: KernelRecord,
    /// Version of this command.
    pub tool_version: &'static str,
    /// Hashes of the scenario files that were run.
    pub scenario_files: Vec<FileHash>,
    /// All claims.
    pub claims: Vec<Claim>,
    /// Whether the robot's limits are consistent, term by term.
    pub contract: Contract,
    /// The checks of the proof ledger.
    pub proofs: Proofs,
    /// Seeded hostile runs.
    pub adversary: Hostile,
    /// Coverage and mutants of the safety core; no claim rests on them.
    pub measured: Standing,
    /// Assumptions the claims rest on.
    pub assumptions: Vec<AssumptionRecord>,
    /// Sweeps judged as a whole.
    pub sweeps: Vec<GroupResult>,
    /// All runs.
    pub cases: Vec<CaseRecord>,
}

/// The overall result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Verdict {
    /// In a word.
    pub result: &'static str,
    /// Exit code of the command.
    pub exit_code: u8,
    /// Number of claims that hold.
    pub holds: usize,
    /// Number of claims that failed.
    pub failed: usize,
    /// Number of claims that could not be checked.
    pub not_checkable: usize,
    /// Number of claims nobody makes yet.
    pub not_claimed: usize,
}

/// The robot file.
#[derive(Clone, Debug, Serialize)]
pub struct RobotRecord {
    /// Name in the file.
    pub name: String,
    /// File as named by the user.
    pub file: String,
    /// Hash of the file.
    pub sha256: String,
}

/// The kernel that was compiled into this command.
#[derive(Clone, Debug, Serialize)]
pub struct KernelRecord {
    /// Hash over the list of files below, each line `sha256  file`.
    pub sources_sha256: String,
    /// Hashes of the sources.
    pub files: Vec<FileHash>,
}

/// An assumption and the runs that broke it on purpose.
#[derive(Clone, Debug, Serialize)]
pub struct AssumptionRecord {
    /// Id.
    pub id: String,
    /// What is assumed, and the run-time check or why there is none.
    pub text: String,
    /// Cases in which the simulator did not keep it.
    pub broken_in: Vec<String>,
}

/// One case, without the data that only a drawing needs.
#[derive(Clone, Debug, Serialize)]
pub struct CaseRecord {
    /// Unique name.
    pub name: String,
    /// File stem.
    pub group: String,
    /// Title.
    pub title: String,
    /// Pass or fail.
    pub outcome: Outcome,
    /// Why.
    pub sentences: Vec<String>,
    /// Requirements the file says it covers.
    pub requirements: Vec<String>,
    /// Seed of all noise.
    pub seed: u64,
    /// Obstacle speed bound given to the guard, m/s.
    pub obstacle_speed_mps: f64,
    /// Values in which the robot of this run differs from its file.
    pub robot_values: Vec<Change>,
    /// With the guard.
    pub guarded: RunRecord,
    /// Without it.
    pub naked: Option<RunRecord>,
    /// Why there is no naked twin.
    pub naked_reason: Option<String>,
    /// Command that runs it alone.
    pub replay: String,
}

/// One run.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs)] // as in haltline_scenarios::result::RunResult
pub struct RunRecord {
    pub time_s: f64,
    pub reached: bool,
    pub at_rest: bool,
    pub travelled_m: f64,
    pub turned_rad: f64,
    pub min_clearance_m: Option<f64>,
    pub min_clearance_moving_m: Option<f64>,
    pub contacts: Vec<Contact>,
    pub stops: Vec<Stop>,
    pub monitors: Vec<MonitorReport>,
    pub assumptions_broken: Vec<BrokenAssumption>,
    pub navigation: Option<NavigationBrief>,
}

impl From<&RunResult> for RunRecord {
    fn from(run: &RunResult) -> Self {
        Self {
            time_s: run.time_s,
            reached: run.reached,
            at_rest: run.at_rest,
            travelled_m: run.travelled_m,
            turned_rad: run.turned_rad,
            min_clearance_m: run.min_clearance_m,
            min_clearance_moving_m: run.min_clearance_moving_m,
            contacts: run.contacts.clone(),
            stops: run.stops.clone(),
            monitors: run.monitors.clone(),
            assumptions_broken: run.assumptions_broken.clone(),
            navigation: run.navigation.as_ref().map(NavigationBrief::from),
        }
    }
}

/// What a certificate is made of.
pub struct Parts<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// Its contract.
    pub contract: Contract,
    /// The runs.
    pub suite: &'a SuiteResult,
    /// The scenario files behind them.
    pub scenario_files: Vec<FileHash>,
    /// All claims.
    pub claims: Vec<Claim>,
    /// How to show a run again.
    pub replay: &'a Replay,
    /// The proofs.
    pub proofs: Proofs,
    /// The hostile runs.
    pub adversary: Hostile,
}

impl Certificate {
    /// Puts the parts together and draws the overall verdict from the claims.
    #[must_use]
    pub fn new(parts: Parts<'_>) -> Self {
        let files = provenance::kernel_sources();
        Self {
            schema: SCHEMA,
            verdict: verdict(&parts.claims),
            robot: RobotRecord {
                name: parts.robot.name.clone(),
                file: parts.robot.file.clone(),
                sha256: provenance::sha256(parts.robot.text.as_bytes()),
            },
            kernel: KernelRecord {
                sources_sha256: provenance::combined(&files),
                files,
            },
            tool_version: env!("CARGO_PKG_VERSION"),
            scenario_files: parts.scenario_files,
            claims: parts.claims,
            contract: parts.contract,
            proofs: parts.proofs,
            adversary: parts.adversary,
            measured: measured::standing(),
            assumptions: assumption_records(parts.suite),
            sweeps: parts.suite.groups.clone(),
            cases: parts
                .suite
                .cases
                .iter()
                .map(|case| case_record(case, parts.replay))
                .collect(),
        }
    }

    /// How the command ends.
    #[must_use]
    pub fn exit(&self) -> Exit {
        exit(&self.claims)
    }
}

fn case_record(case: &CaseResult, replay: &Replay) -> CaseRecord {
    CaseRecord {
        name: case.name.clone(),
        group: case.group.clone(),
        title: case.title.clone(),
        outcome: case.judgement.outcome,
        sentences: case.judgement.sentences.clone(),
        requirements: case.requirements.clone(),
        seed: case.seed,
        obstacle_speed_mps: case.obstacle_speed_mps,
        robot_values: case.robot_values.clone(),
        guarded: RunRecord::from(&case.guarded),
        naked: case.naked.as_ref().map(RunRecord::from),
        naked_reason: case.naked_reason.clone(),
        replay: replay.command(case),
    }
}

fn assumption_records(suite: &SuiteResult) -> Vec<AssumptionRecord> {
    let breaks = |case: &&CaseResult, id: &str| {
        let broken = &case.guarded.assumptions_broken;
        broken.iter().any(|broken| broken.id == id)
    };
    haltline_spec::requirements::assumptions()
        .into_iter()
        .map(|assumption| AssumptionRecord {
            id: assumption.id.to_owned(),
            broken_in: suite
                .cases
                .iter()
                .filter(|case| breaks(case, assumption.id))
                .map(|case| case.name.clone())
                .collect(),
            text: assumption.text,
        })
        .collect()
}

/// A failed claim outweighs one that cannot be checked: the counterexample is there to see.
fn exit(claims: &[Claim]) -> Exit {
    let any = |status| claims.iter().any(|claim| claim.status == status);
    if any(Status::Failed) {
        Exit::ClaimFailed
    } else if any(Status::NotCheckable) || !any(Status::Holds) {
        Exit::NotCheckable
    } else {
        Exit::Holds
    }
}

fn verdict(claims: &[Claim]) -> Verdict {
    let count = |status| claims.iter().filter(|claim| claim.status == status).count();
    let exit = exit(claims);
    Verdict {
        result: match exit {
            Exit::Holds => "holds",
            Exit::ClaimFailed => "failed",
            Exit::BadInput | Exit::NotCheckable => "not_checkable",
        },
        exit_code: exit.code(),
        holds: count(Status::Holds),
        failed: count(Status::Failed),
        not_checkable: count(Status::NotCheckable),
        not_claimed: count(Status::NotClaimed),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::not_claimed;

    #[test]
    fn nothing_claimed_is_not_a_pass() {
        assert_eq!(exit(&[]), Exit::NotCheckable);
        assert_eq!(exit(&not_claimed()), Exit::NotCheckable);
    }

    #[test]
    fn a_failure_outweighs_a_gap() {
        let mut claims = [not_claimed(), not_claimed()].concat();
        claims[0].status = Status::Holds;
        assert_eq!(exit(&claims), Exit::Holds);
        claims[1].status = Status::NotCheckable;
        assert_eq!(exit(&claims), Exit::NotCheckable);
        claims[2].status = Status::Failed;
        assert_eq!(exit(&claims), Exit::ClaimFailed);
    }
}
