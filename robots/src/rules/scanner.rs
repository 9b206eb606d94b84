//! Rules about each scanner.

use haltline::config::MASKS_MAX;

use super::{Found, found};
use crate::robot::Values;
use crate::scanner::{Encoding, Mask, Scanner};

/// Every rule of this file, in the order in which they are applied; the text is the scanner's path.
pub(super) const RULES: &[fn(&Values, &Scanner, &str) -> Found] = &[
    ranges_are_ordered,
    no_return_within_range,
    no_return_is_known,
    scan_time_within_period_of_scanner,
    scan_time_within_scan_age,
    scanner_stands_on_robot,
    mask_count,
    masks_inside_footprint,
];

/// How far a scanner may stand outside the footprint: a bumper, not a slip of the unit.
const SCANNER_OVERHANG_M: f64 = 1.0;

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
