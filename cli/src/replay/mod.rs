//! `haltline replay`: the kernel watches a recorded drive.

mod drawing;
mod drive;
mod events;
mod shadow;
mod verdict;

use crate::args::{LogFormat, ReplayArgs};
use crate::failure::{Exit, Failure, prepare, write_file};
use crate::picture::{Picture, png, svg};
use crate::report::words;
use crate::{carmen, mrclam};
use console::style;
use drawing::Scene;
use drive::Moment;
use events::Event;
use haltline_logs::sena;
use haltline_robots::Robot;
use shadow::Judged;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// At most this many close views are drawn.
const CLOSE_UPS: usize = 12;

/// Reads the log, lets the kernel watch it, prints and draws what it would have done.
///
/// # Errors
/// The log or the robot file is unusable, or the pictures cannot be written.
pub fn replay(args: &ReplayArgs) -> Result<Exit, Failure> {
    match args.format {
        LogFormat::Sena => {
            let log = sena::read(&args.file)?;
            shadow_drive(args, &log, &load_robot(args.robot.as_deref())?)?;
        }
        LogFormat::Carmen => carmen_drive(args)?,
        LogFormat::Mrclam => return mrclam::replay(args),
    }
    Ok(Exit::Holds)
}

/// The guard in shadow, and the map that the recording believed in.
fn carmen_drive(args: &ReplayArgs) -> Result<(), Failure> {
    let drive = carmen::read(&args.file)?;
    let robot = match args.robot.as_deref() {
        Some(path) => load_robot(Some(path))?,
        None => carmen::assumed_robot(&drive.log.header)?,
    };
    if drive.dropped > 0 {
        let dropped = words::count(drive.dropped, "sweep");
        say!("{dropped} not newer than the one before: dropped");
    }
    shadow_drive(args, &drive.log, &robot)?;
    let path = carmen::write_map(&args.out, &drive, &robot)?;
    say!("wrote {}", path.display());
    Ok(())
}

/// Lets the kernel watch one drive.
fn shadow_drive(args: &ReplayArgs, log: &sena::Log, robot: &Robot) -> Result<(), Failure> {
    prepare(&args.out)?;
    let moments = drive::course(log, robot.values.timing.period_s);
    let judged = shadow::watch(robot, log, &moments)?;
    let events = events::events(&moments, &judged);
    print_summary(&args.file, robot, &moments, &judged, &events);
    let body = &robot.values.footprint;
    let scene = Scene {
        moments: &moments,
        judged: &judged,
        events: &events,
        edges: [body.front_m, body.rear_m, body.left_m, body.right_m],
        title: format!(
            "{}: {:.0} m in shadow",
            robot.name,
            drive::length_m(&moments)
        ),
    };
    let written = write_pictures(&args.out, &scene)?;
    let json = serde_json::to_vec_pretty(&events)
        .map_err(|error| Failure::not_checkable(format!("replay.json: {error}")))?;
    let json_path = args.out.join("replay.json");
    write_file(&json_path, &json)?;
    for path in written.iter().chain([&json_path]) {
        say!("wrote {}", path.display());
    }
    Ok(())
}

fn load_robot(file: Option<&Path>) -> Result<Robot, Failure> {
    match file {
        Some(path) => Robot::load(path),
        None => Robot::embedded("sena"),
    }
    .map_err(|error| Failure::input(error.to_string()))
}

fn print_summary(
    file: &Path,
    robot: &Robot,
    moments: &[Moment],
    judged: &[Judged],
    events: &[Event],
) {
    say!("{}", style(file.display()).bold());
    let span = moments.last().map_or(0.0, |m| m.t_s) - moments.first().map_or(0.0, |m| m.t_s);
    say!(
        "{} over {span:.1} s and {:.1} m; robot: {}",
        words::count(moments.iter().filter(|m| m.row.is_some()).count(), "sweep"),
        drive::length_m(moments),
        robot.name
    );
    say!(
        "The recorded robot does not obey the kernel: each verdict is about its own moment. The drive is \
         not checked\nagainst the decisions, and a stop is released once the kernel itself has come to rest.\n"
    );
    print_counts(judged);
    if judged
        .iter()
        .any(|verdict| verdict.refusal.as_deref() == Some("unknown_space"))
    {
        say!(
            "\nunknown space: nobody has looked there, or not lately; a ray without a valid return says nothing, \
             and\nwhat is unknown counts as occupied"
        );
    }
    print_events(events);
    print_times(judged);
}

fn print_counts(judged: &[Judged]) {
    let mut counts: BTreeMap<(String, String), usize> = BTreeMap::new();
    for verdict in judged {
        let why = verdict.refusal.as_ref().unwrap_or(&verdict.reason);
        *counts
            .entry((verdict.action.clone(), why.clone()))
            .or_default() += 1;
    }
    say!("{:>6}  {:<17} why", "ticks", "decision");
    for ((action, why), count) in &counts {
        say!(
            "{count:>6}  {:<17} {}",
            words::reason(action),
            words::reason(why)
        );
    }
}

fn print_events(events: &[Event]) {
    say!(
        "\n{:>3}  {:>7}  {:>5}  {:>6}  event",
        "#",
        "from",
        "ticks",
        "m/s"
    );
    for (index, event) in events.iter().enumerate() {
        let point = event.point_m.map_or(String::new(), |[x, y]| {
            format!(", point ({x:.2}, {y:.2}) m")
        });
        let distance = event
            .distance_m
            .map_or(String::new(), |d| format!(" {d:.2} m away"));
        let why = event.refusal.as_ref().unwrap_or(&event.reason);
        say!(
            "{:>3}  {:>5.1} s  {:>5}  {:>6.2}  {}: {}{point}{distance}",
            index + 1,
            event.from_s,
            event.ticks,
            event.speed_mps,
            words::reason(&event.action),
            words::reason(why)
        );
    }
}

fn print_times(judged: &[Judged]) {
    let mut times: Vec<f64> = judged.iter().map(|verdict| verdict.wall_us).collect();
    times.sort_by(f64::total_cmp);
    let at = |part: f64| {
        let index = (part * (times.len().saturating_sub(1)) as f64).round() as usize;
        times.get(index).copied().unwrap_or(0.0)
    };
    say!(
        "\ntime per tick on this machine: median {:.0} us, 99 % within {:.0} us, longest {:.0} us\n",
        at(0.5),
        at(0.99),
        at(1.0)
    );
}

/// The overview as PNG and SVG, and close views of the first stops.
fn write_pictures(out: &Path, scene: &Scene<'_>) -> Result<Vec<PathBuf>, Failure> {
    let mut written = Vec::new();
    if let Some(picture) = drawing::overview(scene) {
        written.push(write_png(&out.join("replay.png"), &picture)?);
        let path = out.join("replay.svg");
        write_file(&path, svg::file(&picture).as_bytes())?;
        written.push(path);
    }
    let stops = scene
        .events
        .iter()
        .enumerate()
        .filter(|(_, event)| event.is_stop());
    for (index, _) in stops.take(CLOSE_UPS) {
        if let Some(picture) = drawing::close_up(scene, index) {
            let name = format!("event_{:02}.png", index + 1);
            written.push(write_png(&out.join(name), &picture)?);
        }
    }
    Ok(written)
}

fn write_png(path: &Path, picture: &Picture) -> Result<PathBuf, Failure> {
    let bytes = png::encode(picture, 1.4)
        .ok_or_else(|| Failure::not_checkable(format!("{}: cannot be drawn", path.display())))?;
    write_file(path, &bytes)?;
    Ok(path.to_owned())
}
