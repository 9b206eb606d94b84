//! Whatever stands between proposal and drive: the kernel, or in tests something worse.

use haltline::Kernel;
use haltline::convert;
use haltline::decision::Decision;
use haltline::input::{Beam, Command, Inputs, Motion, Odometry, Reading, Scan};
use haltline::time::Instant;
use haltline_robots::{BEAMS, MEMORY, Robot, SCANNERS};

use crate::drive::SetPoint;
use crate::math::Pose;
use crate::navigation::Said;
use crate::odometry::RawOdometry;
use crate::proposer::RawCommand;
use crate::sensor::RawScan;

/// Everything that reached the host since the last tick, still as the drivers wrote it.
#[derive(Clone, Debug, Default)]
pub struct TickInputs {
    /// Scans in the order of arrival; stamps on the host's clock.
    pub scans: Vec<RawScan>,
    /// The newest odometry.
    pub odometry: Option<RawOdometry>,
    /// The newest command.
    pub command: Option<RawCommand>,
    /// Stamp of the order to follow the route, handed in with every tick in which it stands.
    pub order_us: Option<u64>,
    /// Emergency stop line.
    pub emergency_stop: bool,
    /// Stamp of a reset.
    pub reset_us: Option<u64>,
}

/// Something that answers ticks with decisions.
pub trait Controller {
    /// One tick.
    fn step(&mut self, inputs: &Inputs<'_>, now: Instant) -> Decision;

    /// What sensors of its own see at the robot's true pose, just before the tick at `now`: those
    /// that the guard knows nothing of, as cameras that look for markers.
    fn sense(&mut self, _truth: &Pose, _now: Instant) {}

    /// The order under which the next tick follows its own route; none: it must not.
    fn order(&mut self, _stamp: Option<Instant>) {}

    /// Via points of its own route; none if somebody else proposes.
    fn via_points(&self) -> Option<usize> {
        None
    }

    /// What its last tick said of the route; `pose` is the true pose at that tick, `base_us` the
    /// origin of the host's clock.
    fn said(&self, _pose: &Pose, _base_us: u64) -> Option<Said> {
        None
    }

    /// Points it remembers, in metres in its own odometry frame.
    fn remembered(&self) -> Vec<[f64; 2]> {
        Vec::new()
    }
}

/// The kernel at the capacities of the robot files.
pub type RobotKernel = Kernel<SCANNERS, BEAMS, MEMORY>;

impl Controller for RobotKernel {
    fn step(&mut self, inputs: &Inputs<'_>, now: Instant) -> Decision {
        Kernel::step(self, inputs, now)
    }

    fn remembered(&self) -> Vec<[f64; 2]> {
        remembered(self)
    }
}

/// Points that a kernel remembers, in metres in its odometry frame.
pub(crate) fn remembered(kernel: &RobotKernel) -> Vec<[f64; 2]> {
    let (x_um, y_um) = kernel.track().anchor_um();
    let anchor_m = [x_um as f64 * 1e-6, y_um as f64 * 1e-6];
    let points = kernel.memory().remembered().iter();
    points
        .map(|point| {
            [
                anchor_m[0] + f64::from(point.x_mm) * 1e-3,
                anchor_m[1] + f64::from(point.y_mm) * 1e-3,
            ]
        })
        .collect()
}

/// Calls a controller with raw data through the kernel's own conversion.
pub fn tick(
    controller: &mut dyn Controller,
    robot: &Robot,
    inputs: &TickInputs,
    now_us: u64,
) -> Decision {
    let beams: Vec<Vec<Beam>> = inputs.scans.iter().map(|s| decode(robot, s)).collect();
    let scans: Vec<Reading<Scan<'_>>> = inputs
        .scans
        .iter()
        .zip(&beams)
        .map(|(scan, beams)| {
            Reading::Value(Scan {
                scanner: scan.scanner,
                stamp: Instant::from_us(scan.stamp_us),
                beams,
            })
        })
        .collect();
    controller.order(inputs.order_us.map(Instant::from_us));
    let inputs = Inputs {
        scans: &scans,
        odometry: inputs.odometry.map_or(Reading::Absent, |o| odometry(&o)),
        command: inputs.command.map_or(Reading::Absent, |c| command(&c)),
        emergency_stop: inputs.emergency_stop,
        reset: inputs.reset_us.map(Instant::from_us),
    };
    controller.step(&inputs, Instant::from_us(now_us))
}

fn decode(robot: &Robot, scan: &RawScan) -> Vec<Beam> {
    let Some(scanner) = robot.values.scanners.get(scan.scanner) else {
        return Vec::new();
    };
    let limits = robot.config.scanners.get(scan.scanner).copied().flatten();
    let Some(limits) = limits else {
        return Vec::new();
    };
    let encoding = scanner.encoding.into();
    scan.ranges_m
        .iter()
        .map(|range| convert::beam(*range, encoding, limits.range_min, limits.range_max))
        .collect()
}

fn odometry(sample: &RawOdometry) -> Reading<Odometry> {
    convert::odometry(
        Instant::from_us(sample.stamp_us),
        sample.pose,
        sample.twist,
        sample.curvature_per_m,
    )
}

fn command(command: &RawCommand) -> Reading<Command> {
    let stamp = Instant::from_us(command.stamp_us);
    match command.motion {
        SetPoint::Twist { v, omega } => convert::twist_command(stamp, v, omega),
        SetPoint::Arc { v, curvature } => convert::arc_command(stamp, v, curvature),
    }
}

/// The decision's set point in SI units.
#[must_use]
pub fn set_point(motion: Motion) -> SetPoint {
    match motion {
        Motion::Twist(twist) => SetPoint::Twist {
            v: f64::from(twist.linear.as_um_per_s()) * 1e-6,
            omega: f64::from(twist.angular.as_urad_per_s()) * 1e-6,
        },
        Motion::Arc { linear, curvature } => SetPoint::Arc {
            v: f64::from(linear.as_um_per_s()) * 1e-6,
            curvature: f64::from(curvature.as_urad_per_m()) * 1e-6,
        },
    }
}
