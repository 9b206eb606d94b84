//! The planner: whatever it proposes lies in the dynamic window and can be stopped before anything is touched.

use crate::script::{Script, noise};
use crate::{Judged, Property, demand};
use haltline::dwa::{
    Arrival, DynamicWindow, Footprint, Goal, Limits, Margin, Obstacle, Outcome, Plan, Situation,
    Tuning, Velocity, plan,
};
use haltline_spec::plane::{Outline, Pose};

pub const PLAN: Property = Property {
    name: "plan",
    judge: |bytes| {
        judge(bytes, |situation, points| {
            plan(situation, points.iter().copied())
        })
    },
    twins: &[
        ("blind to what is ahead", |bytes| {
            judge(bytes, |situation, points| {
                let beside = points.iter().filter(|point| {
                    let [x, y] = point.position;
                    x < 0.0 || y.is_nan()
                });
                plan(situation, beside.copied())
            })
        }),
        ("no reaction time", |bytes| {
            judge(bytes, |situation, points| {
                let mut quick = *situation;
                quick.limits.reaction_s = 1e-3;
                plan(&quick, points.iter().copied())
            })
        }),
        ("an outline of half the width", |bytes| {
            judge(bytes, |situation, points| {
                let mut narrow = *situation;
                narrow.footprint.left_m /= 2.0;
                narrow.footprint.right_m /= 2.0;
                plan(&narrow, points.iter().copied())
            })
        }),
    ],
    draw: noise::<40, 200>,
    cases: 4000,
};

type Planner = fn(&Situation<'_>, &[Obstacle]) -> Plan;

fn judge(bytes: &[u8], planner: Planner) -> Judged {
    let mut script = Script::new(bytes);
    let limits = Limits {
        speed_mps: script.between(0.2, 1.5),
        acceleration_mps2: script.between(0.2, 1.5),
        braking_mps2: script.between(0.3, 1.5),
        angular_speed_radps: script.between(0.3, 2.0),
        angular_acceleration_radps2: script.between(0.3, 3.0),
        angular_braking_radps2: script.between(0.5, 3.0),
        period_s: script.between(0.02, 0.1),
        reaction_s: script.between(0.02, 0.3),
        curvature_max_per_m: script.flag().then(|| script.between(0.3, 2.0)),
    };
    let velocity = moving(&mut script, &limits);
    let in_flight = [moving(&mut script, &limits), moving(&mut script, &limits)];
    let situation = Situation {
        footprint: Footprint {
            front_m: script.between(0.1, 0.7),
            rear_m: script.between(0.1, 0.7),
            left_m: script.between(0.1, 0.5),
            right_m: script.between(0.1, 0.5),
        },
        limits,
        margin: Margin {
            fixed_m: script.extreme(0.003, 0.04),
            speed_tolerance_mps: script.extreme(0.0, 0.02),
            turn_tolerance_radps: script.extreme(0.0, 0.03),
            obstacle_speed_mps: 0.0,
            near_m: 0.05,
            separate_ramps: script.flag(),
        },
        tuning: Tuning::default(),
        velocity,
        in_flight: &in_flight[..usize::from(script.byte() % 3)],
        goal: goal(&mut script),
    };
    let count = script.count(0, 24);
    let points: Vec<Obstacle> = (0..count).map(|_| obstacle(&mut script)).collect();
    let answer = planner(&situation, &points);
    unusual(&mut script, &situation, &points, planner)?;
    let reversed: Vec<Obstacle> = points.iter().rev().copied().collect();
    let again = planner(&situation, &reversed);
    demand(answer == again, || {
        "the order of the points counts".to_owned()
    })?;
    check(&situation, &points, &answer)?;
    Ok(answer.candidates().len())
}

fn moving(script: &mut Script<'_>, limits: &Limits) -> Velocity {
    let linear_mps = script.extreme(0.0, limits.speed_mps);
    let turn = script.extreme(-limits.angular_speed_radps, limits.angular_speed_radps);
    let most = limits
        .curvature_max_per_m
        .map_or(f64::INFINITY, |most| most * linear_mps);
    Velocity {
        linear_mps,
        angular_radps: turn.clamp(-most, most),
    }
}

fn goal(script: &mut Script<'_>) -> Goal {
    Goal {
        position: [script.between(-5.0, 5.0), script.between(-5.0, 5.0)],
        heading_rad: script.flag().then(|| script.between(-3.0, 3.0)),
        arrival: if script.flag() {
            Arrival::Stop
        } else {
            Arrival::Pass
        },
        position_tolerance_m: 0.15,
        heading_tolerance_rad: 0.1,
    }
}

fn obstacle(script: &mut Script<'_>) -> Obstacle {
    Obstacle {
        position: [script.between(-1.5, 3.0), script.between(-2.0, 2.0)],
        inflation_m: script.extreme(0.0, 0.02),
    }
}

/// What is not finite, or out of range, is not planned on.
fn unusual(
    script: &mut Script<'_>,
    situation: &Situation<'_>,
    points: &[Obstacle],
    planner: Planner,
) -> Result<(), String> {
    let mut odd = points.to_vec();
    odd.push(Obstacle {
        position: [script.any() - 9.0, f64::NAN],
        inflation_m: 0.0,
    });
    let answer = planner(situation, &odd);
    let refused = answer.outcome == Outcome::Malformed && answer.candidates().is_empty();
    demand(refused || odd[odd.len() - 1].position[0] < 0.0, || {
        format!("planned on what is not a number: {answer:?}")
    })?;
    let mut bad = *situation;
    bad.limits.braking_mps2 = -script.any().abs();
    let answer = planner(&bad, points);
    demand(answer.candidates().is_empty(), || {
        format!("planned without brakes: {answer:?}")
    })
}

fn check(situation: &Situation<'_>, points: &[Obstacle], answer: &Plan) -> Result<(), String> {
    let limits = &situation.limits;
    let moving = answer.outcome == Outcome::Moving;
    demand(moving != answer.candidates().is_empty(), || {
        format!("{answer:?}")
    })?;
    let window = DynamicWindow::new(limits, situation.velocity);
    // The second goes on as commanded, whatever its score.
    let mut others = answer.candidates().iter().skip(2);
    let first = answer.candidates().first().map_or(0.0, |first| first.score);
    demand(others.all(|other| other.score <= first), || {
        format!("not the best first: {answer:?}")
    })?;
    for candidate in answer.candidates() {
        let v = candidate.velocity;
        let steered = limits.curvature_max_per_m;
        // How fast steered wheels turn is the guard's business.
        let inside = window.is_some_and(|window| {
            window.linear.contains(v.linear_mps)
                && (steered.is_some() || window.angular.contains(v.angular_radps))
        });
        let bent = steered.is_none_or(|most| v.angular_radps.abs() <= most * v.linear_mps + 1e-6);
        demand(inside && bent && v.linear_mps >= 0.0, || {
            format!("{v:?} is out of {window:?}")
        })?;
        if let Some(point) = first_touched(situation, points, v) {
            return Err(format!("{v:?} touches {point:?} in {situation:?}"));
        }
    }
    Ok(())
}

/// The point that the bare outline touches while it drives on for the reaction time and brakes.
fn first_touched(
    situation: &Situation<'_>,
    points: &[Obstacle],
    velocity: Velocity,
) -> Option<Obstacle> {
    let foot = &situation.footprint;
    let outline = Outline {
        front_m: foot.front_m,
        rear_m: foot.rear_m,
        left_m: foot.left_m,
        right_m: foot.right_m,
    };
    let limits = &situation.limits;
    let (v, w) = (velocity.linear_mps, velocity.angular_radps);
    let braking_s = (v / limits.braking_mps2).max(w.abs() / limits.angular_braking_radps2);
    let lasts_s = limits.reaction_s + braking_s / 2.0;
    let steps = 200;
    (0..=steps).find_map(|step| {
        let share = lasts_s * f64::from(step) / f64::from(steps);
        let pose = Pose::default().along_arc(v * share, w * share);
        let touched = |point: &&Obstacle| outline.distance_m(pose.enter(point.position)) <= 0.0;
        points.iter().find(touched).copied()
    })
}
