//! `haltline-verification`: proofs with their ledger, and instruction counts against bounds.

use std::process::ExitCode;
use std::time::Duration;

use haltline_verification::faults::Fate;
use haltline_verification::measure::{coverage, mutants};
use haltline_verification::prove::command::{Engine, Options, checkout, command};
use haltline_verification::prove::tools::ProveError;
use haltline_verification::timing::{BOUNDS, TimingError, build, count};

const USAGE: &str = "usage: haltline-verification prove [FILTER] [--engine kani|cbmc|all] [--stale|--check|--again] [--cap SECONDS]
       haltline-verification faults [FILTER] [--shard I/N]
       haltline-verification timing
       haltline-verification coverage
       haltline-verification mutants [--shard I/N]

  prove    proves what the kernel's specification demands and writes verification/ledger.json;
           installs its tools itself. FILTER is a part of a proof's name.
           --check  only compares the ledger with the sources (exit 1 if one is stale or missing)
           --stale  only runs what the ledger does not hold for the present sources
           --again  runs everything and leaves the ledger as it is; where a tool cannot be had,
                    it says so and compares the ledger with the sources
           --cap    after so many seconds of processor time a run is unknown, which is no pass (default 240)
  faults   puts seeded faults into a copy of the kernel, one at a time; the proof or test named
           for each must fail (exit 1 if one survives). FILTER is a part of a file's or check's name
  timing   counts the instructions of the kernel's ticks under callgrind and
           compares them with the declared bounds (exit 1 if one is exceeded,
           3 if nothing could be measured)
  coverage lines of the safety core that its tests run, by cargo llvm-cov; writes verification/measured.json
  mutants  small changes to the safety core, one at a time, by cargo mutants: every N-th of them, beginning
           with the I-th (default 1/35, an hour); writes verification/measured.json. Both install their tools; both exit with 3 where
           nothing could be measured. A change that no test noticed is a figure, no failure";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["timing"] => match timing() {
            Ok(true) => ExitCode::SUCCESS,
            Ok(false) => ExitCode::from(1),
            Err(error) => {
                eprintln!("error: {error}");
                ExitCode::from(3)
            }
        },
        ["prove", ref rest @ ..] => match options(rest) {
            Some(options) => command(&options),
            None => {
                eprintln!("{USAGE}");
                ExitCode::from(2)
            }
        },
        ["faults", ref rest @ ..] => match shard(rest) {
            Some(shard) => faults(shard),
            None => {
                eprintln!("{USAGE}");
                ExitCode::from(2)
            }
        },
        ["coverage"] => said(coverage::measure(&checkout()).map(|measured| {
            let [ran, all] = measured.lines;
            format!("{ran} of {all} lines of the safety core are run by its tests")
        })),
        ["mutants", ref rest @ ..] => match part(rest) {
            Some(part) => said(mutants::measure(&checkout(), part).map(|measured| {
                let [tried, all] = measured.tried;
                let missed = measured.missed.join("\n  ");
                format!(
                    "{tried} of {all} changes tried, missed {}:\n  {missed}",
                    measured.missed.len()
                )
            })),
            None => {
                eprintln!("{USAGE}");
                ExitCode::from(2)
            }
        },
        ["--help" | "-h" | "help"] => {
            println!("{USAGE}");
            ExitCode::SUCCESS
        }
        _ => {
            eprintln!("{USAGE}");
            ExitCode::from(2)
        }
    }
}

/// Prints what was measured, or why nothing was.
fn said(measured: Result<String, ProveError>) -> ExitCode {
    match measured {
        Ok(words) => {
            println!("{words}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(3)
        }
    }
}

/// `--shard I/N` of the changes that `mutants` tries.
fn part(arguments: &[&str]) -> Option<[u64; 2]> {
    let [number, count] = match *arguments {
        [] => return Some([1, 35]),
        ["--shard", part] => {
            let (number, count) = part.split_once('/')?;
            [number.parse().ok()?, count.parse().ok()?]
        }
        _ => return None,
    };
    (1 <= number && number <= count).then_some([number, count])
}

/// `--shard I/N`, or all; and a filter.
fn shard<'a>(arguments: &[&'a str]) -> Option<((usize, usize), &'a str)> {
    match *arguments {
        [] => Some(((1, 1), "")),
        ["--shard", part, ref rest @ ..] => {
            let (number, of) = part.split_once('/')?;
            let (number, of) = (number.parse().ok()?, of.parse().ok()?);
            let filter = match *rest {
                [] => "",
                [filter] => filter,
                _ => return None,
            };
            (1 <= number && number <= of).then_some(((number, of), filter))
        }
        [filter, ref rest @ ..] if !filter.starts_with('-') => {
            let (shard, more) = shard(rest)?;
            more.is_empty().then_some((shard, filter))
        }
        _ => None,
    }
}

/// Tries the faults; exit code 0 if all of the shard are killed.
fn faults((shard, filter): ((usize, usize), &str)) -> ExitCode {
    match haltline_verification::faults::try_shard(&checkout(), shard, filter) {
        Ok(fates) => {
            let killed = fates
                .iter()
                .filter(|(_, fate)| *fate == Fate::Killed)
                .count();
            println!("{killed} of {} seeded faults killed", fates.len());
            ExitCode::from(u8::from(killed != fates.len() || fates.is_empty()))
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(3)
        }
    }
}

/// Options of `prove`; `None` if they make no sense.
fn options(arguments: &[&str]) -> Option<Options> {
    let mut options = Options {
        filter: String::new(),
        engine: Engine::Cbmc,
        check: false,
        stale: false,
        again: false,
        cap: Duration::from_secs(240),
    };
    let mut rest = arguments.iter();
    while let Some(&word) = rest.next() {
        match word {
            "--check" => options.check = true,
            "--stale" => options.stale = true,
            "--again" => options.again = true,
            "--cap" => options.cap = Duration::from_secs(rest.next()?.parse().ok()?),
            "--engine" => {
                options.engine = match *rest.next()? {
                    "kani" => Engine::Kani,
                    "cbmc" => Engine::Cbmc,
                    "all" => Engine::All,
                    _ => return None,
                }
            }
            filter if !filter.starts_with('-') && options.filter.is_empty() => {
                filter.clone_into(&mut options.filter);
            }
            _ => return None,
        }
    }
    Some(options)
}

/// Measures every scene; whether all stay within their bounds.
fn timing() -> Result<bool, TimingError> {
    let program = build()?;
    let mut holds = true;
    println!("{:>16} {:>12} {:>12}  scene", "", "instructions", "bound");
    for bound in &BOUNDS {
        let instructions = count(&program, bound.scene)?;
        let within = instructions <= bound.instructions;
        holds &= within;
        println!(
            "{:>16} {:>12} {:>12}  {}{}",
            bound.scene,
            instructions,
            bound.instructions,
            bound.what,
            if within { "" } else { "  EXCEEDED" }
        );
    }
    Ok(holds)
}
