//! Single motions a robot may make under the assumptions, drawn at random.
//!
//! Nothing is bounded or enlarged here: each [`Course`] is one thing that can
//! really happen. Half of the draws sit at the ends of their ranges, because
//! that is where bounds break.

use crate::draw::Draw;
use crate::plane::Pose;

/// Speed in m/s and turn rate in rad/s at the rotation centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Forward speed, m/s.
    pub v_mps: f64,
    /// Counter-clockwise turn rate, rad/s.
    pub omega_radps: f64,
}

impl Twist {
    /// A twist from its two numbers (m/s, rad/s).
    #[must_use]
    pub const fn new(v_mps: f64, omega_radps: f64) -> Self {
        Self { v_mps, omega_radps }
    }

    /// Both parts multiplied by `factor`.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self::new(self.v_mps * factor, self.omega_radps * factor)
    }
}

/// How the drive brings the robot to rest (A-BRAKE).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brakes {
    /// Sure deceleration `b`, m/s².
    pub least_mps2: f64,
    /// Hardest deceleration, m/s²; at least `least_mps2`.
    pub hardest_mps2: f64,
    /// Sure angular deceleration `beta`, rad/s²; infinite where the wheels hold the arc.
    pub angular_radps2: f64,
    /// Whether speed and turn rate may each follow their own ramp.
    pub separate: bool,
}

/// The twists that may be executed in the hold time.
#[derive(Clone, Debug, PartialEq)]
pub enum Reach {
    /// The convex hull of the vertices.
    Hull(Vec<Twist>),
    /// The bounding box of the vertices (separate ramps).
    Bounds(Vec<Twist>),
    /// Ackermann: the speeds of the vertices and any curvature (1/m) of an interval.
    Arc {
        /// Least and largest speed, m/s.
        speed_mps: [f64; 2],
        /// Least and largest curvature, 1/m, steering error included.
        curvature_per_m: [f64; 2],
    },
}

/// Everything that is known about the next moments of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Manoeuvre {
    /// Twists that may be executed.
    pub reach: Reach,
    /// Additional error of the speed, m/s.
    pub tol_v_mps: f64,
    /// Additional error of the turn rate, rad/s.
    pub tol_omega_radps: f64,
    /// Longest time until braking starts, s.
    pub hold_s: f64,
    /// The brakes.
    pub brakes: Brakes,
}

/// Where the robot is at one moment of a course.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Time since the start of the course, s.
    pub t_s: f64,
    /// Pose of the rotation centre, in the frame of the start pose.
    pub pose: Pose,
    /// Path driven forward so far, m.
    pub path_m: f64,
}

/// One motion from the start of the hold time until rest; all moments are moving ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// The moments in order of time.
    pub moments: Vec<Moment>,
}

/// Longest time between two moments of a course, s.
const STEP_S: f64 = 0.01;
/// Integration step where no closed form exists, s.
const FINE_S: f64 = 0.001;

impl Manoeuvre {
    /// Draws one admissible motion starting at `start`.
    #[must_use]
    pub fn course(&self, start: Pose, draw: &mut Draw) -> Course {
        let mut writer = Writer::new(start);
        let brake_at_s = if draw.chance(0.6) {
            self.hold_s
        } else {
            draw.between(0.0, self.hold_s)
        };
        let pieces = 1 + draw.index(3);
        let mut twist = self.twist(draw);
        let mut from_s = 0.0;
        for piece in 0..pieces {
            let until_s = if piece + 1 == pieces {
                brake_at_s
            } else {
                draw.between(from_s, brake_at_s)
            };
            if piece > 0 {
                twist = self.twist(draw);
            }
            writer.hold(twist, until_s - from_s);
            from_s = until_s;
        }
        if self.brakes.separate && draw.chance(0.75) {
            self.ramp_separately(&mut writer, twist, draw);
        } else {
            self.ramp_together(&mut writer, twist, draw);
        }
        writer.course
    }

    /// One twist the robot may execute, tolerance included.
    fn twist(&self, draw: &mut Draw) -> Twist {
        let dv = draw.extreme(-self.tol_v_mps, self.tol_v_mps);
        let dw = draw.extreme(-self.tol_omega_radps, self.tol_omega_radps);
        match &self.reach {
            Reach::Hull(vertices) => {
                let inner = convex(vertices, draw);
                Twist::new(inner.v_mps + dv, inner.omega_radps + dw)
            }
            Reach::Bounds(vertices) => {
                let v = between_all(vertices, |t| t.v_mps, draw);
                let w = between_all(vertices, |t| t.omega_radps, draw);
                Twist::new(v + dv, w + dw)
            }
            Reach::Arc {
                speed_mps,
                curvature_per_m,
            } => {
                let v = draw.extreme(speed_mps[0], speed_mps[1]) + dv;
                let kappa = draw.extreme(curvature_per_m[0], curvature_per_m[1]);
                Twist::new(v, kappa * v + dw)
            }
        }
    }

    /// Both parts fall along one ramp, which need not be straight but is never slower than sure.
    fn ramp_together(&self, writer: &mut Writer, from: Twist, draw: &mut Draw) {
        let brakes = &self.brakes;
        let hardness = draw.extreme(brakes.least_mps2, brakes.hardest_mps2);
        let slowest_s = (from.v_mps.abs() / brakes.least_mps2)
            .max(from.omega_radps.abs() / brakes.angular_radps2);
        let chosen_s =
            (from.v_mps.abs() / hardness).max(from.omega_radps.abs() / brakes.angular_radps2);
        if draw.chance(0.7) {
            writer.ramp(from, from.scaled(0.0), chosen_s);
        } else {
            // Hard at first, then as slowly as allowed.
            let knee = draw.unit();
            writer.ramp(from, from.scaled(knee), chosen_s * (1.0 - knee));
            writer.ramp(from.scaled(knee), from.scaled(0.0), slowest_s * knee);
        }
    }

    /// Each part falls along its own ramp.
    fn ramp_separately(&self, writer: &mut Writer, from: Twist, draw: &mut Draw) {
        let brakes = &self.brakes;
        let linear = draw.extreme(brakes.least_mps2, brakes.hardest_mps2);
        let harder = brakes.hardest_mps2 / brakes.least_mps2;
        let angular = brakes.angular_radps2 * draw.extreme(1.0, harder);
        let (v_s, w_s) = (from.v_mps.abs() / linear, from.omega_radps.abs() / angular);
        let left = |t_s: f64, all_s: f64| {
            if t_s < all_s { 1.0 - t_s / all_s } else { 0.0 }
        };
        // Both rates are linear in time up to the first standstill and after it.
        let (first_s, last_s) = (v_s.min(w_s), v_s.max(w_s));
        for (begin_s, end_s) in [(0.0, first_s), (first_s, last_s)] {
            let steps = ((end_s - begin_s) / FINE_S).ceil() as usize;
            let dt_s = (end_s - begin_s) / steps.max(1) as f64;
            for step in 0..steps {
                let middle_s = begin_s + (step as f64 + 0.5) * dt_s;
                let path_m = from.v_mps * left(middle_s, v_s) * dt_s;
                let turn_rad = from.omega_radps * left(middle_s, w_s) * dt_s;
                writer.advance(path_m, turn_rad, dt_s);
            }
        }
    }
}

/// A random convex combination; often a vertex or an edge.
fn convex(vertices: &[Twist], draw: &mut Draw) -> Twist {
    let pick = |draw: &mut Draw| {
        vertices
            .get(draw.index(vertices.len()))
            .copied()
            .unwrap_or_default()
    };
    let (one, two, three) = (pick(draw), pick(draw), pick(draw));
    let (a, b) = (draw.extreme(0.0, 1.0), draw.extreme(0.0, 1.0));
    let mix = |p: f64, q: f64, r: f64| (p * a + q * (1.0 - a)) * b + r * (1.0 - b);
    Twist::new(
        mix(one.v_mps, two.v_mps, three.v_mps),
        mix(one.omega_radps, two.omega_radps, three.omega_radps),
    )
}

fn between_all(vertices: &[Twist], part: impl Fn(&Twist) -> f64, draw: &mut Draw) -> f64 {
    let low = vertices.iter().map(&part).fold(f64::INFINITY, f64::min);
    let high = vertices.iter().map(&part).fold(f64::NEG_INFINITY, f64::max);
    draw.extreme(low, high)
}

/// Appends moments to a course.
struct Writer {
    course: Course,
    now: Moment,
}

impl Writer {
    fn new(start: Pose) -> Self {
        let now = Moment {
            t_s: 0.0,
            pose: start,
            path_m: 0.0,
        };
        Self {
            course: Course { moments: vec![now] },
            now,
        }
    }

    fn advance(&mut self, path_m: f64, turn_rad: f64, dt_s: f64) {
        self.now = Moment {
            t_s: self.now.t_s + dt_s,
            pose: self.now.pose.along_arc(path_m, turn_rad),
            path_m: self.now.path_m + path_m.max(0.0),
        };
        self.course.moments.push(self.now);
    }

    fn hold(&mut self, twist: Twist, for_s: f64) {
        self.ramp(twist, twist, for_s);
    }

    /// From one twist to a parallel one: an arc of constant curvature, in closed form.
    fn ramp(&mut self, from: Twist, to: Twist, for_s: f64) {
        let steps = (for_s / STEP_S).ceil() as usize;
        let dt_s = for_s / steps.max(1) as f64;
        for step in 0..steps {
            // The mean of a linear ramp is its middle.
            let share = (step as f64 + 0.5) / steps as f64;
            let v = from.v_mps + (to.v_mps - from.v_mps) * share;
            let w = from.omega_radps + (to.omega_radps - from.omega_radps) * share;
            self.advance(v * dt_s, w * dt_s, dt_s);
        }
    }
}
