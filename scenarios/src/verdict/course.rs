//! Where the robot must have gone, and where it must have stopped.

use super::{Sentences, stands};
use crate::file::{Expect, StoppedBefore};
use crate::result::{RunResult, Sample};

/// Judges where the robot went against the expectations about it.
pub(super) fn judge(sentences: &mut Sentences, expect: &Expect, run: &RunResult) {
    if let Some(reached) = expect.reached {
        sentences.demand(run.reached == reached, || {
            format!("Goal reached: {}, expected: {reached}.", run.reached)
        });
    }
    amounts(sentences, expect, run);
    if let Some(before) = &expect.stopped_before {
        stopped(sentences, before, run);
    }
}

fn stopped(sentences: &mut Sentences, before: &StoppedBefore, run: &RunResult) {
    sentences.demand(stands(run), || {
        "The robot still moves at the end.".to_owned()
    });
    if let Some(least) = before.clearance_m {
        let clearance = run.samples.last().and_then(|sample| sample.clearance_m);
        let enough = clearance.is_some_and(|clearance| clearance >= least.get());
        sentences.demand(enough, || {
            let found = clearance.map_or_else(
                || "There is no body to keep clear of".to_owned(),
                |clearance| format!("Stopped {clearance:.3} m from the nearest body"),
            );
            format!("{found}, expected at least {:.3} m.", least.get())
        });
    }
    let beyond = |value: fn(&Sample) -> f64| {
        run.samples
            .iter()
            .map(value)
            .fold(f64::NEG_INFINITY, f64::max)
    };
    for (name, limit, farthest) in [
        ("x", before.x_m, beyond(|sample| sample.pose.x_m)),
        ("y", before.y_m, beyond(|sample| sample.pose.y_m)),
    ] {
        if let Some(limit) = limit {
            sentences.demand(farthest <= limit.get(), || {
                format!(
                    "Went to {name} = {farthest:.3} m, expected to stop before {:.3} m.",
                    limit.get()
                )
            });
        }
    }
}

/// How far it drove and how much it turned.
fn amounts(sentences: &mut Sentences, expect: &Expect, run: &RunResult) {
    if let Some(least) = expect.travelled_min_m {
        sentences.demand(run.travelled_m >= least.get(), || {
            format!(
                "Travelled {:.2} m, expected at least {:.2} m.",
                run.travelled_m,
                least.get()
            )
        });
    }
    if let Some(least) = expect.turned_min_rad {
        sentences.demand(run.turned_rad >= least.get(), || {
            format!(
                "Turned {:.2} rad, expected at least {:.2} rad.",
                run.turned_rad,
                least.get()
            )
        });
    }
    if let Some(most) = expect.turned_max_deg {
        let turned = run.turned_rad.to_degrees();
        sentences.demand(turned <= most.get(), || {
            format!(
                "Turned {turned:.0} deg in all, expected at most {:.0} deg.",
                most.get()
            )
        });
    }
    if let Some(most) = expect.travelled_max_m {
        sentences.demand(run.travelled_m <= most.get(), || {
            format!(
                "Travelled {:.2} m, expected at most {:.2} m.",
                run.travelled_m,
                most.get()
            )
        });
    }
}
