//! From scored samples to a short, ordered list of candidates.

use super::arc::{Clearance, Course, Turn};
use super::lanes::{LANES, Lane, PRESENT, SPEEDS};
use super::margin::{rate_for, worst_stop};
use super::objective::{Sighting, score};
use super::survey::Survey;
use super::types::{CANDIDATES, Candidate, Outcome, Plan, Situation, Velocity};
use super::window::{DynamicWindow, Interval};

/// Candidates are at least this part of all sampled curvatures apart.
const APART: f64 = 0.05;
/// Turns smaller than this are not worth it even where nothing else is possible, rad.
const ALIGNED_LEAST_RAD: f64 = 0.005;
/// Turn rates nearer than this are the same, rad/s.
const SAME_RADPS: f64 = 1e-6;
/// Turn rates below this are not worth it, rad/s.
const TURN_LEAST_RADPS: f64 = 0.01;

/// What the robot is about to do.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Aim {
    /// Drive to the position.
    Position,
    /// Turn by this angle on the spot.
    Heading(f64),
}

/// Scores every sample and lists the best.
pub(super) struct Choice<'a> {
    pub situation: &'a Situation<'a>,
    pub window: &'a DynamicWindow,
    pub lanes: &'a [Lane; LANES],
    pub survey: &'a Survey,
    pub sighting: Sighting,
    /// Speeds that goal and surroundings call for, within the window.
    pub speeds: Interval,
}

/// The best sample of one lane.
#[derive(Clone, Copy, Debug)]
struct Best {
    candidate: Candidate,
    /// The slowest admissible sample of the same lane.
    slowest: Candidate,
    curvature_per_m: Option<f64>,
}

impl Choice<'_> {
    /// The plan.
    /// # Bound
    /// O(lanes × (speeds + candidates)).
    pub fn plan(&self) -> Plan {
        let goal = &self.situation.goal;
        let aim = if self.sighting.distance_m > goal.position_tolerance_m {
            Aim::Position
        } else {
            match goal.heading_rad {
                Some(heading) if heading.abs() > goal.heading_tolerance_rad => {
                    Aim::Heading(heading)
                }
                _ => return Plan::without_candidates(Outcome::Arrived),
            }
        };
        if aim != Aim::Position && self.window.linear.low > 0.0 {
            return Plan::without_candidates(Outcome::Unsuitable);
        }
        let enough = match aim {
            Aim::Position => self.situation.tuning.aligned_rad,
            Aim::Heading(_) => 0.0,
        };
        let mut best = self.best(aim, enough);
        if best.iter().all(Option::is_none) {
            // Where no way leads on, a small turn towards the goal may open one.
            best = self.best(aim, enough.min(ALIGNED_LEAST_RAD));
        }
        let plan = list(&mut best, self.hold(aim));
        if plan.count == 0 {
            return Plan::without_candidates(Outcome::Blocked(self.blocker(aim)));
        }
        plan
    }

    /// The best sample of each lane; turns on the spot by more than `enough`.
    fn best(&self, aim: Aim, enough: f64) -> [Option<Best>; LANES] {
        let mut best = [None; LANES];
        for (index, (slot, lane)) in best.iter_mut().zip(self.lanes).enumerate() {
            *slot = self.best_of(index, lane, aim, enough);
        }
        best
    }

    /// The turn that faces the aim, left positive, rad.
    const fn turn_to(&self, aim: Aim) -> f64 {
        match aim {
            Aim::Position => self.sighting.bearing_rad,
            Aim::Heading(angle) => angle,
        }
    }

    /// The rates of `lane` that are worth sampling.
    fn rates(&self, lane: &Lane, aim: Aim, enough: f64) -> Option<Interval> {
        let limits = &self.situation.limits;
        let tuning = &self.situation.tuning;
        match (lane.course, aim) {
            (Course::Arc { .. }, Aim::Heading(_)) => None,
            (Course::Arc { .. }, Aim::Position) => Some(lane.rates.intersection(self.speeds)),
            (Course::Spot(turn), aim) => {
                let angle = self.turn_to(aim);
                let towards = if turn == Turn::Left { angle } else { -angle };
                let most = rate_for(
                    towards,
                    tuning.comfort * limits.angular_braking_radps2,
                    limits.reaction_s,
                )
                .max(TURN_LEAST_RADPS);
                (towards > enough).then(|| Interval {
                    low: lane.rates.low.max(TURN_LEAST_RADPS.min(lane.rates.high)),
                    high: lane.rates.clamp(most),
                })
            }
        }
        .filter(Interval::is_some)
    }

    /// `rates` down to what brakes gently before the contact, or as slow as the window allows.
    fn eased(&self, lane: &Lane, rates: Interval, clearance: Clearance) -> Option<Interval> {
        let Clearance::Contact(travel) = clearance else {
            return Some(rates);
        };
        let limits = &self.situation.limits;
        let (deceleration, slowest) = match lane.curvature_per_m() {
            Some(curvature) => (
                limits
                    .braking_mps2
                    .min(limits.angular_braking_radps2 / curvature.abs().max(1e-6)),
                self.speeds.low,
            ),
            None => (limits.angular_braking_radps2, rates.low),
        };
        let gentle = rate_for(
            travel,
            self.situation.tuning.comfort * deceleration,
            limits.reaction_s + limits.period_s,
        );
        let eased = Interval {
            low: rates.low,
            high: rates.high.min(gentle.max(slowest)),
        };
        Some(eased).filter(Interval::is_some)
    }

    /// How much of the look-ahead (or the way to the goal) `lane` leaves open at creeping speed, 0–1.
    fn open(&self, lane: &Lane, ahead: Clearance) -> f64 {
        match (ahead, lane.course) {
            (Clearance::Contact(travel), Course::Arc { .. }) => {
                let reach = self.situation.lookahead_m().min(self.sighting.distance_m);
                if travel < reach { travel / reach } else { 1.0 }
            }
            _ => 1.0,
        }
    }

    fn best_of(&self, index: usize, lane: &Lane, aim: Aim, enough: f64) -> Option<Best> {
        if !lane.rates.is_some() {
            return None;
        }
        let clearance = self.survey.firm.clearance(index, lane);
        let ahead = self.survey.ahead.clearance(index, lane);
        let rates = self.eased(
            lane,
            self.rates(lane, aim, enough)?,
            clearance.nearer(ahead),
        )?;
        let open = self.open(lane, ahead);
        let mut found: Option<Best> = None;
        for step in 0..SPEEDS {
            let part = f64::from(u8::try_from(step).unwrap_or(0)) / 10.0;
            let rate = lane
                .rates
                .clamp(rates.low + (rates.high - rates.low) * part);
            let velocity = lane.velocity(rate, self.window);
            if !self.is_admissible(velocity, clearance, aim) {
                continue;
            }
            let candidate = Candidate {
                velocity,
                score: score(
                    self.situation,
                    self.survey,
                    self.sighting,
                    (index, lane),
                    rate,
                    open,
                ),
                clearance,
            };
            found = Some(match found {
                Some(best) if candidate.score <= best.candidate.score => best,
                Some(best) => Best { candidate, ..best },
                None => Best {
                    candidate,
                    slowest: candidate,
                    curvature_per_m: lane.curvature_per_m(),
                },
            });
        }
        found
    }

    /// Going on as commanded, where that is admissible: what the guard accepted a tick ago.
    fn hold(&self, aim: Aim) -> Option<Candidate> {
        let velocity = self.situation.velocity;
        let lane = self.lanes.get(PRESENT)?;
        let clearance = self.survey.firm.clearance(PRESENT, lane);
        let bend = lane.curvature_per_m()?;
        let goes_on = aim == Aim::Position
            && velocity.linear_mps > 0.0
            && lane.rates.contains(velocity.linear_mps)
            && (bend * velocity.linear_mps - velocity.angular_radps).abs() < SAME_RADPS
            && self.is_admissible(velocity, clearance, aim);
        goes_on.then(|| Candidate {
            velocity,
            score: score(
                self.situation,
                self.survey,
                self.sighting,
                (PRESENT, lane),
                velocity.linear_mps,
                self.open(lane, self.survey.ahead.clearance(PRESENT, lane)),
            ),
            clearance,
        })
    }

    /// V_a: whether the robot can stop within `clearance`, whatever it was told before (Loh 4.5).
    fn is_admissible(&self, velocity: Velocity, clearance: Clearance, aim: Aim) -> bool {
        //= spec/navigate.md#nav-03
        //# The robot MUST be able to stop within the clearance of every candidate, even if any motion that may still be executing goes on for the reaction time.
        let moves = velocity.linear_mps > 0.0 || velocity.angular_radps.abs() > 0.0;
        let start = if self.situation.is_at_rest() {
            self.worth_starting(velocity, aim)
        } else {
            0.0
        };
        moves && clearance.allows(worst_stop(self.situation, velocity).travel + start)
    }

    /// How much more than a stop must be free for it to be worth leaving rest, m (rad on the spot).
    ///
    /// Without it a robot before a wall would go on in steps of a millimetre.
    fn worth_starting(&self, velocity: Velocity, aim: Aim) -> f64 {
        let least = self.situation.tuning.start_m;
        if velocity.linear_mps > 0.0 {
            least.min(self.sighting.distance_m)
        } else {
            (least / self.situation.footprint.corner_m()).min(self.turn_to(aim).abs())
        }
    }

    /// The point that ends the way towards the aim.
    fn blocker(&self, aim: Aim) -> Option<super::footprint::Point> {
        let angle = self.turn_to(aim);
        let side = if angle > 0.0 { Turn::Left } else { Turn::Right };
        let turning = self
            .lanes
            .iter()
            .position(|lane| lane.rates.is_some() && lane.course == Course::Spot(side));
        let turn_first =
            matches!(aim, Aim::Heading(_)) || angle.abs() > self.situation.tuning.turn_first_rad;
        let index = if turn_first { turning.unwrap_or(0) } else { 0 };
        let lane = self.lanes.get(index)?;
        let contacts = [&self.survey.firm, &self.survey.ahead];
        contacts
            .iter()
            .find_map(|contacts| match contacts.clearance(index, lane) {
                Clearance::Contact(_) => contacts.contact(index),
                Clearance::Free => None,
            })
    }
}

/// Whether two lanes differ enough for the guard to judge them differently.
fn is_apart(one: Option<f64>, other: Option<f64>, least: f64) -> bool {
    match (one, other) {
        (Some(one), Some(other)) => (one - other).abs() >= least,
        _ => true,
    }
}

/// The best of all lanes in order, curvatures apart from each other; after the first, `hold`; last,
/// the slowest sample of the best lane. Of equal scores the earlier lane comes first.
fn list(best: &mut [Option<Best>; LANES], mut hold: Option<Candidate>) -> Plan {
    let mut plan = Plan::without_candidates(Outcome::Moving);
    let curvatures = || best.iter().flatten().filter_map(|one| one.curvature_per_m);
    let least = curvatures().fold(f64::INFINITY, f64::min);
    let largest = curvatures().fold(f64::NEG_INFINITY, f64::max);
    let gap = (largest - least).max(0.0) * APART;
    let mut slowest: Option<Candidate> = None;
    let mut first = Velocity::default();
    for slot in &mut plan.candidates {
        if plan.count == 1
            && let Some(hold) = hold.take().filter(|hold| hold.velocity != first)
        {
            *slot = hold;
            plan.count = 2;
            continue;
        }
        let chosen = best
            .iter()
            .flatten()
            .copied()
            .fold(None, |leader, one| match leader {
                Some(leader) if !is_better(&one, &leader) => Some(leader),
                _ => Some(one),
            });
        let last = plan.count.saturating_add(1) >= CANDIDATES;
        let next = match (chosen, slowest) {
            (None, None) => break,
            (Some(one), _) if !last => one.candidate,
            (_, Some(slow)) => slow,
            (Some(one), None) => one.candidate,
        };
        *slot = next;
        if plan.count == 0 {
            first = next.velocity;
        }
        plan.count = plan.count.saturating_add(1);
        let Some(chosen) = chosen.filter(|_| !last) else {
            break;
        };
        if slowest.is_none() && plan.count == 1 {
            slowest =
                Some(chosen.slowest).filter(|slow| slow.velocity != chosen.candidate.velocity);
        }
        for lane in best.iter_mut() {
            let keep = |one: &Best| {
                is_apart(one.curvature_per_m, chosen.curvature_per_m, gap) && !is_same(one, &chosen)
            };
            *lane = lane.filter(keep);
        }
    }
    plan
}

fn is_better(one: &Best, other: &Best) -> bool {
    one.candidate.score > other.candidate.score
}

fn is_same(one: &Best, other: &Best) -> bool {
    one.candidate.velocity == other.candidate.velocity
}
