//! `haltline run`: one scenario, its picture, its trace.

use crate::args::RunArgs;
use crate::failure::{Exit, Failure, prepare, write_file};
use crate::library;
use crate::picture::{png, svg};
use crate::report::drawing::{self, Subject};
use crate::report::words;
use console::style;
use haltline_robots::Change;
use haltline_scenarios::batch::{Case, CaseRun, equip, run_case, run_one};
use haltline_scenarios::result::{
    Contact, Judgement, MonitorReport, NavigationRecord, Outcome, RunResult, Stop,
};
use serde::Serialize;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// What `--json` prints.
#[derive(Serialize)]
struct Summary<'a> {
    scenario: &'a str,
    title: &'a str,
    robot: &'a str,
    robot_values: &'a [Change],
    guarded: bool,
    seed: u64,
    contacts: usize,
    contacts_while_moving: usize,
    reached: bool,
    time_s: f64,
    at_rest: bool,
    travelled_m: f64,
    turned_rad: f64,
    min_clearance_m: Option<f64>,
    min_clearance_moving_m: Option<f64>,
    stops: usize,
    stop_details: &'a [Stop],
    contact_details: &'a [Contact],
    monitors: &'a [MonitorReport],
    navigation: Option<&'a NavigationRecord>,
    naked_contacts: Option<usize>,
    judgement: Option<&'a Judgement>,
}

/// Runs the scenario and writes what it left.
///
/// # Errors
/// The scenario or the robot is unusable, or the output cannot be written.
pub fn run(args: &RunArgs) -> Result<Exit, Failure> {
    let (scenario, variants) = library::scenario(&args.scenario, args.variant.as_deref())?;
    if variants > 1 && args.variant.is_none() {
        eprintln!(
            "{}: the first of {variants} variants; choose another with --variant",
            scenario.name
        );
    }
    let robot = match &args.robot {
        Some(path) => library::robot(path)?,
        None => library::robot_by_name(&scenario.robot)?,
    };
    let case = equip(scenario, &robot).map_err(|error| Failure::input(error.to_string()))?;
    prepare(&args.out)?;
    let done = drive(&case, args.naked)?;
    let subject = if args.naked {
        Subject::Naked
    } else {
        Subject::Guarded
    };
    let written = write_files(&args.out, &done, subject)?;
    let judgement = (!args.naked).then_some(&done.result.judgement);
    let exit = match judgement.map(|judgement| judgement.outcome) {
        Some(Outcome::Fail) => Exit::ClaimFailed,
        Some(Outcome::Pass) | None => Exit::Holds,
    };
    if args.json {
        print_json(&case, &done, args.naked)?;
    } else {
        print_summary(&case, &done, args.naked);
        for path in written {
            say!("wrote {}", path.display());
        }
    }
    Ok(exit)
}

fn drive(case: &Case, naked: bool) -> Result<CaseRun, Failure> {
    let refused = || Failure::input("the kernel refuses this robot; see `haltline certify`");
    let mut done = run_case(case).ok_or_else(refused)?;
    if naked && done.result.naked.is_none() {
        // The file says that it is no contact scenario; whoever asks for it gets it all the same.
        let run = run_one(case, false).ok_or_else(refused)?;
        done.result.naked = Some(run.result);
        done.naked_trace = Some(run.trace);
    }
    Ok(done)
}

/// The run that was asked for.
fn subject(done: &CaseRun, naked: bool) -> &RunResult {
    match &done.result.naked {
        Some(run) if naked => run,
        _ => &done.result.guarded,
    }
}

fn write_files(out: &Path, done: &CaseRun, subject: Subject) -> Result<Vec<PathBuf>, Failure> {
    let mut written = Vec::new();
    let mut put = |name: &str, bytes: &[u8]| -> Result<(), Failure> {
        let path = out.join(name);
        write_file(&path, bytes)?;
        written.push(path);
        Ok(())
    };
    let trace = match (&done.naked_trace, subject) {
        (Some(trace), Subject::Naked) => trace,
        _ => &done.guarded_trace,
    };
    put("trace.jsonl", trace.as_bytes())?;
    if let (Some(trace), Subject::Guarded) = (&done.naked_trace, subject) {
        put("trace_naked.jsonl", trace.as_bytes())?;
    }
    if let Some(picture) = drawing::full(&done.result, subject) {
        put("run.svg", svg::file(&picture).as_bytes())?;
        if let Some(bytes) = png::encode(&picture, 1.6) {
            put("run.png", &bytes)?;
        }
    }
    Ok(written)
}

fn print_json(case: &Case, done: &CaseRun, naked: bool) -> Result<(), Failure> {
    let run = subject(done, naked);
    let twin = done.result.naked.as_ref().filter(|_| !naked);
    let summary = Summary {
        scenario: &done.result.name,
        title: &done.result.title,
        robot: &case.scenario.robot,
        robot_values: &done.result.robot_values,
        guarded: !naked,
        seed: done.result.seed,
        contacts: run.contacts.len(),
        contacts_while_moving: run.moving_contacts(),
        reached: run.reached,
        time_s: run.time_s,
        at_rest: run.at_rest,
        travelled_m: run.travelled_m,
        turned_rad: run.turned_rad,
        min_clearance_m: run.min_clearance_m,
        min_clearance_moving_m: run.min_clearance_moving_m,
        stops: run.stops.len(),
        stop_details: &run.stops,
        contact_details: &run.contacts,
        monitors: &run.monitors,
        navigation: run.navigation.as_ref(),
        naked_contacts: twin.map(|twin| twin.contacts.len()),
        judgement: (!naked).then_some(&done.result.judgement),
    };
    let text = serde_json::to_value(&summary)
        .map(rounded)
        .and_then(|value| serde_json::to_string(&value))
        .map_err(|error| Failure::not_checkable(format!("json: {error}")))?;
    say!("{text}");
    Ok(())
}

/// Floats to six decimals: micrometres and microseconds; the rest is noise of the arithmetic.
fn rounded(value: Value) -> Value {
    match value {
        Value::Array(list) => list.into_iter().map(rounded).collect(),
        Value::Object(map) => map.into_iter().map(|(k, v)| (k, rounded(v))).collect(),
        Value::Number(number) if number.is_f64() => number
            .as_f64()
            .map_or(Value::Null, |v| Value::from((v * 1e6).round() / 1e6)),
        other => other,
    }
}

fn print_summary(case: &Case, done: &CaseRun, naked: bool) {
    let run = subject(done, naked);
    let guard = if naked {
        "without the guard"
    } else {
        "with the guard"
    };
    say!("{}  {}", style(&done.result.name).bold(), done.result.title);
    say!("{} {guard}, seed {}", case.robot.name, done.result.seed);
    if let Some(values) = words::robot_values(&done.result.robot_values) {
        say!("not the shipped robot: {values}");
    }
    say!("");
    let end = if run.reached {
        "goal reached"
    } else {
        "goal not reached"
    };
    say!(
        "  {end} after {:.2} s, {:.2} m and {:.0} deg of turning",
        run.time_s,
        run.travelled_m,
        run.turned_rad.to_degrees()
    );
    if let Some(navigation) = &run.navigation {
        say!("  {}", words::navigated(navigation));
    }
    say!(
        "  {}, {} while moving",
        words::count(run.contacts.len(), "contact"),
        run.moving_contacts()
    );
    for contact in &run.contacts {
        let how = if contact.robot_moving {
            "moving"
        } else {
            "at rest"
        };
        say!(
            "    {:.2} s  {} ({how}, {:.2} m/s)",
            contact.t_s,
            contact.body,
            contact.v_mps
        );
    }
    if let Some(gap) = words::nearest(run) {
        say!("  nearest {gap}");
    }
    say!("  {}", words::count(run.stops.len(), "stop"));
    for stop in &run.stops {
        let gap = stop.clearance_m.map_or(String::new(), |gap| {
            format!(", {} left", words::metres(gap))
        });
        let why = words::why_stopped(run, stop);
        say!("    {:.2} s  {why}{gap}", stop.t_s);
    }
    for broken in &run.assumptions_broken {
        say!("  breaks {} on purpose: {}", broken.id, broken.what);
    }
    if !naked {
        print_judgement(done);
    }
}

fn print_judgement(done: &CaseRun) {
    let result = &done.result;
    let twin = match (&result.naked, &result.naked_reason) {
        (Some(twin), _) => words::count(twin.contacts.len(), "contact"),
        (None, Some(reason)) => format!("none ({reason})"),
        (None, None) => "none".to_owned(),
    };
    say!("  naked twin: {twin}");
    let mark = match result.judgement.outcome {
        Outcome::Pass => style("as expected").green().bold(),
        Outcome::Fail => style("FAILED").red().bold(),
    };
    say!("\n  {mark}");
    for sentence in &result.judgement.sentences {
        say!("    {sentence}");
    }
}
