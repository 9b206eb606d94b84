//! A quantity over time, drawn small: axis, limit line, events, one curve.

use super::{Anchor, Picture, Style, simplify, view::round_step};

/// What to plot.
#[derive(Clone, Debug)]
pub struct Plot<'a> {
    /// Heading with the unit.
    pub label: &'a str,
    /// Time in seconds and value, in order of time.
    pub samples: &'a [[f64; 2]],
    /// How the curve looks.
    pub curve: Style,
    /// How the area under it looks.
    pub area: Style,
    /// Horizontal limit line with its name.
    pub limit: Option<(f64, &'a str)>,
    /// Spans of time to shade, seconds.
    pub events: &'a [[f64; 2]],
    /// Values above this are cut.
    pub cap: f64,
}

/// Room left of the axis and below it, pixels.
const LEFT: f64 = 34.0;
const BELOW: f64 = 16.0;
const ABOVE: f64 = 16.0;

/// Draws into `picture` at `origin`, `size` pixels wide and high, over `[0, end_s]`.
pub fn draw(picture: &mut Picture, origin: [f64; 2], size: [f64; 2], end_s: f64, plot: &Plot<'_>) {
    let inner = [size[0] - LEFT - 4.0, size[1] - BELOW - ABOVE];
    let zero = [origin[0] + LEFT, origin[1] + ABOVE + inner[1]];
    let end_s = end_s.max(1e-3);
    let values = plot.samples.iter().map(|s| s[1].min(plot.cap));
    let low = values.clone().fold(0.0, f64::min);
    let top = plot.limit.map_or(0.0, |(limit, _)| limit);
    let high = values.fold(top, f64::max).max(low + 0.1) * 1.05;
    let at = |[t, v]: [f64; 2]| {
        [
            zero[0] + inner[0] * (t / end_s).clamp(0.0, 1.0),
            zero[1] - inner[1] * ((v.min(plot.cap) - low) / (high - low)),
        ]
    };
    for [from, to] in plot.events {
        let (a, b) = (at([*from, low])[0], at([*to, low])[0]);
        let width = (b - a).max(1.0);
        picture.rect([a, zero[1] - inner[1]], [width, inner[1]], Style::Event);
    }
    draw_axes(picture, zero, inner, end_s, [low, high]);
    if let Some((limit, name)) = plot.limit {
        let [_, y] = at([0.0, limit]);
        picture.line(vec![[zero[0], y], [zero[0] + inner[0], y]], Style::Limit);
        let place = [zero[0] + inner[0] - 2.0, y - 3.0];
        picture.text(place, Anchor::End, Style::Label, name);
    }
    let points: Vec<_> = plot.samples.iter().map(|s| at(*s)).collect();
    let curve = simplify(&points, 0.3);
    if let (Some(first), Some(last)) = (curve.first(), curve.last()) {
        let base = at([0.0, 0.0])[1];
        let mut area = vec![[first[0], base]];
        area.extend_from_slice(&curve);
        area.push([last[0], base]);
        picture.polygon(area, plot.area);
    }
    picture.line(curve, plot.curve);
    let place = [zero[0], origin[1] + ABOVE - 5.0];
    picture.text(place, Anchor::Start, Style::Label, plot.label);
}

fn draw_axes(
    picture: &mut Picture,
    zero: [f64; 2],
    inner: [f64; 2],
    end_s: f64,
    [low, high]: [f64; 2],
) {
    let step = round_step(high - low, 3.0);
    let mut value = (low / step).ceil() * step;
    while value <= high {
        let y = zero[1] - inner[1] * ((value - low) / (high - low));
        picture.line(vec![[zero[0], y], [zero[0] + inner[0], y]], Style::Grid);
        let text = number(value, step);
        picture.text([zero[0] - 4.0, y + 4.0], Anchor::End, Style::Label, text);
        value += step;
    }
    let step = round_step(end_s, 4.0);
    let mut t = 0.0;
    while t <= end_s * 1.000_001 {
        let x = zero[0] + inner[0] * t / end_s;
        picture.line(vec![[x, zero[1]], [x, zero[1] + 3.0]], Style::Frame);
        let text = format!("{} s", number(t, step));
        let anchor = if t > 0.0 {
            Anchor::Middle
        } else {
            Anchor::Start
        };
        if x < zero[0] + inner[0] - 8.0 {
            picture.text([x, zero[1] + 14.0], anchor, Style::Label, text);
        }
        t += step;
    }
    picture.line(
        vec![
            [zero[0], zero[1] - inner[1]],
            zero,
            [zero[0] + inner[0], zero[1]],
        ],
        Style::Frame,
    );
}

/// A number with as many decimals as the axis step needs.
#[must_use]
pub fn number(value: f64, step: f64) -> String {
    let decimals = (-step.abs().max(1e-9).log10().floor()).clamp(0.0, 4.0) as usize;
    let text = format!("{value:.decimals$}");
    if text
        .trim_start_matches('-')
        .bytes()
        .all(|b| b == b'0' || b == b'.')
    {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fit_their_step() {
        assert_eq!(number(0.30000000000000004, 0.1), "0.3");
        assert_eq!(number(-0.00001, 0.1), "0.0");
        assert_eq!(number(20.0, 10.0), "20");
    }

    #[test]
    fn an_empty_plot_still_has_axes() {
        let mut picture = Picture::new(200.0, 80.0, "t");
        let plot = Plot {
            label: "speed",
            samples: &[],
            curve: Style::Speed,
            area: Style::SpeedFill,
            limit: Some((1.0, "limit")),
            events: &[],
            cap: 10.0,
        };
        draw(&mut picture, [0.0, 0.0], [200.0, 80.0], 0.0, &plot);
        assert!(picture.items.len() > 3);
    }
}
