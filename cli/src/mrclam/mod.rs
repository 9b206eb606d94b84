//! `haltline replay --format mrclam`: the marker filter on a data set with known truth.
//!
//! The landmarks are unknown at the start and have a position but no direction; the odometry
//! is what the robot was commanded. The start pose is the true one, so that the raw error
//! means something.

mod drive;
mod score;

use crate::args::ReplayArgs;
use crate::failure::{Exit, Failure, prepare, write_file};
use console::style;
use drive::{Counts, Course};
use haltline::marker::Pose2;
use haltline_logs::mrclam::{self as read, DataSet};
use indicatif::{ProgressBar, ProgressStyle};
use score::{Alignment, Distance};
use serde::Serialize;
use std::path::Path;

/// Everything that is printed, for machines.
#[derive(Debug, Serialize)]
struct Summary {
    robot: u16,
    span_s: f64,
    compared: usize,
    trajectory_raw: Distance,
    trajectory_aligned: Distance,
    dead_reckoning_aligned: Distance,
    landmarks_found: usize,
    landmarks_known: usize,
    landmarks_aligned: Distance,
    #[serde(flatten)]
    counts: Counts,
    lost_at_the_end: bool,
}

/// Reads the data set, runs the filter, prints how good it was.
///
/// # Errors
/// The data set is unusable, or the summary cannot be written.
pub fn replay(args: &ReplayArgs) -> Result<Exit, Failure> {
    let robot = robot_number(args.robot.as_deref())?;
    let data = read::read(&args.file, robot)?;
    prepare(&args.out)?;
    let begin_s = data.commands[0].time_s;
    let Some(start) = data.truth.iter().find(|row| row.time_s >= begin_s) else {
        return Err(Failure::input(format!(
            "{}: the true poses of robot {robot} end before its odometry begins",
            args.file.display()
        )));
    };
    let [x, y, theta] = start.pose;
    let bar = progress(data.commands.len() as u64);
    let course = drive::drive(&data, Pose2::new(x, y, theta), || bar.inc(1))?;
    bar.finish_and_clear();
    let summary = summarise(robot, &data, &course)?;
    print(&args.file, &summary, &course.wall_us);
    let json = serde_json::to_vec_pretty(&summary)
        .map_err(|error| Failure::not_checkable(format!("mrclam.json: {error}")))?;
    let path = args.out.join("mrclam.json");
    write_file(&path, &json)?;
    say!("wrote {}", path.display());
    Ok(Exit::Holds)
}

/// The robot's number out of `--robot`.
fn robot_number(given: Option<&Path>) -> Result<u16, Failure> {
    let Some(given) = given else {
        return Ok(1);
    };
    let number = given.to_str().and_then(|text| text.parse().ok());
    number
        .filter(|number| (1..=read::ROBOTS).contains(number))
        .ok_or_else(|| {
            Failure::input(format!(
                "--robot {}: for mrclam write the robot's number, 1 to {}",
                given.display(),
                read::ROBOTS
            ))
        })
}

fn progress(steps: u64) -> ProgressBar {
    let bar = ProgressBar::new(steps);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} odometry samples, {eta}")
    {
        bar.set_style(style);
    }
    bar
}

fn summarise(robot: u16, data: &DataSet, course: &Course) -> Result<Summary, Failure> {
    let estimated = score::paired(data, &course.samples, |sample| sample.pose);
    if estimated.is_empty() {
        return Err(Failure::not_checkable(
            "no odometry sample has a true pose within half a second: nothing to compare with",
        ));
    }
    let reckoned = score::paired(data, &course.samples, |sample| sample.dead_reckoning);
    let alignment = Alignment::of(&estimated);
    let landmarks = score::landmarks(data, course.filter.as_ref());
    let times = (course.samples.first(), course.samples.last());
    Ok(Summary {
        robot,
        span_s: times.1.map_or(0.0, |s| s.time_s) - times.0.map_or(0.0, |s| s.time_s),
        compared: estimated.len(),
        trajectory_raw: Distance::of(&estimated, &Alignment::NONE),
        trajectory_aligned: Distance::of(&estimated, &alignment),
        dead_reckoning_aligned: Distance::of(&reckoned, &Alignment::of(&reckoned)),
        landmarks_found: landmarks.len(),
        landmarks_known: data.landmarks.len(),
        landmarks_aligned: Distance::of(&landmarks, &alignment),
        counts: course.counts,
        lost_at_the_end: course.lost,
    })
}

fn print(folder: &Path, summary: &Summary, wall_us: &[f64]) {
    let distance = |d: &Distance| format!("{:.3} m rms, {:.3} m at most", d.rms_m, d.max_m);
    say!("{}", style(folder.display()).bold());
    say!(
        "robot {}, {:.1} s, landmarks unknown at the start\n",
        summary.robot,
        summary.span_s
    );
    say!(
        "trajectory, raw             {}",
        distance(&summary.trajectory_raw)
    );
    say!(
        "trajectory, aligned         {}",
        distance(&summary.trajectory_aligned)
    );
    say!(
        "by odometry alone, aligned  {}",
        distance(&summary.dead_reckoning_aligned)
    );
    say!(
        "landmarks                   {} of {} found, {}",
        summary.landmarks_found,
        summary.landmarks_known,
        distance(&summary.landmarks_aligned)
    );
    say!(
        "\nmeasurements                {}: {} fused, {} began a landmark, {} gated, {} dropped a landmark,",
        summary.counts.measurements,
        summary.counts.fused,
        summary.counts.added,
        summary.counts.gated,
        summary.counts.removed
    );
    say!(
        "{:27} {} of unknown barcodes, {} of other robots, {} malformed, {} not used",
        "",
        summary.counts.unknown_barcodes,
        summary.counts.robots,
        summary.counts.malformed,
        summary.counts.unused
    );
    say!(
        "pose taken over {} times; {} gaps in the odometry{}",
        summary.counts.relocated,
        summary.counts.odometry_gaps,
        if summary.lost_at_the_end {
            "; lost at the end"
        } else {
            ""
        }
    );
    let mut times = wall_us.to_vec();
    times.sort_by(f64::total_cmp);
    let at = |part: f64| {
        let index = (part * times.len().saturating_sub(1) as f64).round() as usize;
        times.get(index).copied().unwrap_or_default()
    };
    say!(
        "time per update on this machine: median {:.1} us, 99 % within {:.1} us, longest {:.1} us\n",
        at(0.5),
        at(0.99),
        at(1.0)
    );
}
