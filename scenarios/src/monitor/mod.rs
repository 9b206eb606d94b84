//! Judges that watch every tick. They see inputs, decisions and the truth, never the kernel.
//!
//! Each monitor states one family of requirements in its own arithmetic, so a mistake in the
//! kernel cannot hide in a shared function. Each has a test in which it fires.

mod brake;
mod claim;
mod fresh;
mod input;
mod latch;
mod limit;
mod news;
mod sight;
mod silent;
mod usable;
mod zone;

#[cfg(test)]
mod tests;

use haltline::decision::{Action, Reason, StopStatus};
use haltline_robots::Robot;

use crate::assumption::Broken;
use crate::controller::TickInputs;
use crate::drive::SetPoint;
use crate::math::Pose;
use crate::result::{MonitorReport, Violation};
use crate::world::World;
pub use claim::{BUMPED, EXCUSED, FORGOTTEN, OUT_OF_SIGHT, UNSEEN, is_outside};
use usable::Newest;

/// A decision in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecisionRecord {
    /// What was done with the desired motion.
    pub action: Action,
    /// Why.
    pub reason: Reason,
    /// State of the stop logic.
    pub status: StopStatus,
    /// What the drive must do.
    pub set_point: SetPoint,
    /// Expiry on the host's clock.
    pub expires_us: u64,
    /// The point that decided, body frame, metres.
    pub point_m: Option<[f64; 2]>,
    /// The kernel drives itself and wants to stand, because it has arrived.
    pub wants_rest: bool,
}

impl DecisionRecord {
    /// Whether it lets a desired motion through that is not standstill.
    #[must_use]
    pub fn moves(&self) -> bool {
        let still = |v: f64| v.abs() < 1e-9;
        self.action < Action::Brake
            && !(still(self.set_point.speed()) && still(self.set_point.turn_rate()))
    }
}

/// One tick as the monitors see it.
pub struct Tick<'a> {
    /// Time since the start of the run.
    pub t_s: f64,
    /// The host's clock.
    pub now_us: u64,
    /// What reached the kernel.
    pub inputs: &'a TickInputs,
    /// What it answered.
    pub decision: &'a DecisionRecord,
    /// True pose now.
    pub pose: Pose,
    /// True pose at a time of the simulator's clock.
    pub pose_at: &'a dyn Fn(u64) -> Pose,
    /// Whether the robot has truly been at rest for its rest time, less two dynamics steps.
    pub rested: bool,
    /// Whether no assumption is broken that concerns the robot itself.
    pub assumptions_hold: bool,
    /// Newest usable stamps, this tick's inputs included.
    newest: Newest,
}

/// How the robot truly stands at a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// It moves.
    Moving,
    /// It does not, but has not rested for its rest time.
    Still,
    /// It has rested for its rest time.
    Rested,
}

/// A contact at one dynamics step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Time.
    pub t_s: f64,
    /// Body.
    pub body: usize,
    /// Pose of the robot.
    pub pose: Pose,
    /// Whether it would be one with the body as that stood at [`Monitors::settled_s`].
    pub stood: bool,
}

/// What was made of a contact.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Judged {
    /// Ids of the broken assumptions that could explain it.
    pub assumptions: Vec<String>,
    /// Why the claim does not speak of it, if it does not.
    pub outside: Option<&'static str>,
}

/// Counts and complaints of one monitor.
#[derive(Clone, Debug)]
struct Ledger {
    report: MonitorReport,
}

/// Violations kept in full; the rest is only counted.
const KEPT: usize = 20;

impl Ledger {
    fn new(id: &str) -> Self {
        Self {
            report: MonitorReport {
                id: id.to_owned(),
                checked: 0,
                engaged: 0,
                violation_count: 0,
                violations: Vec::new(),
                margin: None,
            },
        }
    }

    /// Notes that a tick was judged, and whether the requirement had something to say.
    fn judged(&mut self, engaged: bool) {
        self.report.checked += 1;
        self.report.engaged += u64::from(engaged);
    }

    /// Notes how far a tick was from a violation.
    fn near(&mut self, margin: f64) {
        let least = self.report.margin.map_or(margin, |least| least.min(margin));
        self.report.margin = Some(least);
    }

    fn violated(&mut self, t_s: f64, what: String) {
        self.report.violation_count += 1;
        let kept = &mut self.report.violations;
        if kept.len() < KEPT {
            kept.push(Violation { t_s, what });
        } else if !claim::is_outside(&what)
            && let Some(place) = kept.iter_mut().find(|one| claim::is_outside(&one.what))
        {
            // What the claim does not speak of must not crowd out what it does.
            *place = Violation { t_s, what };
        }
    }
}

/// All monitors of a run.
pub struct Monitors<'r> {
    robot: &'r Robot,
    newest: Newest,
    claim: claim::Claim,
    brake: brake::Brake,
    limit: limit::Limit,
    zone: zone::Zone,
    fresh: fresh::Fresh,
    silent: silent::Silent,
    latch: latch::Latch,
    input: input::Input,
}

impl<'r> Monitors<'r> {
    /// Monitors at time zero.
    #[must_use]
    pub fn new(robot: &'r Robot, world: &World) -> Self {
        let names = world
            .bodies()
            .iter()
            .map(|body| body.name.clone())
            .collect();
        let moves = world.bodies().iter().map(|b| b.top_speed() > 0.0).collect();
        Self {
            robot,
            newest: Newest::new(robot),
            claim: claim::Claim::new(robot, names, moves),
            brake: brake::Brake::new(),
            limit: limit::Limit::new(),
            zone: zone::Zone::new(),
            fresh: fresh::Fresh::new(),
            silent: silent::Silent::new(),
            latch: latch::Latch::new(),
            input: input::Input::new(),
        }
    }

    /// Judges one tick.
    pub fn tick(&mut self, mut tick: Tick<'_>) {
        let fresh_scans = self.newest.take_in(self.robot, tick.inputs, tick.now_us);
        tick.newest = self.newest.clone();
        self.claim.tick(self.robot, &tick, &fresh_scans);
        self.brake.tick(self.robot, &tick);
        self.limit.tick(self.robot, &tick);
        self.fresh.tick(self.robot, &tick);
        let causes = [
            self.zone.tick(self.robot, &tick, &fresh_scans),
            self.silent.tick(self.robot, &tick),
            self.input.tick(self.robot, &tick),
        ];
        self.latch.tick(self.robot, &tick, causes.contains(&true));
    }

    /// Hears before a tick how far each body is from the footprint, and how the robot stands.
    pub fn stands(&mut self, distances_m: &[f64], standing: Standing) {
        self.claim.stands(distances_m, standing);
    }

    /// Hears which bodies stand where the operator vouched for a free place.
    pub fn vouched(&mut self, bodies: &[usize]) {
        self.claim.vouched(bodies);
    }

    /// A moment so long before the manoeuvre being executed was accepted that a body which stood somewhere then
    /// made that place unknown, if it was not seen there: no tube may lead to it.
    #[must_use]
    pub fn settled_s(&self) -> Option<f64> {
        self.claim.settled_s()
    }

    /// Judges the first dynamics step at which a moving robot overlaps a body.
    pub fn touch(&mut self, touch: Touch, broken: &[Broken]) -> Judged {
        self.claim.touch(self.robot, touch, broken)
    }

    /// The accounts.
    #[must_use]
    pub fn finish(self) -> Vec<MonitorReport> {
        vec![
            self.claim.ledger.report,
            self.brake.ledger.report,
            self.limit.ledger.report,
            self.zone.ledger.report,
            self.fresh.ledger.report,
            self.silent.ledger.report,
            self.latch.ledger.report,
            self.input.ledger.report,
        ]
    }
}

impl<'a> Tick<'a> {
    /// A tick whose newest stamps are filled in by [`Monitors::tick`].
    #[must_use]
    pub fn new(
        (t_s, now_us): (f64, u64),
        inputs: &'a TickInputs,
        decision: &'a DecisionRecord,
        pose_at: &'a dyn Fn(u64) -> Pose,
        (pose, rested): (Pose, bool),
    ) -> Self {
        Self {
            t_s,
            now_us,
            inputs,
            decision,
            pose,
            pose_at,
            rested,
            assumptions_hold: true,
            newest: Newest::default(),
        }
    }
}

/// Whether a point in the body frame lies in the footprint, farther than `border_m` from its outline.
fn covers(robot: &Robot, [x, y]: [f64; 2], border_m: f64) -> bool {
    let outline = &robot.values.footprint;
    x <= outline.front_m - border_m
        && x >= border_m - outline.rear_m
        && y <= outline.left_m - border_m
        && y >= border_m - outline.right_m
}
