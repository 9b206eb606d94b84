//! The claim at one accepted step: no admissible motion touches a body that was returned.

use super::episode::{CURVATURE_TOLERANCE, Episode, SWEEP_S};
use haltline_spec::draw::Draw;
use haltline_spec::motion::{Brakes, Course, Manoeuvre, Reach, Twist};
use haltline_spec::plane::{Body, Outline, Pose};
use haltline_spec::plant::SetPoint;

/// A body as it was when a beam last returned from it.
#[derive(Clone, Debug)]
pub struct Sighting {
    pub index: usize,
    pub body: Body,
    pub t_s: f64,
    /// The surface the newest scan returned: true places `(x, y)` with their times, in order.
    pub surface: Vec<([f64; 2], f64)>,
}

impl Sighting {
    /// Distance of the outline at `pose` from what the claim protects, less what that may have
    /// moved by `t_s` at `speed_mps`.
    ///
    /// In a static world the claim is about whole bodies. Of a body that may move, it is about
    /// the surface that returned beams: where nobody looks, anything may come from behind it.
    pub fn gap_m(&self, outline: &Outline, pose: Pose, t_s: f64, speed_mps: f64) -> f64 {
        if speed_mps <= 0.0 {
            return self.body.distance_m(outline, pose).unwrap_or(0.0);
        }
        let roam_m = |seen_s: f64| speed_mps * (t_s - seen_s).max(0.0);
        let pairs = self.surface.windows(2).map(|pair| {
            let ((a, one_s), (b, two_s)) = (pair[0], pair[1]);
            outline.distance_to_segment_m(pose, a, b).unwrap_or(0.0) - roam_m(one_s.max(two_s))
        });
        let points = self
            .surface
            .iter()
            .map(|&(a, seen_s)| outline.distance_m(pose.enter(a)) - roam_m(seen_s));
        pairs.chain(points).fold(f64::INFINITY, f64::min)
    }
}

/// What is known at an accepted step, in true terms.
#[derive(Clone, Debug)]
pub struct Step {
    /// Stamp of the odometry the kernel decided on, s.
    pub stamp_s: f64,
    /// Time of the decision, s.
    pub now_s: f64,
    /// True pose at the stamp.
    pub pose: Pose,
    /// Measured twist of the stamp.
    pub measured: Twist,
    /// Every set point so far with the time it was sent, the new one last.
    pub log: Vec<(f64, SetPoint)>,
    /// Bodies the claim is about.
    pub sightings: Vec<Sighting>,
}

/// Set points sent after `since_s` and the last one before, of all `(sent at, set point)` so far.
pub fn in_play(log: &[(f64, SetPoint)], since_s: f64) -> &[(f64, SetPoint)] {
    let first = log
        .iter()
        .rposition(|&(sent_s, _)| sent_s <= since_s)
        .unwrap_or(0);
    &log[first..]
}

impl Step {
    /// The motions this step allows.
    pub fn manoeuvre(&self, episode: &Episode) -> Manoeuvre {
        // After the last decision the host may be silent until the drive's watchdog bites.
        let silence_ms =
            (episode.period_ms + episode.jitter_ms).max(episode.watchdog_ms.unwrap_or(0));
        let tick_s = (silence_ms + episode.latency_ms) as f64 * 1e-3;
        Manoeuvre {
            reach: self.reach(episode),
            tol_v_mps: episode.tol_v_mps,
            tol_omega_radps: episode.tol_omega_radps,
            hold_s: self.now_s - self.stamp_s + tick_s,
            brakes: Brakes {
                least_mps2: episode.braking_mps2,
                hardest_mps2: episode.braking_mps2 * episode.harder,
                angular_radps2: if episode.steered {
                    f64::INFINITY
                } else {
                    episode.angular_braking_radps2
                },
                separate: episode.separate || episode.watchdog_ms.is_some(),
            },
        }
    }

    fn reach(&self, episode: &Episode) -> Reach {
        let since_s = self.stamp_s - episode.latency_ms as f64 * 1e-3;
        let mut twists = vec![self.measured];
        twists.extend(
            in_play(&self.log, since_s)
                .iter()
                .map(|entry| as_twist(entry.1)),
        );
        if !episode.steered {
            return if episode.separate {
                Reach::Bounds(twists)
            } else {
                Reach::Hull(twists)
            };
        }
        // Older steering set points count as long as the wheels may still be on their way.
        let [low, high] =
            ends(
                in_play(&self.log, since_s - SWEEP_S)
                    .iter()
                    .map(|entry| match entry.1 {
                        SetPoint::Arc {
                            curvature_per_m, ..
                        } => curvature_per_m,
                        SetPoint::Twist(_) => 0.0,
                    }),
            );
        Reach::Arc {
            speed_mps: ends(twists.iter().map(|twist| twist.v_mps)),
            curvature_per_m: [low - CURVATURE_TOLERANCE, high + CURVATURE_TOLERANCE],
        }
    }

    /// Draws `count` motions; the first that touches a body, with the body's index, depth and time.
    pub fn first_contact(
        &self,
        episode: &Episode,
        count: usize,
        draw: &mut Draw,
    ) -> Option<Contact> {
        let manoeuvre = self.manoeuvre(episode);
        let outline = episode.outline();
        (0..count).find_map(|_| {
            let course = manoeuvre.course(self.pose, draw);
            self.touched(episode, &outline, &course)
        })
    }

    /// Whether a motion touches some body that moved as it pleased since its beam.
    ///
    /// A body that may move at V in any direction touches the footprint by time t if its
    /// distance is at most V t: it runs straight for the nearest place. The same holds for
    /// an error of the path in any direction.
    fn touched(&self, episode: &Episode, outline: &Outline, course: &Course) -> Option<Contact> {
        let rho_m = outline.rho_m();
        for moment in &course.moments {
            let t_s = self.stamp_s + moment.t_s;
            for sighting in &self.sightings {
                let roam_m =
                    episode.obstacle_mps * (t_s - sighting.t_s).max(0.0) + episode.tracking_m;
                let body = &sighting.body;
                let centres_m =
                    (body.pose.x_m - moment.pose.x_m).hypot(body.pose.y_m - moment.pose.y_m);
                // The body may have moved between its first and its last beam.
                let swept_m = episode.obstacle_mps * episode.scan_ms as f64 * 1e-3;
                if centres_m > rho_m + body.reach_m() + roam_m + swept_m {
                    continue;
                }
                let gap_m = sighting.gap_m(outline, moment.pose, t_s, episode.obstacle_mps);
                if gap_m <= episode.tracking_m {
                    return Some(Contact {
                        body: sighting.index,
                        depth_m: episode.tracking_m - gap_m,
                        after_s: moment.t_s,
                    });
                }
            }
        }
        None
    }
}

fn as_twist(set_point: SetPoint) -> Twist {
    match set_point {
        SetPoint::Twist(twist) => twist,
        SetPoint::Arc {
            v_mps,
            curvature_per_m,
        } => Twist::new(v_mps, v_mps * curvature_per_m),
    }
}

fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

/// A motion that touches.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Index of the body.
    pub body: usize,
    /// How much nearer than allowed, m.
    pub depth_m: f64,
    /// Time since the odometry stamp, s.
    pub after_s: f64,
}
