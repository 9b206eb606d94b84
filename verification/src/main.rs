//! `haltline-verification`: proofs with their ledger, and instruction counts against bounds.

use std::process::ExitCode;
use std::time::Duration;

use haltline_verification::faults::Fate;
use haltline_verification::prove::command::{Engine, Options, checkout, command};
use haltline_verification::timing::{BOUNDS, TimingError, build, count};

const USAGE: &str = "usage: haltline-verification prove [FILTER] [--engine kani|cbmc|all] [--stale] [--check] [--cap SECONDS]
       haltline-verification faults [--shard I/N]
       haltline-verification timing

  prove    proves what the kernel's specification demands and writes verification/ledger.json;
           installs its tools itself. FILTER is a part of a proof's name.
           --check  only compares the ledger with the sources (exit 1 if one is stale or missing)
           --stale  only runs what the ledger does not hold for the present sources
           --cap    after so many seconds a run is unknown, which is no pass (default 240)
  faults   puts seeded faults into a copy of the kernel, one at a time; the proof named
           for each must fail (exit 1 if one survives)
  timing   counts the instructions of the kernel's ticks under callgrind and
           compares them with the declared bounds (exit 1 if one is exceeded,
           3 if nothing could be measured)";

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

/// `--shard I/N`, or all.
fn shard(arguments: &[&str]) -> Option<(usize, usize)> {
    match arguments {
        [] => Some((1, 1)),
        ["--shard", part] => {
            let (number, of) = part.split_once('/')?;
            let (number, of) = (number.parse().ok()?, of.parse().ok()?);
            (1 <= number && number <= of).then_some((number, of))
        }
        _ => None,
    }
}

/// Tries the faults; exit code 0 if all of the shard are killed.
fn faults(shard: (usize, usize)) -> ExitCode {
    match haltline_verification::faults::try_shard(&checkout(), shard) {
        Ok(fates) => {
            let killed = fates
                .iter()
                .filter(|(_, fate)| *fate == Fate::Killed)
                .count();
            println!("{killed} of {} seeded faults killed", fates.len());
            ExitCode::from(u8::from(killed != fates.len()))
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
        cap: Duration::from_secs(240),
    };
    let mut rest = arguments.iter();
    while let Some(&word) = rest.next() {
        match word {
            "--check" => options.check = true,
            "--stale" => options.stale = true,
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
