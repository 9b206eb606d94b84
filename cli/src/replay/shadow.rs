//! The kernel in shadow: it sees a recorded drive, decides, and nobody obeys.

use super::drive::Moment;
use super::verdict::{ask_guard, hazard};
use crate::failure::Failure;
use crate::picture::view::{Pose, transform};
use haltline::convert::{self, Round};
use haltline::decision::{Decision, StopStatus};
use haltline::input::{Beam, Inputs, Reading, Scan};
use haltline::time::{Duration, Instant};
use haltline::units::{AngularSpeed, Speed};
use haltline_logs::sena::Log;
use haltline_robots::{BEAMS, MEMORY, Robot, RobotConfig, SCANNERS};
use std::time::Instant as WallClock;

/// The kernel of a robot file.
pub type Shadow = haltline::Kernel<SCANNERS, BEAMS, MEMORY>;

/// The largest tolerances that the kernel takes.
const TOLERANCE_MAX: Speed = Speed::from_um_per_s(2_000_000);
const ANGULAR_TOLERANCE_MAX: AngularSpeed = AngularSpeed::from_urad_per_s(2_000_000);

/// What the kernel made of one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judged {
    /// What it would have done.
    pub action: String,
    /// Why.
    pub reason: String,
    /// Why the guard refused the tube, if it did.
    pub refusal: Option<String>,
    /// The point that decided, in the frame of the first row, metres.
    pub point_m: Option<[f64; 2]>,
    /// Speed factor of the certified motion, 0 to 1.
    pub factor: f64,
    /// Remembered points in the frame of the first row, metres.
    pub memory_m: Vec<[f64; 2]>,
    /// Wall time of the tick, microseconds.
    pub wall_us: f64,
}

/// Lets the kernel watch the whole drive.
///
/// # Errors
/// The robot file does not fit the log, or the kernel refuses its configuration.
pub fn watch(robot: &Robot, log: &Log, moments: &[Moment]) -> Result<Vec<Judged>, Failure> {
    check_fit(robot, log)?;
    let config = shadow_config(&robot.config);
    // The kernel holds its points in place; on the heap it spares the stack of this thread.
    let mut kernel = Box::new(Shadow::new(config).map_err(|error| {
        Failure::input(format!("{}: the kernel refuses it: {error:?}", robot.file))
    })?);
    let mut latched = true;
    let mut judged = Vec::with_capacity(moments.len());
    for moment in moments {
        let beams: Option<Vec<Beam>> = moment.row.and_then(|row| log.rows.get(row)).map(|row| {
            row.ranges_m
                .iter()
                .map(|range| encoded(robot, *range))
                .collect()
        });
        let (decision, wall_us) = tick(&mut kernel, &config, moment, beams.as_deref(), latched);
        latched = decision.status == StopStatus::Latched;
        judged.push(judge(&kernel, &decision, moment, wall_us, robot));
    }
    Ok(judged)
}

fn encoded(robot: &Robot, range_m: f32) -> Beam {
    let Some(scanner) = robot.values.scanners.first() else {
        return Beam::Invalid;
    };
    let (min, max) = robot
        .config
        .scanners
        .first()
        .and_then(Option::as_ref)
        .map_or_else(Default::default, |s| (s.range_min, s.range_max));
    convert::beam(range_m, scanner.encoding.into(), min, max)
}

/// One tick: the sweep that ended now, if one did, the odometry of now, and what the driver wanted.
fn tick(
    kernel: &mut Shadow,
    config: &RobotConfig,
    moment: &Moment,
    beams: Option<&[Beam]>,
    latched: bool,
) -> (Decision, f64) {
    let now = instant(moment.t_s);
    let duration = config
        .scanners
        .first()
        .and_then(Option::as_ref)
        .map_or(Duration::ZERO, |scanner| scanner.scan_duration);
    let scans = [beams.map_or(Reading::Absent, |beams| {
        Reading::Value(Scan {
            scanner: 0,
            stamp: now.minus(duration),
            beams,
        })
    })];
    let [wanted_mps, wanted_radps] = moment.wanted;
    let inputs = Inputs {
        scans: &scans,
        odometry: convert::odometry(now, moment.pose, moment.speed, None),
        command: convert::twist_command(now, wanted_mps, wanted_radps),
        emergency_stop: false,
        reset: latched.then_some(now),
    };
    let start = WallClock::now();
    let decision = kernel.step(&inputs, now);
    (decision, start.elapsed().as_secs_f64() * 1e6)
}

/// Log time as kernel time; an hour is added so that nothing lies before the origin.
fn instant(t_s: f64) -> Instant {
    let hour = 3_600.0;
    convert::duration(t_s + hour, Round::Nearest)
        .map_or(Instant::default(), |span| Instant::default().plus(span))
}

/// The robot's own configuration, but for the rules that a recorded robot cannot keep.
///
/// It neither follows the decisions nor comes to rest when told to. Rest counts as reached once the
/// kernel itself commands rest, so that a stop is released when its reason has gone.
fn shadow_config(own: &RobotConfig) -> RobotConfig {
    let mut config = *own;
    let tolerances = &mut config.tolerances;
    tolerances.rest_speed = TOLERANCE_MAX;
    tolerances.rest_angular_speed = ANGULAR_TOLERANCE_MAX;
    tolerances.follow_speed = TOLERANCE_MAX;
    tolerances.follow_angular_speed = ANGULAR_TOLERANCE_MAX;
    config
}

fn check_fit(robot: &Robot, log: &Log) -> Result<(), Failure> {
    let wrong = |what: String| {
        Err(Failure::input(format!(
            "{} does not fit the log: {what}",
            robot.file
        )))
    };
    let [scanner] = robot.values.scanners.as_slice() else {
        return wrong(format!(
            "it has {} scanners, the log has one",
            robot.values.scanners.len()
        ));
    };
    let header = &log.header;
    if usize::from(scanner.beams) != header.beams {
        return wrong(format!("beams = {}, write {}", scanner.beams, header.beams));
    }
    if (scanner.field_of_view_rad - header.aperture_rad).abs() > 1e-3 {
        let degrees = header.aperture_rad.to_degrees();
        return wrong(format!("field_of_view_deg must be {degrees:.1}"));
    }
    let mount = [scanner.x_m, scanner.y_m, scanner.yaw_rad];
    let off = mount
        .iter()
        .zip(header.sensor_m_rad)
        .any(|(own, log)| (own - log).abs() > 1e-3);
    if off {
        let [x, y, yaw] = header.sensor_m_rad;
        return wrong(format!(
            "the scanner must be at x_m = {x}, y_m = {y}, yaw_deg = {}",
            yaw.to_degrees()
        ));
    }
    Ok(())
}

/// The verdict on one moment: a hazard that the kernel saw, else what the guard says of the motion.
fn judge(
    kernel: &Shadow,
    decision: &Decision,
    moment: &Moment,
    wall_us: f64,
    robot: &Robot,
) -> Judged {
    let mut judged = match hazard(kernel, decision, moment, robot) {
        Some(hazard) => hazard,
        None => ask_guard(kernel, moment),
    };
    judged.wall_us = wall_us;
    judged.memory_m = kernel
        .memory()
        .clouds()
        .last()
        .map_or_else(Vec::new, |points| {
            let known = points.iter().filter(|p| p.x_mm.unsigned_abs() < 32_000);
            known
                .map(|p| in_world(moment.pose, p.x_mm, p.y_mm))
                .collect()
        });
    judged
}

/// A body-frame point in millimetres, in the frame of the first row.
#[must_use]
pub fn in_world(pose: Pose, x_mm: i16, y_mm: i16) -> [f64; 2] {
    transform(pose, [f64::from(x_mm) / 1e3, f64::from(y_mm) / 1e3])
}
