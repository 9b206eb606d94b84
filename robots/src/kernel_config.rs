//! From SI values to the kernel's integers: margins up, promises down.
//!
//! Refuses nothing by opinion; only a value that does not fit the kernel's
//! integers is an error, named by its path in the file.

use haltline::config as kernel;
use haltline::convert::{self, Round};
use haltline::time::Duration;
use haltline::units::{Acceleration, AngularAcceleration, AngularSpeed, Length, Ppm, Speed};

use crate::robot::{Kinematics, Ramps, Values};
use crate::scanner::{Mask, Scanner};
use crate::{RobotConfig, SCANNERS};
use Round::{Down, Up};

/// A value that does not fit, by its path in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct DoesNotFit(pub(crate) String);

type Fits<T> = Result<T, DoesNotFit>;

fn named<T>(path: &str, value: Option<T>) -> Fits<T> {
    value.ok_or_else(|| DoesNotFit(path.to_owned()))
}

fn length(path: &str, metres: f64, how: Round) -> Fits<Length> {
    named(path, convert::length(metres, how))
}

fn speed(path: &str, mps: f64, how: Round) -> Fits<Speed> {
    named(path, convert::speed(mps, how))
}

fn angular_speed(path: &str, radps: f64, how: Round) -> Fits<AngularSpeed> {
    named(path, convert::angular_speed(radps, how))
}

fn acceleration(path: &str, mps2: f64) -> Fits<Acceleration> {
    named(path, convert::acceleration(mps2, Down))
}

fn angular_acceleration(path: &str, radps2: f64) -> Fits<AngularAcceleration> {
    named(path, convert::angular_acceleration(radps2, Down))
}

fn duration(path: &str, seconds: f64, how: Round) -> Fits<Duration> {
    named(path, convert::duration(seconds, how))
}

fn ratio(path: &str, value: f64, how: Round) -> Fits<Ppm> {
    named(path, convert::ratio(value, how))
}

/// The kernel's configuration of these values.
pub(crate) fn config(values: &Values) -> Fits<RobotConfig> {
    let mut scanners = [None; SCANNERS];
    for (index, (slot, scanner)) in scanners.iter_mut().zip(&values.scanners).enumerate() {
        *slot = Some(scanner_config(&format!("scanner[{index}]"), scanner)?);
    }
    let f = values.footprint;
    Ok(RobotConfig {
        footprint: kernel::Footprint {
            front: length("footprint.front_m", f.front_m, Up)?,
            rear: length("footprint.rear_m", f.rear_m, Up)?,
            left: length("footprint.left_m", f.left_m, Up)?,
            right: length("footprint.right_m", f.right_m, Up)?,
        },
        kinematics: kinematics(values)?,
        limits: limits(values)?,
        timing: timing(values)?,
        tolerances: tolerances(values)?,
        zone: kernel::ZoneMargins {
            front: length("zone.front_m", values.zone.front_m, Up)?,
            side: length("zone.side_m", values.zone.side_m, Up)?,
        },
        scanners,
        memory: memory(values)?,
        obstacle_speed: speed("obstacles.speed_mps", values.obstacle_speed_mps, Up)?,
        host_death: host_death(values)?,
    })
}

fn kinematics(values: &Values) -> Fits<kernel::Kinematics> {
    let Kinematics::Ackermann(steering) = values.kinematics else {
        return Ok(kernel::Kinematics::Differential);
    };
    let tolerance = steering.curvature_tolerance_per_m();
    Ok(kernel::Kinematics::Ackermann {
        // Up: the tube must hold every curvature the wheels can reach.
        curvature_max: named(
            "steering.turning_radius_m",
            convert::curvature(1.0 / steering.turning_radius_m, Up),
        )?,
        curvature_tolerance: named("steering.tolerance_deg", convert::curvature(tolerance, Up))?,
        steering_sweep: duration("steering.sweep_s", steering.sweep_s, Up)?,
    })
}

fn limits(values: &Values) -> Fits<kernel::Limits> {
    let l = values.limits;
    Ok(kernel::Limits {
        speed_forward: speed("limits.speed_forward_mps", l.speed_forward_mps, Down)?,
        speed_reverse: speed("limits.speed_reverse_mps", l.speed_reverse_mps, Down)?,
        angular_speed: angular_speed("limits.angular_speed_radps", l.angular_speed_radps, Down)?,
        acceleration: acceleration("limits.acceleration_mps2", l.acceleration_mps2)?,
        braking: acceleration("limits.braking_mps2", l.braking_mps2)?,
        angular_acceleration: angular_acceleration(
            "limits.angular_acceleration_radps2",
            l.angular_acceleration_radps2,
        )?,
        angular_braking: angular_acceleration(
            "limits.angular_braking_radps2",
            l.angular_braking_radps2,
        )?,
        ramps: match l.ramps {
            Ramps::Together => kernel::Ramps::Together,
            Ramps::Separate => kernel::Ramps::Separate,
        },
    })
}

/// Reaction times round up; ages, which bound what is still accepted, round down.
fn timing(values: &Values) -> Fits<kernel::Timing> {
    let t = values.timing;
    Ok(kernel::Timing {
        period: duration("timing.period_s", t.period_s, Up)?,
        jitter: duration("timing.jitter_s", t.jitter_s, Up)?,
        actuation_latency: duration("timing.actuation_latency_s", t.actuation_latency_s, Up)?,
        scan_age_max: duration("timing.scan_age_max_s", t.scan_age_max_s, Down)?,
        odometry_age_max: duration("timing.odometry_age_max_s", t.odometry_age_max_s, Down)?,
        command_age_max: duration("timing.command_age_max_s", t.command_age_max_s, Down)?,
        rest: duration("timing.rest_s", t.rest_s, Up)?,
        clear: duration("timing.clear_s", t.clear_s, Up)?,
        tracking_window: duration("timing.tracking_window_s", t.tracking_window_s, Up)?,
    })
}

/// Error bounds round up; thresholds of run-time checks round to the stricter side.
fn tolerances(values: &Values) -> Fits<kernel::Tolerances> {
    let t = values.tolerances;
    Ok(kernel::Tolerances {
        speed: speed("tolerances.speed_mps", t.speed_mps, Up)?,
        angular_speed: angular_speed("tolerances.angular_speed_radps", t.angular_speed_radps, Up)?,
        tracking: length("tolerances.tracking_m", t.tracking_m, Up)?,
        odometry_linear: ratio("tolerances.odometry_m_per_m", t.odometry_m_per_m, Up)?,
        odometry_angular: ratio(
            "tolerances.odometry_rad_per_rad",
            t.odometry_rad_per_rad,
            Up,
        )?,
        rest_speed: speed("tolerances.rest_speed_mps", t.rest_speed_mps, Down)?,
        rest_angular_speed: angular_speed(
            "tolerances.rest_angular_speed_radps",
            t.rest_angular_speed_radps,
            Down,
        )?,
        follow_speed: speed("tolerances.follow_speed_mps", t.follow_speed_mps, Down)?,
        follow_angular_speed: angular_speed(
            "tolerances.follow_angular_speed_radps",
            t.follow_angular_speed_radps,
            Down,
        )?,
    })
}

/// What memory vouches for rounds down.
fn memory(values: &Values) -> Fits<kernel::MemoryRules> {
    let m = values.memory;
    Ok(kernel::MemoryRules {
        clear_after_scans: m.clear_after_scans,
        age_max: duration("memory.age_max_s", m.age_max_s, Down)?,
        clear_at_start: length("memory.clear_at_start_m", m.clear_at_start_m, Down)?,
        skirt: length("memory.skirt_m", m.skirt_m, Down)?,
        body_width_min: length("memory.body_width_min_m", m.body_width_min_m, Down)?,
    })
}

fn host_death(values: &Values) -> Fits<Option<kernel::HostDeath>> {
    let h = values.host_death;
    if !h.cover_host_death {
        return Ok(None);
    }
    Ok(Some(kernel::HostDeath {
        watchdog: duration("host_death.watchdog_s", h.watchdog_s, Up)?,
        braking: acceleration("host_death.braking_mps2", h.braking_mps2)?,
        angular_braking: angular_acceleration(
            "host_death.angular_braking_radps2",
            h.angular_braking_radps2,
        )?,
    }))
}

fn scanner_config(path: &str, scanner: &Scanner) -> Fits<kernel::Scanner> {
    let at = |key: &str| format!("{path}.{key}");
    let angle = |key: &str, radians: f64| named(&at(key), convert::signed_angle(radians));
    let increment = angle("field_of_view_deg", scanner.increment_rad())?;
    let gap = angle("invalid_gap_max_deg", scanner.invalid_gap_max_rad)?;
    let mut masks = [None; haltline::config::MASKS_MAX];
    for (index, (slot, mask)) in masks.iter_mut().zip(&scanner.masks).enumerate() {
        *slot = Some(mask_config(&at(&format!("mask[{index}]")), mask)?);
    }
    Ok(kernel::Scanner {
        x: length(&at("x_m"), scanner.x_m, Round::Nearest)?,
        y: length(&at("y_m"), scanner.y_m, Round::Nearest)?,
        first_beam: named(&at("yaw_deg"), convert::angle(scanner.first_beam_rad()))?,
        increment: named(&at("field_of_view_deg"), i32::try_from(increment).ok())?,
        beams: scanner.beams,
        scan_duration: duration(&at("scan_time_s"), scanner.scan_time_s, Up)?,
        range_min: length(&at("range_min_m"), scanner.range_min_m, Up)?,
        range_max: length(&at("range_max_m"), scanner.range_max_m, Down)?,
        error: length(&at("error_systematic_m"), scanner.error_m(), Up)?,
        no_return_clear: length(&at("no_return_clear_m"), scanner.no_return_clear_m, Down)?,
        invalid_max: ratio(
            &at("invalid_fraction_max"),
            scanner.invalid_fraction_max,
            Down,
        )?,
        // A full turn is one count more than fits.
        invalid_gap_max: u32::try_from(gap).unwrap_or(u32::MAX),
        masks,
    })
}

/// Masks shrink: what they hide must be the robot's own.
fn mask_config(path: &str, mask: &Mask) -> Fits<kernel::MaskRect> {
    Ok(kernel::MaskRect {
        x_min: length(path, mask.x_min_m, Up)?,
        x_max: length(path, mask.x_max_m, Down)?,
        y_min: length(path, mask.y_min_m, Up)?,
        y_max: length(path, mask.y_max_m, Down)?,
    })
}
