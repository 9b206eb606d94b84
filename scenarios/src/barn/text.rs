//! A world as the text of a scenario file, with its sources in comments.

use core::fmt::Write as _;

use super::{
    CYLINDER_RADIUS_M, GOAL_M, GOAL_RADIUS_M, NOISE_SIGMA_M, Options, START, TIMEOUT_S, World, path,
};

/// Half the Jackal's width: where the straight way is narrower, a reckless driver must touch, metres.
const HALF_WIDTH_M: f64 = 0.165;

pub(super) fn scenario(world: &World, options: &Options) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = head(&mut out, world, options).and_then(|()| bodies(&mut out, world));
    out
}

fn head(out: &mut String, world: &World, options: &Options) -> core::fmt::Result {
    let [x, y, heading_rad] = START;
    let [goal_x, goal_y] = GOAL_M;
    let systematic_m = (options.sensor_bound_m - 3.0 * NOISE_SIGMA_M).max(0.0);
    writeln!(
        out,
        "# World {name} of the BARN benchmark (Perille et al. 2020): start, goal, time limit and robot are
# the benchmark's; the via points are its published reference path, thinned where a straight line
# keeps as clear of the cylinders.
title = \"BARN {name}\"
requirements = [\"GUARD-01\", \"GUARD-11\"]
robot = \"jackal\"
obstacle_speed_mps = 0.0
seed = {seed}
timeout_s = {TIMEOUT_S:.1}

[robot_values]
\"scanner.0.error_systematic_m\" = {systematic_m:.4}  # with three sigma the bound of {bound} m
\"scanner.0.error_sigma_m\" = {NOISE_SIGMA_M:.4}
\"scanner.0.no_return_clear_m\" = 30.0     # cylinders return every beam, and nothing else is there
\"tolerances.tracking_m\" = 0.010
\"tolerances.angular_speed_radps\" = 0.02

[sensor]
noise_sigma_m = {NOISE_SIGMA_M:.4}
bias_m = 0.0                           # the benchmark's lidar has noise and no bias

[start]
x_m = {x:.1}
y_m = {y:.1}
heading_deg = {heading_deg:.4}                # {heading_rad} rad

[goal]
position_m = [{goal_x:.1}, {goal_y:.1}]
radius_m = {GOAL_RADIUS_M:.1}

[proposer]
kind = \"navigate\"
via_m = [",
        name = world.name,
        seed = seed(&world.name),
        bound = options.sensor_bound_m,
        heading_deg = heading_rad.to_degrees(),
    )?;
    for [x, y] in world.via_m() {
        writeln!(out, "  [{x:.4}, {y:.4}],")?;
    }
    writeln!(out, "]\n\n[proposer.navigate]\nvia_tolerance_m = 0.25\n")?;
    writeln!(out, "[expect]\nreached = true\n\n[naked]")?;
    if path::clearance_m(world, [x, y], GOAL_M) < HALF_WIDTH_M - 0.005 {
        writeln!(out, "path = \"goal\"")
    } else {
        writeln!(
            out,
            "must_touch = false\nreason = \"nothing stands on the straight line from start to goal\""
        )
    }
}

fn bodies(out: &mut String, world: &World) -> core::fmt::Result {
    for [x, y] in &world.cylinders_m {
        writeln!(
            out,
            "\n[[circle]]\ncenter_m = [{x:.4}, {y:.4}]\nradius_m = {CYLINDER_RADIUS_M}"
        )?;
    }
    Ok(())
}

/// The digits of the name, so that each world has its own noise and always the same.
fn seed(name: &str) -> u64 {
    let digits: String = name.chars().filter(char::is_ascii_digit).collect();
    digits
        .parse()
        .map_or(1, |number: u64| number % 1_000_000_007)
}
