//! `haltline-verification timing`: instruction counts of the kernel against their declared bounds.

use std::process::ExitCode;

use haltline_verification::timing::{BOUNDS, TimingError, build, count};

const USAGE: &str = "usage: haltline-verification timing

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
