//! The robot from above, to scale: outline, critical zone, scanners, what they watch.

use crate::picture::plot::number;
use crate::picture::view::{View, outline, round_step, transform};
use crate::picture::{Anchor, Picture, Style};
use haltline_robots::{Robot, Scanner};

const SIZE: [f64; 2] = [560.0, 380.0];

/// Plan view of the robot.
#[must_use]
pub fn plan(robot: &Robot) -> Picture {
    let body = &robot.values.footprint;
    let reach = (body.front_m + body.rear_m).max(body.left_m + body.right_m);
    let centre_x = (body.front_m - body.rear_m) / 2.0;
    let half = reach * 1.05;
    let aspect = SIZE[0] / SIZE[1];
    let view = View::fit(
        [centre_x - half * aspect, -half],
        [centre_x + half * aspect, half],
        [0.0, 0.0],
        SIZE,
    );
    let mut picture = Picture::new(SIZE[0], SIZE[1], format!("{} from above", robot.name));
    picture.rect([0.0, 0.0], SIZE, Style::Paper);
    for scanner in &robot.values.scanners {
        draw_watched(&mut picture, scanner, &view);
    }
    let zone = &robot.values.zone;
    let around = [
        body.front_m + zone.front_m,
        body.rear_m + zone.side_m,
        body.left_m + zone.side_m,
        body.right_m + zone.side_m,
    ];
    let origin = [0.0, 0.0, 0.0];
    picture.polygon(view.all(&outline(origin, around)), Style::Limit);
    let edges = [body.front_m, body.rear_m, body.left_m, body.right_m];
    picture.polygon(view.all(&outline(origin, edges)), Style::Footprint);
    let tip = view.at([body.front_m, 0.0]);
    let back = 12.0;
    picture.polygon(
        vec![
            tip,
            [tip[0] - back, tip[1] - back / 2.0],
            [tip[0] - back, tip[1] + back / 2.0],
        ],
        Style::StopMark,
    );
    let centre = view.at([0.0, 0.0]);
    picture.line(
        vec![[centre[0] - 7.0, centre[1]], [centre[0] + 7.0, centre[1]]],
        Style::Start,
    );
    picture.line(
        vec![[centre[0], centre[1] - 7.0], [centre[0], centre[1] + 7.0]],
        Style::Start,
    );
    for scanner in &robot.values.scanners {
        picture.circle(view.at([scanner.x_m, scanner.y_m]), 5.0, Style::Memory);
    }
    draw_words(&mut picture, robot, &view);
    picture
}

/// The watched sector, as far as the picture goes.
fn draw_watched(picture: &mut Picture, scanner: &Scanner, view: &View) {
    let steps = 48;
    let half = scanner.field_of_view_rad / 2.0;
    let radius = (view.max_m[0] - view.min_m[0]) * 0.36;
    let at = [scanner.x_m, scanner.y_m, scanner.yaw_rad];
    let mut corners = vec![[scanner.x_m, scanner.y_m]];
    corners.extend((0..=steps).map(|i| {
        let angle = -half + scanner.field_of_view_rad * f64::from(i) / f64::from(steps);
        transform(at, [radius * angle.cos(), radius * angle.sin()])
    }));
    picture.polygon(view.all(&corners), Style::KnownFree);
}

fn draw_words(picture: &mut Picture, robot: &Robot, view: &View) {
    let values = &robot.values;
    let text = format!(
        "{:.2} m x {:.2} m, top speed {} m/s",
        values.footprint.length_m(),
        values.footprint.width_m(),
        values.limits.speed_forward_mps
    );
    picture.text([14.0, 24.0], Anchor::Start, Style::LabelStrong, text);
    let mut y = SIZE[1] - 46.0;
    for scanner in &values.scanners {
        let text = format!(
            "{}: {} beams over {:.0} deg, to {} m",
            scanner.name,
            scanner.beams,
            scanner.field_of_view_rad.to_degrees(),
            scanner.range_max_m
        );
        picture.text([14.0, y], Anchor::Start, Style::Label, text);
        y -= 15.0;
    }
    let note =
        "blue: footprint · red dashes: critical zone · green: watched · cross: rotation centre";
    picture.text([14.0, SIZE[1] - 30.0], Anchor::Start, Style::Label, note);
    let bar = round_step(view.max_m[0] - view.min_m[0], 8.0);
    let (x, y) = (14.0, SIZE[1] - 10.0);
    let right = x + bar * view.scale;
    picture.line(
        vec![[x, y - 5.0], [x, y], [right, y], [right, y - 5.0]],
        Style::Start,
    );
    let text = format!("{} m", number(bar, bar));
    picture.text([x + 4.0, y - 4.0], Anchor::Start, Style::Label, text);
}
