//! Arc distances against `parry2d` and against a walk along the arc.

use super::*;
use parry2d_f64::math::{Pose, Vector};
use parry2d_f64::query::{NonlinearRigidMotion, PointQuery, cast_shapes_nonlinear};
use parry2d_f64::shape::{Ball, Cuboid};
use std::f64::consts::TAU;

const CASES: usize = if cfg!(debug_assertions) {
    10_000
} else {
    100_000
};
/// What must agree, m (rad on the spot, whose lever is about 1 m).
const TOLERANCE: f64 = 1e-3;
/// Outline change that decides whether a contact is grazing, m.
const GRAZING_M: f64 = 2e-4;
/// Largest turn given to one cast, rad.
const PIECE_RAD: f64 = 0.1;
/// Stands for a point in the cast, m.
const BALL_M: f64 = 1e-5;

struct Case {
    footprint: Footprint,
    course: Course,
    point: Point,
}

impl Case {
    /// Outlines from long to wide and asymmetric; curvatures from straight to spot; points near
    /// and far, some exactly on an edge or a corner.
    fn random(random: &mut Random) -> Self {
        let mut side = || random.between(0.05, 1.0);
        let footprint = Footprint {
            front_m: side(),
            rear_m: side(),
            left_m: side(),
            right_m: side(),
        };
        let direction = if random.unit() < 0.5 {
            Direction::Forward
        } else {
            Direction::Reverse
        };
        let curvature_per_m = match random.below(6) {
            0 => 0.0,
            1 => random.between(-1e-6, 1e-6),
            2 => random.between(-50.0, 50.0),
            _ => random.between(-3.0, 3.0),
        };
        let course = match random.below(8) {
            0 => Course::Spot(Turn::Left),
            1 => Course::Spot(Turn::Right),
            _ => Course::Arc {
                curvature_per_m,
                direction,
            },
        };
        let inner = [
            random.between(-footprint.rear_m, footprint.front_m),
            random.between(-footprint.right_m, footprint.left_m),
        ];
        let point = match random.below(20) {
            0 => [footprint.front_m, inner[1]],
            1 => [-footprint.rear_m, inner[1]],
            2 => [inner[0], footprint.left_m],
            3 => [inner[0], -footprint.right_m],
            4 => inner,
            5 => [footprint.front_m, footprint.left_m],
            6..=13 => met_by(
                course,
                [footprint.front_m, inner[1]],
                random.between(0.0, 3.0),
            ),
            14 => met_by(
                course,
                [inner[0], footprint.left_m],
                random.between(0.0, 3.0),
            ),
            15 => met_by(
                course,
                [-footprint.rear_m, -footprint.right_m],
                random.between(0.0, 3.0),
            ),
            _ => [random.between(-4.0, 4.0), random.between(-4.0, 4.0)],
        };
        Self {
            footprint,
            course,
            point,
        }
    }

    fn ours(&self, margin_m: f64) -> Clearance {
        arc_distance(&self.footprint.inflated(margin_m), self.course, self.point)
    }

    /// Centre of rotation, sense and travel per radian, from the definitions.
    fn rotation(&self) -> Option<(f64, f64, f64)> {
        match self.course {
            Course::Spot(Turn::Left) => Some((0.0, 1.0, 1.0)),
            Course::Spot(Turn::Right) => Some((0.0, -1.0, 1.0)),
            Course::Arc {
                curvature_per_m,
                direction,
            } => {
                let along = if direction == Direction::Forward {
                    1.0
                } else {
                    -1.0
                };
                (curvature_per_m.abs() > 1e-9).then(|| {
                    let radius = 1.0 / curvature_per_m;
                    (radius, along * radius.signum(), radius.abs())
                })
            }
        }
    }

    fn cuboid(&self) -> (Cuboid, Vector) {
        let foot = &self.footprint;
        let half = Vector::new(
            (foot.front_m + foot.rear_m) / 2.0,
            (foot.left_m + foot.right_m) / 2.0,
        );
        let middle = Vector::new(
            (foot.front_m - foot.rear_m) / 2.0,
            (foot.left_m - foot.right_m) / 2.0,
        );
        (Cuboid::new(half), middle)
    }

    /// The longest travel looked at: a full turn, at most 50 m.
    fn end(&self) -> f64 {
        self.rotation()
            .map_or(50.0, |(_, _, per_radian)| (TAU * per_radian).min(50.0))
    }

    fn parry(&self) -> Option<f64> {
        let (cuboid, middle) = self.cuboid();
        let still = NonlinearRigidMotion::constant_position(Pose::translation(
            self.point[0],
            self.point[1],
        ));
        let ball = Ball::new(BALL_M);
        // In pieces of unit time: the cast's tolerance is absolute, so that it does not come to
        // an end at late times, and over large turns it loses contacts.
        let piece = self
            .rotation()
            .map_or(1.0, |(_, _, per_radian)| per_radian * PIECE_RAD);
        let mut from = 0.0;
        while from < self.end() {
            let motion = self.piece(from, piece, middle);
            let hit = cast_shapes_nonlinear(&motion, &cuboid, &still, &ball, 0.0, 1.0, true);
            if let Some(hit) = hit.unwrap() {
                return Some(from + hit.time_of_impact * piece);
            }
            from += piece;
        }
        None
    }

    /// The outline's motion from travel `from` on, `piece` per unit of time.
    fn piece(&self, from: f64, piece: f64, middle: Vector) -> NonlinearRigidMotion {
        let Some((centre_y, sense, per_radian)) = self.rotation() else {
            let reverse = matches!(
                self.course,
                Course::Arc {
                    direction: Direction::Reverse,
                    ..
                }
            );
            let sign = if reverse { -1.0 } else { 1.0 };
            return NonlinearRigidMotion::new(
                Pose::translation(middle.x + sign * from, middle.y),
                Vector::new(0.0, 0.0),
                Vector::new(sign * piece, 0.0),
                0.0,
            );
        };
        let centre = Vector::new(0.0, centre_y);
        let turned = sense * from / per_radian;
        let (sin, cos) = turned.sin_cos();
        let arm = middle - centre;
        let place = centre + Vector::new(cos * arm.x - sin * arm.y, sin * arm.x + cos * arm.y);
        NonlinearRigidMotion::new(
            Pose::new(place, turned),
            centre - middle,
            Vector::new(0.0, 0.0),
            sense * piece / per_radian,
        )
    }

    /// Walks the arc in steps that cannot jump over the outline: distance / fastest speed.
    fn walk(&self) -> Option<f64> {
        let (cuboid, middle) = self.cuboid();
        let point = Vector::new(self.point[0], self.point[1]);
        let mut travel = 0.0;
        for _ in 0..200_000 {
            let (seen, speed) = match self.rotation() {
                Some((centre_y, sense, per_radian)) => {
                    let arm = point - Vector::new(0.0, centre_y);
                    let (sin, cos) = (-sense * travel / per_radian).sin_cos();
                    let turned = Vector::new(cos * arm.x - sin * arm.y, sin * arm.x + cos * arm.y);
                    (
                        turned + Vector::new(0.0, centre_y),
                        arm.length() / per_radian,
                    )
                }
                None => {
                    let reverse = matches!(
                        self.course,
                        Course::Arc {
                            direction: Direction::Reverse,
                            ..
                        }
                    );
                    let along = if reverse { travel } else { -travel };
                    (point + Vector::new(along, 0.0), 1.0)
                }
            };
            let distance = cuboid.distance_to_local_point(seen - middle, true);
            if distance < 1e-7 {
                return Some(travel);
            }
            travel += (distance / speed.max(1e-9)).max(1e-7);
            if travel > self.end() {
                return None;
            }
        }
        Some(travel)
    }

    /// Whether `judged` agrees; `None` if it does only because the contact is grazing.
    fn agrees(&self, judged: Option<f64>) -> Option<bool> {
        let near = |ours: Clearance| match (ours, judged) {
            (Clearance::Contact(ours), Some(judged)) => (ours - judged).abs() <= TOLERANCE,
            (Clearance::Contact(ours), None) => ours >= self.end() - TOLERANCE,
            (Clearance::Free, judged) => judged.is_none(),
        };
        if near(self.ours(0.0)) {
            return Some(true);
        }
        // Between a slightly larger and a slightly smaller outline lies the truth.
        let value = |ours| match ours {
            Clearance::Contact(travel) => travel,
            Clearance::Free => f64::INFINITY,
        };
        let judged = judged.unwrap_or(f64::INFINITY);
        let bracket =
            value(self.ours(GRAZING_M)) - TOLERANCE..=value(self.ours(-GRAZING_M)) + TOLERANCE;
        if bracket.contains(&judged) {
            None
        } else {
            Some(false)
        }
    }
}

/// Where a point is that coincides with `outline` (body frame) after `travel`.
fn met_by(course: Course, [x, y]: Point, travel: f64) -> Point {
    let (curvature, sign) = match course {
        Course::Spot(turn) => {
            let angle = if turn == Turn::Left { travel } else { -travel };
            let (sin, cos) = angle.sin_cos();
            return [cos * x - sin * y, sin * x + cos * y];
        }
        Course::Arc {
            curvature_per_m,
            direction,
        } => (
            curvature_per_m,
            if direction == Direction::Forward {
                1.0
            } else {
                -1.0
            },
        ),
    };
    let way = sign * travel;
    let (sin, cos) = (curvature * way).sin_cos();
    let half = curvature * way / 2.0;
    let chord = if half.abs() < 1e-6 {
        way
    } else {
        way * half.sin() / half
    };
    [
        chord * half.cos() + cos * x - sin * y,
        chord * half.sin() + sin * x + cos * y,
    ]
}

/// Compares `CASES` random cases with `judge`; `arbiter` decides where they differ.
///
/// Returns how often the arbiter found the judge wrong.
fn compare(seed: u64, judge: fn(&Case) -> Option<f64>, arbiter: fn(&Case) -> Option<f64>) -> usize {
    let mut random = Random(seed);
    let (mut grazing, mut contacts, mut overruled) = (0, 0, 0);
    for number in 0..CASES {
        let case = Case::random(&mut random);
        let judged = judge(&case);
        contacts += usize::from(judged.is_some_and(|travel| travel > 0.0));
        let agrees = match case.agrees(judged) {
            Some(false) => {
                assert!(
                    judged.is_none(),
                    "case {number}: {judged:?} is too early or too late"
                );
                overruled += 1;
                case.agrees(arbiter(&case))
            }
            agrees => agrees,
        };
        match agrees {
            Some(true) => {}
            None => grazing += 1,
            Some(false) => panic!(
                "case {number}: {:?} {:?} {:?}: ours {:?}, judge {judged:?}, arbiter {:?}",
                case.footprint,
                case.course,
                case.point,
                case.ours(0.0),
                arbiter(&case),
            ),
        }
    }
    assert!(
        grazing * 100 < CASES,
        "{grazing} grazing cases explain too much"
    );
    assert!(contacts * 3 > CASES, "only {contacts} contacts");
    std::println!("{CASES} cases, {contacts} contacts, {grazing} grazing, {overruled} overruled");
    overruled
}

#[test]
fn agrees_with_parry_nonlinear_casts() {
    // Now and then the cast misses a contact that the walk finds.
    let overruled = compare(0x5eed_0001, Case::parry, Case::walk);
    assert!(overruled * 10_000 <= CASES, "{overruled}");
}

#[test]
fn agrees_with_a_walk_along_the_arc() {
    assert_eq!(compare(0x5eed_0002, Case::walk, Case::walk), 0);
}

#[test]
fn a_point_on_an_edge_or_inside_is_touched_at_once() {
    let foot = Footprint {
        front_m: 0.7,
        rear_m: 0.2,
        left_m: 0.3,
        right_m: 0.4,
    };
    for point in [
        [0.7, 0.1],
        [-0.2, 0.0],
        [0.0, 0.3],
        [0.3, -0.4],
        [0.7, 0.3],
        [0.1, 0.1],
    ] {
        for curvature_per_m in [0.0, 1e-8, -0.5, 2.0, 1e6] {
            for direction in [Direction::Forward, Direction::Reverse] {
                let course = Course::Arc {
                    curvature_per_m,
                    direction,
                };
                assert_eq!(arc_distance(&foot, course, point), Clearance::Contact(0.0));
            }
        }
        assert_eq!(
            arc_distance(&foot, Course::Spot(Turn::Left), point),
            Clearance::Contact(0.0)
        );
    }
}

#[test]
fn a_point_a_hair_outside_an_edge_it_enters_is_not_missed() {
    let mut random = Random(0x5eed_0003);
    for _ in 0..20_000 {
        let across = random.between(-0.42, 0.42);
        let point = [SEEKUR.front_m + random.unit() * 1e-15, across];
        let curvature_per_m = random.between(-1.0, 1.0);
        let course = Course::Arc {
            curvature_per_m,
            direction: Direction::Forward,
        };
        match arc_distance(&SEEKUR, course, point) {
            Clearance::Contact(travel) => assert!(travel < 1e-6, "{point:?} {course:?}: {travel}"),
            Clearance::Free => panic!("missed {point:?} {course:?}"),
        }
    }
}

#[test]
fn what_is_not_finite_counts_as_touched() {
    let straight = Course::Arc {
        curvature_per_m: 0.0,
        direction: Direction::Forward,
    };
    let bad = Course::Arc {
        curvature_per_m: f64::NAN,
        direction: Direction::Forward,
    };
    let none = Footprint {
        front_m: f64::NAN,
        ..SEEKUR
    };
    assert_eq!(
        arc_distance(&SEEKUR, straight, [f64::NAN, 9.0]),
        Clearance::Contact(0.0)
    );
    assert_eq!(
        arc_distance(&SEEKUR, straight, [9.0, f64::INFINITY]),
        Clearance::Contact(0.0)
    );
    assert_eq!(
        arc_distance(&SEEKUR, bad, [9.0, 9.0]),
        Clearance::Contact(0.0)
    );
    assert_eq!(
        arc_distance(&none, straight, [9.0, 9.0]),
        Clearance::Contact(0.0)
    );
}
