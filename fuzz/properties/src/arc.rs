//! Arc distances in closed form against a walk along the arc that cannot jump over the outline.

use crate::script::{Script, noise};
use crate::{Judged, Property, demand};
use haltline::dwa::{Clearance, Course, Direction, Footprint, Point, Turn, arc_distance};
use haltline_spec::plane::{Outline, Pose};
use std::f64::consts::TAU;

pub const ARC: Property = Property {
    name: "arc",
    judge: |bytes| judge(bytes, arc_distance),
    twins: &[
        ("one per cent too far", |bytes| {
            judge(bytes, |footprint, course, point| {
                match arc_distance(footprint, course, point) {
                    Clearance::Contact(travel) => Clearance::Contact(travel * 1.01),
                    free @ Clearance::Free => free,
                }
            })
        }),
        ("blind behind the axis", |bytes| {
            judge(bytes, |footprint, course, point| {
                let front = Footprint {
                    rear_m: 0.01,
                    ..*footprint
                };
                arc_distance(&front, course, point)
            })
        }),
        ("a millimetre too narrow", |bytes| {
            judge(bytes, |footprint, course, point| {
                let narrow = Footprint {
                    left_m: footprint.left_m - 1e-3,
                    ..*footprint
                };
                arc_distance(&narrow, course, point)
            })
        }),
    ],
    draw: noise::<16, 120>,
    cases: 10_000,
};

type Answer = fn(&Footprint, Course, Point) -> Clearance;
/// Agreement of the two, m or rad.
const TOLERANCE: f64 = 2e-6;
/// Contacts that an outline so much larger or smaller would have or not have are grazing, m.
const GRAZING_M: f64 = 2e-6;
/// Longest travel looked at, m or rad.
const FAR: f64 = 30.0;

fn judge(bytes: &[u8], answer: Answer) -> Judged {
    let mut script = Script::new(bytes);
    let mut contacts = 0;
    let foot = Footprint {
        front_m: script.between(0.05, 0.8),
        rear_m: script.between(0.05, 0.8),
        left_m: script.between(0.05, 0.5),
        right_m: script.between(0.05, 0.5),
    };
    for _ in 0..8 {
        let course = course(&mut script);
        let point = if script.chance(128) {
            let edge = [
                script.extreme(-foot.rear_m, foot.front_m),
                script.extreme(-foot.right_m, foot.left_m),
            ];
            pose_after(course, script.between(0.0, 3.0)).place(edge)
        } else {
            [script.between(-4.0, 4.0), script.between(-4.0, 4.0)]
        };
        contacts += usize::from(agrees(&foot, course, point, answer)?);
        unusual(&mut script, &foot, course, answer)?;
        if script.is_over() {
            break;
        }
    }
    Ok(contacts)
}

fn course(script: &mut Script<'_>) -> Course {
    match script.byte() {
        ..24 => Course::Spot(Turn::Left),
        24..48 => Course::Spot(Turn::Right),
        byte => Course::Arc {
            curvature_per_m: if byte < 64 {
                script.extreme(-1e-6, 1e-6)
            } else {
                script.between(-4.0, 4.0)
            },
            direction: if byte & 1 == 0 {
                Direction::Forward
            } else {
                Direction::Reverse
            },
        },
    }
}

fn pose_after(course: Course, travel: f64) -> Pose {
    match course {
        Course::Spot(Turn::Left) => Pose::new(0.0, 0.0, travel),
        Course::Spot(Turn::Right) => Pose::new(0.0, 0.0, -travel),
        Course::Arc {
            curvature_per_m,
            direction,
        } => {
            let way = if direction == Direction::Forward {
                travel
            } else {
                -travel
            };
            Pose::default().along_arc(way, way * curvature_per_m)
        }
    }
}

/// What is not a number counts as touched.
fn unusual(
    script: &mut Script<'_>,
    foot: &Footprint,
    course: Course,
    answer: Answer,
) -> Result<(), String> {
    let point = [script.any(), script.any()];
    let found = answer(foot, course, point);
    let finite = point.iter().all(|value| value.is_finite());
    demand(finite || found == Clearance::Contact(0.0), || {
        format!("{point:?}: {found:?}")
    })?;
    let sound = match found {
        Clearance::Free => true,
        Clearance::Contact(travel) => travel >= 0.0 && travel.is_finite(),
    };
    demand(sound, || format!("{course:?} {point:?}: {found:?}"))
}

/// Travel until contact by walking, infinite if there is none up to `end`; `None` where a point so near the outline that
/// steps become tiny leaves it undecided.
fn walk(foot: &Footprint, course: Course, point: Point, end: f64) -> Option<f64> {
    let outline = Outline {
        front_m: foot.front_m,
        rear_m: foot.rear_m,
        left_m: foot.left_m,
        right_m: foot.right_m,
    };
    let mut travel = 0.0;
    for _ in 0..60_000 {
        let seen = pose_after(course, travel).enter(point);
        let distance = outline.distance_m(seen);
        if distance < 1e-7 {
            return Some(travel);
        }
        // How fast the point moves, seen from the robot, per unit of travel.
        let speed = match course {
            Course::Spot(_) => seen[0].hypot(seen[1]),
            Course::Arc {
                curvature_per_m, ..
            } => (1.0 - curvature_per_m * seen[1]).hypot(curvature_per_m * seen[0]),
        };
        travel += (distance / speed.max(1e-9)).max(1e-7);
        if travel > end {
            return Some(f64::INFINITY);
        }
    }
    None
}

/// Whether there is a contact; an error if the two disagree by more than a grazing contact explains.
fn agrees(foot: &Footprint, course: Course, point: Point, answer: Answer) -> Result<bool, String> {
    let turn = match course {
        Course::Spot(_) => TAU,
        Course::Arc {
            curvature_per_m, ..
        } => TAU / curvature_per_m.abs().max(1e-9),
    };
    let end = turn.min(FAR);
    let Some(within) = walk(foot, course, point, end) else {
        return Ok(false);
    };
    let value = |margin: f64| match answer(&foot.inflated(margin), course, point) {
        Clearance::Contact(travel) if travel <= end => travel,
        Clearance::Contact(_) | Clearance::Free => f64::INFINITY,
    };
    let (early, late) = (value(GRAZING_M) - TOLERANCE, value(-GRAZING_M) + TOLERANCE);
    // At the very end of the walk both answers are right.
    let last = within.min(end) >= end - 1e-5 && early >= end - 1e-3;
    demand((early <= within && within <= late) || last, || {
        let ours = answer(foot, course, point);
        format!("{foot:?} {course:?} {point:?}: {ours:?}, walked {within}")
    })?;
    Ok(within > 0.0 && within.is_finite())
}
