//! `haltline barn`: all worlds of a folder, a table, a score.

mod table;

use crate::args::BarnArgs;
use crate::failure::{Exit, Failure, prepare, write_file};
use crate::library;
use crate::picture::svg;
use crate::report::drawing::{self, Subject};
use haltline_robots::Robot;
use haltline_scenarios::barn::{Options, World};
use haltline_scenarios::batch::{Case, equip, run_guarded};
use haltline_scenarios::file::parse;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use table::{Row, Table};

/// Drives the worlds and tells what came of it.
///
/// # Errors
/// The folder or a world cannot be used, or the output cannot be written.
pub fn barn(args: &BarnArgs) -> Result<Exit, Failure> {
    let options = Options {
        sensor_bound_m: args.sensor_bound,
    };
    let cases = cases(&args.folder, &options)?;
    if let Some(out) = &args.out {
        prepare(out)?;
    }
    let table = Table {
        sensor_bound_m: args.sensor_bound,
        rows: drive(&cases, args)?,
    };
    table.print();
    if let Some(out) = &args.out {
        for (name, bytes) in [("barn.csv", table.csv()), ("barn.json", table.json()?)] {
            let path = out.join(name);
            write_file(&path, bytes.as_bytes())?;
            say!("wrote {}", path.display());
        }
        say!("wrote {} pictures to {}", cases.len(), out.display());
    }
    Ok(if table.is_safe() {
        Exit::Holds
    } else {
        Exit::ClaimFailed
    })
}

/// The worlds of a folder as cases, in the order of their names.
fn cases(folder: &Path, options: &Options) -> Result<Vec<(World, Case)>, Failure> {
    let listing = std::fs::read_dir(folder).map_err(|error| Failure::read(folder, &error))?;
    let mut files: Vec<PathBuf> = listing
        .filter_map(Result::ok)
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|end| end == "csv"))
        .collect();
    files.sort();
    if files.is_empty() {
        return Err(Failure::input(format!(
            "{}: holds no world; name a folder with files that end in .csv",
            folder.display()
        )));
    }
    let robot = library::robot_by_name("jackal")?;
    files
        .iter()
        .map(|file| case(file, options, &robot))
        .collect()
}

fn case(file: &Path, options: &Options, robot: &Robot) -> Result<(World, Case), Failure> {
    let bad = |error: haltline_scenarios::file::ScenarioError| Failure::input(error.to_string());
    let world = World::read(file).map_err(bad)?;
    let text = world.scenario_text(options);
    let made = format!("scenario of {}", file.display());
    let mut scenarios = parse(&text, &made, &world.name).map_err(bad)?;
    let case = equip(scenarios.swap_remove(0), robot).map_err(bad)?;
    Ok((world, case))
}

/// Runs all worlds behind a progress bar on standard error, hidden where that is no terminal.
fn drive(cases: &[(World, Case)], args: &BarnArgs) -> Result<Vec<Row>, Failure> {
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(jobs) = args.jobs {
        pool = pool.num_threads(usize::from(jobs));
    }
    let pool = pool
        .build()
        .map_err(|error| Failure::not_checkable(format!("no threads: {error}")))?;
    let bar = ProgressBar::with_draw_target(Some(cases.len() as u64), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{bar:28} {pos}/{len} worlds  {wide_msg}") {
        bar.set_style(style);
    }
    let rows = pool.install(|| {
        cases
            .par_iter()
            .map(|(world, case)| {
                let row = one(world, case, args.out.as_deref());
                bar.inc(1);
                bar.set_message(world.name.clone());
                row
            })
            .collect()
    });
    bar.finish_and_clear();
    rows
}

fn one(world: &World, case: &Case, out: Option<&Path>) -> Result<Row, Failure> {
    let refused = || Failure::input("the kernel refuses this robot; see `haltline certify`");
    let done = run_guarded(case).ok_or_else(refused)?.result;
    if let Some(out) = out
        && let Some(picture) = drawing::full(&done, Subject::Guarded)
    {
        let path = out.join(format!("{}.svg", world.name));
        write_file(&path, svg::file(&picture).as_bytes())?;
    }
    Ok(Row::new(world, &done.guarded))
}
