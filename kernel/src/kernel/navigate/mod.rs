//! `navigate`: the Dynamic Window Approach proposes, the guard disposes.
//!
//! A [`Navigator`] is a [`Kernel`] with a planner. It follows a [`Route`]
//! through via points to a goal: each tick the planner lists at most eight commands, the
//! guard certifies the first that it can, and when it can certify none the robot brakes.
//! Nothing in here is trusted: a bug can stop the robot, or send it the wrong way, but
//! every motion passes the same guard, window and stop logic as anybody else's.

mod localise;
mod pilot;
mod progress;
mod proposal;
mod route;

pub use localise::Localiser;
pub use progress::{Blocked, Obstruction, Progress, ProgressRules};
pub use route::{Destination, Route, VIA_MAX, Via};

use super::Kernel;
use crate::checked::ConfigError;
use crate::config::Config;
use crate::decision::{Action, Decision, Reason};
use crate::dwa::{Plan, Tuning};
use crate::guard::Verdict;
use crate::input::{Inputs, Reading};
use crate::stop::Mode;
use crate::time::Instant;
use pilot::{Attempt, Pilot};
use progress::Watch;
use route::Course;

/// How to plan; none of it can make the guard accept anything.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Planning {
    /// The planner's preferences.
    pub tuning: Tuning,
    /// When a robot that moves but comes no nearer gives up.
    pub progress: ProgressRules,
}

/// Why a navigator cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum NavigatorError {
    /// The kernel refuses the robot.
    Config(ConfigError),
    /// A preference of the planner is not finite or out of its range, or giving up takes no time.
    Planning,
}

/// What a tick of the navigator answers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Navigation {
    /// What the drive must do.
    pub decision: Decision,
    /// How far the route has come.
    pub progress: Progress,
    /// Commands of the planner that the guard refused in this tick; zero in nominal operation.
    pub refused: u8,
    /// The guard's verdict on the first of them.
    pub refusal: Option<Verdict>,
    /// What the planner proposed, best first; `None` where it was not asked.
    pub plan: Option<Plan>,
}

/// A kernel that drives to goals, hardly larger than a [`Kernel`].
///
/// The planner sees the points that the guard sees, with their inflation. A map of the
/// surroundings is the caller's: [`crate::grid`] has one that rolls with the robot.
#[derive(Clone, Debug)]
pub struct Navigator<const S: usize, const B: usize, const M: usize> {
    kernel: Kernel<S, B, M>,
    planning: Planning,
    course: Option<Course>,
    watch: Watch,
    /// When a latched stop was last released; older routes are void.
    restarted: Instant,
}

impl<const S: usize, const B: usize, const M: usize> Navigator<S, B, M> {
    /// A navigator for the robot of `config`, latched until its first reset.
    ///
    /// # Errors
    /// The first rule of robot or planning that is broken.
    pub fn new(config: Config<S>, planning: Planning) -> Result<Self, NavigatorError> {
        if !(planning.tuning.is_valid() && planning.progress.is_valid()) {
            return Err(NavigatorError::Planning);
        }
        Ok(Self {
            kernel: Kernel::new(config).map_err(NavigatorError::Config)?,
            planning,
            course: None,
            watch: Watch::default(),
            restarted: Instant::default(),
        })
    }

    /// One control tick at `now`, following `route`; without one, as [`Kernel::step`].
    ///
    /// A route is what the caller wants in this very tick; whoever holds it back stops the
    /// robot. Together with a command in `inputs` it contradicts itself, and the robot brakes.
    ///
    /// # Bound
    /// As [`Kernel::step`] with eight motions instead of ten, plus two plans; no allocation.
    /// # Source
    /// spec/ NAV; Loh 2018, Alg. 4.1.
    pub fn step(
        &mut self,
        inputs: &Inputs<'_>,
        route: Option<&Route<'_>>,
        now: Instant,
    ) -> Navigation {
        let before = self.kernel.stop.mode;
        let tick = self.kernel.perceive(inputs, now);
        if before == Mode::Latched && self.kernel.stop.mode == Mode::Running {
            self.restarted = tick.now;
        }
        //= spec/navigate.md#nav-06
        //# A tick without a route MUST NOT follow the route of an earlier tick.
        let Some(route) = route else {
            self.course = None;
            return Navigation {
                decision: self.kernel.decide(&tick, Kernel::drive),
                progress: Progress::Idle,
                refused: 0,
                refusal: None,
                plan: None,
            };
        };
        let objection = self.objection(inputs, route, tick.now);
        let mut attempt = Attempt::held();
        let Self {
            kernel,
            planning,
            course,
            watch,
            ..
        } = self;
        let decision = kernel.decide(&tick, |kernel, tick| {
            if let Some(reason) = objection {
                return kernel.braking(Action::Brake, reason, tick.elapsed);
            }
            let mut pilot = Pilot {
                kernel,
                planning,
                course,
                watch,
            };
            let outcome;
            (outcome, attempt) = pilot.drive(route, tick);
            outcome
        });
        if attempt.progress == Progress::Held {
            watch.pause();
        }
        Navigation {
            decision,
            progress: attempt.progress,
            refused: attempt.refused,
            refusal: attempt.refusal,
            plan: attempt.plan,
        }
    }

    /// Why `route` cannot be followed, if it cannot.
    fn objection(&self, inputs: &Inputs<'_>, route: &Route<'_>, now: Instant) -> Option<Reason> {
        //= spec/navigate.md#nav-08
        //# A route together with a command in one tick MUST stop the robot.
        if inputs.command != Reading::Absent || !route.is_valid() {
            return Some(Reason::CommandMalformed);
        }
        if route.stamp > now {
            return Some(Reason::CommandFuture);
        }
        //= spec/navigate.md#nav-07
        //# A route ordered before or at the last release of a latched stop MUST NOT be followed.
        (route.stamp <= self.restarted).then_some(Reason::CommandMissing)
    }

    /// The kernel underneath.
    #[must_use]
    pub const fn kernel(&self) -> &Kernel<S, B, M> {
        &self.kernel
    }
}
