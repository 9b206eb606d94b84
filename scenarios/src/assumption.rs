//! Which assumptions of the contract a scenario breaks, found by comparing what the simulator
//! does with what the robot file says. A contact then has a name instead of an excuse.

use haltline_robots::{Encoding, Robot};

use crate::drive::DriveModel;
use crate::file::fault::{FaultEntry, FaultKind};
use crate::file::{Scenario, Silence};
use crate::math::seconds;
use crate::result::BrokenAssumption;
use crate::sensor::ScannerModel;
use crate::world::World;

/// A broken assumption: for one body or for all, from some moment on.
#[derive(Clone, Debug, PartialEq)]
pub struct Broken {
    /// Id in `spec/assumptions.md`, such as `A-BRAKE`.
    pub id: &'static str,
    /// What was assumed and what happened.
    pub what: String,
    /// The only body concerned, if it is one.
    pub body: Option<usize>,
    /// Since when.
    pub from_s: f64,
}

impl Broken {
    fn always(id: &'static str, what: String) -> Self {
        Self {
            id,
            what,
            body: None,
            from_s: 0.0,
        }
    }

    /// Whether it could explain touching `body` at `t_s`.
    #[must_use]
    pub fn covers(&self, body: usize, t_s: f64) -> bool {
        self.body.is_none_or(|only| only == body) && t_s >= self.from_s
    }

    /// Whether it is broken at `t_s`, and not by a single body.
    #[must_use]
    pub fn concerns_all(&self, t_s: f64) -> bool {
        self.body.is_none() && t_s >= self.from_s
    }

    /// As it stands in results.
    #[must_use]
    pub fn record(&self) -> BrokenAssumption {
        BrokenAssumption {
            id: self.id.to_owned(),
            what: self.what.clone(),
        }
    }
}

/// What the operator vouches for at a reset.
pub const START: &str = "A-START";

/// Margin for comparing decimal numbers from two files.
const EPSILON: f64 = 1e-9;

/// Everything a scenario breaks that is known before it runs.
///
/// `odometry_error` are the relative errors of distance and angle of this run's odometer.
#[must_use]
pub fn broken(
    robot: &Robot,
    scenario: &Scenario,
    world: &World,
    odometry_error: [f64; 2],
) -> Vec<Broken> {
    let drive = DriveModel::new(robot, scenario);
    let mut found = drive_breaks(robot, &drive);
    found.extend(skid_break(robot, scenario));
    found.extend(odometry_breaks(robot, &drive, odometry_error));
    found.extend(sensor_breaks(robot, scenario));
    found.extend(body_breaks(robot, scenario, world));
    found.extend(fault_breaks(robot, scenario, &drive));
    found
}

fn drive_breaks(robot: &Robot, drive: &DriveModel) -> Vec<Broken> {
    let (limits, timing) = (&robot.values.limits, &robot.values.timing);
    let mut found = Vec::new();
    if drive.braking < limits.braking_mps2 - EPSILON
        || drive.angular_braking < limits.angular_braking_radps2 - EPSILON
    {
        found.push(Broken::always(
            "A-BRAKE",
            format!(
                "the brakes give {} m/s2 and {} rad/s2, {} and {} are assumed",
                drive.braking,
                drive.angular_braking,
                limits.braking_mps2,
                limits.angular_braking_radps2
            ),
        ));
    }
    let latency_s = seconds(drive.latency_us) + drive.lag_s;
    if latency_s > timing.actuation_latency_s + EPSILON {
        found.push(Broken::always(
            "A-LATENCY",
            format!(
                "latency and lag of the drive are {latency_s:.3} s, {} s are assumed",
                timing.actuation_latency_s
            ),
        ));
    }
    if drive.separate && limits.ramps == haltline_robots::Ramps::Together {
        found.push(Broken::always(
            "A-FOLLOW",
            "the drive ramps speed and turn rate separately, joint ramps are assumed".to_owned(),
        ));
    }
    found
}

fn skid_break(robot: &Robot, scenario: &Scenario) -> Option<Broken> {
    let skid = scenario.drive.skid?;
    let slid_m = libm::hypot(skid.ahead_m.get(), skid.left_m.get());
    let allowed_m = robot.values.tolerances.tracking_m;
    (slid_m > allowed_m + EPSILON).then(|| Broken {
        id: "A-TRACKING",
        what: format!("the robot skids by {slid_m:.3} m, {allowed_m} m are assumed"),
        body: None,
        from_s: skid.from_s.get(),
    })
}

fn odometry_breaks(robot: &Robot, drive: &DriveModel, [linear, angular]: [f64; 2]) -> Vec<Broken> {
    let tolerances = &robot.values.tolerances;
    // The wheels turn by 1/slip for each radian over the ground.
    let angular = (1.0 + angular) / drive.slip - 1.0;
    let bad = linear.abs() > tolerances.odometry_m_per_m + EPSILON
        || angular.abs() > tolerances.odometry_rad_per_rad + EPSILON;
    let what = format!(
        "odometry errs by {linear:.4} m/m and {angular:.4} rad/rad, {} and {} are assumed",
        tolerances.odometry_m_per_m, tolerances.odometry_rad_per_rad
    );
    bad.then(|| Broken::always("A-ODOMETRY", what))
        .into_iter()
        .collect()
}

fn sensor_breaks(robot: &Robot, scenario: &Scenario) -> Vec<Broken> {
    let worst = |scanner: &haltline_robots::Scanner| {
        let model = ScannerModel::new(scanner, scenario);
        let error_m = model.bias_m.abs() + 3.0 * model.sigma_m;
        (error_m > scanner.error_m() + EPSILON).then(|| {
            let what = format!(
                "ranges err by up to {error_m:.3} m, {:.3} m are assumed",
                scanner.error_m()
            );
            Broken::always("A-SENSOR", what)
        })
    };
    robot.values.scanners.iter().filter_map(worst).collect()
}

fn body_breaks(robot: &Robot, scenario: &Scenario, world: &World) -> Vec<Broken> {
    let width = robot.values.memory.body_width_min_m;
    let speed = scenario.obstacle_speed_mps.get();
    let mut found = Vec::new();
    for (index, body) in world.bodies().iter().enumerate() {
        let mut note = |id, what| {
            found.push(Broken {
                id,
                what,
                body: Some(index),
                from_s: 0.0,
            });
        };
        if body.invisible {
            note(
                "A-VISIBLE",
                format!("no beam comes back from {}", body.name),
            );
        }
        if body.shape.width() < width - EPSILON {
            note(
                "A-WIDTH",
                format!(
                    "{} is {:.3} m wide, {width} m are assumed",
                    body.name,
                    body.shape.width()
                ),
            );
        }
        if body.top_speed() > speed + EPSILON {
            note(
                "A-OBSTACLE",
                format!(
                    "{} moves at {:.2} m/s, {speed} m/s are assumed",
                    body.name,
                    body.top_speed()
                ),
            );
        }
    }
    found
}

fn fault_breaks(robot: &Robot, scenario: &Scenario, drive: &DriveModel) -> Vec<Broken> {
    let describe = |entry: &toml::Spanned<FaultEntry>| {
        let fault = entry.get_ref();
        let (id, what) = fault_break(robot, scenario, drive, fault)?;
        Some(Broken {
            id,
            what,
            body: None,
            from_s: fault.from_s.get(),
        })
    };
    scenario.fault.iter().filter_map(describe).collect()
}

fn fault_break(
    robot: &Robot,
    scenario: &Scenario,
    drive: &DriveModel,
    fault: &FaultEntry,
) -> Option<(&'static str, String)> {
    let clears = robot.values.scanners.iter().any(|scanner| {
        scanner.no_return_clear_m > 0.0 && scanner.encoding != Encoding::ZeroIsInvalid
    });
    let factor = fault.factor.map_or(1.0, |factor| factor.get());
    let (id, what) = match fault.kind {
        FaultKind::RangesQuantised => return quantised_break(robot, scenario, fault),
        FaultKind::RangesSaturated => ("A-SENSOR", "ranges read less than they should"),
        FaultKind::RangesScaled if (factor - 1.0).abs() > EPSILON => {
            ("A-SENSOR", "ranges are scaled")
        }
        FaultKind::SectorSpoofed => ("A-SENSOR", "beams come back from where nothing is"),
        FaultKind::ScanMirrored => ("A-SENSOR", "scans are mirrored"),
        FaultKind::ScanRotated => ("A-SENSOR", "the scanner is turned on its mount"),
        FaultKind::OdometryScaled => return scaled_break(robot, factor),
        FaultKind::DriveStuck => ("A-LATENCY", "the drive keeps an old set point"),
        FaultKind::DriveIgnoresStop => {
            ("A-BRAKE", "the drive ignores set points that slow it down")
        }
        FaultKind::OdometryJump => ("A-ODOMETRY", "the odometry pose jumps"),
        FaultKind::OdometrySign => ("A-ODOMETRY", "odometry has the wrong sign"),
        FaultKind::OdometryFrozen => ("A-ODOMETRY", "odometry is frozen"),
        FaultKind::ScanFrozen => ("A-SENSOR", "scans are frozen"),
        FaultKind::BeamsLost | FaultKind::RangesInfinite if clears => {
            ("A-NORETURN", "beams that met a body come back from nowhere")
        }
        FaultKind::ScanFuture
        | FaultKind::ScanPast
        | FaultKind::ScanJitter
        | FaultKind::ScanWrapped
        | FaultKind::OdometryFuture
        | FaultKind::ClockForwards
        | FaultKind::ClockBackwards => ("A-CLOCK", "stamps and clock do not agree"),
        FaultKind::HostDeath => return host_death_break(robot, drive),
        FaultKind::HostPause if scenario.drive.honours_expiry == Some(false) => (
            "A-WATCHDOG",
            "the adapter goes on after the decision has expired",
        ),
        _ => return None,
    };
    Some((id, what.to_owned()))
}

/// Rounding to steps errs by half a step, on top of all other errors.
fn quantised_break(
    robot: &Robot,
    scenario: &Scenario,
    fault: &FaultEntry,
) -> Option<(&'static str, String)> {
    let half_m = fault.range_m?.get() / 2.0;
    let worst = |scanner: &haltline_robots::Scanner| {
        let model = ScannerModel::new(scanner, scenario);
        let error_m = model.bias_m.abs() + 3.0 * model.sigma_m + half_m;
        let allowed_m = scanner.error_m();
        (error_m > allowed_m + EPSILON).then(|| {
            format!("coarse ranges err by up to {error_m:.3} m, {allowed_m:.3} m are assumed")
        })
    };
    let what = robot.values.scanners.iter().find_map(worst)?;
    Some(("A-SENSOR", what))
}

fn scaled_break(robot: &Robot, factor: f64) -> Option<(&'static str, String)> {
    let tolerances = &robot.values.tolerances;
    let error = (factor - 1.0).abs();
    let allowed = [tolerances.odometry_m_per_m, tolerances.odometry_rad_per_rad];
    let bad = allowed.iter().any(|allowed| error > allowed + EPSILON);
    let what = format!(
        "odometry counts {factor} times what it should, errors of {} and {} are assumed",
        allowed[0], allowed[1]
    );
    bad.then_some(("A-ODOMETRY", what))
}

fn host_death_break(robot: &Robot, drive: &DriveModel) -> Option<(&'static str, String)> {
    let stated = &robot.values.host_death;
    let what = if !stated.cover_host_death {
        "the host dies, and host failure is not covered"
    } else if drive.silence == Silence::None {
        "the host dies, and the drive never stops by itself"
    } else if seconds(drive.watchdog_us) > stated.watchdog_s + EPSILON
        || drive.silent_braking < stated.braking_mps2 - EPSILON
    {
        "the host dies, and the drive's watchdog is weaker than stated"
    } else {
        return None;
    };
    Some(("A-WATCHDOG", what.to_owned()))
}

#[cfg(test)]
mod tests;
