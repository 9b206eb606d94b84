//! `haltline import`: worlds of others as scenario files.

use crate::args::ImportBarnArgs;
use crate::failure::{Exit, Failure, write_whole};
use haltline_scenarios::barn::{Options, World};

/// Writes a world of BARN as a scenario.
///
/// # Errors
/// The world cannot be used, the file exists, or it cannot be written.
pub fn barn(args: &ImportBarnArgs) -> Result<Exit, Failure> {
    let world = World::read(&args.file).map_err(|error| Failure::input(error.to_string()))?;
    let shown = args.output.display();
    if args.output.exists() && !args.force {
        return Err(Failure::input(format!(
            "{shown}: exists already and is not overwritten; name another file or add --force"
        )));
    }
    let options = Options {
        sensor_bound_m: args.sensor_bound,
    };
    write_whole(&args.output, world.scenario_text(&options).as_bytes())?;
    say!(
        "wrote {shown}: {} cylinders, {} via points of {} path points",
        world.cylinders_m.len(),
        world.via_m().len(),
        world.path_m.len()
    );
    say!("Drive it: haltline run {shown}");
    Ok(Exit::Holds)
}
