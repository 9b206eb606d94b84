//! One tick's work on a route: where to steer, what to propose, what the guard leaves of it.

use super::progress::{Blocked, Obstruction, Progress, Watch, body_point};
use super::route::{Course, Route};
use super::{Planning, proposal};
use crate::decision::{Action, Reason};
use crate::dwa::{self, Plan};
use crate::guard::{BodyPoint, Verdict};
use crate::input::{Odometry, Pose};
use crate::kernel::{Kernel, Outcome, Tick};
use crate::window;

/// What the route needs of the kernel in one tick.
pub(super) struct Pilot<'a, const S: usize, const B: usize, const M: usize> {
    pub kernel: &'a mut Kernel<S, B, M>,
    pub planning: &'a Planning,
    pub course: &'a mut Option<Course>,
    pub watch: &'a mut Watch,
}

/// Where the robot is.
pub(super) struct Here {
    /// The newest odometry.
    pub odometry: Odometry,
    /// Its pose in the frame of the route.
    pub pose: Pose,
}

/// What the caller learns besides the decision.
pub(super) struct Attempt {
    pub progress: Progress,
    pub refused: u8,
    pub refusal: Option<Verdict>,
    pub plan: Option<Plan>,
}

impl Attempt {
    /// The planner was not asked.
    pub const fn held() -> Self {
        Self::of(Progress::Held, None)
    }

    const fn of(progress: Progress, plan: Option<Plan>) -> Self {
        Self {
            progress,
            refused: 0,
            refusal: None,
            plan,
        }
    }
}

impl<const S: usize, const B: usize, const M: usize> Pilot<'_, S, B, M> {
    /// Plans towards the next target and has the candidates judged one after the other.
    ///
    /// # Bound
    /// Two plans, [`dwa::CANDIDATES`] verdicts.
    pub fn drive(&mut self, route: &Route<'_>, tick: &Tick) -> (Outcome, Attempt) {
        let Some(odometry) = self.kernel.track.newest().copied() else {
            return (self.brake(Reason::OdometryMissing, tick), Attempt::held());
        };
        let Some(pose) = route.locate(&odometry.pose) else {
            return (self.brake(Reason::CommandMalformed, tick), Attempt::held());
        };
        let here = Here { odometry, pose };
        let course = Course::of(*self.course, route, &pose);
        if self.course.is_none_or(|before| before.id != course.id) {
            *self.watch = Watch::default();
        }
        *self.course = Some(course);
        let distance_m = course.straight(route, &pose).distance_m;
        let rules = &self.planning.progress;
        //= spec/navigate.md#nav-11
        //# A robot that moves for the given time without coming nearer to its next target MUST stop until it gets another route.
        if self.watch.has_given_up(rules, course.next, distance_m) {
            return self.blocked(tick, Obstruction::NoProgress, None, None);
        }
        let plan = self.steer(route, &course, &here, tick);
        match plan.outcome {
            dwa::Outcome::Moving => self.dispose(plan, route, &here, tick, course.next),
            dwa::Outcome::Arrived => {
                self.watch.pause();
                let mut outcome = self
                    .kernel
                    .braking(Action::Pass, Reason::None, tick.elapsed);
                outcome.factor_permille = 1000;
                (outcome, Attempt::of(Progress::Arrived, Some(plan)))
            }
            // Rolling where a turn is wanted, or backwards: come to rest first.
            dwa::Outcome::Unsuitable => {
                self.watch.pause();
                let progress = Progress::Driving { next: course.next };
                (
                    self.brake(Reason::EmptyWindow, tick),
                    Attempt::of(progress, Some(plan)),
                )
            }
            dwa::Outcome::Blocked(point) => {
                let reason = self.reason(Obstruction::NoWay, route, &here);
                self.blocked(tick, reason, point.and_then(body_point), Some(plan))
            }
            dwa::Outcome::Malformed => (
                self.brake(Reason::CommandMalformed, tick),
                Attempt::of(Progress::Held, Some(plan)),
            ),
        }
    }

    /// The plan along the legs of the route, or if that is blocked, straight to the next target.
    fn steer(&self, route: &Route<'_>, course: &Course, here: &Here, tick: &Tick) -> Plan {
        let straight = course.straight(route, &here.pose);
        let mut onward = course.onward(route, &here.pose, self.ahead_m());
        //= spec/navigate.md#nav-09
        //# Via points MUST be passed in their order, all of them before the destination counts as reached.
        if onward.is_reached() && !straight.is_goal {
            // The route comes by its own end: first what lies before it.
            onward = straight;
        }
        let plan = self.plan(route, here, tick, onward);
        if matches!(plan.outcome, dwa::Outcome::Blocked(_)) && onward != straight {
            // What blocks the leg may be passed on the way to its end.
            return self.plan(route, here, tick, straight);
        }
        plan
    }

    /// Takes the first candidate that window and guard accept.
    fn dispose(
        &mut self,
        plan: Plan,
        route: &Route<'_>,
        here: &Here,
        tick: &Tick,
        next: usize,
    ) -> (Outcome, Attempt) {
        let step = tick.elapsed.min(self.kernel.config.config().timing.period);
        let reference = self.kernel.pipeline.last();
        let mut attempt = Attempt::of(Progress::Driving { next }, Some(plan));
        //= spec/navigate.md#nav-05
        //# When the guard refuses a candidate, the next ones MUST be tried in their order, at most eight in all, and the robot brakes when none is left.
        for (rank, candidate) in plan.candidates().iter().enumerate() {
            let config = self.kernel.config.config();
            let Some(vertex) = proposal::vertex(config, candidate.velocity) else {
                continue;
            };
            if !window::admissible(config, reference, vertex, step) {
                continue;
            }
            let verdict = self.kernel.judge(&here.odometry, vertex, tick.now);
            //= spec/navigate.md#nav-01
            //# Every set point of the navigator that is not a braking one MUST be certified by the guard in the same tick.
            if verdict.refusal.is_none() {
                self.watch.moved(tick.elapsed);
                let mut outcome = self.kernel.accepted(vertex, 1000, false, verdict);
                if rank > 0 {
                    // Not the planner's first choice: what the guard left of it.
                    (outcome.action, outcome.reason) = (Action::Slow, Reason::GuardLimited);
                }
                return (outcome, attempt);
            }
            attempt.refused = attempt.refused.saturating_add(1);
            attempt.refusal.get_or_insert(verdict);
        }
        let (reason, point) = match attempt.refusal {
            Some(Verdict {
                refusal: Some(refusal),
                point,
                ..
            }) => (Obstruction::Guard(refusal), point),
            _ => (Obstruction::NoWay, None),
        };
        let reason = self.reason(reason, route, here);
        let (mut outcome, blocked) = self.blocked(tick, reason, point, Some(plan));
        outcome.verdict = attempt.refusal;
        attempt.progress = blocked.progress;
        (outcome, attempt)
    }

    /// `reason`, unless the destination itself is taken: that tells the caller more.
    fn reason(&self, reason: Obstruction, route: &Route<'_>, here: &Here) -> Obstruction {
        if self.is_occupied(route, &here.pose) {
            Obstruction::GoalOccupied
        } else {
            reason
        }
    }

    /// Brakes and says why.
    fn blocked(
        &mut self,
        tick: &Tick,
        reason: Obstruction,
        point: Option<BodyPoint>,
        plan: Option<Plan>,
    ) -> (Outcome, Attempt) {
        //= spec/navigate.md#nav-10
        //# While nothing leads on, the navigator MUST report why, the point that decided if one did, and since when.
        let since = self.watch.blocked(tick.now);
        let cause = match reason {
            Obstruction::Guard(_) => Reason::GuardBlocked,
            _ => Reason::PathBlocked,
        };
        let progress = Progress::Blocked(Blocked {
            reason,
            point,
            since,
        });
        (self.brake(cause, tick), Attempt::of(progress, plan))
    }

    fn brake(&mut self, reason: Reason, tick: &Tick) -> Outcome {
        self.kernel.braking(Action::Brake, reason, tick.elapsed)
    }
}
