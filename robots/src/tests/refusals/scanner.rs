//! Rules about what a scanner measures and which part of it is masked.

use super::{Bad, of, seekur};
use crate::{EMBEDDED, Robot};

#[test]
fn ranges_in_wrong_order_are_refused() {
    let bad = seekur("range_min_m = 0.05", "range_min_m = 9.0")
        .and("range_max_m = 18.0", "range_max_m = 9.0");
    bad.refused(
        "range_min_m",
        "the shortest range is not below the longest",
        "range_max_m = 9",
    );
}

#[test]
fn clearing_beyond_the_range_is_refused() {
    let bad = of(2, "no_return_clear_m = 10.0", "no_return_clear_m = 31.0");
    bad.refused(
        "no_return_clear_m",
        "cannot clear more than",
        "at most range_max_m = 30",
    );
}

#[test]
fn clearing_by_lost_measurements_is_refused() {
    let bad = seekur("no_return_clear_m = 0.0", "no_return_clear_m = 5.0");
    bad.refused("no_return_clear_m", "\"zero_is_invalid\"", "write 0.0");
}

#[test]
fn scan_longer_than_its_rate_allows_is_refused() {
    let bad = seekur("scan_time_s = 0.015", "scan_time_s = 0.021");
    bad.refused(
        "scan_time_s",
        "longer than 1/rate_hz = 0.0200 s",
        "without the blind part",
    );
}

#[test]
fn scan_older_than_its_age_limit_when_complete_is_refused() {
    let bad = seekur("scan_time_s = 0.015", "scan_time_s = 0.060").and("= 50.0 ", "= 10.0 ");
    bad.refused("scan_time_s", "before its last beam", "less than 0.06");
}

#[test]
fn scanner_far_off_the_robot_is_refused() {
    let bad = seekur("x_m = 0.527", "x_m = 52.7");
    bad.refused(
        "x_m",
        "stands 52.10 m outside the footprint",
        "in metres, x forward",
    );
    let bad = seekur("y_m = 0.0 ", "y_m = -3.0");
    bad.refused(
        "y_m",
        "stands 2.58 m outside the footprint",
        "in metres, x forward",
    );
}

fn masked(masks: &[[f64; 4]]) -> Bad {
    let tables = masks.iter().map(|[x_min, x_max, y_min, y_max]| {
        format!(
            "[[scanner.mask]]\nx_min_m = {x_min:?}\nx_max_m = {x_max:?}\n\
             y_min_m = {y_min:?}\ny_max_m = {y_max:?}\n"
        )
    });
    let tables: String = tables.collect();
    Bad {
        text: format!("{}{tables}", EMBEDDED[0].1),
    }
}

#[test]
fn masks_within_the_footprint_are_accepted() {
    let good = masked(&[[0.4, 0.6, -0.42, -0.3]]);
    let robot = Robot::parse(&good.text, "good.toml").unwrap();
    assert!(robot.config.scanners[0].unwrap().masks[0].is_some());
}

#[test]
fn mask_without_area_is_refused() {
    let bad = masked(&[[0.5, 0.5, -0.1, 0.1]]);
    bad.refused(
        "[[scanner.mask]]",
        "the mask has no area",
        "x_min_m below x_max_m",
    );
}

#[test]
fn mask_outside_the_footprint_is_refused() {
    let bad = masked(&[[0.5, 0.9, -0.1, 0.1]]);
    bad.refused(
        "[[scanner.mask]]",
        "where it would hide real bodies",
        "shrink the mask",
    );
}

#[test]
fn too_many_masks_are_refused() {
    let bad = masked(&[[0.4, 0.5, -0.1, 0.1]; 5]);
    let error = Robot::parse(&bad.text, "bad.toml").unwrap_err();
    assert!(error.problem.starts_with("5 masks"), "{error}");
}
