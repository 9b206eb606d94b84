//! What the robot did: swept footprints, path by verdict, start, end, stops, contacts.

use super::{WIDTH, body_outline, pose};
use crate::picture::view::{Pose, View, transform};
use crate::picture::{Anchor, Picture, Style, simplify};
use crate::report::words;
use haltline_scenarios::result::{FootprintRecord, RunResult, Stop};

/// Footprints so close together that their union is the swept area to the eye.
pub(super) fn draw_swept(
    picture: &mut Picture,
    run: &RunResult,
    footprint: &FootprintRecord,
    view: &View,
) {
    let step_m = (footprint.front_m + footprint.rear_m) / 4.0;
    let mut last: Option<Pose> = None;
    for sample in &run.samples {
        let at = pose(&sample.pose);
        let far = last.is_none_or(|from| {
            (at[0] - from[0]).hypot(at[1] - from[1]) > step_m || (at[2] - from[2]).abs() > 0.3
        });
        if far {
            picture.polygon(view.all(&body_outline(footprint, at)), Style::Swept);
            last = Some(at);
        }
    }
}

/// The path, cut where the decision changes.
pub(super) fn draw_path(picture: &mut Picture, run: &RunResult, view: &View) {
    let mut part: Vec<[f64; 2]> = Vec::new();
    let mut style = Style::PathPass;
    let mut changes = run.decisions.iter().peekable();
    for sample in &run.samples {
        let at = view.at([sample.pose.x_m, sample.pose.y_m]);
        let mut next = style;
        while let Some(change) = changes.next_if(|change| change.t_s <= sample.t_s) {
            next = words::path_style(&change.decision);
        }
        part.push(at);
        if next != style {
            picture.line(simplify(&part, 0.3), style);
            part = vec![at];
            style = next;
        }
    }
    picture.line(simplify(&part, 0.3), style);
}

/// Where the robot started, where it ended, and where it came to rest.
pub(super) fn draw_ends(
    picture: &mut Picture,
    run: &RunResult,
    footprint: &FootprintRecord,
    view: &View,
) {
    let ends = [
        (run.samples.first(), Style::Start),
        (run.samples.last(), Style::Footprint),
    ];
    for (sample, style) in ends {
        let Some(sample) = sample else { continue };
        let at = pose(&sample.pose);
        picture.polygon(view.all(&body_outline(footprint, at)), style);
        let nose = transform(at, [footprint.front_m * 0.8, 0.0]);
        let tip = transform(at, [footprint.front_m, 0.0]);
        picture.line(view.all(&[nose, tip]), style);
    }
    for (_, stop) in places(&run.stops) {
        let corners = body_outline(footprint, pose(&stop.pose));
        picture.polygon(view.all(&corners), Style::FootprintStop);
    }
}

/// Stops at different places with their numbers; later ones at the same place are left out.
fn places(stops: &[Stop]) -> Vec<(usize, &Stop)> {
    let mut places: Vec<(usize, &Stop)> = Vec::new();
    for (index, stop) in stops.iter().enumerate() {
        let known = places.iter().any(|(_, known)| {
            (known.pose.x_m - stop.pose.x_m).hypot(known.pose.y_m - stop.pose.y_m) < 0.25
                && (known.pose.theta_rad - stop.pose.theta_rad).abs() < 0.35
        });
        if !known {
            places.push((index + 1, stop));
        }
    }
    places
}

/// A number at each place of rest, and why.
pub(super) fn draw_stops(
    picture: &mut Picture,
    run: &RunResult,
    footprint: &FootprintRecord,
    view: &View,
) {
    for (count, (number, stop)) in places(&run.stops).into_iter().enumerate() {
        let [x, y] = view.at([stop.pose.x_m, stop.pose.y_m]);
        picture.circle([x, y], 8.0, Style::StopMark);
        picture.text(
            [x, y + 4.0],
            Anchor::Middle,
            Style::MarkText,
            number.to_string(),
        );
        if count < 3 {
            let text = format!("{} at {:.1} s", words::why_stopped(run, stop), stop.t_s);
            // By turns above and below the footprint, inside the picture.
            let corners = view.all(&body_outline(footprint, pose(&stop.pose)));
            let heights = corners.iter().map(|corner| corner[1]);
            let line = if count % 2 == 0 {
                heights.fold(y, f64::min) - 6.0
            } else {
                heights.fold(y, f64::max) + 14.0
            };
            let half = 3.0 * text.chars().count() as f64;
            let at = [x.clamp(half, WIDTH - half), line.max(12.0)];
            picture.text(at, Anchor::Middle, Style::Label, text);
        }
    }
}

/// A contact.
pub(super) fn draw_cross(picture: &mut Picture, [x, y]: [f64; 2], style: Style) {
    picture.circle([x, y], 6.5, style);
    picture.line(vec![[x - 3.5, y - 3.5], [x + 3.5, y + 3.5]], style);
    picture.line(vec![[x - 3.5, y + 3.5], [x + 3.5, y - 3.5]], style);
}

/// The contacts of the subject: whether it moved decides whether the claim is at stake.
pub(super) fn draw_contacts(picture: &mut Picture, run: &RunResult, view: &View) {
    for contact in &run.contacts {
        let style = match (run.guarded, contact.robot_moving) {
            (false, _) => Style::Contact,
            (true, true) => Style::ContactMoving,
            (true, false) => Style::ContactResting,
        };
        let at = view.at([contact.pose.x_m, contact.pose.y_m]);
        draw_cross(picture, at, style);
    }
}
