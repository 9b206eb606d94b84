//! Distances between rectangles, discs and segments by hand: corners, edges and signs, no library.
//!
//! A second opinion on what `parry2d` says about contacts, in [`crate::plane`] and in the simulator's judge.

/// A point, metres.
pub type Point = [f64; 2];

/// The four corners of a rectangle around `centre` (m) with heading `theta_rad`, in order around it.
#[must_use]
pub fn corners(centre: Point, theta_rad: f64, half: Point) -> [Point; 4] {
    let (sin, cos) = theta_rad.sin_cos();
    [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[sx, sy]| {
        let (x, y) = (sx * half[0], sy * half[1]);
        [centre[0] + cos * x - sin * y, centre[1] + sin * x + cos * y]
    })
}

/// Distance of a point from a segment, metres.
#[must_use]
pub fn point_to_segment(point: Point, a: Point, b: Point) -> f64 {
    let (way, off) = (minus(b, a), minus(point, a));
    let length = dot(way, way);
    let share = if length > 0.0 {
        (dot(off, way) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let foot = [a[0] + share * way[0], a[1] + share * way[1]];
    let apart = minus(point, foot);
    apart[0].hypot(apart[1])
}

/// Distance between two segments, metres; 0 if they cross or touch.
#[must_use]
pub fn segment_to_segment([a, b]: [Point; 2], [c, d]: [Point; 2]) -> f64 {
    let side = |from: Point, to: Point, point: Point| cross(minus(to, from), minus(point, from));
    let apart = |one: f64, two: f64| (one > 0.0 && two > 0.0) || (one < 0.0 && two < 0.0);
    let crosses = !apart(side(a, b, c), side(a, b, d)) && !apart(side(c, d, a), side(c, d, b));
    let ends = point_to_segment(a, c, d)
        .min(point_to_segment(b, c, d))
        .min(point_to_segment(c, a, b))
        .min(point_to_segment(d, a, b));
    // Signs of collinear segments are all zero; their ends decide.
    let parallel = cross(minus(b, a), minus(d, c)).abs() <= f64::MIN_POSITIVE;
    if crosses && !parallel { 0.0 } else { ends }
}

/// Distance of a point from a convex outline given by its corners in order, metres; 0 inside.
#[must_use]
pub fn point_to_outline(point: Point, outline: &[Point; 4]) -> f64 {
    if contains(outline, point) {
        return 0.0;
    }
    edges(outline)
        .map(|[a, b]| point_to_segment(point, a, b))
        .fold(f64::INFINITY, f64::min)
}

/// Distance of a segment from a convex outline, metres; 0 if they meet.
#[must_use]
pub fn segment_to_outline(segment: [Point; 2], outline: &[Point; 4]) -> f64 {
    if contains(outline, segment[0]) {
        return 0.0;
    }
    edges(outline)
        .map(|edge| segment_to_segment(segment, edge))
        .fold(f64::INFINITY, f64::min)
}

/// Distance between two convex outlines, metres; 0 if they meet, also if one holds the other.
#[must_use]
pub fn outline_to_outline(one: &[Point; 4], two: &[Point; 4]) -> f64 {
    if contains(one, two[0]) || contains(two, one[0]) {
        return 0.0;
    }
    edges(one)
        .map(|edge| segment_to_outline(edge, two))
        .fold(f64::INFINITY, f64::min)
}

/// Whether a point lies inside or on a convex outline of either sense.
#[must_use]
pub fn contains(outline: &[Point; 4], point: Point) -> bool {
    let sides = edges(outline).map(|[a, b]| cross(minus(b, a), minus(point, a)));
    let (mut left, mut right) = (false, false);
    for side in sides {
        left |= side > 0.0;
        right |= side < 0.0;
    }
    !(left && right)
}

fn edges(outline: &[Point; 4]) -> impl Iterator<Item = [Point; 2]> + use<'_> {
    (0..4).map(|index| [outline[index], outline[(index + 1) % 4]])
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
