//! Makes a found scenario small: whatever can go, goes; whatever can be a rounder number, becomes one.

use crate::setting::Setting;
use crate::trial::{self, Trial, Verdict};
use toml::{Table, Value};

/// Runs spent on one scenario at most.
const RUNS_MAX: usize = 500;

/// A place in a document: keys and indices.
type Path = Vec<Step>;

#[derive(Clone, Debug, PartialEq)]
enum Step {
    Key(String),
    Index(usize),
}

/// The smallest scenario found that shows the same as `shown` and breaks no other assumption, and the runs it took.
#[must_use]
pub fn shrink(setting: &Setting, text: &str, shown: &Trial) -> (String, usize) {
    let Ok(document) = text.parse::<Table>() else {
        return (text.to_owned(), 0);
    };
    let mut best = Value::Table(document);
    let mut runs = 0;
    let mut keeps = |candidate: &Value| {
        if runs >= RUNS_MAX {
            return false;
        }
        runs += 1;
        let text = toml::to_string(candidate).unwrap_or_default();
        trial::run(setting, &text).shows(shown)
    };
    let breaks = matches!(shown.verdict, Verdict::Broken { .. });
    loop {
        let before = best.clone();
        removed(&mut best, breaks, &mut keeps);
        if !breaks {
            rounder(&mut best, &mut keeps);
        }
        if best == before {
            break;
        }
    }
    let text = toml::to_string(&best).unwrap_or_else(|_| text.to_owned());
    (text, runs)
}

/// What says whose scenario it is and what it is judged by stays.
const FIXED: [&str; 9] = [
    "title",
    "requirements",
    "robot",
    "robot_values",
    "told",
    "expect",
    "naked",
    "seed",
    "obstacle_speed_mps",
];

/// Removes elements of lists and keys of tables, the last first, as long as the verdict stays.
fn removed(best: &mut Value, breaks: bool, keeps: &mut impl FnMut(&Value) -> bool) {
    let mut all = paths(best);
    all.reverse();
    for path in all.iter().filter(|path| !breaks || !is_a_break(path)) {
        let mut candidate = best.clone();
        if remove(&mut candidate, path) && keeps(&candidate) {
            *best = candidate;
        }
    }
}

/// Whether how far an assumption is broken may hang on this place; it stays, and no number is rounded, so that the
/// file breaks it as far as is said. Whole faults may go.
fn is_a_break(path: &Path) -> bool {
    let first = match path.first() {
        Some(Step::Key(key)) => key.as_str(),
        _ => "",
    };
    matches!(first, "sensor" | "odometry" | "drive") || (first == "fault" && path.len() > 2)
}

/// Rounds numbers to fewer decimals.
fn rounder(best: &mut Value, keeps: &mut impl FnMut(&Value) -> bool) {
    for path in paths(best) {
        let Some(number) = at(best, &path).and_then(|value| value.as_float()) else {
            continue;
        };
        for digits in [0, 1, 2] {
            let scale = 10_f64.powi(digits);
            let round = (number * scale).round() / scale;
            if round.total_cmp(&number).is_eq() {
                break;
            }
            let mut candidate = best.clone();
            if let Some(place) = at(&mut candidate, &path) {
                *place = Value::Float(round);
            }
            if keeps(&candidate) {
                *best = candidate;
                break;
            }
        }
    }
}

/// All places below the top that may change, outer ones first.
fn paths(root: &Value) -> Vec<Path> {
    let mut found = Vec::new();
    let mut open = vec![(Vec::new(), root)];
    while let Some((path, value)) = open.pop() {
        let mut inner: Vec<(Step, &Value)> = Vec::new();
        match value {
            Value::Table(table) => {
                let kept = |key: &str| !(path.is_empty() && FIXED.contains(&key));
                let keys = table.iter().filter(|(key, _)| kept(key));
                inner.extend(keys.map(|(key, value)| (Step::Key(key.clone()), value)));
            }
            Value::Array(list) => {
                inner.extend(list.iter().enumerate().map(|(i, v)| (Step::Index(i), v)));
            }
            _ => {}
        }
        for (step, value) in inner {
            let mut path: Path = path.clone();
            path.push(step);
            found.push(path.clone());
            open.push((path, value));
        }
    }
    found
}

fn at<'v>(root: &'v mut Value, path: &[Step]) -> Option<&'v mut Value> {
    path.iter().try_fold(root, |value, step| match step {
        Step::Key(key) => value.as_table_mut()?.get_mut(key),
        Step::Index(index) => value.as_array_mut()?.get_mut(*index),
    })
}

/// Removes a key, or an element of a list of tables; numbers of a vector stay.
fn remove(root: &mut Value, path: &[Step]) -> bool {
    let Some((last, outer)) = path.split_last() else {
        return false;
    };
    match (at(root, outer), last) {
        (Some(Value::Table(table)), Step::Key(key)) => table.remove(key).is_some(),
        (Some(Value::Array(list)), Step::Index(index)) => {
            let is_table = list.get(*index).is_some_and(Value::is_table);
            if is_table {
                list.remove(*index);
            }
            is_table
        }
        _ => false,
    }
}
