//! Properties of plans over random situations.

use super::super::lanes::lanes;
use super::super::margin::stop;
use super::super::survey::Survey;
use super::*;

const CASES: usize = 3_000;

struct Case {
    situation: Situation<'static>,
    points: Vec<Obstacle>,
}

fn random_case(random: &mut Random) -> Case {
    let velocity = match random.below(4) {
        0 => Velocity::default(),
        1 => Velocity {
            linear_mps: 0.0,
            angular_radps: random.between(-1.3, 1.3),
        },
        _ => Velocity {
            linear_mps: random.between(0.0, 1.2),
            angular_radps: random.between(-1.3, 1.3),
        },
    };
    let goal = [random.between(-5.0, 5.0), random.between(-5.0, 5.0)];
    let mut situation = seekur(velocity, goal);
    situation.limits.period_s = [0.02, 0.04, 0.3][random.below(3)];
    if random.unit() < 0.3 {
        situation.goal.heading_rad = Some(random.between(-3.0, 3.0));
        situation.goal.position = [0.05, 0.0];
    }
    if random.unit() < 0.2 {
        situation.limits.curvature_max_per_m = Some(1.0);
    }
    let count = random.below(60);
    let points = (0..count)
        .map(|_| {
            let angle = random.between(-3.1, 3.1);
            let distance = random.between(0.75, 6.0);
            Obstacle {
                position: [distance * angle.cos(), distance * angle.sin()],
                inflation_m: random.between(0.0, 0.03),
            }
        })
        .collect();
    Case { situation, points }
}

fn bits(plan: &Plan) -> Vec<[u64; 3]> {
    plan.candidates()
        .iter()
        .map(|one| {
            [
                one.velocity.linear_mps.to_bits(),
                one.velocity.angular_radps.to_bits(),
                one.score.to_bits(),
            ]
        })
        .collect()
}

fn course_of(velocity: Velocity) -> Course {
    if velocity.linear_mps > 0.0 {
        Course::Arc {
            curvature_per_m: velocity.angular_radps / velocity.linear_mps,
            direction: Direction::Forward,
        }
    } else if velocity.angular_radps > 0.0 {
        Course::Spot(Turn::Left)
    } else {
        Course::Spot(Turn::Right)
    }
}

//= spec/navigate.md#nav-02
//= type=test
//# Every candidate of a plan MUST lie in the dynamic window around the command in force.
#[test]
fn candidates_lie_in_the_window_and_in_order() {
    let mut random = Random(0x5eed_0005);
    let mut moving = 0;
    for _ in 0..CASES {
        let case = random_case(&mut random);
        let limits = &case.situation.limits;
        let plan = plan(&case.situation, case.points.iter().copied());
        let candidates = plan.candidates();
        assert_eq!(plan.outcome == Outcome::Moving, !candidates.is_empty());
        moving += usize::from(!candidates.is_empty());
        assert!(candidates.len() <= CANDIDATES);
        let window = DynamicWindow::new(limits, case.situation.velocity);
        for candidate in candidates {
            let (window, velocity) = (window.unwrap(), candidate.velocity);
            assert!(
                window.linear.contains(velocity.linear_mps),
                "{velocity:?} {window:?}"
            );
            match limits.curvature_max_per_m {
                None => assert!(window.contains(velocity), "{velocity:?} {window:?}"),
                Some(most) => {
                    assert!(velocity.angular_radps.abs() <= most * velocity.linear_mps + 1e-9);
                    assert!(velocity.linear_mps > 0.0);
                }
            }
            assert!((0.0..=1.0).contains(&candidate.score));
        }
        // The last may be the slowest of the best lane, and going on as commanded comes early;
        // the others descend.
        let ordered = candidates.len().saturating_sub(1);
        let descending: Vec<_> = candidates[..ordered]
            .iter()
            .enumerate()
            .filter(|(rank, one)| *rank != 1 || one.velocity != case.situation.velocity)
            .map(|(_, one)| one)
            .collect();
        for pair in descending.windows(2) {
            assert!(pair[0].score >= pair[1].score);
        }
    }
    assert!(moving > CASES / 3, "{moving}");
}

//= spec/navigate.md#nav-03
//= type=test
//# The robot MUST be able to stop within the clearance of every candidate, even if any motion that may still be executing goes on for the reaction time.
#[test]
fn candidates_stop_before_the_bare_outline_touches_anything() {
    let mut random = Random(0x5eed_0006);
    let mut limited = 0;
    for _ in 0..CASES {
        let case = random_case(&mut random);
        let fixed = case
            .situation
            .footprint
            .inflated(case.situation.margin.fixed_m);
        for candidate in plan(&case.situation, case.points.iter().copied()).candidates() {
            let course = course_of(candidate.velocity);
            let needed = stop(&case.situation.limits, candidate.velocity).travel;
            for obstacle in &case.points {
                // Within the fixed margin from the start: only excused at rest.
                if fixed
                    .inflated(obstacle.inflation_m)
                    .contains(obstacle.position)
                {
                    continue;
                }
                let free = arc_distance(&case.situation.footprint, course, obstacle.position);
                assert!(
                    free.allows(needed),
                    "{candidate:?} {obstacle:?} {free:?} {needed}"
                );
                limited += usize::from(free != Clearance::Free);
            }
        }
    }
    assert!(limited > CASES, "{limited}");
}

/// The fast pass over the points must find what the plain minimum over `arc_distance` finds.
#[test]
fn the_fast_pass_finds_the_least_arc_distance() {
    let mut random = Random(0x5eed_0007);
    let (mut contacts, mut free) = (0, 0);
    for _ in 0..CASES / 10 {
        let case = random_case(&mut random);
        let Some((_, lanes)) = lanes(&case.situation) else {
            continue;
        };
        let mut survey = Survey::new(&case.situation, &lanes);
        for obstacle in &case.points {
            survey.add(&case.situation, &lanes, *obstacle);
        }
        for (index, lane) in lanes.iter().enumerate() {
            for sweep in [&survey.firm, &survey.ahead] {
                let swept = sweep.swept(index);
                let outline = |one: &Obstacle| swept.rect.inflated(one.inflation_m);
                let inside = |one: &Obstacle| outline(one).contains(one.position);
                // What is within the margin from the start has rules of its own.
                if !lane.rates.is_some() || case.points.iter().any(inside) {
                    continue;
                }
                let expected = case
                    .points
                    .iter()
                    .map(|one| arc_distance(&outline(one), lane.course, one.position))
                    .fold(Clearance::Free, Clearance::nearer);
                match (sweep.clearance(index, lane), expected) {
                    (Clearance::Contact(found), Clearance::Contact(expected)) => {
                        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
                        contacts += 1;
                    }
                    (Clearance::Free, expected) => {
                        assert!(
                            expected.allows(swept.horizon * 0.999),
                            "{expected:?} {lane:?}"
                        );
                        free += 1;
                    }
                    (found, expected) => panic!("{found:?} {expected:?} {lane:?}"),
                }
            }
        }
    }
    assert!(contacts > 1_000 && free > 1_000, "{contacts} {free}");
}

//= spec/navigate.md#nav-04
//= type=test
//# A plan MUST depend on nothing but its input, and not on the order of the points.
#[test]
fn plans_do_not_depend_on_the_order_of_points() {
    let mut random = Random(0x5eed_0008);
    for _ in 0..CASES {
        let mut case = random_case(&mut random);
        // Some points twice: ties must not matter either.
        let twice = case.points.len() / 3;
        case.points.extend_from_within(..twice);
        let first = plan(&case.situation, case.points.iter().copied());
        let again = plan(&case.situation, case.points.iter().copied());
        assert_eq!(bits(&first), bits(&again));
        for index in (1..case.points.len()).rev() {
            let other = random.below(index + 1);
            case.points.swap(index, other);
        }
        let shuffled = plan(&case.situation, case.points.iter().copied());
        assert_eq!(bits(&first), bits(&shuffled));
        assert_eq!(first.outcome, shuffled.outcome);
    }
}

#[test]
fn malformed_input_has_no_candidates() {
    let good = seekur(Velocity::default(), [5.0, 0.0]);
    let far = Obstacle::from([9.0, 9.0]);
    assert_eq!(plan(&good, [far]).outcome, Outcome::Moving);
    let bad_points = [
        Obstacle::from([f64::NAN, 0.0]),
        Obstacle::from([0.0, f64::INFINITY]),
        Obstacle {
            inflation_m: f64::NAN,
            ..far
        },
        Obstacle {
            inflation_m: -0.1,
            ..far
        },
    ];
    for bad in bad_points {
        let plan = plan(&good, [far, bad]);
        assert_eq!(
            (plan.outcome, plan.candidates().len()),
            (Outcome::Malformed, 0)
        );
    }
    let spoil: [fn(&mut Situation<'_>); 10] = [
        |s| s.velocity.linear_mps = f64::NAN,
        |s| s.goal.position = [f64::NAN, 0.0],
        |s| s.goal.heading_rad = Some(f64::INFINITY),
        |s| s.limits.braking_mps2 = 0.0,
        |s| s.limits.period_s = -0.04,
        |s| s.limits.curvature_max_per_m = Some(f64::NAN),
        |s| s.margin.fixed_m = f64::NAN,
        |s| s.footprint.rear_m = -0.1,
        |s| s.tuning.comfort = 1.5,
        |s| {
            s.in_flight = &[Velocity {
                linear_mps: f64::NAN,
                angular_radps: 0.0,
            }]
        },
    ];
    for change in spoil {
        let mut situation = good;
        change(&mut situation);
        let plan = plan(&situation, [far]);
        assert_eq!(
            (plan.outcome, plan.candidates().len()),
            (Outcome::Malformed, 0)
        );
    }
}

#[test]
fn extreme_but_finite_numbers_do_not_panic() {
    let values = [
        0.0,
        -0.0,
        1e-300,
        1e-9,
        1.0,
        1e9,
        1e300,
        f64::MAX,
        -f64::MAX,
    ];
    let mut random = Random(0x5eed_0009);
    for _ in 0..20_000 {
        let mut pick = || values[random.below(values.len())];
        let mut situation = seekur(
            Velocity {
                linear_mps: pick(),
                angular_radps: pick(),
            },
            [pick(), pick()],
        );
        situation.limits.speed_mps = pick();
        situation.limits.braking_mps2 = pick();
        situation.limits.period_s = pick();
        situation.margin.fixed_m = pick();
        situation.footprint.front_m = pick();
        let points = [[pick(), pick()], [pick(), pick()]];
        let plan = plan(&situation, obstacles(&points));
        for candidate in plan.candidates() {
            assert!(candidate.velocity.is_finite());
        }
    }
}

#[test]
fn never_drives_backwards() {
    let backwards = Velocity {
        linear_mps: -0.2,
        angular_radps: 0.0,
    };
    let plan = plan(&seekur(backwards, [5.0, 0.0]), []);
    assert_eq!(
        (plan.outcome, plan.candidates().len()),
        (Outcome::Unsuitable, 0)
    );
}

#[test]
fn what_is_in_flight_counts() {
    let slow = Velocity {
        linear_mps: 0.3,
        angular_radps: 0.0,
    };
    let fast = [Velocity {
        linear_mps: 1.1,
        angular_radps: 0.0,
    }];
    let wall: Vec<Point> = (-20..=20).map(|y| [1.6, f64::from(y) * 0.05]).collect();
    let situation = seekur(slow, [5.0, 0.0]);
    assert_eq!(plan(&situation, obstacles(&wall)).outcome, Outcome::Moving);
    let hurried = Situation {
        in_flight: &fast,
        ..situation
    };
    let plan = plan(&hurried, obstacles(&wall));
    assert!(
        matches!(plan.outcome, Outcome::Blocked(Some(_))),
        "{plan:?}"
    );
}

#[test]
fn candidates_differ_and_the_guards_points_convert() {
    let plan = plan(
        &seekur(
            Velocity {
                linear_mps: 0.5,
                angular_radps: 0.0,
            },
            [5.0, 1.0],
        ),
        [],
    );
    assert_eq!(plan.candidates().len(), CANDIDATES);
    for (index, one) in plan.candidates().iter().enumerate() {
        let earlier = &plan.candidates()[..index];
        assert!(
            earlier.iter().all(|other| other.velocity != one.velocity),
            "{plan:?}"
        );
    }
    let point = crate::guard::check::CloudPoint {
        x_mm: 1_500,
        y_mm: -20,
        extra_mm: 12,
        joined: true,
    };
    let obstacle = Obstacle {
        position: [1.5, -0.02],
        inflation_m: 0.012,
    };
    assert_eq!(Obstacle::from(point), obstacle);
}
