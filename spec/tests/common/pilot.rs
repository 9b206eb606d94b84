//! The untrusted side: somebody who wants to drive into things.

use super::episode::{CURVATURE_MAX, Episode, Style};
use super::run::EPOCH_US;
use haltline::convert;
use haltline::input::{Command, Reading};
use haltline::time::Instant;
use haltline_spec::draw::Draw;
use haltline_spec::motion::Twist;
use haltline_spec::plane::Pose;
use haltline_spec::world::Mover;

/// What the pilot pursues.
pub struct Pilot {
    target: usize,
    until_us: u64,
    held: Twist,
    stuck: usize,
}

/// What the pilot sees: the truth.
pub struct View<'a> {
    pub episode: &'a Episode,
    pub world: &'a [Mover],
    pub pose: Pose,
    pub now_us: u64,
}

impl Pilot {
    /// A pilot with its eye on one body.
    pub const fn new(target: usize) -> Self {
        Self {
            target,
            until_us: 0,
            held: Twist::new(0.0, 0.0),
            stuck: 0,
        }
    }

    /// Learns whether it gets on.
    pub const fn learn(&mut self, gets_on: bool) {
        self.stuck = if gets_on { 0 } else { self.stuck + 1 };
    }

    /// What the pilot wants now.
    pub fn command(&mut self, view: &View<'_>, draw: &mut Draw) -> Reading<Command> {
        let wish = self.wish(view, draw);
        let stamp = Instant::from_us(EPOCH_US + view.now_us - 1000);
        if view.episode.steered {
            let curvature = if wish.v_mps.abs() > 1e-3 {
                wish.omega_radps / wish.v_mps
            } else {
                0.0
            };
            let curvature = curvature.clamp(-CURVATURE_MAX, CURVATURE_MAX) * 0.999;
            convert::arc_command(stamp, wish.v_mps, curvature)
        } else {
            convert::twist_command(stamp, wish.v_mps, wish.omega_radps)
        }
    }

    fn wish(&mut self, view: &View<'_>, draw: &mut Draw) -> Twist {
        let (speed, turn) = (view.episode.speed_mps, view.episode.turn_radps);
        if self.stuck > 25 {
            // Blocked: something else for a while.
            self.stuck = 0;
            self.target = draw.index(view.world.len());
            self.until_us = view.now_us + 600_000;
            self.held = Twist::new(draw.extreme(-speed, speed) * 0.5, draw.extreme(-turn, turn));
        }
        if view.now_us < self.until_us {
            return self.held;
        }
        match view.episode.style {
            Style::Reckless => self.aim(view, speed),
            Style::Creep => self.aim(view, speed.min(0.05)),
            Style::Wander => {
                let twist = Twist::new(draw.extreme(-speed, speed), draw.extreme(-turn, turn));
                self.hold(view, 800_000, twist, draw)
            }
            Style::Weave => {
                let twist = Twist::new(speed, draw.sign() * turn);
                self.hold(view, 150_000, twist, draw)
            }
            Style::Spot => {
                let twist = if draw.chance(0.6) {
                    Twist::new(0.0, draw.sign() * turn)
                } else {
                    Twist::new(draw.extreme(-speed, speed), 0.0)
                };
                self.hold(view, 2_500_000, twist, draw)
            }
        }
    }

    fn hold(&mut self, view: &View<'_>, most_us: u64, twist: Twist, draw: &mut Draw) -> Twist {
        self.held = twist;
        self.until_us = view.now_us + (draw.between(0.2, 1.0) * most_us as f64) as u64;
        twist
    }

    /// Straight for the target.
    fn aim(&self, view: &View<'_>, speed: f64) -> Twist {
        let Some(mover) = view.world.get(self.target) else {
            return Twist::new(speed, 0.0);
        };
        let body = mover.at(view.now_us as f64 * 1e-6);
        let [x_m, y_m] = view.pose.enter([body.pose.x_m, body.pose.y_m]);
        let turn = view.episode.turn_radps;
        if view.episode.steered && x_m < 0.0 {
            return Twist::new(-speed, speed * 2.0 * y_m / (x_m * x_m + y_m * y_m));
        }
        let bearing = y_m.atan2(x_m);
        if bearing.abs() > 0.8 && !view.episode.steered {
            return Twist::new(0.0, turn.copysign(bearing));
        }
        Twist::new(speed, (2.0 * bearing).clamp(-turn, turn))
    }
}
