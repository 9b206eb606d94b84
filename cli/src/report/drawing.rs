//! Draws a case: map, swept footprints, path by verdict, stops, the naked twin, and two curves over time.

use super::actors;
use super::claims::case_anchor as anchor;
use super::words;
use crate::picture::plot::{self, Plot};
use crate::picture::view::{Pose, View, bounds, outline, round_step, transform};
use crate::picture::{Anchor, Picture, Style, simplify};
use haltline_scenarios::result::{
    BodyRecord, CaseResult, FootprintRecord, PoseRecord, RunResult, Sample, ShapeRecord, Stop,
};

/// Width of a full drawing, pixels.
pub const WIDTH: f64 = 620.0;
const MAP_HEIGHT: f64 = 400.0;
const PLOT_HEIGHT: f64 = 116.0;
/// World shown beyond everything that moved, metres.
const MARGIN_M: f64 = 0.8;

/// Which of the two runs of a case is the subject of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The guarded run, with the naked twin behind it.
    Guarded,
    /// The naked twin alone.
    Naked,
}

/// Full drawing: map above, speed and clearance over time below. `None` if there is no such run.
#[must_use]
pub fn full(case: &CaseResult, subject: Subject) -> Option<Picture> {
    let run = subject_run(case, subject)?;
    let view = map_view(case, subject, [WIDTH, MAP_HEIGHT])?;
    let [_, map_height] = view.size();
    let title = format!("{}: {}", case.name, words::outcome(case));
    let mut picture = Picture::new(WIDTH, map_height + PLOT_HEIGHT + 8.0, title);
    picture.rect([0.0, 0.0], [WIDTH, picture.height], Style::Paper);
    picture.id = Some(format!("play-{}", anchor(&case.name)));
    draw_map(&mut picture, case, subject, run, &view, true);
    actors::add(&mut picture, case, subject, run, &view);
    let below = [0.0, map_height];
    let rest = [WIDTH, picture.height - map_height];
    picture.rect(below, rest, Style::Paper);
    draw_plots(&mut picture, run, map_height + 8.0);
    Some(picture)
}

/// Map alone in a small box, for sweeps.
#[must_use]
pub fn thumbnail(case: &CaseResult, size: [f64; 2]) -> Option<Picture> {
    let run = subject_run(case, Subject::Guarded)?;
    let mut view = map_view(case, Subject::Guarded, size)?;
    let [w, h] = view.size();
    view.origin = [(size[0] - w) / 2.0, (size[1] - h) / 2.0];
    let title = format!("{}: {}", case.name, words::outcome(case));
    let mut picture = Picture::new(size[0], size[1], title);
    picture.rect([0.0, 0.0], size, Style::Paper);
    draw_map(&mut picture, case, Subject::Guarded, run, &view, false);
    Some(picture)
}

fn subject_run(case: &CaseResult, subject: Subject) -> Option<&RunResult> {
    match subject {
        Subject::Guarded => Some(&case.guarded),
        Subject::Naked => case.naked.as_ref(),
    }
}

pub fn pose(record: &PoseRecord) -> Pose {
    [record.x_m, record.y_m, record.theta_rad]
}

pub fn body_outline(record: &FootprintRecord, at: Pose) -> Vec<[f64; 2]> {
    outline(
        at,
        [record.front_m, record.rear_m, record.left_m, record.right_m],
    )
}

/// The part of the world worth showing: wherever the robot was, the goal, whatever moved near it.
fn map_view(case: &CaseResult, subject: Subject, size: [f64; 2]) -> Option<View> {
    let run = subject_run(case, subject)?;
    let twin = case.naked.as_ref().filter(|_| subject == Subject::Guarded);
    let course = run
        .samples
        .iter()
        .chain(twin.into_iter().flat_map(until_contact))
        .flat_map(|sample| body_outline(&case.footprint, pose(&sample.pose)));
    let (low, high) = bounds(course.chain(run.world.goal_m))?;
    let near = |p: &[f64; 2]| (0..2).all(|i| p[i] > low[i] - 2.5 && p[i] < high[i] + 2.5);
    let movers = run
        .world
        .bodies
        .iter()
        .filter(|body| body.poses.len() > 1 || extent(&body.shape) < 1.5)
        .flat_map(|body| body.poses.iter().map(|at| [at.pose.x_m, at.pose.y_m]))
        .filter(near);
    let (low, high) = bounds(movers.chain([low, high]))?;
    let mut low = low.map(|v| v - MARGIN_M);
    let mut high = high.map(|v| v + MARGIN_M);
    // Very long or high maps are widened, so that every picture fills its box.
    let wanted = size[0] / size[1];
    let (w, h) = (high[0] - low[0], high[1] - low[1]);
    let (axis, grow) = if w / h < wanted {
        (0, h * wanted - w)
    } else {
        (1, (w / (wanted * 2.2) - h).max(0.0))
    };
    low[axis] -= grow / 2.0;
    high[axis] += grow / 2.0;
    Some(View::fit(low, high, [0.0, 0.0], size))
}

/// The course of a naked twin until it touches; what comes after shows nothing more.
fn until_contact(naked: &RunResult) -> impl Iterator<Item = &Sample> {
    let end_s = naked
        .contacts
        .first()
        .map_or(f64::INFINITY, |contact| contact.t_s);
    naked
        .samples
        .iter()
        .take_while(move |sample| sample.t_s <= end_s)
}

fn extent(shape: &ShapeRecord) -> f64 {
    match shape {
        ShapeRecord::Segment { from_m, to_m } => (to_m[0] - from_m[0]).hypot(to_m[1] - from_m[1]),
        ShapeRecord::Box { size_m } => size_m[0].max(size_m[1]),
        ShapeRecord::Circle { radius_m } => 2.0 * radius_m,
    }
}

fn draw_map(
    picture: &mut Picture,
    case: &CaseResult,
    subject: Subject,
    run: &RunResult,
    view: &View,
    detailed: bool,
) {
    if detailed {
        draw_grid(picture, view);
    }
    draw_goal(picture, run, view);
    for body in &run.world.bodies {
        draw_body(picture, body, moment_of_interest(run), view);
    }
    if let Some(naked) = case.naked.as_ref().filter(|_| subject == Subject::Guarded) {
        draw_naked(picture, naked, &case.footprint, view);
    }
    draw_swept(picture, run, &case.footprint, view);
    draw_path(picture, run, view);
    draw_ends(picture, run, &case.footprint, view);
    if detailed {
        draw_stops(picture, run, &case.footprint, view);
        draw_scale(picture, view);
    }
    for contact in &run.contacts {
        draw_cross(picture, view.at([contact.pose.x_m, contact.pose.y_m]));
    }
}

/// The time at which moving bodies are drawn: when the robot was nearest to something.
fn moment_of_interest(run: &RunResult) -> f64 {
    let contact = run.contacts.first().map(|contact| contact.t_s);
    let nearest = || {
        run.samples
            .iter()
            .filter_map(|s| s.clearance_m.map(|gap| (s.t_s, gap)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(t_s, _)| t_s)
    };
    contact.or_else(nearest).unwrap_or(0.0)
}

fn draw_grid(picture: &mut Picture, view: &View) {
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

fn draw_scale(picture: &mut Picture, view: &View) {
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

fn draw_goal(picture: &mut Picture, run: &RunResult, view: &View) {
    let Some(goal) = run.world.goal_m else { return };
    let radius = run.world.goal_radius_m.unwrap_or(0.1).max(0.05);
    picture.circle(view.at(goal), radius * view.scale, Style::Goal);
}

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

fn draw_shape(picture: &mut Picture, shape: &ShapeRecord, at: Pose, view: &View, style: Style) {
    match shape {
        ShapeRecord::Circle { radius_m } => {
            // Poles of a few millimetres stay visible on paper.
            let radius = (radius_m * view.scale).max(1.6);
            picture.circle(view.at([at[0], at[1]]), radius, style);
        }
        _ => picture.polygon(view.all(&shape_outline(shape, at)), style),
    }
}

fn draw_body(picture: &mut Picture, body: &BodyRecord, when_s: f64, view: &View) {
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

fn draw_naked(picture: &mut Picture, naked: &RunResult, footprint: &FootprintRecord, view: &View) {
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
        draw_cross(picture, view.at([at[0], at[1]]));
    }
}

fn draw_cross(picture: &mut Picture, [x, y]: [f64; 2]) {
    picture.circle([x, y], 6.5, Style::Contact);
    picture.line(vec![[x - 3.5, y - 3.5], [x + 3.5, y + 3.5]], Style::Contact);
    picture.line(vec![[x - 3.5, y + 3.5], [x + 3.5, y - 3.5]], Style::Contact);
}

/// Footprints so close together that their union is the swept area to the eye.
fn draw_swept(picture: &mut Picture, run: &RunResult, footprint: &FootprintRecord, view: &View) {
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
fn draw_path(picture: &mut Picture, run: &RunResult, view: &View) {
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

fn draw_ends(picture: &mut Picture, run: &RunResult, footprint: &FootprintRecord, view: &View) {
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

fn draw_stops(picture: &mut Picture, run: &RunResult, footprint: &FootprintRecord, view: &View) {
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
            let text = format!(
                "{} at {:.1} s",
                words::why_stopped(&stop.decision, &stop.reason),
                stop.t_s
            );
            // Above the footprint, inside the picture.
            let corners = view.all(&body_outline(footprint, pose(&stop.pose)));
            let top = corners.iter().map(|corner| corner[1]).fold(y, f64::min);
            let at = [x.clamp(70.0, WIDTH - 70.0), (top - 6.0).max(12.0)];
            picture.text(at, Anchor::Middle, Style::Label, text);
        }
    }
}

fn draw_plots(picture: &mut Picture, run: &RunResult, top: f64) {
    let series = |value: &dyn Fn(&Sample) -> Option<f64>| -> Vec<[f64; 2]> {
        run.samples
            .iter()
            .filter_map(|s| value(s).map(|v| [s.t_s, v]))
            .collect()
    };
    let speed = series(&|s| Some(s.v_mps));
    let clearance = series(&|s| s.clearance_m);
    let stops: Vec<[f64; 2]> = run.stops.iter().map(|stop| [stop.t_s, stop.t_s]).collect();
    let half = [WIDTH / 2.0, PLOT_HEIGHT];
    let plots = [
        ("speed, m/s", &speed, Style::Speed, Style::SpeedFill, 100.0),
        (
            "clearance, m",
            &clearance,
            Style::Clearance,
            Style::ClearanceFill,
            2.0,
        ),
    ];
    for (i, (label, samples, curve, area, cap)) in plots.into_iter().enumerate() {
        let plot = Plot {
            label,
            samples,
            curve,
            area,
            limit: None,
            events: &stops,
            cap,
        };
        let origin = [WIDTH / 2.0 * i as f64, top];
        plot::draw(picture, origin, half, run.time_s, &plot);
    }
}
