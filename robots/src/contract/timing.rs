//! Checks of reaction times: scans, the drive, the death of the host.

use super::tables::known_ahead;
use super::{Check, Finding, holds_if};
use crate::{Robot, Silence};

pub(super) fn scan_in_time(robot: &Robot, scanner: &crate::Scanner) -> Check {
    let bound = robot.values.timing.scan_age_max_s;
    let value = scanner.scan_time_s + 1.0 / scanner.rate_hz;
    let (name, ms) = (&scanner.name, |s: f64| s * 1000.0);
    Check {
        id: "C-SCAN-AGE",
        title: "Age of a scan when the next one is due against the age limit",
        finding: holds_if(value < bound),
        value,
        bound,
        unit: "s",
        sentence: if value < bound {
            format!(
                "A scan of {name} is {:.0} ms old when the next is complete; the limit of {:.0} ms leaves \
                 {:.0} ms for transport.",
                ms(value),
                ms(bound),
                ms(bound - value)
            )
        } else {
            format!(
                "A scan of {name} is {:.0} ms old when the next is complete, beyond the limit of {:.0} ms: \
                 the robot would stop between scans; raise scan_age_max_s.",
                ms(value),
                ms(bound)
            )
        },
    }
}

pub(super) fn tracking_window_spans_latency(robot: &Robot) -> Check {
    let t = robot.values.timing;
    let value = t.actuation_latency_s + t.odometry_age_max_s + t.period_s;
    let bound = t.tracking_window_s;
    let comparison = if value <= bound {
        "fits into"
    } else {
        "does not fit into: a healthy drive would be stopped; raise tracking_window_s beyond it, not"
    };
    Check {
        id: "C-TRACKING",
        title: "Latency of the drive against the window in which it must follow",
        finding: holds_if(value <= bound),
        value,
        bound,
        unit: "s",
        sentence: format!(
            "From a command to its echo in the odometry it may take {:.0} ms, which {comparison} the \
             window of {:.0} ms.",
            value * 1000.0,
            bound * 1000.0
        ),
    }
}

pub(super) fn host_death(robot: &Robot) -> Check {
    let (h, limits) = (robot.values.host_death, robot.values.limits);
    let v = limits.speed_forward_mps;
    let value = v * h.watchdog_s + v * v / (2.0 * h.braking_mps2);
    let (bound, by) = known_ahead(robot);
    let does = match h.behaviour {
        Silence::Coast => "coasts",
        Silence::Brake => "brakes",
    };
    let distance = format!(
        "If the host dies at {v:.2} m/s the drive goes on for {:.2} s, then {does}: {value:.2} m",
        h.watchdog_s
    );
    //= spec/silent.md#silent-05
    //# A certificate MUST NOT claim freedom from contact after the death of the host unless the tube covers it.
    let (finding, sentence) = if !h.cover_host_death {
        (
            Finding::NotCovered,
            format!("Host failure: not covered. {distance}."),
        )
    } else if value <= bound {
        let sentence = format!("{distance}; the guard keeps that room. Host failure: covered.");
        (Finding::Holds, sentence)
    } else {
        let sentence = format!(
            "{distance}, more than the {bound:.2} m known ahead ({by}); lower speed_forward_mps or \
             watchdog_s, or write cover_host_death = false."
        );
        (Finding::Fails, sentence)
    };
    Check {
        id: "C-HOST",
        title: "Distance after the death of the host",
        finding,
        value,
        bound,
        unit: "m",
        sentence,
    }
}
