//! Bodies that move, and what a laser scanner sees of them from a moving robot.

use crate::draw::Draw;
use crate::plane::{Body, Pose};

/// A body with a constant velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mover {
    /// The body at time zero.
    pub body: Body,
    /// Velocity, m/s.
    pub velocity_mps: [f64; 2],
}

impl Mover {
    /// The body at time `t_s`.
    #[must_use]
    pub fn at(&self, t_s: f64) -> Body {
        self.body
            .moved(self.velocity_mps[0] * t_s, self.velocity_mps[1] * t_s)
    }
}

/// A scanner as it is, not as anybody believes it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scanner {
    /// Mounting pose in the robot's frame; the heading is the direction of the first beam.
    pub mount: Pose,
    /// Angle from one beam to the next, rad.
    pub increment_rad: f64,
    /// Number of beams.
    pub beams: usize,
    /// Time of one sweep, s.
    pub duration_s: f64,
    /// Longest range with a return, m.
    pub range_max_m: f64,
    /// Bound of the range error, m.
    pub error_m: f64,
}

/// One beam of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Reported range, m; `None` without a return.
    pub range_m: Option<f64>,
    /// Index of the body that was hit.
    pub body: Option<usize>,
    /// Where the surface really is that returned the beam.
    pub place: Option<[f64; 2]>,
    /// Time at which the beam was fired, s.
    pub t_s: f64,
}

impl Scanner {
    /// One sweep whose first beam is fired at `start_s`, by a robot that is at `pose_at(t)`.
    ///
    /// Every beam sees the world at its own time from the pose of its own time. Errors keep
    /// within the bound; `bias` in [−1, 1] is the share that all beams have in common.
    pub fn sweep(
        &self,
        world: &[Mover],
        start_s: f64,
        pose_at: impl Fn(f64) -> Pose,
        bias: f64,
        draw: &mut Draw,
    ) -> Vec<Ray> {
        (0..self.beams)
            .map(|index| {
                let t_s = start_s + self.duration_s * index as f64 / self.beams as f64;
                let pose = pose_at(t_s);
                let origin = pose.place([self.mount.x_m, self.mount.y_m]);
                let angle_rad =
                    pose.theta_rad + self.mount.theta_rad + self.increment_rad * index as f64;
                let hit = nearest(world, t_s, origin, angle_rad);
                let own = draw.between(-1.0, 1.0) * (1.0 - bias.abs()) + bias;
                let seen = hit.filter(|&(_, range_m)| range_m <= self.range_max_m - self.error_m);
                Ray {
                    range_m: seen.map(|(_, range_m)| (range_m + own * self.error_m).max(0.0)),
                    body: seen.map(|(body, _)| body),
                    place: seen.map(|(_, range_m)| {
                        [
                            origin[0] + range_m * angle_rad.cos(),
                            origin[1] + range_m * angle_rad.sin(),
                        ]
                    }),
                    t_s,
                }
            })
            .collect()
    }
}

/// The first body along a ray, with the distance to it.
fn nearest(world: &[Mover], t_s: f64, origin: [f64; 2], angle_rad: f64) -> Option<(usize, f64)> {
    world
        .iter()
        .enumerate()
        .filter_map(|(index, mover)| Some((index, mover.at(t_s).range_m(origin, angle_rad)?)))
        .min_by(|one, two| one.1.total_cmp(&two.1))
}
