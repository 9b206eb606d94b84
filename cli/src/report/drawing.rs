//! Draws a case: map, swept footprints, path by verdict, stops, the naked twin, and two curves over time.

mod course;
mod world;

use super::actors;
use super::claims::case_anchor as anchor;
use super::words;
use crate::picture::plot::{self, Plot};
use crate::picture::view::{Pose, View, bounds, outline};
use crate::picture::{Picture, Style};
use course::{draw_contacts, draw_ends, draw_path, draw_stops, draw_swept};
use haltline_scenarios::result::{
    CaseResult, FootprintRecord, PoseRecord, RunResult, Sample, ShapeRecord,
};
pub use world::shape_outline;
use world::{draw_body, draw_goal, draw_grid, draw_naked, draw_scale};

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

/// A recorded pose as numbers.
#[must_use]
pub fn pose(record: &PoseRecord) -> Pose {
    [record.x_m, record.y_m, record.theta_rad]
}

/// The robot's corners at a pose.
#[must_use]
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
    draw_contacts(picture, run, view);
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
