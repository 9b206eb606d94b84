//! How much of an area around the robot no scanner looks at.

use crate::Robot;

/// Areas are looked at in cells of this size, metres.
const CELL_M: f64 = 0.02;

/// An area around the robot and how much of it is out of view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct View {
    /// Part of the area that no scanner sees, 0 to 1.
    pub(super) blind: f64,
    /// Distance from the innermost blind place to the nearest place in view, metres.
    pub(super) depth_m: f64,
}

/// View of the disc of `radius_m` around the rotation centre without the footprint.
pub(super) fn of_disc(robot: &Robot, radius_m: f64) -> View {
    view(robot, radius_m, |x, y| x.hypot(y) <= radius_m)
}

/// View of the critical zone.
pub(super) fn of_zone(robot: &Robot) -> View {
    let (f, zone) = (robot.values.footprint, robot.values.zone);
    let reach = f.radius_m() + zone.front_m.max(zone.side_m);
    view(robot, reach, |x, y| {
        x <= f.front_m + zone.front_m
            && x >= -f.rear_m - zone.side_m
            && y <= f.left_m + zone.side_m
            && y >= -f.right_m - zone.side_m
    })
}

fn view(robot: &Robot, reach_m: f64, inside: impl Fn(f64, f64) -> bool) -> View {
    let f = robot.values.footprint;
    let steps = (reach_m / CELL_M).ceil() as i32;
    let (mut seen, mut blind) = (Vec::new(), Vec::new());
    for column in -steps..=steps {
        for row in -steps..=steps {
            let (x, y) = (f64::from(column) * CELL_M, f64::from(row) * CELL_M);
            let on_robot = x <= f.front_m && x >= -f.rear_m && y <= f.left_m && y >= -f.right_m;
            if on_robot || !inside(x, y) {
                continue;
            }
            let watched = robot.values.scanners.iter().any(|s| s.sees(x, y));
            if watched { &mut seen } else { &mut blind }.push((x, y));
        }
    }
    let total = seen.len() + blind.len();
    if total == 0 {
        return View::default();
    }
    let nearest = |(x, y): &(f64, f64)| {
        let distances = seen.iter().map(|(a, b)| (x - a).hypot(y - b));
        distances.fold(f64::INFINITY, f64::min)
    };
    View {
        blind: blind.len() as f64 / total as f64,
        depth_m: blind.iter().map(nearest).fold(0.0, f64::max),
    }
}
