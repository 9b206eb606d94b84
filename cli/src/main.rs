//! The `haltline` command: certify a robot, run scenarios, replay recorded drives, explain requirements.

// Drawing rounds floats to pixels and indices all over; nothing here is part of the safety core.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

/// Prints a line; a reader that went away (`haltline ... | head`) is no reason to complain.
macro_rules! say {
    ($($words:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stdout(), $($words)*);
    }};
}

mod args;
mod attack;
mod barn;
mod carmen;
mod certificate;
mod certify;
mod claims;
mod drive;
mod emulate;
mod explain;
mod failure;
mod import;
mod junit;
mod library;
mod measure;
mod measured;
mod mrclam;
mod new;
mod picture;
mod proofs;
mod provenance;
mod replay;
mod report;
mod run;
mod sarif;
mod terminal;
mod timing;

use args::{Cli, Command, Import, New};
use clap::Parser as _;
use console::style;
use failure::{Exit, Failure};
use std::process::ExitCode;

fn main() -> ExitCode {
    match dispatch(Cli::parse().command) {
        Ok(exit) => exit.into(),
        Err(failure) => {
            eprintln!("{} {failure}", style("error:").red().bold().for_stderr());
            failure.exit.into()
        }
    }
}

fn dispatch(command: Option<Command>) -> Result<Exit, Failure> {
    match command {
        Some(Command::Explain(args)) => explain::explain(args.id.as_deref()),
        Some(Command::New {
            what: New::Robot { file },
        }) => new::robot(&file),
        Some(Command::Replay(args)) => replay::replay(&args),
        Some(Command::Certify(args)) => certify::certify(&args),
        Some(Command::Run(args)) => run::run(&args),
        Some(Command::Import {
            what: Import::Barn(args),
        }) => import::barn(&args),
        Some(Command::Barn(args)) => barn::barn(&args),
        Some(Command::Attack(args)) => attack::attack(&args),
        Some(Command::Drive(args)) => drive::drive(&args),
        Some(Command::Emulate(args)) => emulate::emulate(&args),
        Some(Command::Measure(args)) => measure::measure(&args),
        None => certify::default_robot(),
    }
}
