//! From what the kernel knows to what the planner is told, and back.
//!
//! The margins follow the guard's, so that it does not refuse what the planner proposes: a
//! point carries its own inflation, and the outline the terms of the motion ([`crate::dwa`]).

use super::pilot::{Here, Pilot};
use super::route::{Route, Sight, radians};
use crate::checked::KernelConfig;
use crate::config::{Config, Kinematics};
use crate::convert::{self, Round};
use crate::dwa::{self, Arrival, Footprint, Goal, Limits, Margin, Obstacle, Plan, Situation};
use crate::guard::check::CloudPoint;
use crate::guard::hull::{VERTICES_MAX, Vertex};
use crate::input::{Motion, Odometry, Pose, Twist};
use crate::kernel::Tick;
use crate::time::Duration;
use crate::units::{BinaryAngle, Curvature, Length};
use crate::window;
use core::f64::consts::PI;

/// SI units per micro-unit.
const MICRO: f64 = 1e-6;
/// What the guard adds for rounding, m.
const GUARD_ROUNDING_M: f64 = 0.003;
/// What may hide between two beams when the robot is near, m.
const NEAR_GAP_M: f64 = 0.002;
/// Kept between the planner's outline and the critical zone, m.
const ZONE_SLACK_M: f64 = 0.002;
/// A joined pair of returns is filled up with points this far apart, m.
const FILL_M: f64 = 0.03;
/// Pairs with both ends farther away than this along an axis are not filled up, mm.
const FILL_WITHIN_MM: i16 = 2_500;
/// Most points between two returns.
const FILL_MAX: u32 = 28;

impl<const S: usize, const B: usize, const M: usize> Pilot<'_, S, B, M> {
    /// Plans one step towards the target in `sight`.
    pub(super) fn plan(&self, route: &Route<'_>, here: &Here, tick: &Tick, sight: Sight) -> Plan {
        let odometry = &here.odometry;
        let mut in_flight = [dwa::Velocity::default(); VERTICES_MAX];
        let count = self.in_flight(odometry, &mut in_flight);
        let config = &self.kernel.config;
        let age = tick.now.since(odometry.stamp).unwrap_or_default();
        let margin = margin(config);
        let situation = Situation {
            footprint: footprint(config, &margin),
            limits: limits(config, age, tick.elapsed),
            margin,
            tuning: self.planning.tuning,
            velocity: velocity(self.kernel.pipeline.last().twist),
            in_flight: in_flight.get(..count).unwrap_or(&[]),
            goal: goal(route, &here.pose, sight),
        };
        // A point in the critical zone stops the robot, whatever is known of its error.
        let zone_m = metres(config.config().zone.side) + ZONE_SLACK_M - margin.fixed_m;
        dwa::plan(&situation, self.obstacles(zone_m))
    }

    /// How far ahead on the route to steer for: by speed, and at least by the outline's corner.
    pub(super) fn ahead_m(&self) -> f64 {
        let speed = velocity(self.kernel.pipeline.last().twist).linear_mps;
        let corner = Footprint::of(self.kernel.config.config()).corner_m();
        (speed * self.planning.tuning.lookahead_s).max(corner)
    }

    /// The measured twist and every command that may still be executing.
    fn in_flight(&self, odometry: &Odometry, out: &mut [dwa::Velocity; VERTICES_MAX]) -> usize {
        let since = odometry.stamp.minus(self.kernel.window(odometry));
        let sent = self.kernel.pipeline.since(since).map(|vertex| vertex.twist);
        let mut count = 0_usize;
        for (slot, twist) in out
            .iter_mut()
            .zip(core::iter::once(odometry.twist).chain(sent))
        {
            *slot = velocity(twist);
            count = count.saturating_add(1);
        }
        count
    }

    /// Every known point with its inflation, and points along what two neighbours bound.
    ///
    /// No inflation is less than `least_m`.
    fn obstacles(&self, least_m: f64) -> impl Iterator<Item = Obstacle> {
        let clouds = self.kernel.memory.clouds();
        let all = clouds.flat_map(|cloud| {
            let next = cloud.iter().skip(1).map(Some);
            cloud
                .iter()
                .zip(next.chain(core::iter::once(None)))
                .flat_map(|(point, next)| {
                    core::iter::once(Obstacle::from(*point)).chain(between(point, next))
                })
        });
        all.map(move |obstacle| Obstacle {
            inflation_m: obstacle.inflation_m.max(least_m),
            ..obstacle
        })
    }

    /// Whether a known point lies so near to the destination that no pose within its tolerance
    /// is free, whatever the heading; `pose` in the route's frame.
    pub(super) fn is_occupied(&self, route: &Route<'_>, pose: &Pose) -> bool {
        let [x, y] = route.goal_seen(pose);
        let inscribed = Footprint::of(self.kernel.config.config()).inscribed_m();
        let tolerance = f64::from(route.goal.tolerance.as_um()) * MICRO;
        let mut points = self.kernel.memory.clouds().flatten();
        points.any(|point| {
            let obstacle = Obstacle::from(*point);
            let [px, py] = obstacle.position;
            libm::hypot(px - x, py - y) + tolerance < inscribed
        })
    }
}

/// Points on the way from a return to its neighbour, where both bound one surface.
fn between(point: &CloudPoint, next: Option<&CloudPoint>) -> impl Iterator<Item = Obstacle> {
    let near = |one: &CloudPoint| {
        one.x_mm.unsigned_abs().max(one.y_mm.unsigned_abs()) <= FILL_WITHIN_MM.unsigned_abs()
    };
    let pair = next
        .filter(|next| point.joined && (near(point) || near(next)))
        .map(|next| (Obstacle::from(*point), Obstacle::from(*next)));
    let (from, to) = pair.unwrap_or_default();
    let ([x, y], [to_x, to_y]) = (from.position, to.position);
    let (along, across) = (to_x - x, to_y - y);
    let gaps = libm::ceil(libm::hypot(along, across) / FILL_M).max(1.0);
    let inflation_m = from.inflation_m.max(to.inflation_m);
    (1..=FILL_MAX)
        .map(f64::from)
        .take_while(move |number| *number < gaps)
        .map(move |number| Obstacle {
            position: [x + along * number / gaps, y + across * number / gaps],
            inflation_m,
        })
}

/// A command of the planner as the kernel executes it; `None` if it is none.
pub(super) fn vertex<const S: usize>(
    config: &Config<S>,
    velocity: dwa::Velocity,
) -> Option<Vertex> {
    let linear = convert::speed(velocity.linear_mps, Round::Nearest)?;
    let motion = match config.kinematics {
        Kinematics::Differential => Motion::Twist(Twist {
            linear,
            angular: convert::angular_speed(velocity.angular_radps, Round::Nearest)?,
        }),
        Kinematics::Ackermann { curvature_max, .. } => {
            let bend = velocity.angular_radps / velocity.linear_mps;
            let curvature = convert::curvature(bend, Round::Nearest)?;
            let most = curvature_max.as_urad_per_m();
            Motion::Arc {
                linear,
                // Rounding may exceed the limit by a count.
                curvature: Curvature::from_urad_per_m(
                    curvature
                        .as_urad_per_m()
                        .min(most)
                        .max(most.saturating_neg()),
                ),
            }
        }
    };
    window::desired(config, &motion)
        .ok()
        .map(|(vertex, _)| vertex)
}

fn metres(length: Length) -> f64 {
    f64::from(length.as_um()) * MICRO
}

fn velocity(twist: Twist) -> dwa::Velocity {
    dwa::Velocity {
        linear_mps: f64::from(twist.linear.as_um_per_s()) * MICRO,
        angular_radps: f64::from(twist.angular.as_urad_per_s()) * MICRO,
    }
}

fn seconds(span: Duration) -> f64 {
    span.as_us() as f64 * MICRO
}

fn limits<const S: usize>(config: &KernelConfig<S>, age: Duration, elapsed: Duration) -> Limits {
    let plain = config.config();
    let dynamics = &config.tube().dynamics;
    let own = &plain.limits;
    let braking = u64::from(own.braking.as_um_per_s2()).min(dynamics.braking);
    let angular = u64::from(own.angular_braking.as_urad_per_s2()).min(dynamics.angular_braking);
    Limits {
        speed_mps: f64::from(own.speed_forward.as_um_per_s()) * MICRO,
        acceleration_mps2: f64::from(own.acceleration.as_um_per_s2()) * MICRO,
        braking_mps2: braking as f64 * MICRO,
        angular_speed_radps: f64::from(own.angular_speed.as_urad_per_s()) * MICRO,
        angular_acceleration_radps2: f64::from(own.angular_acceleration.as_urad_per_s2()) * MICRO,
        angular_braking_radps2: angular as f64 * MICRO,
        // A late tick does not earn more acceleration.
        period_s: seconds(elapsed.min(plain.timing.period)),
        reaction_s: config.reaction_us(age) as f64 * MICRO,
        curvature_max_per_m: match plain.kinematics {
            Kinematics::Differential => None,
            Kinematics::Ackermann { curvature_max, .. } => {
                Some(f64::from(curvature_max.as_urad_per_m()) * MICRO)
            }
        },
    }
}

fn margin<const S: usize>(config: &KernelConfig<S>) -> Margin {
    let plain = config.config();
    Margin {
        fixed_m: metres(plain.tolerances.tracking) + GUARD_ROUNDING_M,
        speed_tolerance_mps: f64::from(plain.tolerances.speed.as_um_per_s()) * MICRO,
        turn_tolerance_radps: f64::from(plain.tolerances.angular_speed.as_urad_per_s()) * MICRO,
        obstacle_speed_mps: f64::from(plain.obstacle_speed.as_um_per_s()) * MICRO,
        near_m: sensor_m(config) + NEAR_GAP_M,
        separate_ramps: config.tube().dynamics.separate_ramps,
    }
}

fn sensor_m<const S: usize>(config: &KernelConfig<S>) -> f64 {
    config.memory().sensor_um as f64 * MICRO
}

/// The outline, longer in front where the critical zone reaches farther than the margin.
fn footprint<const S: usize>(config: &KernelConfig<S>, margin: &Margin) -> Footprint {
    let mut outline = Footprint::of(config.config());
    let zone = metres(config.config().zone.front) + ZONE_SLACK_M - sensor_m(config);
    outline.front_m += (zone - margin.fixed_m).max(0.0);
    outline
}

impl Footprint {
    fn of<const S: usize>(config: &Config<S>) -> Self {
        let outline = &config.footprint;
        Self {
            front_m: metres(outline.front),
            rear_m: metres(outline.rear),
            left_m: metres(outline.left),
            right_m: metres(outline.right),
        }
    }
}

fn goal(route: &Route<'_>, pose: &Pose, sight: Sight) -> Goal {
    let end = &route.goal;
    let heading = end.heading.filter(|_| sight.is_goal).map(|heading| {
        let turn = heading.minus(pose.heading);
        radians(BinaryAngle::from_counts(turn.cast_unsigned()))
    });
    let angle = f64::from(end.heading_tolerance) * (PI / 2_147_483_648.0);
    Goal {
        position: sight.position,
        heading_rad: heading,
        arrival: if sight.is_goal {
            Arrival::Stop
        } else {
            Arrival::Pass
        },
        position_tolerance_m: sight.tolerance_m,
        heading_tolerance_rad: if angle > 0.0 { angle } else { PI },
    }
}
