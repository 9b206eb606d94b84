//! What the kernel's own navigator must say at the end, and how often the guard may contradict it.

use super::Sentences;
use crate::file::Expect;
use crate::navigation::{NavigationRecord, ProgressRecord};
use crate::result::RunResult;

/// Judges the navigator's account against the expectations about it.
pub(super) fn judge(sentences: &mut Sentences, expect: &Expect, run: &RunResult) {
    let Some(navigation) = &run.navigation else {
        return;
    };
    let end = &navigation.end;
    if let Some(arrived) = expect.arrived {
        sentences.demand((end.kind == "arrived") == arrived, || {
            let wanted = if arrived {
                "that it has arrived"
            } else {
                "anything but that it has arrived"
            };
            format!(
                "At the end the kernel says {}, expected {wanted}.",
                said(end)
            )
        });
    }
    if let Some(reason) = &expect.blocked_reason {
        let holds = end.kind == "blocked" && end.reason.as_ref() == Some(reason);
        sentences.demand(holds, || {
            format!(
                "At the end the kernel says {}, expected that it is blocked by {reason}.",
                said(end)
            )
        });
    }
    if let Some(most) = expect.refused_max {
        sentences.demand(navigation.refused <= most, || refusals(navigation, most));
    }
    if navigation.refused > 0 {
        let fact = format!(
            "The guard refused {} of the planner's candidates in {} ticks.",
            navigation.refused, navigation.refused_ticks
        );
        sentences.facts.push(fact);
    }
}

fn refusals(navigation: &NavigationRecord, most: u64) -> String {
    let first = navigation
        .refusals
        .first()
        .map_or_else(String::new, |refusal| {
            format!(
                ", first at {:.2} s at ({:.3}, {:.3})",
                refusal.t_s, refusal.pose.x_m, refusal.pose.y_m
            )
        });
    format!(
        "The guard refused {} candidates of the planner{first}; at most {most} were expected.",
        navigation.refused
    )
}

/// The progress in words.
fn said(progress: &ProgressRecord) -> String {
    match (progress.kind.as_str(), &progress.reason, progress.via) {
        ("blocked", Some(reason), _) => {
            let since = progress
                .since_s
                .map_or_else(String::new, |t| format!(" since {t:.2} s"));
            format!("that it is blocked by {reason}{since}")
        }
        ("driving", _, Some(via)) => format!("that it is driving, {via} via points behind it"),
        (kind, _, _) => format!("that it is {kind}"),
    }
}
