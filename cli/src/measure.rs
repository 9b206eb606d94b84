//! `haltline measure`: bench figures for what a robot file assumes.

use crate::args::MeasureArgs;
use crate::drive::robot;
use crate::failure::{Exit, Failure};
use haltline_drives::clock::Clock;
use haltline_drives::link;
use haltline_drives::measure::{self, Live};
use haltline_drives::robots::Kind;
use haltline_robots::Robot;
use std::fs::File;
use std::io::BufWriter;

/// Turns on the spot and asks how far that really was.
fn skid(robot: &Robot, live: &mut Live, known: f64) -> Result<Exit, Failure> {
    let rate = robot.values.limits.angular_speed_radps / 3.0;
    say!("two turns on the spot to each side, by the wheels; mark where the robot points now");
    let ask = |told: f64| {
        say!(
            "the wheels tell {:+.1} deg. How many did it turn really (left +)? Enter alone ends",
            told.to_degrees()
        );
        let mut line = String::new();
        std::io::stdin().read_line(&mut line).ok()?;
        line.trim().parse().map(f64::to_radians).ok()
    };
    match measure::skid(live, rate, ask).map_err(Failure::not_checkable)? {
        Some(fit) => {
            say!(
                "skid factor {:.3} (standard error {:.3}, {} turns): write --skid {:.3} with drive and measure",
                known * fit.factor,
                known * fit.standard_error,
                fit.turns,
                known * fit.factor
            );
            Ok(Exit::Holds)
        }
        None => Err(Failure::not_checkable(
            "no number of degrees, no skid factor",
        )),
    }
}

/// Drives the bench procedure and prints a figure with its spread for each assumption.
///
/// # Errors
/// Unusable robot file or port, or a procedure that could not be driven to its end.
pub fn measure(args: &MeasureArgs) -> Result<Exit, Failure> {
    let (kind, robot) = robot(&args.robot, args.adapter.as_deref())?;
    if !args.i_have_cleared_the_floor {
        return Err(Failure::input(
            "nothing guards these motions: clear the floor, keep a hand on the stop button, and \
             say so with --i-have-cleared-the-floor",
        ));
    }
    let most = robot.values.limits.speed_forward_mps;
    if !(args.speed_mps > 0.0 && args.speed_mps <= most) {
        return Err(Failure::input(format!(
            "--speed {}: write a speed above 0 and up to the robot's {most} m/s",
            args.speed_mps
        )));
    }
    let clock = Clock::default();
    let known = args.skid.unwrap_or(1.0);
    let adapter = kind.skidding_adapter(&robot, known, std::process::id(), clock.now());
    let link = link::open(&args.port, args.baud.unwrap_or(kind.baud()))
        .map_err(|error| Failure::input(error.to_string()))?;
    let period = robot.config.timing.period;
    let mut live = Live::new(adapter, link, clock, period, kind == Kind::PsesCar);
    if let Some(path) = &args.log {
        let file = File::create(path).map_err(|error| Failure::write(path, &error))?;
        live.log_to(Box::new(BufWriter::new(file)))
            .map_err(|error| Failure::write(path, &error))?;
    }
    if args.turn_only {
        return skid(&robot, &mut live, known);
    }
    say!(
        "{} runs at {} m/s: straight on, brake, turn, fall silent",
        measure::RUNS,
        args.speed_mps
    );
    let outcome =
        measure::run(&robot, &mut live, args.speed_mps).map_err(Failure::not_checkable)?;
    let file = args.robot.display();
    say!("the lines for {file}, by table:");
    for figure in &outcome.figures {
        let table = figure.key.split('.').next().unwrap_or_default();
        say!("[{table}]  {figure}");
    }
    for note in &outcome.notes {
        say!("{note}");
    }
    let holds = outcome.figures.iter().all(|figure| figure.holds);
    Ok(if holds {
        Exit::Holds
    } else {
        Exit::ClaimFailed
    })
}
