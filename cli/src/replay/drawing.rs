//! Pictures of a replay: the whole drive, and a close view of each event.

use super::drive::Moment;
use super::events::Event;
use super::shadow::Judged;
use crate::picture::plot::number;
use crate::picture::view::{View, bounds, outline, round_step};
use crate::picture::{Anchor, Picture, Style};
use crate::report::words;

const PANEL: f64 = 372.0;
const MAP: [f64; 2] = [1000.0, 860.0];
/// Farther returns are outside the picture anyway.
const BEYOND_PATH_M: f64 = 9.0;

/// The robot's outline: front, rear, left, right from the rotation centre, metres.
pub type Edges = [f64; 4];

/// Everything a picture needs.
pub struct Scene<'a> {
    /// The drive.
    pub moments: &'a [Moment],
    /// The verdict at each moment.
    pub judged: &'a [Judged],
    /// Consecutive moments with the same verdict.
    pub events: &'a [Event],
    /// Outline of the robot.
    pub edges: Edges,
    /// Heading of the picture.
    pub title: String,
}

/// The whole drive.
#[must_use]
pub fn overview(scene: &Scene<'_>) -> Option<Picture> {
    let (low, high) = bounds(scene.moments.iter().map(|m| [m.pose[0], m.pose[1]]))?;
    let low = low.map(|v| v - BEYOND_PATH_M);
    let high = high.map(|v| v + BEYOND_PATH_M);
    let view = View::fit(low, high, [0.0, 0.0], MAP);
    let [w, h] = view.size();
    let height = h.max(560.0);
    let mut picture = Picture::new(w + PANEL, height, scene.title.clone());
    picture.rect([0.0, 0.0], [picture.width, height], Style::Paper);
    draw_free(&mut picture, scene.moments, &view);
    draw_points(&mut picture, scene, &view, 1.7);
    draw_path(&mut picture, scene, &view);
    for (index, event) in scene.events.iter().enumerate() {
        draw_event(&mut picture, scene, event, index + 1, &view);
    }
    draw_ends(&mut picture, scene, &view);
    cover_outside(&mut picture, [w, h], height);
    draw_scale(&mut picture, &view);
    draw_panel(&mut picture, scene, w + 18.0, height);
    Some(picture)
}

/// The surroundings of one event: the sweep of that moment, the memory, the deciding point.
#[must_use]
pub fn close_up(scene: &Scene<'_>, index: usize) -> Option<Picture> {
    const SIDE: f64 = 700.0;
    const HALF_M: f64 = 5.5;
    let event = scene.events.get(index)?;
    let moment = scene.moments.get(event.first)?;
    let judged = scene.judged.get(event.first)?;
    // Between two rows, the newest sweep is the one before.
    let swept = scene
        .moments
        .get(..=event.first)?
        .iter()
        .rev()
        .find(|m| m.row.is_some())?;
    let [x, y, _] = moment.pose;
    let view = View::fit(
        [x - HALF_M, y - HALF_M],
        [x + HALF_M, y + HALF_M],
        [0.0, 0.0],
        [SIDE, SIDE],
    );
    let title = format!("{}. {}", index + 1, event.sentence());
    let mut picture = Picture::new(SIDE, SIDE + 46.0, title.clone());
    picture.rect([0.0, 0.0], [SIDE, SIDE + 46.0], Style::Paper);
    draw_free(&mut picture, std::slice::from_ref(swept), &view);
    let near = |p: &[f64; 2]| (p[0] - x).abs() < HALF_M && (p[1] - y).abs() < HALF_M;
    let memory: Vec<_> = judged.memory_m.iter().copied().filter(near).collect();
    picture.dots(view.all(&memory), 5.0, Style::Memory);
    let returns: Vec<_> = swept.returns_m.iter().copied().filter(near).collect();
    picture.dots(view.all(&returns), 3.0, Style::Scan);
    draw_path(&mut picture, scene, &view);
    draw_event(&mut picture, scene, event, index + 1, &view);
    cover_outside(&mut picture, [SIDE, SIDE], SIDE + 46.0);
    draw_scale(&mut picture, &view);
    picture.text(
        [12.0, SIDE + 20.0],
        Anchor::Start,
        Style::LabelStrong,
        title,
    );
    let about = format!(
        "black: newest sweep   teal: {} remembered points   green: seen free   red: footprint and deciding point",
        judged.memory_m.len()
    );
    picture.text([12.0, SIDE + 38.0], Anchor::Start, Style::Label, about);
    Some(picture)
}

fn draw_free(picture: &mut Picture, moments: &[Moment], view: &View) {
    for moment in moments {
        picture.polygon(view.all(&moment.seen_m), Style::KnownFree);
    }
}

/// All returns, each cell of the paper only once, then what was remembered.
fn draw_points(picture: &mut Picture, scene: &Scene<'_>, view: &View, size: f64) {
    let mut once = std::collections::BTreeSet::new();
    let mut fresh = |points: &mut dyn Iterator<Item = [f64; 2]>| -> Vec<[f64; 2]> {
        points
            .map(|point| view.at(point))
            .filter(|[x, y]| (0.0..=MAP[0]).contains(x) && (0.0..=MAP[1]).contains(y))
            .filter(|[x, y]| once.insert(((x * 1.5) as i64, (y * 1.5) as i64)))
            .collect()
    };
    let memory = fresh(&mut scene.judged.iter().flat_map(|j| j.memory_m.iter().copied()));
    let returns = fresh(
        &mut scene
            .moments
            .iter()
            .flat_map(|m| m.returns_m.iter().copied()),
    );
    picture.dots(returns, size, Style::Scan);
    picture.dots(memory, size + 0.6, Style::Memory);
}

fn draw_path(picture: &mut Picture, scene: &Scene<'_>, view: &View) {
    for (pair, judged) in scene.moments.windows(2).zip(scene.judged) {
        let ends = [pair[0].pose, pair[1].pose].map(|pose| view.at([pose[0], pose[1]]));
        picture.line(ends.to_vec(), words::path_style(&judged.action));
    }
}

fn draw_event(picture: &mut Picture, scene: &Scene<'_>, event: &Event, number: usize, view: &View) {
    let (Some(moment), Some(judged)) = (
        scene.moments.get(event.first),
        scene.judged.get(event.first),
    ) else {
        return;
    };
    picture.polygon(
        view.all(&outline(moment.pose, scene.edges)),
        Style::FootprintStop,
    );
    let centre = view.at([moment.pose[0], moment.pose[1]]);
    if let Some(point) = judged.point_m {
        let at = view.at(point);
        picture.line(vec![centre, at], Style::Deciding);
        picture.circle(at, 4.0, Style::Deciding);
    }
    if event.is_stop() {
        picture.circle(centre, 8.5, Style::StopMark);
        let at = [centre[0], centre[1] + 4.0];
        picture.text(at, Anchor::Middle, Style::MarkText, number.to_string());
    }
}

fn draw_ends(picture: &mut Picture, scene: &Scene<'_>, view: &View) {
    let ends = [
        (scene.moments.first(), "start"),
        (scene.moments.last(), "end"),
    ];
    for (moment, word) in ends {
        let Some(moment) = moment else { continue };
        picture.polygon(view.all(&outline(moment.pose, scene.edges)), Style::Start);
        let [x, y] = view.at([moment.pose[0], moment.pose[1]]);
        picture.text(
            [x + 12.0, y - 10.0],
            Anchor::Start,
            Style::LabelStrong,
            word,
        );
    }
}

/// Paper over what hangs out of the map.
fn cover_outside(picture: &mut Picture, [w, h]: [f64; 2], height: f64) {
    let right = picture.width - w;
    if right > 0.0 {
        picture.rect([w, 0.0], [right, height], Style::Paper);
    }
    if height > h {
        picture.rect([0.0, h], [w, height - h], Style::Paper);
    }
    picture.polygon(vec![[0.5, 0.5], [w, 0.5], [w, h], [0.5, h]], Style::Frame);
}

fn draw_scale(picture: &mut Picture, view: &View) {
    let [_, height] = view.size();
    let bar = round_step(view.max_m[0] - view.min_m[0], 8.0);
    let (x, y) = (14.0, height - 14.0);
    let right = x + bar * view.scale;
    let corners = vec![[x, y - 6.0], [x, y], [right, y], [right, y - 6.0]];
    picture.line(corners, Style::Start);
    let text = format!("{} m", number(bar, bar));
    picture.text([x + 5.0, y - 5.0], Anchor::Start, Style::LabelStrong, text);
}

fn draw_panel(picture: &mut Picture, scene: &Scene<'_>, x: f64, height: f64) {
    let title = scene.title.clone();
    picture.text([x, 28.0], Anchor::Start, Style::LabelStrong, title);
    let mut y = draw_legend(picture, x, 54.0) + 16.0;
    let heading = "where it would have braked or stopped";
    picture.text([x, y], Anchor::Start, Style::LabelStrong, heading);
    let stops = scene.events.iter().enumerate();
    for (index, event) in stops.filter(|(_, event)| event.is_stop()) {
        y += 16.0;
        if y > height - 30.0 {
            let more = "... more in replay.json";
            picture.text([x, y], Anchor::Start, Style::Label, more);
            break;
        }
        let text = format!("{:>3}  {}", index + 1, event.sentence());
        picture.text([x, y], Anchor::Start, Style::Label, text);
    }
}

/// What the colours mean; returns the base line below.
fn draw_legend(picture: &mut Picture, x: f64, top: f64) -> f64 {
    let mut y = top;
    let lines = [
        (Style::PathPass, "guard would pass the motion"),
        (Style::PathSlow, "guard would slow it"),
        (Style::PathBrake, "guard would brake"),
        (Style::PathStop, "protective or emergency stop"),
    ];
    for (style, text) in lines {
        picture.line(vec![[x, y - 4.0], [x + 26.0, y - 4.0]], style);
        picture.text([x + 36.0, y], Anchor::Start, Style::Label, text);
        y += 18.0;
    }
    let points = [
        (Style::Scan, 3.0, "laser returns"),
        (Style::Memory, 4.0, "returns the guard remembered"),
    ];
    for (style, size, text) in points {
        let dots = (0..5)
            .map(|i| [x + 3.0 + 5.0 * f64::from(i), y - 4.0])
            .collect();
        picture.dots(dots, size, style);
        picture.text([x + 36.0, y], Anchor::Start, Style::Label, text);
        y += 18.0;
    }
    picture.rect([x, y - 11.0], [26.0, 12.0], Style::KnownFree);
    picture.text(
        [x + 36.0, y],
        Anchor::Start,
        Style::Label,
        "seen free by some beam",
    );
    y + 18.0
}
