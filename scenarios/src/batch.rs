//! Runs cases, alone or many at a time, and puts the results in a fixed order.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::controller::{Controller, RobotKernel};
use crate::engine::{Run, run};
pub use crate::equip::{Case, equip};
use crate::pilot::Pilot;
use crate::result::{CaseResult, FootprintRecord, Outcome, SuiteResult};
use crate::verdict::{judge, judge_group};

/// A case that has just finished.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Cases finished so far.
    pub done: usize,
    /// Cases in all.
    pub total: usize,
    /// Name of the finished one.
    pub name: &'a str,
    /// Whether it passed.
    pub outcome: Outcome,
}

/// A case's result and the traces of its runs.
#[derive(Clone, Debug)]
pub struct CaseRun {
    /// The result.
    pub result: CaseResult,
    /// Trace of the guarded run, JSON lines.
    pub guarded_trace: String,
    /// Trace of the naked run.
    pub naked_trace: Option<String>,
}

/// Runs one case with the guard, or without; none if the kernel refuses the robot.
#[must_use]
pub fn run_one(case: &Case, guard_on: bool) -> Option<Run> {
    let controller: Option<Box<dyn Controller>> = match (guard_on, case.scenario.navigates()) {
        (false, _) => None,
        (true, false) => Some(Box::new(RobotKernel::new(case.told.config).ok()?)),
        (true, true) => Some(Box::new(Pilot::new(&case.scenario, &case.told).ok()?)),
    };
    Some(run(&case.scenario, &case.robot, controller))
}

/// Runs a case and its naked twin and judges them; none if the kernel refuses the robot.
#[must_use]
pub fn run_case(case: &Case) -> Option<CaseRun> {
    let guarded = run_one(case, true)?;
    let excuse = case.scenario.naked_excuse();
    let naked = match excuse {
        Some(_) => None,
        None => run_one(case, false),
    };
    Some(assemble(case, guarded, naked, excuse))
}

/// Runs a case with the guard only and judges that; none if the kernel refuses the robot.
#[must_use]
pub fn run_guarded(case: &Case) -> Option<CaseRun> {
    let guarded = run_one(case, true)?;
    Some(assemble(case, guarded, None, Some("not run")))
}

fn assemble(case: &Case, guarded: Run, naked: Option<Run>, excuse: Option<&str>) -> CaseRun {
    let scenario = &case.scenario;
    let outline = &case.robot.values.footprint;
    let judgement = judge(scenario, &guarded.result, naked.as_ref().map(|n| &n.result));
    let (naked_result, naked_trace) = naked.map(|n| (n.result, n.trace)).unzip();
    CaseRun {
        result: CaseResult {
            name: scenario.name.clone(),
            group: scenario.group.clone(),
            title: scenario.title.clone(),
            requirements: scenario.requirements.clone(),
            robot: scenario.robot.clone(),
            robot_values: case.changes.clone(),
            seed: scenario.seed,
            obstacle_speed_mps: scenario.obstacle_speed_mps.get(),
            footprint: FootprintRecord {
                front_m: outline.front_m,
                rear_m: outline.rear_m,
                left_m: outline.left_m,
                right_m: outline.right_m,
            },
            guarded: guarded.result,
            naked: naked_result,
            naked_reason: excuse.map(str::to_owned),
            judgement,
        },
        guarded_trace: guarded.trace,
        naked_trace,
    }
}

/// Runs all cases on all cores; `finished` is called from any thread after each.
#[must_use]
pub fn run_suite(cases: &[Case], finished: &(dyn Fn(Progress<'_>) + Sync)) -> SuiteResult {
    let done = AtomicUsize::new(0);
    let mut results: Vec<CaseResult> = cases
        .par_iter()
        .filter_map(|case| {
            let result = run_case(case)?.result;
            finished(Progress {
                done: done.fetch_add(1, Ordering::Relaxed) + 1,
                total: cases.len(),
                name: &result.name,
                outcome: result.judgement.outcome,
            });
            Some(result)
        })
        .collect();
    results.sort_by(|a, b| a.name.cmp(&b.name));
    summarise(cases, results)
}

fn summarise(cases: &[Case], results: Vec<CaseResult>) -> SuiteResult {
    let sweeps: BTreeMap<&str, Option<usize>> = cases
        .iter()
        .filter(|case| !case.scenario.sweep.is_empty())
        .map(|case| {
            let scenario = &case.scenario;
            (scenario.group.as_str(), scenario.sweep_naked_touch_min)
        })
        .collect();
    let groups: Vec<_> = sweeps
        .into_iter()
        .map(|(group, required)| {
            let members: Vec<_> = results.iter().filter(|r| r.group == group).collect();
            judge_group(group, &members, required)
        })
        .collect();
    let bad_cases = results
        .iter()
        .filter(|r| r.judgement.outcome == Outcome::Fail);
    let bad_groups = groups
        .iter()
        .filter(|g| g.judgement.outcome == Outcome::Fail);
    let missing = cases.len() - results.len();
    let failed = bad_cases.count() + bad_groups.count() + missing;
    SuiteResult {
        cases: results,
        groups,
        failed,
    }
}
