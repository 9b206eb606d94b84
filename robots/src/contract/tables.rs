//! Top speed and smallest passable gap for an obstacle speed, term by term.

use super::tubes::{Reserve, Term, Tubes};
use super::{GapRow, SpeedRow};
use crate::Robot;

/// Speeds are tried in steps of this, m/s.
const STEP_MPS: f64 = 0.01;

/// Slower than this is not driving, m/s.
const CREEP_MPS: f64 = 0.05;

/// The slowest drive looked at, m/s: within the speed tolerance the guard cannot tell driving
/// from turning on the spot.
pub(super) fn slowest_mps(robot: &Robot) -> f64 {
    CREEP_MPS.max(robot.values.tolerances.speed_mps + STEP_MPS)
}

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

/// How far ahead of the front edge the kernel's memory can hold space as free, metres.
pub(super) fn space_ahead_m(robot: &Robot) -> f64 {
    let v = &robot.values;
    let cover = f64::from(haltline::guard::seen::COVER_MM) / 1000.0;
    // A scanner's rays are believed up to the window less the distance of its mounting.
    let reach = v
        .scanners
        .iter()
        .map(|s| cover - s.x_m.abs() - s.y_m.abs() + s.x_m);
    reach.fold(0.0, f64::max).min(cover) - v.footprint.front_m
}

/// What stands against a reserve: nothing, what is known of bodies, or of free space.
pub(super) fn obstructs(robot: &Robot, reserve: &Reserve) -> Option<&'static str> {
    let (known, bound) = known_ahead(robot);
    if sum(&reserve.reach()) > known {
        Some(bound)
    } else if reserve.into_space_m() > space_ahead_m(robot) {
        Some(MEMORY_WINDOW)
    } else {
        None
    }
}

/// Name of the bound that the kernel's window of known space sets.
const MEMORY_WINDOW: &str = "window of known space";
/// Name of the bound that the guard's largest tube sets.
const LARGEST_TUBE: &str = "largest tube the guard checks";

/// Speeds worth driving: the file's limit, then whole steps down to the slowest.
fn speeds(robot: &Robot) -> impl Iterator<Item = f64> {
    let (limit, slowest) = (robot.values.limits.speed_forward_mps, slowest_mps(robot));
    let steps = (limit / STEP_MPS).ceil() as u32;
    let below = (1..steps).rev().map(|step| f64::from(step) * STEP_MPS);
    let below = below.take_while(move |speed| *speed >= slowest);
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

/// The fastest straight drive for which enough is known.
struct TopSpeed {
    speed_mps: f64,
    reserve: Reserve,
    /// What stands against anything faster, unless the file's limit does.
    above: Option<&'static str>,
}

fn top_speed(robot: &Robot, tubes: &dyn Tubes) -> Result<TopSpeed, &'static str> {
    let mut above = None;
    for speed_mps in speeds(robot) {
        let Some(reserve) = tubes.straight(robot, speed_mps) else {
            above = Some(LARGEST_TUBE);
            continue;
        };
        match obstructs(robot, &reserve) {
            None => {
                return Ok(TopSpeed {
                    speed_mps,
                    reserve,
                    above,
                });
            }
            obstacle => above = obstacle,
        }
    }
    Err(above.unwrap_or(LARGEST_TUBE))
}

/// The row of the speed table for one obstacle speed.
pub(super) fn speed_row(robot: &Robot, tubes: &dyn Tubes, obstacle_speed_mps: f64) -> SpeedRow {
    let (known_m, bound) = known_ahead(robot);
    let mut row = SpeedRow {
        obstacle_speed_mps,
        top_speed_mps: 0.0,
        limited_by_file: false,
        terms: Vec::new(),
        reach_m: 0.0,
        known_m,
        space_m: space_ahead_m(robot),
        decides: bound,
        sentence: String::new(),
    };
    let found = match robot.with_obstacle_speed(obstacle_speed_mps) {
        Some(robot) => top_speed(&robot, tubes),
        None => Err(bound),
    };
    let top = match found {
        Ok(top) => top,
        Err(obstacle) => {
            row.decides = obstacle;
            row.sentence = format!(
                "With bodies of up to {obstacle_speed_mps} m/s the robot may not drive at all, however \
                 slowly ({obstacle}); it knows {known_m:.2} m ahead."
            );
            return row;
        }
    };
    row.terms = top.reserve.reach();
    row.reach_m = sum(&row.terms);
    row.top_speed_mps = top.speed_mps;
    row.limited_by_file = top.above.is_none();
    row.decides = match top.above {
        None => "limit of the file",
        Some(LARGEST_TUBE) => LARGEST_TUBE,
        Some(MEMORY_WINDOW) => MEMORY_WINDOW,
        Some(_) => largest(&row.terms),
    };
    row.sentence = format!(
        "With bodies of up to {obstacle_speed_mps} m/s the robot may drive {:.2} m/s: it needs {:.2} m \
         of the {known_m:.2} m it knows ahead ({bound}); what decides: {}.",
        row.top_speed_mps, row.reach_m, row.decides
    );
    row
}

/// The row of the gap table for the obstacle speed of `row`.
pub(super) fn gap_row(robot: &Robot, tubes: &dyn Tubes, row: &SpeedRow) -> GapRow {
    let width_m = robot.values.footprint.width_m();
    let obstacle_speed_mps = row.obstacle_speed_mps;
    let gap = |reserve: &Reserve| width_m + 2.0 * reserve.inflation_m();
    let with_obstacles = robot.with_obstacle_speed(obstacle_speed_mps);
    let narrowest = with_obstacles.as_ref().and_then(|robot| {
        let slow = speeds(robot).filter(|v| *v <= row.top_speed_mps);
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
