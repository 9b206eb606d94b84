//! What moves when the reader clicks on a drawing: the robot, its naked twin, the moving bodies.

use super::drawing::{Subject, body_outline, pose, shape_outline};
use crate::picture::view::{Pose, View};
use crate::picture::{Picture, Style};
use haltline_scenarios::result::{BodyRecord, CaseResult, RunResult, ShapeRecord};

/// How much faster than life a drawing plays.
const SPEED_UP: f64 = 3.0;
/// At most this many frames are kept; between them the motion is linear.
const FRAMES_MAX: usize = 48;

/// Adds all actors of a drawing.
pub fn add(
    picture: &mut Picture,
    case: &CaseResult,
    subject: Subject,
    run: &RunResult,
    view: &View,
) {
    let body = |style: Style, run: &RunResult, picture: &mut Picture, end_s: f64| {
        let timed: Vec<(f64, Pose)> = run
            .samples
            .iter()
            .filter(|sample| sample.t_s <= end_s)
            .map(|sample| (sample.t_s, pose(&sample.pose)))
            .collect();
        let outline = local(&body_outline(&case.footprint, [0.0; 3]), view);
        picture.actor(outline, frames(&timed, view), style);
    };
    for moving in run.world.bodies.iter().filter(|body| body.poses.len() > 1) {
        add_body(picture, moving, run.time_s, view);
    }
    if let Some(naked) = case.naked.as_ref().filter(|_| subject == Subject::Guarded) {
        let end_s = naked
            .contacts
            .first()
            .map_or(f64::INFINITY, |contact| contact.t_s);
        body(Style::NakedBody, naked, picture, end_s);
    }
    body(Style::Actor, run, picture, f64::INFINITY);
}

fn add_body(picture: &mut Picture, body: &BodyRecord, end_s: f64, view: &View) {
    let timed: Vec<(f64, Pose)> = body
        .poses
        .iter()
        .filter(|at| at.t_s <= end_s)
        .map(|at| (at.t_s, pose(&at.pose)))
        .collect();
    let outline = match &body.shape {
        ShapeRecord::Circle { radius_m } => (0..16)
            .map(|i| {
                let angle = f64::from(i) * std::f64::consts::PI / 8.0;
                [radius_m * angle.cos(), radius_m * angle.sin()]
            })
            .collect(),
        shape => shape_outline(shape, [0.0; 3]),
    };
    picture.actor(local(&outline, view), frames(&timed, view), Style::Moving);
}

/// Metres around an origin to pixels around it; y points down on paper.
fn local(outline: &[[f64; 2]], view: &View) -> Vec<[f64; 2]> {
    outline
        .iter()
        .map(|[x, y]| [x * view.scale, -y * view.scale])
        .collect()
}

fn frames(timed: &[(f64, Pose)], view: &View) -> Vec<[f64; 4]> {
    let Some(last) = timed.len().checked_sub(1) else {
        return Vec::new();
    };
    let step = timed.len().div_ceil(FRAMES_MAX).max(1);
    let mut heading = timed[0].1[2];
    let mut before = heading;
    let mut frames = Vec::new();
    for (index, (t_s, at)) in timed.iter().enumerate() {
        // Headings jump by a whole turn at the edge of their range; the drawing must not spin.
        let turn = at[2] - before;
        heading += turn - std::f64::consts::TAU * (turn / std::f64::consts::TAU).round();
        before = at[2];
        if index % step == 0 || index == last {
            let [x, y] = view.at([at[0], at[1]]);
            frames.push([t_s / SPEED_UP, x, y, -heading.to_degrees()]);
        }
    }
    frames
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_that_wraps_does_not_spin() {
        let view = View::fit([0.0, 0.0], [10.0, 10.0], [0.0, 0.0], [100.0, 100.0]);
        let timed = [(0.0, [1.0, 1.0, 3.1]), (3.0, [1.0, 1.0, -3.1])];
        let found = frames(&timed, &view);
        assert!((found[0][3] - found[1][3]).abs() < 10.0, "{found:?}");
        assert!((found[1][0] - 1.0).abs() < 1e-12);
    }
}
