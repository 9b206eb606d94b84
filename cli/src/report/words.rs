//! The same words everywhere: terminal, report and certificate.

use crate::picture::Style;
use haltline_robots::Change;
use haltline_scenarios::result::{CaseResult, DecisionChange, NavigationRecord, RunResult, Stop};

/// A name of the kernel, in whichever case it was written, as `snake_case`.
#[must_use]
pub fn snake(word: &str) -> String {
    let mut out = String::new();
    for (i, c) in word.chars().enumerate() {
        if c.is_uppercase() && i > 0 && !out.ends_with('_') {
            out.push('_');
        }
        out.extend(c.to_lowercase());
    }
    out
}

/// A name of the kernel as people read it.
#[must_use]
pub fn reason(word: &str) -> String {
    snake(word).replace('_', " ")
}

/// Longest time for which an objection still explains a rest, seconds.
const AFTERMATH_S: f64 = 0.5;

/// Why the robot came to rest, as people say it.
///
/// A guard that lets a braking robot creep on for a tick passes that tick; what stopped the robot is
/// the objection just before.
#[must_use]
pub fn why_stopped(run: &RunResult, stop: &Stop) -> String {
    let in_words = |decision: &str, why: &str| match snake(decision).as_str() {
        "protective_stop" | "emergency_stop" => format!("{} ({})", reason(why), reason(decision)),
        _ => reason(why),
    };
    if snake(&stop.reason) != "none" {
        return in_words(&stop.decision, &stop.reason);
    }
    let before: Vec<&DecisionChange> = run.decisions.iter().filter(|d| d.t_s <= stop.t_s).collect();
    // Each decision was in force until the next one came.
    let mut end_s = stop.t_s;
    let mut objection = None;
    for decision in before.into_iter().rev() {
        if stop.t_s - end_s > AFTERMATH_S {
            break;
        }
        if snake(&decision.reason) != "none" {
            objection = Some(decision);
            break;
        }
        end_s = decision.t_s;
    }
    objection.map_or_else(
        || "as commanded".to_owned(),
        |decision| in_words(&decision.decision, &decision.reason),
    )
}

/// How the path looks under a decision.
#[must_use]
pub fn path_style(decision: &str) -> Style {
    match snake(decision).as_str() {
        "slow" => Style::PathSlow,
        "brake" => Style::PathBrake,
        "protective_stop" | "emergency_stop" => Style::PathStop,
        "naked" => Style::PathNaked,
        _ => Style::PathPass,
    }
}

/// What became of the guarded run, in a few words.
#[must_use]
pub fn outcome(case: &CaseResult) -> String {
    let run = &case.guarded;
    let contacts = run.moving_contacts();
    let end = if contacts > 0 {
        format!("touched something while moving ({contacts} times)")
    } else if run.reached {
        format!("reached the goal in {:.1} s", run.time_s)
    } else if run.at_rest {
        format!("at rest after {:.1} s", run.time_s)
    } else {
        format!("still moving after {:.1} s", run.time_s)
    };
    match run.min_clearance_moving_m.map(metres) {
        Some(gap) => format!("{end}, nearest while moving {gap}"),
        None => end,
    }
}

/// Least clearance of a run in words.
#[must_use]
pub fn nearest(run: &RunResult) -> Option<String> {
    run.min_clearance_m.map(metres)
}

/// Where a robot differs from its file, if it does.
#[must_use]
pub fn robot_values(changes: &[Change]) -> Option<String> {
    let one =
        |change: &Change| format!("{} = {} (was {})", change.key, change.value, change.before);
    let all: Vec<String> = changes.iter().map(one).collect();
    (!all.is_empty()).then(|| all.join(", "))
}

/// What the kernel's own navigator said at the end, and how often the guard contradicted it.
#[must_use]
pub fn navigated(navigation: &NavigationRecord) -> String {
    let end = &navigation.end;
    let end = match (end.kind.as_str(), &end.reason, end.via) {
        ("blocked", Some(why), _) => {
            let since = end
                .since_s
                .map_or_else(String::new, |t| format!(" since {t:.1} s"));
            let point = end.point_m.map_or_else(String::new, |[x, y]| {
                format!(", by a point at ({x:.2}, {y:.2})")
            });
            format!("blocked: {}{since}{point}", reason(why))
        }
        ("driving", _, Some(via)) => {
            format!(
                "driving, {via} of {} passed",
                count(navigation.via_points, "via point")
            )
        }
        (kind, _, _) => kind.to_owned(),
    };
    let refused = usize::try_from(navigation.refused).unwrap_or(usize::MAX);
    format!(
        "{end}; the guard refused {} of the planner",
        count(refused, "candidate")
    )
}

/// A length for people: millimetres below one metre.
#[must_use]
pub fn metres(value_m: f64) -> String {
    if value_m.abs() < 0.9995 {
        format!("{:.0} mm", value_m * 1e3)
    } else {
        format!("{value_m:.2} m")
    }
}

/// `1 run`, `2 runs`.
#[must_use]
pub fn count(n: usize, noun: &str) -> String {
    if n == 1 {
        format!("1 {noun}")
    } else {
        format!("{n} {noun}s")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_the_kernel_read_the_same_in_either_case() {
        assert_eq!(reason("CriticalZone"), "critical zone");
        assert_eq!(reason("critical_zone"), "critical zone");
        assert_eq!(path_style("ProtectiveStop"), Style::PathStop);
    }

    #[test]
    fn lengths_and_counts_read_well() {
        assert_eq!(metres(0.0314), "31 mm");
        assert_eq!(metres(1.5), "1.50 m");
        assert_eq!(count(1, "run"), "1 run");
        assert_eq!(count(0, "run"), "0 runs");
    }
}
