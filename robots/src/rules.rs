//! Impossible combinations of values that are each fine by themselves.

use crate::error::{RobotError, Source};
use crate::reader::{Places, example_of};
use crate::robot::{Footprint, Kinematics, Mask, Scanner, Values};
use crate::schema::SCANNERS_MAX;
use haltline::config::MASKS_MAX;

/// How far a scanner may stand outside the footprint: a bumper, not a slip of the unit.
const SCANNER_OVERHANG_M: f64 = 1.0;

/// Steepest wheel angle that any real steering reaches.
const WHEEL_ANGLE_MAX_DEG: f64 = 80.0;

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
    let robot_rules: [fn(&Values) -> Found; 9] = [
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
    let scanner_rules: [fn(&Values, &Scanner, &str) -> Found; 8] = [
        ranges_are_ordered,
        no_return_within_range,
        scan_time_within_period_of_scanner,
        scan_time_within_scan_age,
        scanner_stands_on_robot,
        mask_count,
        masks_inside_footprint,
        no_return_is_known,
    ];
    let of_robot = robot_rules.iter().find_map(|rule| rule(values));
    let of_scanner = || {
        let numbered = values.scanners.iter().enumerate();
        numbered
            .flat_map(|(index, scanner)| {
                let path = format!("scanner[{index}]");
                scanner_rules
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
        n if n > SCANNERS_MAX => found(
            &format!("scanner[{SCANNERS_MAX}]"),
            format!("{n} scanners are more than the kernel was built for"),
            format!("keep at most {SCANNERS_MAX} `[[scanner]]` tables"),
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

fn ranges_are_ordered(_: &Values, scanner: &Scanner, path: &str) -> Found {
    if scanner.range_min_m < scanner.range_max_m {
        return None;
    }
    found(
        &format!("{path}.range_min_m"),
        "the shortest range is not below the longest",
        format!("write less than range_max_m = {}", scanner.range_max_m),
    )
}

fn no_return_within_range(_: &Values, scanner: &Scanner, path: &str) -> Found {
    if scanner.no_return_clear_m <= scanner.range_max_m {
        return None;
    }
    found(
        &format!("{path}.no_return_clear_m"),
        "a beam without return cannot clear more than the scanner's range",
        format!("write at most range_max_m = {}", scanner.range_max_m),
    )
}

fn no_return_is_known(_: &Values, scanner: &Scanner, path: &str) -> Found {
    use crate::robot::Encoding;
    if scanner.encoding != Encoding::ZeroIsInvalid || scanner.no_return_clear_m <= 0.0 {
        return None;
    }
    found(
        &format!("{path}.no_return_clear_m"),
        "with encoding = \"zero_is_invalid\" the scanner never reports that nothing came back \
         within its range",
        "write 0.0",
    )
}

fn scan_time_within_period_of_scanner(_: &Values, scanner: &Scanner, path: &str) -> Found {
    if scanner.scan_time_s * scanner.rate_hz <= 1.0 {
        return None;
    }
    found(
        &format!("{path}.scan_time_s"),
        format!(
            "one scan takes longer than 1/rate_hz = {:.4} s",
            1.0 / scanner.rate_hz
        ),
        "write the time from the first beam to the last, without the blind part of the turn",
    )
}

fn scan_time_within_scan_age(values: &Values, scanner: &Scanner, path: &str) -> Found {
    let age = values.timing.scan_age_max_s;
    if scanner.scan_time_s < age {
        return None;
    }
    found(
        &format!("{path}.scan_time_s"),
        "a scan is older than scan_age_max_s before its last beam is measured",
        format!("write less than {age} or raise scan_age_max_s"),
    )
}

fn scanner_stands_on_robot(values: &Values, scanner: &Scanner, path: &str) -> Found {
    let f = values.footprint;
    let x_out = (scanner.x_m - f.front_m).max(-f.rear_m - scanner.x_m);
    let y_out = (scanner.y_m - f.left_m).max(-f.right_m - scanner.y_m);
    let (key, out) = if x_out > y_out {
        ("x_m", x_out)
    } else {
        ("y_m", y_out)
    };
    if out <= SCANNER_OVERHANG_M {
        return None;
    }
    found(
        &format!("{path}.{key}"),
        format!("the scanner stands {out:.2} m outside the footprint"),
        "write its position from the rotation centre in metres, x forward, y left",
    )
}

fn mask_count(_: &Values, scanner: &Scanner, path: &str) -> Found {
    if scanner.masks.len() <= MASKS_MAX {
        return None;
    }
    found(
        &format!("{path}.mask[{MASKS_MAX}]"),
        format!(
            "{} masks are more than the kernel was built for",
            scanner.masks.len()
        ),
        format!("join rectangles until at most {MASKS_MAX} are left"),
    )
}

fn masks_inside_footprint(values: &Values, scanner: &Scanner, path: &str) -> Found {
    let f = values.footprint;
    let slack = scanner.error_m();
    let fits = |m: &Mask| {
        m.x_min_m >= -f.rear_m - slack
            && m.x_max_m <= f.front_m + slack
            && m.y_min_m >= -f.right_m - slack
            && m.y_max_m <= f.left_m + slack
    };
    for (index, mask) in scanner.masks.iter().enumerate() {
        let path = format!("{path}.mask[{index}]");
        if mask.x_min_m >= mask.x_max_m || mask.y_min_m >= mask.y_max_m {
            let advice = "write x_min_m below x_max_m and y_min_m below y_max_m";
            return found(&path, "the mask has no area", advice);
        }
        if !fits(mask) {
            return found(
                &path,
                "the mask reaches outside the footprint, where it would hide real bodies",
                "enlarge the footprint to hold the part, or shrink the mask",
            );
        }
    }
    None
}
