//! A robot that drives in a world and looks at it once a tick, all of it the oracle's.

use crate::closed_loop::episode::Episode;
use crate::closed_loop::run::EPOCH_US;
use crate::closed_loop::wire::encode;
use haltline::convert;
use haltline::input::{Beam, Odometry, Reading};
use haltline::time::Instant;
use haltline_spec::draw::Draw;
use haltline_spec::motion::Twist;
use haltline_spec::plane::Pose;
use haltline_spec::plant::{Plant, SetPoint};
use haltline_spec::world::{Mover, Scanner};

/// Step of the plant, µs.
const SUB_US: u64 = 2_000;
/// From the last beam to delivery, µs.
const DELIVERY_US: u64 = 4_000;

/// One moment of the truth.
#[derive(Clone, Copy)]
struct Moment {
    pose: Pose,
    odometry: Pose,
    measured: Twist,
}

pub struct Vehicle<'e> {
    episode: &'e Episode,
    plant: Plant,
    world: Vec<Mover>,
    scanner: Scanner,
    draw: Draw,
    bias: f64,
    history: Vec<Moment>,
    /// Whether a beam ever returned from a body.
    seen: Vec<bool>,
    pub now_us: u64,
}

/// What a tick gets.
pub struct News {
    pub now: Instant,
    pub stamp: Instant,
    pub beams: Vec<Beam>,
    pub odometry: Reading<Odometry>,
    /// Where the odometry believes the robot is.
    pub place: Pose,
}

impl<'e> Vehicle<'e> {
    pub fn new(episode: &'e Episode, world: Vec<Mover>) -> Self {
        let mut draw = Draw::new(episode.seed);
        let plant = Plant::new(episode.quality(), Pose::default(), &mut draw);
        let first = Moment {
            pose: plant.pose,
            odometry: plant.odometry,
            measured: plant.measured(),
        };
        Self {
            episode,
            plant,
            scanner: episode.scanner(),
            bias: draw.extreme(-1.0, 1.0),
            seen: vec![false; world.len()],
            world,
            draw,
            history: vec![first],
            now_us: 0,
        }
    }

    /// Drives on for one tick of at most period and jitter; the name of a body that was touched in motion.
    pub fn drive(&mut self) -> Option<String> {
        let late_us = self.draw.unit() * self.episode.jitter_ms as f64 * 1e3;
        self.now_us += self.episode.period_ms * 1000 + late_us as u64;
        while (self.history.len() as u64) * SUB_US <= self.now_us {
            self.plant.advance(SUB_US as f64 * 1e-6);
            self.history.push(Moment {
                pose: self.plant.pose,
                odometry: self.plant.odometry,
                measured: self.plant.measured(),
            });
            if let Some(touched) = self.touched() {
                return Some(touched);
            }
        }
        None
    }

    fn touched(&self) -> Option<String> {
        if self.plant.is_at_rest() {
            return None;
        }
        let outline = self.episode.outline();
        self.world.iter().zip(&self.seen).find_map(|(mover, seen)| {
            let gap_m = mover.body.distance_m(&outline, self.plant.pose)?;
            (*seen && gap_m <= 0.0).then(|| format!("{:?} at {:?}", mover.body, self.plant.pose))
        })
    }

    /// The newest sweep and the newest odometry.
    pub fn look(&mut self) -> News {
        let sweep_us = self.episode.scan_ms * 1000;
        let start_us = self.now_us.saturating_sub(sweep_us + DELIVERY_US);
        let history = &self.history;
        let rays = self.scanner.sweep(
            &self.world,
            start_us as f64 * 1e-6,
            |t_s| {
                let index = (t_s * 1e6 / SUB_US as f64).max(0.0) as usize;
                history[index.min(history.len() - 1)].pose
            },
            self.bias,
            &mut self.draw,
        );
        for body in rays.iter().filter_map(|ray| ray.body) {
            self.seen[body] = true;
        }
        let newest = self.history[self.history.len() - 1];
        let stamp_us = (self.history.len() as u64 - 1) * SUB_US;
        let place = newest.odometry;
        Self::news(
            self.now_us,
            start_us,
            stamp_us,
            &newest,
            encode(&rays),
            place,
        )
    }

    fn news(
        now_us: u64,
        start_us: u64,
        stamp_us: u64,
        newest: &Moment,
        beams: Vec<Beam>,
        place: Pose,
    ) -> News {
        let at = |us: u64| Instant::from_us(EPOCH_US + us);
        News {
            now: at(now_us),
            stamp: at(start_us),
            beams,
            odometry: convert::odometry(
                at(stamp_us),
                [place.x_m, place.y_m, place.theta_rad],
                [newest.measured.v_mps, newest.measured.omega_radps],
                None,
            ),
            place,
        }
    }

    pub fn obey(&mut self, set_point: SetPoint) {
        self.plant.send(set_point);
    }
}
