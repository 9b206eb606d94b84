//! Bodies, how they move, and where each is at a given time.

use crate::math::{Pose, sin_cos};
use crate::result::{BodyPose, BodyRecord, PoseRecord, ShapeRecord};

/// Outline of a body in its own frame, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A line without thickness.
    Segment([f64; 2], [f64; 2]),
    /// A rectangle around the origin: half extents.
    Box([f64; 2]),
    /// A disc around the origin: radius.
    Circle(f64),
}

impl Shape {
    /// Radius of a disc around the origin that holds the shape.
    #[must_use]
    pub fn reach(&self) -> f64 {
        match self {
            Self::Segment(a, b) => libm::hypot(a[0], a[1]).max(libm::hypot(b[0], b[1])),
            Self::Box([x, y]) => libm::hypot(*x, *y),
            Self::Circle(radius) => *radius,
        }
    }

    /// Least width a laser may see of it: what assumption A-WIDTH speaks about.
    #[must_use]
    pub fn width(&self) -> f64 {
        match self {
            Self::Segment(a, b) => libm::hypot(b[0] - a[0], b[1] - a[1]),
            Self::Box([x, y]) => 2.0 * x.min(*y),
            Self::Circle(radius) => 2.0 * radius,
        }
    }
}

/// When a body starts to move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trigger {
    /// At this time, seconds.
    At(f64),
    /// `delay_s` after the robot's rotation centre first had `x ≥ x_m`.
    RobotPasses {
        /// The line.
        x_m: f64,
        /// Delay after the crossing.
        delay_s: f64,
    },
}

/// A body's course after its trigger.
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// Never moves.
    Still,
    /// Constant velocity (m/s) for a time (s).
    Straight {
        /// Velocity in the world.
        velocity: [f64; 2],
        /// Duration.
        for_s: f64,
    },
    /// Turns about a pivot (world, m) at a rate (rad/s) for a time (s): a door.
    Turn {
        /// Pivot in the world.
        pivot: [f64; 2],
        /// Turn rate, counter-clockwise.
        rate: f64,
        /// Duration.
        for_s: f64,
    },
    /// Straight lines through `[t_s, x_m, y_m]`, times since the trigger, increasing.
    WayPoints(Vec<[f64; 3]>),
}

/// One obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Name for reports.
    pub name: String,
    /// Outline.
    pub shape: Shape,
    /// Pose before the trigger.
    pub home: Pose,
    /// Glass, black cloth: no beam comes back from it, and beams pass through it.
    pub invisible: bool,
    /// When it starts.
    pub trigger: Trigger,
    /// How it moves then.
    pub course: Course,
}

impl Body {
    /// Pose `elapsed_s` after the trigger; negative means not yet.
    #[must_use]
    pub fn pose_after(&self, elapsed_s: f64) -> Pose {
        let time = elapsed_s.max(0.0);
        match &self.course {
            Course::Still => self.home,
            Course::Straight { velocity, for_s } => {
                let t = time.min(*for_s);
                Pose::new(
                    self.home.x + velocity[0] * t,
                    self.home.y + velocity[1] * t,
                    self.home.theta,
                )
            }
            Course::Turn { pivot, rate, for_s } => {
                let angle = rate * time.min(*for_s);
                let (sin, cos) = sin_cos(angle);
                let (dx, dy) = (self.home.x - pivot[0], self.home.y - pivot[1]);
                Pose::new(
                    pivot[0] + cos * dx - sin * dy,
                    pivot[1] + sin * dx + cos * dy,
                    self.home.theta + angle,
                )
            }
            Course::WayPoints(points) => along(points, self.home, time),
        }
    }

    /// Fastest speed of any of its points, m/s.
    #[must_use]
    pub fn top_speed(&self) -> f64 {
        match &self.course {
            Course::Still => 0.0,
            Course::Straight { velocity, .. } => libm::hypot(velocity[0], velocity[1]),
            Course::Turn { pivot, rate, .. } => {
                let arm = libm::hypot(self.home.x - pivot[0], self.home.y - pivot[1]);
                rate.abs() * (arm + self.shape.reach())
            }
            Course::WayPoints(points) => points
                .windows(2)
                .filter_map(|pair| match pair {
                    [a, b] => Some(libm::hypot(b[1] - a[1], b[2] - a[2]) / (b[0] - a[0])),
                    _ => None,
                })
                .fold(0.0, f64::max),
        }
    }
}

/// Position on a polyline of way points; before the first it waits there.
fn along(points: &[[f64; 3]], home: Pose, time: f64) -> Pose {
    let mut at = [home.x, home.y];
    for (index, [t, x, y]) in points.iter().enumerate() {
        if time >= *t || index == 0 {
            at = [*x, *y];
            continue;
        }
        if let Some([t0, x0, y0]) = points.get(index - 1) {
            let part = (time - t0) / (t - t0);
            at = [x0 + (x - x0) * part, y0 + (y - y0) * part];
        }
        break;
    }
    Pose::new(at[0], at[1], home.theta)
}

/// All bodies with the state of their triggers.
#[derive(Clone, Debug, Default)]
pub struct World {
    bodies: Vec<Body>,
    started_s: Vec<Option<f64>>,
}

impl World {
    /// A world at time zero.
    #[must_use]
    pub fn new(bodies: Vec<Body>) -> Self {
        let started_s = bodies
            .iter()
            .map(|body| match body.trigger {
                Trigger::At(at) => Some(at),
                Trigger::RobotPasses { .. } => None,
            })
            .collect();
        Self { bodies, started_s }
    }

    /// The bodies in the order of the file.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Fires the triggers that wait for the robot, given its rotation centre's x.
    pub fn observe_robot(&mut self, t_s: f64, robot_x_m: f64) {
        for (body, started) in self.bodies.iter().zip(&mut self.started_s) {
            if let (None, Trigger::RobotPasses { x_m, delay_s }) = (*started, body.trigger)
                && robot_x_m >= x_m
            {
                *started = Some(t_s + delay_s);
            }
        }
    }

    /// Pose of body `index` at `t_s`; the origin for an index that does not exist.
    #[must_use]
    pub fn pose(&self, index: usize, t_s: f64) -> Pose {
        match (self.bodies.get(index), self.started_s.get(index)) {
            (Some(body), Some(Some(start))) => body.pose_after(t_s - start),
            (Some(body), _) => body.home,
            _ => Pose::default(),
        }
    }

    /// Draws the bodies; moving ones with a pose for every `step_s` up to `end_s`.
    #[must_use]
    pub fn record(&self, end_s: f64, step_s: f64) -> Vec<BodyRecord> {
        let steps = libm::floor(end_s / step_s) as usize;
        self.bodies
            .iter()
            .enumerate()
            .map(|(index, body)| BodyRecord {
                name: body.name.clone(),
                shape: shape_record(&body.shape),
                invisible: body.invisible,
                poses: (0..=if body.course == Course::Still {
                    0
                } else {
                    steps
                })
                    .map(|step| {
                        let t_s = step as f64 * step_s;
                        let pose = pose_record(&self.pose(index, t_s));
                        BodyPose { t_s, pose }
                    })
                    .collect(),
            })
            .collect()
    }
}

/// A pose as it stands in results.
#[must_use]
pub fn pose_record(pose: &Pose) -> PoseRecord {
    PoseRecord {
        x_m: pose.x,
        y_m: pose.y,
        theta_rad: crate::math::wrap(pose.theta),
    }
}

fn shape_record(shape: &Shape) -> ShapeRecord {
    match shape {
        Shape::Segment(from, to) => ShapeRecord::Segment {
            from_m: *from,
            to_m: *to,
        },
        Shape::Box([x, y]) => ShapeRecord::Box {
            size_m: [2.0 * x, 2.0 * y],
        },
        Shape::Circle(radius) => ShapeRecord::Circle { radius_m: *radius },
    }
}

#[cfg(test)]
mod tests;
