//! `navigate`: the Dynamic Window Approach proposes, the guard disposes.
//!
//! A [`Navigator`] is a [`Kernel`] with a planning grid and a planner. It follows a [`Route`]
//! through via points to a goal: each tick the planner lists at most eight commands, the
//! guard certifies the first that it can, and when it can certify none the robot brakes.
//! Nothing in here is trusted: a bug can stop the robot, or send it the wrong way, but
//! every motion passes the same guard, window and stop logic as anybody else's.

mod progress;
mod proposal;
mod route;

pub use progress::{Blocked, Obstruction, Progress, ProgressRules};
pub use route::{Destination, Route, Via};

use super::{Kernel, Outcome, Tick};
use crate::checked::ConfigError;
use crate::config::Config;
use crate::decision::{Action, Decision, Reason};
use crate::dwa::{self, Plan, Tuning};
use crate::grid::{GridError, GridRules, RollingGrid};
use crate::guard::Verdict;
use crate::input::{Inputs, Reading};
use crate::stop::Mode;
use crate::time::{Duration, Instant};
use crate::window;
use progress::Watch;
use route::Course;

/// How to plan; none of it can make the guard accept anything.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Planning {
    /// The planner's preferences.
    pub tuning: Tuning,
    /// The planning grid.
    pub grid: GridRules,
    /// When a robot that moves but comes no nearer gives up.
    pub progress: ProgressRules,
}

/// Why a navigator cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum NavigatorError {
    /// The kernel refuses the robot.
    Config(ConfigError),
    /// The grid refuses its rules.
    Grid(GridError),
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
}

/// A kernel that drives to goals, with a planning grid of `W` × `H` cells around the robot.
///
/// About `2 · W · H` bytes more than a [`Kernel`].
#[derive(Clone, Debug)]
pub struct Navigator<const S: usize, const B: usize, const M: usize, const W: usize, const H: usize>
{
    kernel: Kernel<S, B, M>,
    planning: Planning,
    grid: RollingGrid<W, H>,
    /// Stamp of the newest scan of each scanner in the grid.
    mapped: [Option<Instant>; S],
    course: Option<Course>,
    watch: Watch,
    /// When a latched stop was last released; older routes are void.
    restarted: Instant,
}

/// What came of one tick's plan.
struct Attempt {
    outcome: Outcome,
    progress: Progress,
    refused: u8,
}

impl<const S: usize, const B: usize, const M: usize, const W: usize, const H: usize>
    Navigator<S, B, M, W, H>
{
    /// A navigator for the robot of `config`, latched until its first reset.
    ///
    /// # Errors
    /// The first rule of robot, grid or planning that is broken.
    pub fn new(config: Config<S>, planning: Planning) -> Result<Self, NavigatorError> {
        if !(planning.tuning.is_valid() && planning.progress.is_valid()) {
            return Err(NavigatorError::Planning);
        }
        Ok(Self {
            kernel: Kernel::new(config).map_err(NavigatorError::Config)?,
            grid: RollingGrid::new(planning.grid).map_err(NavigatorError::Grid)?,
            planning,
            mapped: [None; S],
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
    /// As [`Kernel::step`] with eight motions instead of ten, plus one plan and at most one
    /// grid update per scanner; no allocation.
    /// # Source
    /// spec/ NAV, GRID; Loh 2018, Alg. 4.1.
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
        self.map();
        let Some(route) = route else {
            self.course = None;
            return Navigation {
                decision: self.kernel.decide(&tick, Kernel::drive),
                progress: Progress::Idle,
                refused: 0,
            };
        };
        let refusal = self.refusal(inputs, route, tick.now);
        let (mut progress, mut refused) = (Progress::Held, 0);
        let Self {
            kernel,
            planning,
            course,
            watch,
            ..
        } = self;
        let decision = kernel.decide(&tick, |kernel, tick| {
            if let Some(reason) = refusal {
                return kernel.braking(Action::Brake, reason, tick.elapsed);
            }
            let mut pilot = Pilot {
                kernel,
                planning,
                course,
                watch,
            };
            let attempt = pilot.attempt(route, tick);
            (progress, refused) = (attempt.progress, attempt.refused);
            attempt.outcome
        });
        if progress == Progress::Held {
            watch.pause();
        }
        Navigation {
            decision,
            progress,
            refused,
        }
    }

    /// Why `route` cannot be followed, if it cannot.
    fn refusal(&self, inputs: &Inputs<'_>, route: &Route<'_>, now: Instant) -> Option<Reason> {
        if inputs.command != Reading::Absent || !route.is_valid() {
            return Some(Reason::CommandMalformed);
        }
        if route.stamp > now {
            return Some(Reason::CommandFuture);
        }
        (route.stamp <= self.restarted).then_some(Reason::CommandMissing)
    }

    /// Enters into the grid what memory has accepted since.
    fn map(&mut self) {
        let Some(newest) = self.kernel.track.newest() else {
            return;
        };
        let pose = newest.pose;
        let scanners = &self.kernel.config.config().scanners;
        for ((channel, setup), mapped) in self
            .kernel
            .channels
            .iter()
            .zip(scanners)
            .zip(&mut self.mapped)
        {
            let Some(setup) = setup else { continue };
            let Some(stamp) = channel
                .accepted
                .filter(|_| channel.accepted == channel.beams_stamp && !channel.pending)
                .filter(|stamp| mapped.is_none_or(|before| *stamp > before))
            else {
                continue;
            };
            let middle = Duration::from_us(setup.scan_duration.as_us() / 2);
            let then = self.kernel.track.world_pose_at(stamp.plus(middle));
            let beams = channel.beams.get(..usize::from(setup.beams));
            if let (Some(then), Some(beams)) = (then, beams) {
                // The window follows the robot; a scan that the grid refuses is one it cannot
                // place, and the planner does without.
                let _ = self.grid.update(&then, setup, beams);
            }
            *mapped = Some(stamp);
        }
        let _ = self.grid.follow(&pose);
    }

    /// The kernel underneath.
    #[must_use]
    pub const fn kernel(&self) -> &Kernel<S, B, M> {
        &self.kernel
    }

    /// The planning grid in the odometry frame.
    #[must_use]
    pub const fn grid(&self) -> &RollingGrid<W, H> {
        &self.grid
    }
}

/// One tick's work on a route.
struct Pilot<'a, const S: usize, const B: usize, const M: usize> {
    kernel: &'a mut Kernel<S, B, M>,
    planning: &'a Planning,
    course: &'a mut Option<Course>,
    watch: &'a mut Watch,
}

impl<const S: usize, const B: usize, const M: usize> Pilot<'_, S, B, M> {
    /// Plans towards the next target and has the candidates judged one after the other.
    fn attempt(&mut self, route: &Route<'_>, tick: &Tick) -> Attempt {
        let Some(odometry) = self.kernel.track.newest().copied() else {
            let outcome = self
                .kernel
                .braking(Action::Brake, Reason::OdometryMissing, tick.elapsed);
            return Attempt::of(outcome, Progress::Held);
        };
        let course = Course::of(*self.course, route, &odometry.pose);
        if self.course.is_none_or(|before| before.id != course.id) {
            *self.watch = Watch::default();
        }
        *self.course = Some(course);
        let sight = course.sight(route, &odometry.pose);
        if self
            .watch
            .has_given_up(&self.planning.progress, course.next, sight.distance_m)
        {
            return self.blocked(tick, Obstruction::NoProgress, None);
        }
        let plan = self.plan(route, &odometry, tick, sight);
        match plan.outcome {
            dwa::Outcome::Moving => self.dispose(&plan, &odometry, tick, course.next),
            dwa::Outcome::Arrived => {
                self.watch.pause();
                let mut outcome = self
                    .kernel
                    .braking(Action::Pass, Reason::None, tick.elapsed);
                outcome.factor_permille = 1000;
                Attempt::of(outcome, Progress::Arrived)
            }
            // Rolling where a turn is wanted, or backwards: come to rest first.
            dwa::Outcome::Unsuitable => {
                self.watch.pause();
                let mut outcome = self
                    .kernel
                    .braking(Action::Pass, Reason::None, tick.elapsed);
                outcome.factor_permille = 1000;
                Attempt::of(outcome, Progress::Driving { next: course.next })
            }
            dwa::Outcome::Blocked(point) => {
                let reason = if self.is_occupied(route, &odometry.pose) {
                    Obstruction::GoalOccupied
                } else {
                    Obstruction::NoWay
                };
                self.blocked(tick, reason, point.and_then(progress::body_point))
            }
            dwa::Outcome::Malformed => {
                let outcome =
                    self.kernel
                        .braking(Action::Brake, Reason::CommandMalformed, tick.elapsed);
                Attempt::of(outcome, Progress::Held)
            }
        }
    }

    /// Takes the first candidate that window and guard accept.
    fn dispose(
        &mut self,
        plan: &Plan,
        odometry: &crate::input::Odometry,
        tick: &Tick,
        next: usize,
    ) -> Attempt {
        let step = tick.elapsed.min(self.kernel.config.config().timing.period);
        let reference = self.kernel.pipeline.last();
        let mut first: Option<Verdict> = None;
        let mut refused = 0_u8;
        for (rank, candidate) in plan.candidates().iter().enumerate() {
            let config = self.kernel.config.config();
            let Some(vertex) = proposal::vertex(config, candidate.velocity) else {
                continue;
            };
            if !window::admissible(config, reference, vertex, step) {
                continue;
            }
            let verdict = self.kernel.judge(odometry, vertex, tick.now);
            if verdict.refusal.is_none() {
                self.watch.moved(tick.elapsed);
                // A candidate that is not the planner's first choice is what the guard leaves.
                let mut outcome = self.kernel.accepted(vertex, 1000, false, verdict);
                if rank > 0 {
                    (outcome.action, outcome.reason) = (Action::Slow, Reason::GuardLimited);
                }
                return Attempt {
                    outcome,
                    progress: Progress::Driving { next },
                    refused,
                };
            }
            refused = refused.saturating_add(1);
            first.get_or_insert(verdict);
        }
        let mut attempt = match first.and_then(|verdict| Some((verdict, verdict.refusal?))) {
            Some((verdict, refusal)) => {
                self.blocked(tick, Obstruction::Guard(refusal), verdict.point)
            }
            None => self.blocked(tick, Obstruction::NoWay, None),
        };
        attempt.outcome.verdict = first;
        attempt.refused = refused;
        attempt
    }

    /// Brakes and says why.
    fn blocked(
        &mut self,
        tick: &Tick,
        reason: Obstruction,
        point: Option<crate::guard::BodyPoint>,
    ) -> Attempt {
        let since = self.watch.blocked(tick.now);
        let cause = match reason {
            Obstruction::Guard(_) => Reason::GuardBlocked,
            _ => Reason::PathBlocked,
        };
        let outcome = self.kernel.braking(Action::Brake, cause, tick.elapsed);
        Attempt::of(
            outcome,
            Progress::Blocked(Blocked {
                reason,
                point,
                since,
            }),
        )
    }
}

impl Attempt {
    const fn of(outcome: Outcome, progress: Progress) -> Self {
        Self {
            outcome,
            progress,
            refused: 0,
        }
    }
}
