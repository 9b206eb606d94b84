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
