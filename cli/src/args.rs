//! The command line, and the help that teaches it.

use clap::{Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  haltline                                      certify the Seekur Jr that comes with the program
  haltline new robot my_robot.toml              start a file for your own robot
  haltline certify my_robot.toml --out out/mine check it; then open out/mine/report.html
  haltline run scenarios/files/thin_pole.toml   drive one scenario and look at the picture
  haltline run FILE --naked                     the same without the guard: it should touch
  haltline barn DIR                             drive all BARN worlds of a folder; table and summary
  haltline explain GUARD-01                     read a requirement and what stands behind it

Exit codes:
  0  every claim holds        1  a claim failed (the output says which, when, and how to replay it)
  2  the input is unusable    3  not checkable: something needed for a verdict is missing";

/// A navigation safety kernel with its own evidence.
///
/// `haltline certify ROBOT` checks the limits of a robot against each other, drives it through
/// scenarios with every invariant monitored, and writes a report. Claims are worded as strongly as
/// the evidence: "tested (N runs)" is not "proved", and what nobody examined is "not claimed yet".
#[derive(Debug, Parser)]
#[command(name = "haltline", version, after_help = EXAMPLES, max_term_width = 100)]
pub struct Cli {
    /// What to do; without a command, certify the Seekur Jr into `out/`.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Check a robot: contract, scenarios, timing; write report and certificate.
    #[command(after_help = "\
Writes to the output folder:
  report.html       self-contained; every run drawn, every claim linked to its evidence
  certificate.json  the same for machines; schema in cli/CERTIFICATE.md
  junit.xml         for CI servers
  timing.json       wall times; the only file that differs between two runs

Example:
  haltline certify robots/seekur_jr.toml --out out/seekur && xdg-open out/seekur/report.html")]
    Certify(CertifyArgs),
    /// Drive one scenario; print a summary, draw it, write its trace.
    #[command(after_help = "\
Writes run.svg, run.png and trace.jsonl to the output folder. The trace holds one line per dynamics
step, so that anybody can recount the contacts. Exit code 1 if the run did not come out as its file
expects.

Examples:
  haltline run scenarios/files/corridor_ahead.toml
  haltline run FILE --variant NAME --naked
  haltline run FILE --json | jq .min_clearance_m")]
    Run(RunArgs),
    /// Let the kernel watch a recorded drive: where would it have slowed or stopped, and why?
    #[command(after_help = "\
The kernel runs in shadow: it sees the recorded scans and odometry and is asked to pass the recorded
motion. The recorded robot does not obey it, so every verdict is about one moment, not about a
different history.

Example:
  haltline replay --format sena ../shared/data/sena/sena.csv.gz --out out/sena
  haltline replay --format carmen intel.log --robot my_robot.toml
  haltline replay --format mrclam MRCLAM_Dataset1 --robot 3")]
    Replay(ReplayArgs),
    /// Turn somebody else's world into a scenario file.
    Import {
        /// What the file is.
        #[command(subcommand)]
        what: Import,
    },
    /// Let the kernel drive all BARN worlds of a folder; print a table and the benchmark's score.
    #[command(after_help = "\
Each world is turned into a scenario as `haltline import barn` does it, and driven with every
monitor watching. A world counts as reached within 1 m of the goal, without contact, in 100 s; its
score is T / clip(time, 4 T, 8 T), where T is the way at 2 m/s: at most 0.25.

With --out DIR it also writes barn.csv, barn.json and a picture of each run.
Exit code 1 if the robot touched anything or a monitor objected; a goal that it did not reach is a
result, not a failed claim.

Examples:
  haltline barn ../shared/data/barn
  haltline barn ../shared/data/barn --sensor-bound 0.04 --out out/barn")]
    Barn(BarnArgs),
    /// Print a requirement: its text, its assumptions, its evidence.
    #[command(
        after_help = "Examples:\n  haltline explain FRESH-01\n  haltline explain            list all"
    )]
    Explain(ExplainArgs),
    /// Write a commented file to start from.
    New {
        /// What to start.
        #[command(subcommand)]
        what: New,
    },
}

/// Arguments of `certify`.
#[derive(Debug, clap::Args)]
pub struct CertifyArgs {
    /// Robot file, for instance robots/seekur_jr.toml.
    pub robot: PathBuf,
    /// Folder with scenario files; only those for this robot are run [default: those that come with the program].
    #[arg(long, value_name = "DIR")]
    pub scenarios: Option<PathBuf>,
    /// Folder to write to.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

/// Arguments of `run`.
#[derive(Debug, clap::Args)]
pub struct RunArgs {
    /// Scenario file.
    pub scenario: PathBuf,
    /// Which member of a family of runs [default: the first].
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// Run without the guard.
    #[arg(long)]
    pub naked: bool,
    /// Robot file, instead of the robot that the scenario names.
    #[arg(long, value_name = "FILE")]
    pub robot: Option<PathBuf>,
    /// Folder to write picture and trace to.
    #[arg(long, value_name = "DIR", default_value = "out/run")]
    pub out: PathBuf,
    /// Print one JSON object instead of the summary.
    #[arg(long)]
    pub json: bool,
}

/// Worlds that can be imported.
#[derive(Debug, Subcommand)]
pub enum Import {
    /// A world of the BARN benchmark: cylinders and reference path as CSV.
    #[command(after_help = "\
The file has the header kind,x_m,y_m; its rows are `cylinder,X,Y` (radius 0.075 m) and `path,X,Y`.
The scenario holds the benchmark's task for the Jackal: start (-2, 3), goal (-2, 13), 100 s; the
published path becomes via points, thinned where a straight line keeps as clear of the cylinders.
The robot's values that differ from robots/jackal.toml stand in [robot_values].

Examples:
  haltline import barn world_003.csv -o world_003.toml && haltline run world_003.toml
  haltline import barn world_003.csv -o wide.toml --sensor-bound 0.04")]
    Barn(ImportBarnArgs),
}

/// Arguments of `import barn`.
#[derive(Debug, clap::Args)]
pub struct ImportBarnArgs {
    /// World as CSV.
    pub file: PathBuf,
    /// Scenario file to write.
    #[arg(short, long, value_name = "SCENARIO")]
    pub output: PathBuf,
    /// Bound of the lidar's range error that the kernel is told, in metres.
    #[arg(long, value_name = "M", default_value = "0.005", value_parser = sensor_bound)]
    pub sensor_bound: f64,
    /// Overwrite a file that exists.
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `barn`.
#[derive(Debug, clap::Args)]
pub struct BarnArgs {
    /// Folder with worlds as CSV.
    pub folder: PathBuf,
    /// Bound of the lidar's range error that the kernel is told, in metres.
    #[arg(long, value_name = "M", default_value = "0.005", value_parser = sensor_bound)]
    pub sensor_bound: f64,
    /// Worlds driven at the same time [default: one for each core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
    /// Folder to write table and pictures to [default: none are written].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// A bound in metres that the simulated noise keeps to.
fn sensor_bound(text: &str) -> Result<f64, String> {
    use haltline_scenarios::barn::{NOISE_SIGMA_M, SENSOR_BOUND_MAX_M};
    let least = 3.0 * NOISE_SIGMA_M;
    text.parse::<f64>()
        .ok()
        .filter(|bound| (least..=SENSOR_BOUND_MAX_M).contains(bound))
        .ok_or_else(|| {
            format!(
                "write metres from {least} (three times the simulated noise) to {SENSOR_BOUND_MAX_M}"
            )
        })
}

/// Arguments of `replay`.
#[derive(Debug, clap::Args)]
pub struct ReplayArgs {
    /// Format of the log.
    #[arg(long, value_enum)]
    pub format: LogFormat,
    /// Log file, plain or gzip; for mrclam the data set's folder.
    pub file: PathBuf,
    /// Robot file [default: the SENA robot that comes with the program]; for mrclam the robot's
    /// number [default: 1].
    #[arg(long, value_name = "FILE|N")]
    pub robot: Option<PathBuf>,
    /// Folder to write the pictures to.
    #[arg(long, value_name = "DIR", default_value = "out/replay")]
    pub out: PathBuf,
}

/// Formats of recorded drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LogFormat {
    /// CSV: time, odometry increment and ranges in each line.
    Sena,
    /// A log of the CARMEN toolkit with FLASER lines; the map is drawn, too.
    Carmen,
    /// A folder of the UTIAS multi-robot data sets: the marker filter against known truth.
    Mrclam,
}

/// Arguments of `explain`.
#[derive(Debug, clap::Args)]
pub struct ExplainArgs {
    /// Requirement, for instance BRAKE-02, or a whole group, for instance BRAKE; without one, list all.
    pub id: Option<String>,
}

/// Things to start.
#[derive(Debug, Subcommand)]
pub enum New {
    /// A robot file with every key explained.
    Robot {
        /// File to write; it must not exist.
        #[arg(default_value = "robot.toml")]
        file: PathBuf,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
