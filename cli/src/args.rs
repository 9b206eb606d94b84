//! The command line, and the help that teaches it.

mod value;

use clap::{Parser, Subcommand, ValueEnum};
use haltline_attack::campaign::Budget;
use std::path::PathBuf;
use value::{above_zero, budget, sensor_bound, setting, shard, skid};

const EXAMPLES: &str = "\
Examples:
  haltline                                      certify the Seekur Jr that comes with the program
  haltline new robot my_robot.toml              start a file for your own robot
  haltline certify my_robot.toml --out out/mine check it; then open out/mine/report.html
  haltline run scenarios/files/thin_pole.toml   drive one scenario and look at the picture
  haltline run FILE --naked                     the same without the guard: it should touch
  haltline barn DIR                             drive all BARN worlds of a folder; table and summary
  haltline attack my_robot.toml --budget 5m     search for a scenario that breaks the claim
  haltline emulate seekur-jr                    an emulated robot to connect to; see drive --help
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
  claims.sarif      failed claims, for code scanning
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
    /// Search for a scenario in which the guarded robot breaks its claim; shrink what is found.
    #[command(
        args_conflicts_with_subcommands = true,
        after_help = "\
Composes worlds, motions, faults and a true robot at the edge of what its file assumes, runs them in
the simulator, and lets an optimiser (CMA-ES) bring each nearer to a violation. Faults come from the
catalogue in scenarios/FAULTS.md. Robustness is the signed distance to a violation: for CLAIM the least
clearance while moving (metres; after a contact minus its speed), for ZONE the distance of the nearest
return from the critical zone, for FRESH and SILENT the time that was left, for LIMIT the speed. LATCH
and INPUT say yes or no. Six searches of eight aim at CLAIM, the others at ZONE and FRESH. Every
tenth scenario is also run without the guard, to say how often the guard had something to do.

What is found is shrunk and written as counterexample_N.toml; `haltline run` replays it to the bit.
Its head says whether a claim is violated (a bug) or which assumption is broken, and by how much.
nearest.toml is the scenario that came nearest. attack.json is the record, and what `merge` joins:
I/N makes every N-th search beginning with the I-th, so shards never overlap and may run anywhere.

With --break each scenario breaks one assumption, and the least break that led to a contact is kept
for each assumption. With --told the kernel alone is told other values than the truth: a false twin.

Exit code: 0 no claim violated, 1 violated, 2 the input is unusable.

Examples:
  haltline attack robots/seekur_jr.toml --budget 2000
  haltline attack my_robot.toml --budget 30m --shard 2/8 --out out/shard_2
  haltline attack merge out/shard_* --out out/attack
  haltline attack robots/seekur_jr.toml --break --budget 5m
  haltline attack robots/seekur_jr.toml --told timing.actuation_latency_s=0.0"
    )]
    Attack(AttackArgs),
    /// Drive a robot, or an emulated one, with the kernel in between.
    #[command(after_help = "\
The kernel drives to a goal itself, or shields it from commands that somebody writes to standard
input: a line `V TURN` each (m/s and rad/s; a steered robot: m/s and 1/m). Commands that are older
than the robot file allows stop the robot; the end of the input ends the drive.

Starting the command is the operator's first reset: look around the robot before. After a latched
stop, or when the motors went off, the line `reset` on standard input or `kill -USR1` of this process
resets again. Ctrl-C, kill, a closed terminal, a panic and a lost deadline all end in a ramp to rest
on the wire; SIGKILL leaves it to the robot's own watchdog.

Only emulators were driven so far (CAVEATS.md). Exit code 1: the robot could not be told to stop;
3: no robot of this kind answered.

Examples, with `haltline emulate seekur-jr --port tcp:127.0.0.1:8101` in another terminal:
  haltline drive robots/seekur_jr.toml --port tcp:127.0.0.1:8101 --scan-from 127.0.0.1:PORT --goal 4,0
  my_planner | haltline drive robots/seekur_jr.toml --port /dev/ttyUSB0 --scan-from 192.168.0.1:2111 --shield")]
    Drive(DriveArgs),
    /// Emulate a robot with its scanner: a pseudo-terminal or socket that answers as the real one.
    #[command(after_help = "\
The robot stands in a corridor with an obstacle, or with --hall in an empty hall. Its scanner
answers on a port of its own (SICK LMS1xx, CoLa ASCII). Both addresses are the first line.

Examples:
  haltline emulate seekur-jr
  haltline emulate pses-car --port tcp:127.0.0.1:5555
  haltline emulate seekur-jr --hall 12")]
    Emulate(EmulateArgs),
    /// Measure what a robot file assumes: braking, latency, tracking, what silence does.
    #[command(after_help = "\
NOTHING GUARDS THESE MOTIONS. Put the robot on a free floor and keep a hand on the stop button.
Five times: straight on and brake, turn on the spot and stop (not a steered robot), straight on and
fall silent until the robot has stopped by itself. From each run: the time until the set point shows,
the decelerations, the dead-man time, the deceleration of the silence. Each figure is printed as the
line to paste: a bound that 95 % of runs keep with 95 % confidence, its sample, and whether the file's
value holds. Exit code 1: some value of the file does not hold.

Examples:
  haltline measure robots/seekur_jr.toml --port /dev/ttyUSB0 --log bench.csv --i-have-cleared-the-floor
  haltline measure robots/seekur_jr.toml --port /dev/ttyUSB0 --turn-only --i-have-cleared-the-floor")]
    Measure(MeasureArgs),
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
    /// Run every proof again, instead of trusting the ledger for these sources; takes minutes,
    /// needs the checkout, and installs what it lacks from Debian.
    #[arg(long)]
    pub prove: bool,
}

/// Arguments of `attack`.
#[derive(Debug, clap::Args)]
pub struct AttackArgs {
    /// Join shards instead of searching.
    #[command(subcommand)]
    pub merge: Option<AttackCommand>,
    /// Robot file.
    #[arg(required = true)]
    pub robot: Option<PathBuf>,
    /// How much to try: a number of runs (rounded up to whole searches), or a time such as 90s, 5m, 2h.
    #[arg(long, value_name = "N|TIME", default_value = "1200", value_parser = budget)]
    pub budget: Budget,
    /// How scenarios are chosen.
    #[arg(long, value_enum, default_value_t = AttackStrategy::Search)]
    pub strategy: AttackStrategy,
    /// Seed of everything; the same seed makes the same searches on every machine.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// This process makes every N-th search, beginning with the I-th: for campaigns on many machines.
    #[arg(long, value_name = "I/N", default_value = "1/1", value_parser = shard)]
    pub shard: [u64; 2],
    /// Break an assumption in each scenario, and keep the least break that leads to a contact.
    #[arg(long = "break")]
    pub breaking: bool,
    /// Go on after a claim was violated.
    #[arg(long)]
    pub keep_going: bool,
    /// Another value for a key of the robot file, such as limits.braking_mps2=0.4; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    pub set: Vec<(String, String)>,
    /// What the kernel alone is told instead of the truth, as --set; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    pub told: Vec<(String, String)>,
    /// Folder to write attack.json and counterexamples to.
    #[arg(long, value_name = "DIR", default_value = "out/attack")]
    pub out: PathBuf,
}

/// What else `attack` does.
#[derive(Debug, Subcommand)]
pub enum AttackCommand {
    /// Join the folders of shards into one record.
    Merge {
        /// Folders that `haltline attack --shard` wrote.
        #[arg(required = true)]
        folders: Vec<PathBuf>,
        /// Folder to write to.
        #[arg(long, value_name = "DIR", default_value = "out/attack")]
        out: PathBuf,
    },
}

/// How an attack chooses scenarios.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AttackStrategy {
    /// Each at random.
    Random,
    /// Structures at random, numbers by an optimiser.
    Search,
}

/// Arguments of `drive`.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("mode").required(true).args(["goal", "shield"]))]
pub struct DriveArgs {
    /// Robot file.
    pub robot: PathBuf,
    /// Serial line (/dev/ttyUSB0) or tcp:HOST:PORT.
    #[arg(long, value_name = "PORT")]
    pub port: String,
    /// HOST:PORT of the scanner (CoLa ASCII).
    #[arg(long, value_name = "ADDR")]
    pub scan_from: String,
    /// Speed of the serial line, baud [default: 38400 for a Seekur Jr, 921600 for a model car].
    #[arg(long, value_name = "BAUD")]
    pub baud: Option<u32>,
    /// Skid factor: how far the robot turns for each turn that its wheels tell (see `haltline measure`).
    #[arg(long, value_name = "XI", value_parser = skid)]
    pub skid: Option<f64>,
    /// Drive to X,Y (metres ahead and to the left of where it stands now) and take the heading DEG there.
    #[arg(long, value_name = "X,Y[,DEG]", allow_hyphen_values = true)]
    pub goal: Option<String>,
    /// Pass on commands from standard input as far as the guard allows.
    #[arg(long)]
    pub shield: bool,
    /// Adapter, where the robot's name does not tell it: seekur-jr or pses-car.
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// End after so many seconds.
    #[arg(long = "for", value_name = "S", allow_negative_numbers = true, value_parser = above_zero)]
    pub for_s: Option<f64>,
    /// Write scans and odometry to a file that `haltline replay --format sena` reads.
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
}

/// Arguments of `emulate`.
#[derive(Debug, clap::Args)]
pub struct EmulateArgs {
    /// seekur-jr or pses-car.
    pub robot: String,
    /// `pty`, or tcp:HOST:PORT (port 0: any).
    #[arg(long, value_name = "PORT", default_value = "pty")]
    pub port: String,
    /// Robot file with other values [default: the one that comes with the program].
    #[arg(long, value_name = "FILE")]
    pub file: Option<PathBuf>,
    /// Skid factor: how far the robot turns for each turn that its wheels tell (see `haltline measure`).
    #[arg(long, value_name = "XI", value_parser = skid)]
    pub skid: Option<f64>,
    /// An empty hall with a wall so many metres ahead, instead of the corridor with an obstacle.
    #[arg(long = "hall", value_name = "AHEAD_M", allow_negative_numbers = true, value_parser = above_zero)]
    pub hall_m: Option<f64>,
}

/// Arguments of `measure`.
#[derive(Debug, clap::Args)]
pub struct MeasureArgs {
    /// Robot file.
    pub robot: PathBuf,
    /// Serial line (/dev/ttyUSB0) or tcp:HOST:PORT.
    #[arg(long, value_name = "PORT")]
    pub port: String,
    /// Adapter, where the robot's name does not tell it: seekur-jr or pses-car.
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Speed of the serial line, baud [default: 38400 for a Seekur Jr, 921600 for a model car].
    #[arg(long, value_name = "BAUD")]
    pub baud: Option<u32>,
    /// Skid factor: how far the robot turns for each turn that its wheels tell (see `haltline measure`).
    #[arg(long, value_name = "XI", value_parser = skid)]
    pub skid: Option<f64>,
    /// Only turn on the spot, twice to each side, and calibrate the skid factor from the true turn.
    #[arg(long)]
    pub turn_only: bool,
    /// Write every feedback of the drive to this file (CSV).
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,
    /// Speed to measure at, m/s.
    #[arg(long = "speed", value_name = "MPS", default_value_t = 0.5)]
    pub speed_mps: f64,
    /// The floor is free and somebody holds the stop button.
    #[arg(long)]
    pub i_have_cleared_the_floor: bool,
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
