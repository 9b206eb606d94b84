//! Values of arguments: what they may be, and what is said where they are not.

use haltline_attack::campaign::Budget;

/// A number of runs, or a time with its unit.
pub(super) fn budget(text: &str) -> Result<Budget, String> {
    let wrong =
        || "write a number of runs such as 2000, or a time such as 90s, 5m or 2h".to_owned();
    let units = [("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let timed = units
        .iter()
        .find_map(|(unit, s)| Some((text.strip_suffix(unit)?, s)));
    match timed {
        None => text.parse().ok().filter(|runs| *runs > 0).map(Budget::Runs),
        Some((number, s)) => number
            .parse::<f64>()
            .ok()
            .filter(|value| *value > 0.0 && value.is_finite())
            .map(|value| Budget::Seconds(value * s)),
    }
    .ok_or_else(wrong)
}

/// `I/N` as the index from 0 and the count.
pub(super) fn shard(text: &str) -> Result<[u64; 2], String> {
    let parts = text
        .split_once('/')
        .and_then(|(index, count)| Some([index.parse::<u64>().ok()?, count.parse::<u64>().ok()?]));
    match parts {
        Some([index, count]) if (1..=count).contains(&index) => Ok([index - 1, count]),
        _ => Err("write I/N with I from 1 to N, such as 2/8".to_owned()),
    }
}

/// `KEY=VALUE`.
pub(super) fn setting(text: &str) -> Result<(String, String), String> {
    text.split_once('=')
        .map(|(key, value)| (key.trim().to_owned(), value.trim().to_owned()))
        .ok_or_else(|| "write KEY=VALUE, such as timing.actuation_latency_s=0.0".to_owned())
}

/// A length or a time that is one.
pub(super) fn above_zero(text: &str) -> Result<f64, String> {
    let value = text.parse().ok();
    value
        .filter(|value: &f64| *value > 0.0 && value.is_finite())
        .ok_or_else(|| "write a number above 0, such as 12".to_owned())
}

/// A skid factor: above 0.05, at most 1.
pub(super) fn skid(text: &str) -> Result<f64, String> {
    let factor = text.parse().ok();
    factor
        .filter(|factor| *factor > 0.05 && *factor <= 1.0)
        .ok_or_else(|| "write a number above 0.05 and at most 1, such as 0.73".to_owned())
}

/// A bound in metres that the simulated noise keeps to.
pub(super) fn sensor_bound(text: &str) -> Result<f64, String> {
    use haltline_scenarios::barn::{NOISE_SIGMA_M, SENSOR_BOUND_MAX_M};
    let least = 3.0 * NOISE_SIGMA_M;
    text.parse::<f64>()
        .ok()
        .filter(|bound| (least..=SENSOR_BOUND_MAX_M).contains(bound))
        .ok_or_else(|| {
            format!(
                "write metres from {least} (three times the simulated noise) to {SENSOR_BOUND_MAX_M}"
            )
        })
}
