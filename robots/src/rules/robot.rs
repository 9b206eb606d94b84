//! Rules about the robot as a whole.

use super::{Found, found};
use crate::SCANNERS;
use crate::reader::example_of;
use crate::robot::{Footprint, Kinematics, Values};

/// Every rule of this file, in the order in which they are applied.
pub(super) const RULES: &[fn(&Values) -> Found] = &[
    footprint_has_area,
    steering_is_possible,
    scanner_count,
    reverse_is_watched,
    rest_is_slower_than_driving,
    jitter_below_period,
    period_within_scan_age,
    period_within_other_ages,
    start_vouches_for_footprint,
];

/// Steepest wheel angle that any real steering reaches.
const WHEEL_ANGLE_MAX_DEG: f64 = 80.0;

fn footprint_has_area(values: &Values) -> Found {
    let Footprint {
        front_m,
        rear_m,
        left_m,
        right_m,
    } = values.footprint;
    let flat = if front_m + rear_m <= 0.0 {
        "length (front_m + rear_m)"
    } else if left_m + right_m <= 0.0 {
        "width (left_m + right_m)"
    } else {
        return None;
    };
    found(
        "footprint",
        format!("the footprint has no {flat}"),
        "write the distances from the rotation centre to the robot's edges in metres",
    )
}

fn steering_is_possible(values: &Values) -> Found {
    let Kinematics::Ackermann(steering) = values.kinematics else {
        return None;
    };
    let angle_deg = (steering.angle_max_rad() + steering.tolerance_rad).to_degrees();
    if angle_deg <= WHEEL_ANGLE_MAX_DEG {
        return None;
    }
    found(
        "steering.turning_radius_m",
        format!("this turning radius needs a wheel angle of {angle_deg:.0} deg"),
        "write the least radius of the path of the rear axle's midpoint, as measured",
    )
}

fn scanner_count(values: &Values) -> Found {
    match values.scanners.len() {
        0 => found("", "the robot has no scanner", example_of("scanner")),
        n if n > SCANNERS => found(
            &format!("scanner[{SCANNERS}]"),
            format!("{n} scanners are more than the kernel was built for"),
            format!("keep at most {SCANNERS} `[[scanner]]` tables"),
        ),
        _ => None,
    }
}

fn reverse_is_watched(values: &Values) -> Found {
    let limits = values.limits;
    if limits.speed_reverse_mps <= 0.0 || limits.reverse_into_memory || watches_rear(values) {
        return None;
    }
    found(
        "limits.speed_reverse_mps",
        "reverse is allowed, but no scanner sees the space behind the rear edge",
        "write `speed_reverse_mps = 0.0`, add a rear `[[scanner]]`, or write \
         `reverse_into_memory = true` to reverse only into space remembered as free",
    )
}

/// Whether the strip right behind the rear edge lies in the scanners' view.
///
/// Looked at in steps of 50 mm along a line 0.1 m behind the edge.
pub(crate) fn watches_rear(values: &Values) -> bool {
    let Footprint {
        rear_m,
        left_m,
        right_m,
        ..
    } = values.footprint;
    let steps = ((left_m + right_m) / 0.05).ceil().max(1.0);
    (0..=steps as u32).all(|step| {
        let y = -right_m + (left_m + right_m) * f64::from(step) / steps;
        let mut scanners = values.scanners.iter();
        scanners.any(|scanner| scanner.sees(-rear_m - 0.1, y))
    })
}

fn rest_is_slower_than_driving(values: &Values) -> Found {
    let (tolerances, limits) = (values.tolerances, values.limits);
    if tolerances.rest_speed_mps >= limits.speed_forward_mps {
        return found(
            "tolerances.rest_speed_mps",
            "the robot would count as resting at its top speed",
            format!("write a speed well below {}", limits.speed_forward_mps),
        );
    }
    if tolerances.rest_angular_speed_radps >= limits.angular_speed_radps {
        return found(
            "tolerances.rest_angular_speed_radps",
            "the robot would count as resting at its highest turn rate",
            format!("write a rate well below {}", limits.angular_speed_radps),
        );
    }
    None
}

fn jitter_below_period(values: &Values) -> Found {
    let timing = values.timing;
    if timing.jitter_s < timing.period_s {
        return None;
    }
    found(
        "timing.jitter_s",
        "the jitter is as long as a whole control period",
        format!("write less than period_s = {}", timing.period_s),
    )
}

fn period_within_scan_age(values: &Values) -> Found {
    let timing = values.timing;
    if timing.period_s <= timing.scan_age_max_s {
        return None;
    }
    found(
        "timing.period_s",
        "between two ticks every scan grows older than scan_age_max_s, so no tick could move",
        format!(
            "write at most {} or raise scan_age_max_s",
            timing.scan_age_max_s
        ),
    )
}

fn period_within_other_ages(values: &Values) -> Found {
    let timing = values.timing;
    let ages = [
        ("odometry_age_max_s", timing.odometry_age_max_s),
        ("command_age_max_s", timing.command_age_max_s),
        ("tracking_window_s", timing.tracking_window_s),
    ];
    let (key, _) = ages.into_iter().find(|(_, age)| *age < timing.period_s)?;
    found(
        &format!("timing.{key}"),
        format!("`{key}` is shorter than one control period"),
        format!("write at least period_s = {}", timing.period_s),
    )
}

fn start_vouches_for_footprint(values: &Values) -> Found {
    let (clear, radius) = (values.memory.clear_at_start_m, values.footprint.radius_m());
    if clear <= 0.0 || clear >= radius {
        return None;
    }
    found(
        "memory.clear_at_start_m",
        format!("the vouched circle is smaller than the robot (farthest corner {radius:.3} m)"),
        "write 0.0 to vouch for nothing, or a radius beyond the farthest corner",
    )
}
