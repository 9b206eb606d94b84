//! One run: odometry and images in the order of time, a filter, and what it made of them.

use super::camera::{Camera, SightErrors};
use super::chance::Chance;
use super::outlier::{Label, Outliers};
use super::path::Path;
use super::places::Marker;
use crate::math::{Pose, wrap};
use haltline::marker::{
    Frame, FrameReport, Increment, MarkerFilter, OdometryNoise, Pose2, Prediction, Sighting,
};
use haltline::time::Instant;

/// Wheels turn and the robot does not follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slip {
    /// After this way, m.
    pub at_m: f64,
    /// Motion that the odometry reports and that never happened, m.
    pub distance_m: f64,
    /// Turn that the odometry reports and that never happened, rad.
    pub turn_rad: f64,
}

/// A world, a way through it, and everything that goes wrong.
#[derive(Clone, Debug)]
pub struct Setup {
    /// All markers that hang there.
    pub markers: Vec<Marker>,
    /// The cameras, by number.
    pub cameras: Vec<Camera>,
    /// The true way.
    pub path: Path,
    /// Errors of good sightings.
    pub sights: SightErrors,
    /// Errors of the odometry, as the filter's model has them.
    pub odometry: OdometryNoise,
    /// Time between odometry samples, µs.
    pub odometry_period_us: u64,
    /// Slips; each happens within one odometry sample.
    pub slips: Vec<Slip>,
    /// Bad sightings.
    pub outliers: Outliers,
}

/// After one cycle: truth and estimate.
#[derive(Clone, Copy, Debug)]
pub struct StepSample {
    /// Since the start, s.
    pub time_s: f64,
    /// Driven so far, m.
    pub way_m: f64,
    /// The true pose.
    pub truth: Pose,
    /// The estimate.
    pub estimate: Pose2,
    /// Its covariance.
    pub covariance: [[f64; 3]; 3],
    /// Whether any camera detects a marker now.
    pub in_sight: bool,
}

/// One frame that showed markers.
#[derive(Clone, Debug)]
pub struct FrameSample {
    /// Since the start, s.
    pub time_s: f64,
    /// Driven so far, m.
    pub way_m: f64,
    /// What each sighting really was, in the frame's order.
    pub labels: Vec<Label>,
    /// What became of them.
    pub report: FrameReport,
    /// How far the frame moved the estimate, m.
    pub jump_m: f64,
}

/// A whole run.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// One entry per odometry sample but the first.
    pub steps: Vec<StepSample>,
    /// One entry per frame with sightings.
    pub frames: Vec<FrameSample>,
}

/// The kernel's kind of pose.
#[must_use]
pub fn planar(pose: &Pose) -> Pose2 {
    Pose2::new(pose.x, pose.y, wrap(pose.theta))
}

/// Streams of chance, so that more of one thing does not change another.
const ODOMETRY: u64 = 1;
const SIGHTS: u64 = 2;

/// Drives the whole way with a filter.
pub fn run(setup: &Setup, seed: u64, filter: &mut dyn MarkerFilter) -> Trace {
    let mut runner = Runner {
        setup,
        odometry: Chance::new(seed, ODOMETRY),
        sights: Chance::new(seed, SIGHTS),
        before: setup.path.at(0.0),
        trace: Trace::default(),
    };
    let end_us = (setup.path.time_s() * 1e6) as u64;
    let mut time_us = 0;
    while time_us <= end_us {
        runner.move_on(time_us, filter);
        let next_us = time_us + setup.odometry_period_us;
        for (stamp_us, camera) in runner.images(time_us, next_us) {
            runner.look(stamp_us, camera, filter);
        }
        runner.sample(time_us, filter);
        time_us = next_us;
    }
    runner.trace
}

struct Runner<'a> {
    setup: &'a Setup,
    odometry: Chance,
    sights: Chance,
    /// True pose and way at the last odometry sample.
    before: (Pose, f64),
    trace: Trace,
}

/// Stamps start here, so that nothing depends on zero.
fn stamp(time_us: u64) -> Instant {
    Instant::from_us(time_us + 1_000_000)
}

impl Runner<'_> {
    /// One odometry sample: what truly happened plus errors.
    fn move_on(&mut self, time_us: u64, filter: &mut dyn MarkerFilter) {
        let after = self.setup.path.at(time_us as f64 * 1e-6);
        let truth = Increment::between(&planar(&self.before.0), &planar(&after.0));
        let mut told = self.disturbed(&truth);
        let passed = |at_m: f64| self.before.1 < at_m && at_m <= after.1;
        for slip in self.setup.slips.iter().filter(|slip| passed(slip.at_m)) {
            told.forward_m += slip.distance_m;
            told.turn_rad += slip.turn_rad;
        }
        let done = filter.predict(stamp(time_us), &told);
        debug_assert_eq!(done, Prediction::Done);
        self.before = after;
    }

    /// Errors along, across and in turn; the turn's grows evenly, so it bends the way by half.
    fn disturbed(&mut self, truth: &Increment) -> Increment {
        let noise = &self.setup.odometry;
        let way = libm::hypot(truth.forward_m, truth.left_m);
        let turn = truth.turn_rad.abs();
        let along = noise.along_m2_per_m * way + noise.position_m2_per_sample;
        let across = noise.across_m2_per_m * way + noise.position_m2_per_sample;
        let heading = noise.heading_rad2_per_m * way
            + noise.heading_rad2_per_rad * turn
            + noise.heading_rad2_per_sample;
        let chance = &mut self.odometry;
        let mut draw = |variance: f64| libm::sqrt(variance) * chance.normal();
        let (along, across, heading) = (draw(along), draw(across), draw(heading));
        Increment {
            forward_m: truth.forward_m + along - heading * truth.left_m / 2.0,
            left_m: truth.left_m + across + heading * truth.forward_m / 2.0,
            turn_rad: truth.turn_rad + heading,
        }
    }

    /// Images taken in a span of time, in order: (time, camera).
    fn images(&self, from_us: u64, to_us: u64) -> Vec<(u64, usize)> {
        let mut images = Vec::new();
        for (number, camera) in self.setup.cameras.iter().enumerate() {
            let periods = from_us
                .saturating_sub(camera.offset_us)
                .div_ceil(camera.period_us);
            let mut at = camera.offset_us + periods * camera.period_us;
            while at < to_us {
                images.push((at, number));
                at += camera.period_us;
            }
        }
        images.sort_unstable();
        images
    }

    fn look(&mut self, time_us: u64, number: usize, filter: &mut dyn MarkerFilter) {
        let (robot, way_m) = self.setup.path.at(time_us as f64 * 1e-6);
        let camera = &self.setup.cameras[number];
        let mut seen: Vec<(Sighting, Label)> = Vec::new();
        for marker in self
            .setup
            .markers
            .iter()
            .filter(|m| camera.detects(&robot, &m.pose))
        {
            let setup = self.setup;
            let chance = &mut self.sights;
            seen.extend(setup.outliers.report(
                &robot,
                marker,
                &setup.markers,
                &setup.sights,
                chance,
            ));
        }
        if seen.is_empty() {
            return;
        }
        let (sightings, labels): (Vec<Sighting>, Vec<Label>) = seen.into_iter().unzip();
        let before = filter.pose();
        let report = filter.correct(&Frame {
            camera: number as u8,
            stamp: stamp(time_us),
            sightings: &sightings,
        });
        self.trace.frames.push(FrameSample {
            time_s: time_us as f64 * 1e-6,
            way_m,
            labels,
            report,
            jump_m: before.distance_m(&filter.pose()),
        });
    }

    fn sample(&mut self, time_us: u64, filter: &dyn MarkerFilter) {
        let (truth, way_m) = self.before;
        let sees = |camera: &Camera| {
            let mut markers = self.setup.markers.iter();
            markers.any(|marker| camera.detects(&truth, &marker.pose))
        };
        self.trace.steps.push(StepSample {
            time_s: time_us as f64 * 1e-6,
            way_m,
            truth,
            estimate: filter.pose(),
            covariance: filter.pose_covariance(),
            in_sight: self.setup.cameras.iter().any(sees),
        });
    }
}
