//! Prints the contract of a robot file, or of one that comes with the project.

use haltline_robots::Robot;
use haltline_robots::contract::Contract;

fn main() {
    let name = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "seekur_jr".to_owned());
    let robot = Robot::embedded(&name).or_else(|_| Robot::load(name.as_ref()));
    let contract = match robot {
        Ok(robot) => Contract::of(&robot),
        Err(error) => {
            eprintln!("{error}");
            std::process::exit(2);
        }
    };
    for check in &contract.checks {
        println!("{:11} {:?}: {}", check.id, check.finding, check.sentence);
    }
    for row in &contract.speed_table {
        println!("{}", row.sentence);
        row.terms
            .iter()
            .for_each(|t| print!("  {} {:.3}", t.name, t.value_m));
        println!();
    }
    for row in &contract.gap_table {
        println!(
            "{} At top speed: {:?}",
            row.sentence, row.gap_at_top_speed_m
        );
        row.terms
            .iter()
            .for_each(|t| print!("  {} {:.3}", t.name, t.value_m));
        println!();
    }
    println!("{} assumed values", contract.assumed.len());
}
