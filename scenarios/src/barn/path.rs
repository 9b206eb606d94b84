//! The published path: its length, how clear it keeps, and the points that are enough to follow it.

use super::{CYLINDER_RADIUS_M, GOAL_M, START, World};

/// A straight line may keep this much less clear than the piece of path it replaces, metres.
const LOST_M: f64 = 0.01;
/// Clearances from here on count as equal: the robot has room, metres.
const AMPLE_M: f64 = 0.5;
/// No via point is farther from the one before, so that the path keeps its shape, metres.
const APART_MAX_M: f64 = 1.5;

pub(super) fn length_m(points: impl Iterator<Item = [f64; 2]>) -> f64 {
    let mut before: Option<[f64; 2]> = None;
    points.fold(0.0, |sum, point| {
        let step = before.map_or(0.0, |[x, y]| libm::hypot(point[0] - x, point[1] - y));
        before = Some(point);
        sum + step
    })
}

/// Distance from the line between two points to the surface of the nearest cylinder, metres.
pub(super) fn clearance_m(world: &World, from: [f64; 2], to: [f64; 2]) -> f64 {
    let away = |centre: &[f64; 2]| distance_m(*centre, from, to) - CYLINDER_RADIUS_M;
    world
        .cylinders_m
        .iter()
        .map(away)
        .fold(f64::INFINITY, f64::min)
}

fn distance_m(point: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let off = [point[0] - from[0], point[1] - from[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let part = if square > 0.0 {
        ((off[0] * along[0] + off[1] * along[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    libm::hypot(off[0] - part * along[0], off[1] - part * along[1])
}

/// From each point the farthest one that a straight line reaches as clear as the path does.
pub(super) fn thinned(world: &World) -> Vec<[f64; 2]> {
    let [x, y, _] = START;
    let mut way = vec![[x, y]];
    way.extend(world.path_m.iter().copied());
    way.push(GOAL_M);
    way.dedup();
    let mut kept = Vec::new();
    let mut from = 0;
    while from + 1 < way.len() {
        let reachable = |to: &usize| is_as_clear(world, way.get(from..=*to).unwrap_or_default());
        let to = (from + 2..way.len())
            .rev()
            .find(reachable)
            .unwrap_or(from + 1);
        kept.extend(way.get(to).copied().filter(|_| to + 1 < way.len()));
        from = to;
    }
    kept
}

/// Whether the straight line keeps as clear as the pieces it replaces.
fn is_as_clear(world: &World, piece: &[[f64; 2]]) -> bool {
    let (Some(first), Some(last)) = (piece.first(), piece.last()) else {
        return false;
    };
    let pairs = piece
        .windows(2)
        .filter_map(|pair| <[[f64; 2]; 2]>::try_from(pair).ok());
    let own = pairs
        .map(|[from, to]| clearance_m(world, from, to))
        .fold(AMPLE_M, f64::min);
    let apart = libm::hypot(last[0] - first[0], last[1] - first[1]);
    apart <= APART_MAX_M && clearance_m(world, *first, *last) >= own - LOST_M
}
