//! The simulator's judge of contacts (`parry2d`) against a second geometry written by hand.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // Tests may fail loudly.

use haltline_robots::Footprint;
use haltline_scenarios::contact::Judge;
use haltline_scenarios::math::Pose;
use haltline_scenarios::world::{Body, Course, Shape, Trigger, World};
use haltline_spec::draw::Draw;
use haltline_spec::exact::{self, Point};
use std::f64::consts::FRAC_PI_2;

const CASES: usize = 100_000;
/// Agreement of distances, m.
const TOLERANCE_M: f64 = 1e-9;

struct Case {
    footprint: Footprint,
    robot: Pose,
    shape: Shape,
    home: Pose,
}

/// Half of the cases lie on a raster of quarter turns and centimetres, where edges touch, coincide and cross.
fn case(draw: &mut Draw) -> Case {
    let raster = draw.chance(0.5);
    let mut length = |low: f64, high: f64| {
        let value = draw.between(low, high);
        if raster {
            (value * 20.0).round() / 20.0
        } else {
            value
        }
    };
    let footprint = Footprint {
        front_m: length(0.05, 0.7),
        rear_m: length(0.05, 0.7),
        left_m: length(0.05, 0.5),
        right_m: length(0.05, 0.5),
    };
    let mut place = || [length(-1.0, 1.0), length(-1.0, 1.0)];
    let (robot, home, end) = (place(), place(), place());
    let size = [length(0.05, 0.5), length(0.05, 0.5)];
    let mut heading = || {
        if raster {
            (draw.between(-4.0, 4.0)).round() * FRAC_PI_2
        } else {
            draw.between(-9.0, 9.0)
        }
    };
    let (robot_heading, home_heading) = (heading(), heading());
    Case {
        footprint,
        robot: Pose::new(robot[0], robot[1], robot_heading),
        home: Pose::new(home[0], home[1], home_heading),
        shape: match draw.index(3) {
            0 => Shape::Segment([0.0, 0.0], end),
            1 => Shape::Box(size),
            _ => Shape::Circle(size[0]),
        },
    }
}

impl Case {
    fn judged(&self) -> f64 {
        let body = Body {
            name: String::new(),
            shape: self.shape,
            home: self.home,
            invisible: false,
            trigger: Trigger::At(0.0),
            course: Course::Still,
        };
        let world = World::new(vec![body]);
        Judge::new(&self.footprint, &world).distances(&world, &self.robot, 0.0)[0]
    }

    fn outline(&self) -> [Point; 4] {
        let foot = &self.footprint;
        [
            [foot.front_m, foot.left_m],
            [-foot.rear_m, foot.left_m],
            [-foot.rear_m, -foot.right_m],
            [foot.front_m, -foot.right_m],
        ]
        .map(|corner| placed(&self.robot, corner))
    }

    fn by_hand(&self) -> f64 {
        let outline = self.outline();
        match self.shape {
            Shape::Segment(a, b) => {
                let ends = [placed(&self.home, a), placed(&self.home, b)];
                exact::segment_to_outline(ends, &outline)
            }
            Shape::Box(half) => {
                let centre = [self.home.x, self.home.y];
                let other = exact::corners(centre, self.home.theta, half);
                exact::outline_to_outline(&outline, &other)
            }
            Shape::Circle(radius) => {
                (exact::point_to_outline([self.home.x, self.home.y], &outline) - radius).max(0.0)
            }
        }
    }
}

/// Written out, so that nothing is shared with the judge.
fn placed(pose: &Pose, [x, y]: Point) -> Point {
    let (sin, cos) = pose.theta.sin_cos();
    [pose.x + cos * x - sin * y, pose.y + sin * x + cos * y]
}

#[test]
fn the_judge_and_the_second_geometry_agree_on_every_contact() {
    let mut draw = Draw::new(61);
    let (mut contacts, mut touching) = (0, 0);
    for number in 0..CASES {
        let case = case(&mut draw);
        let (judged, by_hand) = (case.judged(), case.by_hand());
        assert!(
            (judged - by_hand).abs() <= TOLERANCE_M,
            "case {number}: {judged} and {by_hand} for {:?} at {:?}, robot {:?} at {:?}",
            case.shape,
            case.home,
            case.footprint,
            case.robot
        );
        contacts += usize::from(by_hand <= 0.0);
        touching += usize::from(by_hand > 0.0 && by_hand < TOLERANCE_M);
    }
    println!("{CASES} poses, {contacts} contacts, {touching} apart by rounding only");
    assert!(contacts * 10 > CASES && contacts * 10 < CASES * 9);
}

/// The first shape whose distance by `wrong` differs from the judge's.
fn found(wrong: impl Fn(&Case) -> f64) -> Option<usize> {
    let mut draw = Draw::new(61);
    (0..CASES).find(|_| {
        let case = case(&mut draw);
        (case.judged() - wrong(&case)).abs() > TOLERANCE_M
    })
}

#[test]
fn false_twins_are_found() {
    let mirrored = found(|case| {
        let foot = &case.footprint;
        let swapped = Footprint {
            front_m: foot.rear_m,
            rear_m: foot.front_m,
            ..*foot
        };
        Case {
            footprint: swapped,
            ..*case
        }
        .by_hand()
    });
    let hollow = found(|case| match case.shape {
        Shape::Segment(a, b) => {
            let (ends, outline) = (
                [placed(&case.home, a), placed(&case.home, b)],
                case.outline(),
            );
            (0..4)
                .map(|at| exact::segment_to_segment(ends, [outline[at], outline[(at + 1) % 4]]))
                .fold(f64::INFINITY, f64::min)
        }
        _ => case.by_hand(),
    });
    let micrometre = found(|case| (case.by_hand() - 1e-6).max(0.0));
    println!(
        "found: front for rear {mirrored:?}, outline only {hollow:?}, a micrometre {micrometre:?}"
    );
    assert!(mirrored.is_some() && hollow.is_some() && micrometre.is_some());
}
