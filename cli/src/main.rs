//! The `haltline` command.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod args;
mod failure;
mod picture;
mod report;
mod sena;

use clap::Parser as _;

fn main() {
    let _ = args::Cli::parse();
}
