//! The `haltline` command: certify a robot, run scenarios, replay recorded drives, explain requirements.

// Drawing rounds floats to pixels and indices all over; nothing here is part of the safety core.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod args;
mod certificate;
mod claims;
mod explain;
mod failure;
mod junit;
mod new;
mod picture;
mod provenance;
mod report;
mod sena;

use args::{Cli, Command, New};
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
        _ => Ok(Exit::Holds),
    }
}
