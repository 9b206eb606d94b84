//! What a run leaves behind: everything a report needs, and nothing that depends on the machine.

use haltline_robots::Change;
use serde::Serialize;

pub use crate::navigation::{NavigationRecord, ProgressChange, ProgressRecord, RefusalRecord};

/// Pose of the rotation centre in the world: metres and radians, REP 103.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PoseRecord {
    /// Position along x.
    pub x_m: f64,
    /// Position along y.
    pub y_m: f64,
    /// Heading, counter-clockwise from x, in (−π, π].
    pub theta_rad: f64,
}

/// Outline of the robot, distances from the rotation centre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FootprintRecord {
    /// To the front edge.
    pub front_m: f64,
    /// To the rear edge.
    pub rear_m: f64,
    /// To the left edge.
    pub left_m: f64,
    /// To the right edge.
    pub right_m: f64,
}

/// One line of the downsampled course.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sample {
    /// Time since the start of the run.
    pub t_s: f64,
    /// True pose.
    pub pose: PoseRecord,
    /// True forward speed.
    pub v_mps: f64,
    /// True turn rate.
    pub omega_radps: f64,
    /// Exact distance from the footprint to the nearest body; none in an empty world.
    pub clearance_m: Option<f64>,
}

/// A change of what the guard decided, or of why.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DecisionChange {
    /// Time of the tick.
    pub t_s: f64,
    /// Action of the decision; `naked` while no guard runs.
    pub decision: String,
    /// Its reason.
    pub reason: String,
    /// True pose at the tick.
    pub pose: PoseRecord,
    /// The point that decided, in the world; none if the guard named none.
    pub point_m: Option<[f64; 2]>,
}

/// The robot came to rest after it had moved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stop {
    /// When it came to rest.
    pub t_s: f64,
    /// Action in force then.
    pub decision: String,
    /// Reason in force then.
    pub reason: String,
    /// Where.
    pub pose: PoseRecord,
    /// Distance to the nearest body there.
    pub clearance_m: Option<f64>,
}

/// Footprint and a body began to overlap.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contact {
    /// First dynamics step of the overlap at which the robot moved; if it never did, the first of all.
    pub t_s: f64,
    /// Name of the body.
    pub body: String,
    /// Whether the robot moved (above its rest thresholds) at any step of the overlap.
    pub robot_moving: bool,
    /// Forward speed at that step.
    pub v_mps: f64,
    /// Turn rate at that step.
    pub omega_radps: f64,
    /// Pose at that step.
    pub pose: PoseRecord,
    /// Ids of the broken assumptions that could explain it, if the robot was guarded and moved.
    pub assumptions: Vec<String>,
    /// Why the claim does not speak of it, if it does not: one of the words of [`crate::monitor`].
    pub outside: Option<String>,
}

/// Outline of a body in its own frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ShapeRecord {
    /// A line without thickness.
    Segment {
        /// One end.
        from_m: [f64; 2],
        /// The other end.
        to_m: [f64; 2],
    },
    /// A rectangle around the body's origin.
    Box {
        /// Full extents along the body's x and y.
        size_m: [f64; 2],
    },
    /// A disc around the body's origin.
    Circle {
        /// Radius.
        radius_m: f64,
    },
}

/// Where a body was at some time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BodyPose {
    /// Time since the start of the run.
    pub t_s: f64,
    /// Pose of the body's frame in the world.
    pub pose: PoseRecord,
}

/// A body as drawn in a report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BodyRecord {
    /// Name from the file, or its kind and number.
    pub name: String,
    /// Outline.
    pub shape: ShapeRecord,
    /// Whether a laser cannot see it.
    pub invisible: bool,
    /// Poses over time; a single entry if it never moves.
    pub poses: Vec<BodyPose>,
}

/// Everything to draw around the robot.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WorldRecord {
    /// All bodies.
    pub bodies: Vec<BodyRecord>,
    /// Goal centre, if there is one.
    pub goal_m: Option<[f64; 2]>,
    /// Goal radius.
    pub goal_radius_m: Option<f64>,
    /// Points to pass on the way.
    pub via_m: Vec<[f64; 2]>,
}

/// A tick at which a monitored requirement did not hold.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Violation {
    /// Time of the tick (or dynamics step).
    pub t_s: f64,
    /// What was seen and what the requirement wants.
    pub what: String,
}

/// One monitor's account of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MonitorReport {
    /// Requirement it watches: `CLAIM`, `LIMIT`, `ZONE`, `FRESH`, `SILENT`, `LATCH`.
    pub id: String,
    /// How many ticks it judged.
    pub checked: u64,
    /// At how many of them the requirement had something to say (it was not vacuous).
    pub engaged: u64,
    /// Number of violations in all.
    pub violation_count: u64,
    /// The first of them.
    pub violations: Vec<Violation>,
    /// Least signed distance to a violation, negative once violated; none where there is none to measure. Metres for
    /// ZONE, seconds for FRESH and SILENT, m/s or rad/s for LIMIT; CLAIM's is the clearance while moving.
    #[serde(skip)]
    pub margin: Option<f64>,
}

/// An assumption of the robot's contract that the scenario did not keep.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct BrokenAssumption {
    /// Short id: `A-BRAKE`, `A-LATENCY`, ...
    pub id: String,
    /// What was assumed, and what the simulator did instead.
    pub what: String,
}

/// One run of one scenario, guarded or naked.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunResult {
    /// Whether the guard stood between proposal and drive.
    pub guarded: bool,
    /// Time at which the run ended: goal, rest for good, or time-out.
    pub time_s: f64,
    /// Whether the rotation centre came within the goal radius.
    pub reached: bool,
    /// Path length of the rotation centre.
    pub travelled_m: f64,
    /// Angle turned, summed without sign.
    pub turned_rad: f64,
    /// Whether the robot was at rest at the end.
    pub at_rest: bool,
    /// Contacts in order of time, those at rest included.
    pub contacts: Vec<Contact>,
    /// Least distance to any body over the run; none in an empty world.
    pub min_clearance_m: Option<f64>,
    /// Least distance to any body while the robot moved.
    pub min_clearance_moving_m: Option<f64>,
    /// Each coming to rest.
    pub stops: Vec<Stop>,
    /// Changes of decision or reason.
    pub decisions: Vec<DecisionChange>,
    /// Course, one sample each tenth of a second.
    pub samples: Vec<Sample>,
    /// World to draw.
    pub world: WorldRecord,
    /// Remembered points at the end, in the world as the robot believes it to be.
    pub remembered_m: Vec<[f64; 2]>,
    /// One report for each monitor; empty in a naked run.
    pub monitors: Vec<MonitorReport>,
    /// What the kernel's own navigator made of its route; none where somebody else proposes.
    pub navigation: Option<NavigationRecord>,
    /// Assumptions the simulator broke.
    pub assumptions_broken: Vec<BrokenAssumption>,
}

impl RunResult {
    /// Contacts during which the robot moved.
    #[must_use]
    pub fn moving_contacts(&self) -> usize {
        self.contacts.iter().filter(|c| c.robot_moving).count()
    }

    /// Violations over all monitors.
    #[must_use]
    pub fn violation_count(&self) -> u64 {
        self.monitors.iter().map(|m| m.violation_count).sum()
    }
}

/// What a case amounts to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Everything expected came true and no monitor objected.
    Pass,
    /// Something did not.
    Fail,
}

/// Pass or fail with the reasons in sentences.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judgement {
    /// The verdict.
    pub outcome: Outcome,
    /// Why, one sentence each; failures first.
    pub sentences: Vec<String>,
}

/// One scenario (or one variant of a sweep): the guarded run, its naked twin and the judgement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaseResult {
    /// Unique name: file stem, and the variant after a slash.
    pub name: String,
    /// File stem alone: what a sweep's variants have in common.
    pub group: String,
    /// Title from the file.
    pub title: String,
    /// Ids of the requirements it covers.
    pub requirements: Vec<String>,
    /// Robot file stem.
    pub robot: String,
    /// Values in which the robot differs from its file.
    pub robot_values: Vec<Change>,
    /// Seed of all noise.
    pub seed: u64,
    /// Obstacle speed bound given to the guard.
    pub obstacle_speed_mps: f64,
    /// Outline to draw.
    pub footprint: FootprintRecord,
    /// Run with the guard.
    pub guarded: RunResult,
    /// Run without it; none if the file says that it is not a contact scenario.
    pub naked: Option<RunResult>,
    /// Why there is no naked twin, from the file.
    pub naked_reason: Option<String>,
    /// Verdict on this case alone.
    pub judgement: Judgement,
}

/// A sweep judged as a whole.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroupResult {
    /// File stem.
    pub group: String,
    /// Number of variants.
    pub variants: usize,
    /// Naked runs that touched.
    pub naked_touched: usize,
    /// Least number of naked runs that must touch.
    pub naked_required: usize,
    /// Guarded runs that touched while moving.
    pub guarded_touched: usize,
    /// Verdict on the sweep.
    pub judgement: Judgement,
}

/// All cases of a batch, in the order of their names.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SuiteResult {
    /// Cases.
    pub cases: Vec<CaseResult>,
    /// Sweeps.
    pub groups: Vec<GroupResult>,
    /// Cases and sweeps that failed.
    pub failed: usize,
}
