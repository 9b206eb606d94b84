//! Top speed and smallest passable gap for an obstacle speed, term by term.

use super::tubes::{Reserve, Term, Tubes};
use super::{GapRow, SpeedRow};
use crate::Robot;

/// Speeds are tried in steps of this, m/s.
const STEP_MPS: f64 = 0.01;

/// Slower than this is not driving: the narrowest gap is looked for from here up, m/s.
pub(super) const CREEP_MPS: f64 = 0.05;

/// How far ahead of the front edge bodies of the least width are known, metres; with what bounds it.
///
/// A body narrower than the distance between two beams may stand between them, so beyond
/// `body_width_min / beam angle` nothing is known even within the scanner's range.
pub(super) fn known_ahead(robot: &Robot) -> (f64, &'static str) {
    let v = &robot.values;
    let width = v.memory.body_width_min_m;
    let mut best = (0.0, "no scanner looks ahead");
    for scanner in &v.scanners {
        let ahead = v.footprint.front_m.max(scanner.x_m + scanner.range_min_m) + 0.01;
        if !scanner.sees(ahead, scanner.y_m) {
            continue;
        }
        let between_beams = width / scanner.beam_angle_rad();
        let (range, name) = if between_beams < scanner.range_max_m {
            (between_beams, "beam spacing")
        } else {
            (scanner.range_max_m, "scanner range")
        };
        let known = scanner.x_m + range - v.footprint.front_m;
        if known > best.0 {
            best = (known, name);
        }
    }
    best
}

/// Speeds up to the file's limit: the limit itself, then whole steps downwards.
fn speeds(robot: &Robot) -> impl Iterator<Item = f64> {
    let limit = robot.values.limits.speed_forward_mps;
    let steps = (limit / STEP_MPS).ceil() as u32;
    let below = (1..steps).rev().map(|step| f64::from(step) * STEP_MPS);
    std::iter::once(limit).chain(below)
}

/// Sum of the terms, metres.
fn sum(terms: &[Term]) -> f64 {
    terms.iter().map(|term| term.value_m).sum()
}

/// Name of the largest term.
fn largest(terms: &[Term]) -> &'static str {
    let order = |a: &&Term, b: &&Term| a.value_m.total_cmp(&b.value_m);
    terms.iter().max_by(order).map_or("", |term| term.name)
}

/// The fastest straight drive whose reach is known.
struct TopSpeed {
    speed_mps: f64,
    reserve: Reserve,
    /// The guard refuses to look at anything faster, whatever is known.
    refused_above: bool,
}

fn top_speed(robot: &Robot, tubes: &dyn Tubes) -> Option<TopSpeed> {
    let (known, _) = known_ahead(robot);
    let mut refused_above = false;
    for speed_mps in speeds(robot) {
        match tubes.straight(robot, speed_mps) {
            Some(reserve) if sum(&reserve.reach()) <= known => {
                return Some(TopSpeed {
                    speed_mps,
                    reserve,
                    refused_above,
                });
            }
            reserve => refused_above = reserve.is_none(),
        }
    }
    None
}

/// The row of the speed table for one obstacle speed.
pub(super) fn speed_row(robot: &Robot, tubes: &dyn Tubes, obstacle_speed_mps: f64) -> SpeedRow {
    let limit = robot.values.limits.speed_forward_mps;
    let (known_m, bound) = known_ahead(robot);
    let with_obstacles = robot.with_obstacle_speed(obstacle_speed_mps);
    let found = with_obstacles.and_then(|robot| top_speed(&robot, tubes));
    let Some(top) = found else {
        return SpeedRow {
            obstacle_speed_mps,
            top_speed_mps: 0.0,
            limited_by_file: false,
            terms: Vec::new(),
            reach_m: 0.0,
            known_m,
            decides: bound,
            sentence: format!(
                "With bodies of up to {obstacle_speed_mps} m/s the robot may not drive at all: even \
                 creeping needs more than the {known_m:.2} m it knows ahead ({bound})."
            ),
        };
    };
    let terms = top.reserve.reach();
    let limited_by_file = top.speed_mps >= limit;
    let decides = if limited_by_file {
        "limit of the file"
    } else if top.refused_above {
        "largest tube the guard checks"
    } else {
        largest(&terms)
    };
    let reach_m = sum(&terms);
    SpeedRow {
        obstacle_speed_mps,
        top_speed_mps: top.speed_mps,
        limited_by_file,
        terms,
        reach_m,
        known_m,
        decides,
        sentence: format!(
            "With bodies of up to {obstacle_speed_mps} m/s the robot may drive {:.2} m/s: it needs \
             {reach_m:.2} m of the {known_m:.2} m it knows ahead ({bound}); what decides: {decides}.",
            top.speed_mps
        ),
    }
}

/// The row of the gap table for the obstacle speed of `row`.
pub(super) fn gap_row(robot: &Robot, tubes: &dyn Tubes, row: &SpeedRow) -> GapRow {
    let width_m = robot.values.footprint.width_m();
    let obstacle_speed_mps = row.obstacle_speed_mps;
    let gap = |reserve: &Reserve| width_m + 2.0 * reserve.inflation_m();
    let with_obstacles = robot.with_obstacle_speed(obstacle_speed_mps);
    let narrowest = with_obstacles.as_ref().and_then(|robot| {
        let slow = speeds(robot).filter(|v| (CREEP_MPS..=row.top_speed_mps).contains(v));
        let reserves = slow.filter_map(|v| Some((v, tubes.straight(robot, v)?)));
        reserves.min_by(|a, b| gap(&a.1).total_cmp(&gap(&b.1)))
    });
    let at_top = with_obstacles
        .filter(|_| row.top_speed_mps > 0.0)
        .and_then(|robot| tubes.straight(&robot, row.top_speed_mps));
    let Some((at_speed_mps, reserve)) = narrowest else {
        return GapRow {
            obstacle_speed_mps,
            gap_m: None,
            at_speed_mps: 0.0,
            gap_at_top_speed_m: at_top.as_ref().map(gap),
            width_m,
            terms: Vec::new(),
            decides: row.decides,
            sentence: format!(
                "With bodies of up to {obstacle_speed_mps} m/s the robot passes no gap."
            ),
        };
    };
    let decides = largest(&reserve.inflation);
    GapRow {
        obstacle_speed_mps,
        gap_m: Some(gap(&reserve)),
        at_speed_mps,
        gap_at_top_speed_m: at_top.as_ref().map(gap),
        width_m,
        decides,
        sentence: format!(
            "With bodies of up to {obstacle_speed_mps} m/s the robot ({width_m:.2} m wide) passes a \
             straight gap of {:.2} m at {at_speed_mps:.2} m/s; the largest term is {decides}.",
            gap(&reserve)
        ),
        terms: reserve.inflation,
    }
}
