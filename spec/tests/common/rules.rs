//! What every single decision has to keep: limits, ramps, expiry.

use super::episode::{CURVATURE_MAX, Episode};
use super::report::Report;
use haltline::decision::{Action, Decision};
use haltline_spec::plant::SetPoint;

/// Rounding of set points to whole micro-units, generously.
const EPS: f64 = 1e-5;

fn speeds(set_point: SetPoint) -> [f64; 2] {
    match set_point {
        SetPoint::Twist(twist) => [twist.v_mps, twist.omega_radps],
        SetPoint::Arc {
            v_mps,
            curvature_per_m,
        } => [v_mps, v_mps * curvature_per_m],
    }
}

/// Checks one decision against the one before; broken rules go into the report.
pub fn check(
    episode: &Episode,
    log: &[(f64, SetPoint)],
    set_point: SetPoint,
    decision: &Decision,
    now_us: u64,
    report: &mut Report,
) {
    let Some(&(before_s, before)) = log.last() else {
        return;
    };
    let mut broken = |id: &str, holds: bool| {
        if !holds {
            report.faults.push(format!(
                "{id}: t={:.3} {before:?} -> {set_point:?} {:?} {:?}",
                now_us as f64 * 1e-6,
                decision.action,
                decision.reason
            ));
        }
    };
    let ([v, w], [v_old, w_old]) = (speeds(set_point), speeds(before));
    broken("LIMIT-01", v.abs() <= episode.speed_mps + EPS);
    if let SetPoint::Arc {
        curvature_per_m, ..
    } = set_point
    {
        broken("LIMIT-05", curvature_per_m.abs() <= CURVATURE_MAX + EPS);
    } else {
        broken("LIMIT-02", w.abs() <= episode.turn_radps + EPS);
    }
    let age_us = decision
        .expires
        .as_us()
        .saturating_sub(now_us + super::run::EPOCH_US);
    broken(
        "SILENT-01",
        age_us <= (episode.period_ms + episode.jitter_ms) * 1000,
    );
    let accepted = matches!(decision.action, Action::Pass | Action::Slow);
    if accepted {
        let dt_s = (now_us as f64 * 1e-6 - before_s).min(1.0) + episode.jitter_ms as f64 * 1e-3;
        let speeding = v.abs() > v_old.abs() && v * v_old >= 0.0;
        broken(
            "LIMIT-04",
            !speeding || (v - v_old).abs() <= episode.braking_mps2 * dt_s + EPS,
        );
    } else {
        broken(
            "BRAKE-06",
            v.abs() <= v_old.abs() + EPS && w.abs() <= w_old.abs() + EPS,
        );
        if !episode.steered && !episode.separate {
            // Cross product of the two twists: zero as long as the ratio is kept.
            broken("BRAKE-03", (v * w_old - w * v_old).abs() <= 1e-4);
        }
    }
}
