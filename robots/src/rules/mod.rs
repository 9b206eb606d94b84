//! Impossible combinations of values that are each fine by themselves.

mod kernel;
mod robot;
mod scanner;

pub(crate) use kernel::of_kernel;
pub(crate) use robot::watches_rear;

use crate::error::{RobotError, Source};
use crate::reader::Places;
use crate::robot::Values;

/// What a rule answers: the path of the offending value, what is wrong, what to write.
type Found = Option<(String, String, String)>;

fn found(path: &str, problem: impl Into<String>, advice: impl Into<String>) -> Found {
    Some((path.to_owned(), problem.into(), advice.into()))
}

/// Applies every rule; the first violated one is the error.
pub(crate) fn check(
    source: Source<'_>,
    values: &Values,
    places: &Places,
) -> Result<(), RobotError> {
    let of_robot = robot::RULES.iter().find_map(|rule| rule(values));
    let of_scanner = || {
        let numbered = values.scanners.iter().enumerate();
        numbered
            .flat_map(|(index, scanner)| {
                let path = format!("scanner[{index}]");
                scanner::RULES
                    .iter()
                    .filter_map(move |rule| rule(values, scanner, &path))
            })
            .next()
    };
    match of_robot.or_else(of_scanner) {
        None => Ok(()),
        Some((path, problem, advice)) => Err(source.error(&places.of(&path), problem, advice)),
    }
}
