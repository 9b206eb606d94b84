//! Guard and memory: no motion of an accepted tube touches a body that a beam returned.
//!
//! The bytes are a robot, a world and what somebody commands, tick by tick; the plant, the scanner and the
//! judge are the oracle's.

use crate::closed_loop::episode::{CLEAR_M, Episode, Lie, Style};
use crate::closed_loop::run::run_in;
use crate::closed_loop::tamper::{Raw, Tamper};
use crate::script::{Script, noise};
use crate::{Judged, Property};
use haltline::convert;
use haltline::time::Duration;
use haltline_spec::draw::Draw;
use haltline_spec::plane::{Body, Pose};
use haltline_spec::world::Mover;

pub const GUARD: Property = Property {
    name: "guard",
    judge: |bytes| judge(bytes, Lie::None),
    twins: &[
        ("obstacle speed 0", |bytes| judge(bytes, Lie::ObstacleSpeed)),
        ("latency 0", |bytes| judge(bytes, Lie::Latency)),
        ("brakes four times as good", |bytes| {
            judge(bytes, Lie::Braking)
        }),
        ("tracking error 0", |bytes| judge(bytes, Lie::Tracking)),
        ("a smaller footprint", |bytes| judge(bytes, Lie::Footprint)),
    ],
    draw: noise::<60, 400>,
    cases: 250,
};

/// The robot of a script; see the ranges of `spec/tests`.
pub fn episode(script: &mut Script<'_>) -> Episode {
    let style = script.one_of([Style::Reckless, Style::Reckless, Style::Weave, Style::Spot]);
    let moving = script.flag();
    Episode {
        style,
        lie: Lie::None,
        steered: script.chance(64) && style != Style::Spot,
        separate: false,
        full_circle: script.flag(),
        thin: script.chance(80),
        edges_m: [
            script.between(0.15, 0.6),
            script.between(0.15, 0.6),
            script.between(0.12, 0.4),
            script.between(0.12, 0.4),
        ],
        period_ms: script.count(20, 49) as u64,
        jitter_ms: script.count(0, 7) as u64,
        latency_ms: script.count(0, 149) as u64,
        scan_ms: script.count(5, 49) as u64,
        beams: script.count(180, 400),
        speed_mps: script.between(0.3, 1.2),
        turn_radps: script.between(0.4, 2.0),
        braking_mps2: script.between(0.4, 1.5),
        angular_braking_radps2: script.between(0.6, 3.0),
        harder: script.between(1.0, 4.0),
        tol_v_mps: script.extreme(0.0, 0.02),
        tol_omega_radps: script.extreme(0.0, 0.03),
        tracking_m: script.extreme(0.0, 0.02),
        sensor_m: script.extreme(0.0, 0.02),
        odometry_linear: script.extreme(0.0, 0.02),
        odometry_angular: script.extreme(0.0, 0.02),
        obstacle_mps: if moving {
            script.between(0.1, 1.0)
        } else {
            0.0
        },
        bodies: script.count(1, 5),
        zone_m: [0.01, 0.005],
        watchdog_ms: None,
        tube_every: 2,
        seed: script.bits(),
    }
}

/// Bodies outside the disc that the operator vouches for.
pub fn world(script: &mut Script<'_>, episode: &Episode) -> Vec<Mover> {
    let body = |script: &mut Script<'_>| {
        let size = if episode.thin {
            0.03
        } else {
            script.between(0.05, 0.4)
        };
        let angle = script.between(-3.1, 3.1);
        let distance = CLEAR_M + size * 1.5 + 0.02 + script.between(0.0, 1.5);
        let (x, y) = (distance * angle.cos(), distance * angle.sin());
        let body = if episode.thin || script.flag() {
            Body::disc(x, y, size)
        } else {
            let other = script.between(0.03, size);
            Body::rectangle(Pose::new(x, y, script.between(-3.0, 3.0)), size, other)
        };
        let (course, speed) = (
            script.between(-3.1, 3.1),
            script.extreme(0.0, episode.obstacle_mps),
        );
        Mover {
            body,
            velocity_mps: [speed * course.cos(), speed * course.sin()],
        }
    };
    (0..episode.bodies).map(|_| body(script)).collect()
}

/// Leaves the margin in question alone, so that no other covers for it.
fn alone(episode: &mut Episode, lie: Lie) {
    episode.lie = lie;
    episode.steered = false;
    episode.tol_v_mps = 0.0;
    episode.tol_omega_radps = 0.0;
    episode.tracking_m = 0.0;
    episode.sensor_m = 0.0;
    episode.style = Style::Reckless;
    match lie {
        Lie::Latency => episode.latency_ms = 250,
        Lie::Tracking => episode.tracking_m = 0.06,
        _ => {}
    }
}

/// Commands of the script; where it says nothing, the pilot's.
struct Commands<'a, 'b> {
    script: &'a mut Script<'b>,
    episode: &'a Episode,
    held: Option<(usize, [f64; 2])>,
}

impl Tamper for Commands<'_, '_> {
    fn alter(&mut self, raw: &mut Raw, _draw: &mut Draw) {
        self.held = match self.held {
            Some((ticks, twist)) if ticks > 0 => Some((ticks - 1, twist)),
            _ if self.script.chance(48) => {
                let (speed, turn) = (self.episode.speed_mps, self.episode.turn_radps);
                let twist = [
                    self.script.extreme(-speed, speed),
                    self.script.extreme(-turn, turn),
                ];
                Some((self.script.count(0, 15), twist))
            }
            _ => None,
        };
        if let Some((_, [v_mps, turn])) = self.held
            && !self.episode.steered
        {
            let stamp = raw.now.minus(Duration::from_us(1000));
            raw.command = convert::twist_command(stamp, v_mps, turn);
        }
    }
}

fn judge(bytes: &[u8], lie: Lie) -> Judged {
    let mut script = Script::new(bytes);
    let mut episode = episode(&mut script);
    if lie != Lie::None {
        alone(&mut episode, lie);
    }
    let world = world(&mut script, &episode);
    let ticks = 40 + 2 * bytes.len().min(60);
    let seconds = (ticks as u64 * episode.period_ms) as f64 * 1e-3;
    let mut commands = Commands {
        script: &mut script,
        episode: &episode,
        held: None,
    };
    let report = run_in(&episode, world, seconds, &mut commands);
    let broken = report
        .contacts
        .iter()
        .chain(&report.crashes)
        .chain(&report.faults)
        .next();
    broken.map_or(Ok(report.accepted), |first| Err(first.clone()))
}
