//! How much of an area around the robot no scanner looks at.

use crate::Robot;

/// A disc is looked at in about this many cells each way.
const CELLS: f64 = 100.0;

/// The critical zone is only centimetres wide and is looked at in cells of this size, metres.
const ZONE_CELL_M: f64 = 0.005;

/// Part of the disc of `radius_m` around the rotation centre, footprint left out, that no
/// scanner sees, 0 to 1.
pub(super) fn of_disc(robot: &Robot, radius_m: f64) -> f64 {
    let cell_m = 2.0 * radius_m / CELLS;
    share(robot, radius_m, cell_m, |x, y| x.hypot(y) <= radius_m)
}

/// Part of the critical zone that no scanner sees, 0 to 1.
pub(super) fn of_zone(robot: &Robot) -> f64 {
    let (f, zone) = (robot.values.footprint, robot.values.zone);
    let reach = f.radius_m() + zone.front_m.max(zone.side_m);
    share(robot, reach, ZONE_CELL_M, |x, y| {
        x <= f.front_m + zone.front_m
            && x >= -f.rear_m - zone.side_m
            && y <= f.left_m + zone.side_m
            && y >= -f.right_m - zone.side_m
    })
}

/// Looks at the middles of the cells of an area beside the footprint.
fn share(robot: &Robot, reach_m: f64, cell_m: f64, inside: impl Fn(f64, f64) -> bool) -> f64 {
    let f = robot.values.footprint;
    let steps = (reach_m / cell_m).ceil() as i32;
    let middle = |index: i32| (f64::from(index) + 0.5) * cell_m;
    let (mut total, mut blind) = (0_u32, 0_u32);
    for column in -steps..steps {
        for row in -steps..steps {
            let (x, y) = (middle(column), middle(row));
            let on_robot = x <= f.front_m && x >= -f.rear_m && y <= f.left_m && y >= -f.right_m;
            if on_robot || !inside(x, y) {
                continue;
            }
            total += 1;
            blind += u32::from(!robot.values.scanners.iter().any(|s| s.sees(x, y)));
        }
    }
    f64::from(blind) / f64::from(total.max(1))
}
