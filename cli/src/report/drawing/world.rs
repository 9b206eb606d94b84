//! What was around the robot: grid, scale, goal, bodies, and the naked twin.

use super::course::draw_cross;
use super::{body_outline, pose, until_contact};
use crate::picture::plot;
use crate::picture::view::{Pose, View, outline, round_step, transform};
use crate::picture::{Anchor, Picture, Style, simplify};
use haltline_scenarios::result::{BodyRecord, FootprintRecord, RunResult, ShapeRecord};

/// Lines a metre apart, or as many metres as keep the paper readable.
pub(super) fn draw_grid(picture: &mut Picture, view: &View) {
    let step = round_step(view.max_m[0] - view.min_m[0], 14.0).max(1.0);
    for axis in 0..2 {
        let mut at = (view.min_m[axis] / step).ceil() * step;
        while at <= view.max_m[axis] {
            let (mut from, mut to) = (view.min_m, view.max_m);
            (from[axis], to[axis]) = (at, at);
            picture.line(view.all(&[from, to]), Style::Grid);
            at += step;
        }
    }
}

/// A bar of a round length.
pub(super) fn draw_scale(picture: &mut Picture, view: &View) {
    let [_, height] = view.size();
    let bar = round_step(view.max_m[0] - view.min_m[0], 8.0);
    let (x, y) = (10.0, height - 10.0);
    let right = x + bar * view.scale;
    picture.line(
        vec![[x, y - 5.0], [x, y], [right, y], [right, y - 5.0]],
        Style::Start,
    );
    let text = format!("{} m", plot::number(bar, bar));
    picture.text([x + 4.0, y - 4.0], Anchor::Start, Style::Label, text);
}

/// How large a via point is drawn, pixels.
const VIA_RADIUS_PX: f64 = 3.0;

/// Where the robot wanted to go, and what it should pass on the way.
pub(super) fn draw_goal(picture: &mut Picture, run: &RunResult, view: &View) {
    let Some(goal) = run.world.goal_m else { return };
    let radius = run.world.goal_radius_m.unwrap_or(0.1).max(0.05);
    picture.circle(view.at(goal), radius * view.scale, Style::Goal);
    for via in &run.world.via_m {
        picture.circle(view.at(*via), VIA_RADIUS_PX, Style::Goal);
    }
}

/// Corners of a body at a pose; none for a disc.
#[must_use]
pub fn shape_outline(shape: &ShapeRecord, at: Pose) -> Vec<[f64; 2]> {
    match shape {
        ShapeRecord::Segment { from_m, to_m } => {
            let (dx, dy) = (to_m[0] - from_m[0], to_m[1] - from_m[1]);
            let length = dx.hypot(dy).max(1e-9);
            // A line has no thickness; on paper it gets two centimetres.
            let n = [-dy / length * 0.01, dx / length * 0.01];
            [
                [from_m[0] + n[0], from_m[1] + n[1]],
                [to_m[0] + n[0], to_m[1] + n[1]],
                [to_m[0] - n[0], to_m[1] - n[1]],
                [from_m[0] - n[0], from_m[1] - n[1]],
            ]
            .iter()
            .map(|p| transform(at, *p))
            .collect()
        }
        ShapeRecord::Box { size_m } => outline(
            at,
            [
                size_m[0] / 2.0,
                size_m[0] / 2.0,
                size_m[1] / 2.0,
                size_m[1] / 2.0,
            ],
        ),
        ShapeRecord::Circle { .. } => Vec::new(),
    }
}

/// A body at a pose.
pub(super) fn draw_shape(
    picture: &mut Picture,
    shape: &ShapeRecord,
    at: Pose,
    view: &View,
    style: Style,
) {
    match shape {
        ShapeRecord::Circle { radius_m } => {
            // Poles of a few millimetres stay visible on paper.
            let radius = (radius_m * view.scale).max(1.6);
            picture.circle(view.at([at[0], at[1]]), radius, style);
        }
        _ => picture.polygon(view.all(&shape_outline(shape, at)), style),
    }
}

/// A body where it was at a time, with its trail if it moves.
pub(super) fn draw_body(picture: &mut Picture, body: &BodyRecord, when_s: f64, view: &View) {
    let moves = body.poses.len() > 1;
    let style = match (moves, body.invisible) {
        (_, true) => Style::Invisible,
        (true, false) => Style::Moving,
        (false, false) => Style::Wall,
    };
    let Some(at) = body
        .poses
        .iter()
        .take_while(|at| at.t_s <= when_s)
        .last()
        .or(body.poses.first())
    else {
        return;
    };
    if moves {
        let trail: Vec<_> = body
            .poses
            .iter()
            .map(|at| view.at([at.pose.x_m, at.pose.y_m]))
            .collect();
        picture.line(simplify(&trail, 0.4), Style::MovingTrail);
    }
    draw_shape(picture, &body.shape, pose(&at.pose), view, style);
}

/// The naked twin until it touches, and where it does.
pub(super) fn draw_naked(
    picture: &mut Picture,
    naked: &RunResult,
    footprint: &FootprintRecord,
    view: &View,
) {
    let path: Vec<_> = until_contact(naked)
        .map(|s| view.at([s.pose.x_m, s.pose.y_m]))
        .collect();
    picture.line(simplify(&path, 0.4), Style::PathNaked);
    if let Some(contact) = naked.contacts.first() {
        let at = pose(&contact.pose);
        picture.polygon(view.all(&body_outline(footprint, at)), Style::NakedBody);
        let body = naked.world.bodies.iter().find(|b| b.name == contact.body);
        if let Some(body) = body.filter(|body| body.poses.len() > 1)
            && let Some(then) = body.poses.iter().rfind(|at| at.t_s <= contact.t_s)
        {
            draw_shape(
                picture,
                &body.shape,
                pose(&then.pose),
                view,
                Style::NakedBody,
            );
        }
        draw_cross(picture, view.at([at[0], at[1]]), Style::Contact);
    }
}
