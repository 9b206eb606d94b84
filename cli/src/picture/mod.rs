//! A small display list that is drawn both as SVG (for the report) and as PNG (for terminals and mail).
//!
//! A [`Picture`] knows pixels and meanings ([`Style`]), no robots and no colours;
//! [`style`] alone turns meanings into colours. Nothing here reads a clock or a random number,
//! so the same picture gives the same bytes.

pub mod plot;
pub mod png;
pub mod style;
pub mod svg;
pub mod view;

pub use style::Style;

/// Horizontal alignment of a text at its anchor point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins at the point.
    Start,
    /// The text is centred on the point.
    Middle,
    /// The text ends at the point.
    End,
}

/// One thing to draw; coordinates in pixels, y down.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// Connected lines, or a filled outline if `closed`.
    Line {
        /// Corners in order.
        points: Vec<[f64; 2]>,
        /// Whether the last corner joins the first.
        closed: bool,
        /// What it means.
        style: Style,
    },
    /// A circle.
    Circle {
        /// Centre.
        centre: [f64; 2],
        /// Radius.
        radius: f64,
        /// What it means.
        style: Style,
    },
    /// Many small squares, drawn as one shape.
    Dots {
        /// Centres.
        points: Vec<[f64; 2]>,
        /// Edge length.
        size: f64,
        /// What they mean.
        style: Style,
    },
    /// Something that moves when the reader clicks on the picture; a still picture leaves it out.
    Actor {
        /// Corners around the actor's own origin.
        outline: Vec<[f64; 2]>,
        /// Seconds of the reader's time, x, y, and degrees clockwise, in order of time.
        frames: Vec<[f64; 4]>,
        /// What it means.
        style: Style,
    },
    /// One line of text.
    Text {
        /// Anchor point on the base line.
        at: [f64; 2],
        /// The words.
        text: String,
        /// Alignment.
        anchor: Anchor,
        /// What it means.
        style: Style,
    },
}

/// A drawing of fixed size.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: f64,
    /// Height in pixels.
    pub height: f64,
    /// What the picture shows, for readers who cannot see it.
    pub title: String,
    /// Name of the picture within a page, if it has actors.
    pub id: Option<String>,
    /// Things to draw, first at the bottom.
    pub items: Vec<Item>,
}

impl Picture {
    /// An empty picture.
    #[must_use]
    pub fn new(width: f64, height: f64, title: impl Into<String>) -> Self {
        Self {
            width,
            height,
            title: title.into(),
            id: None,
            items: Vec::new(),
        }
    }

    /// Adds connected lines; fewer than two points draw nothing.
    pub fn line(&mut self, points: Vec<[f64; 2]>, style: Style) {
        if points.len() > 1 {
            self.items.push(Item::Line {
                points,
                closed: false,
                style,
            });
        }
    }

    /// Adds a closed outline; fewer than three points draw nothing.
    pub fn polygon(&mut self, points: Vec<[f64; 2]>, style: Style) {
        if points.len() > 2 {
            self.items.push(Item::Line {
                points,
                closed: true,
                style,
            });
        }
    }

    /// Adds a rectangle parallel to the axes.
    pub fn rect(&mut self, [x, y]: [f64; 2], [w, h]: [f64; 2], style: Style) {
        self.polygon(vec![[x, y], [x + w, y], [x + w, y + h], [x, y + h]], style);
    }

    /// Adds a circle.
    pub fn circle(&mut self, centre: [f64; 2], radius: f64, style: Style) {
        self.items.push(Item::Circle {
            centre,
            radius,
            style,
        });
    }

    /// Adds many dots as one shape.
    pub fn dots(&mut self, points: Vec<[f64; 2]>, size: f64, style: Style) {
        if !points.is_empty() {
            self.items.push(Item::Dots {
                points,
                size,
                style,
            });
        }
    }

    /// Adds something that moves; fewer than two frames are left out.
    pub fn actor(&mut self, outline: Vec<[f64; 2]>, frames: Vec<[f64; 4]>, style: Style) {
        if frames.len() > 1 && outline.len() > 2 {
            self.items.push(Item::Actor {
                outline,
                frames,
                style,
            });
        }
    }

    /// Adds a text.
    pub fn text(&mut self, at: [f64; 2], anchor: Anchor, style: Style, text: impl Into<String>) {
        self.items.push(Item::Text {
            at,
            text: text.into(),
            anchor,
            style,
        });
    }
}

/// Drops points that lie within `tolerance` of the line through the kept ones (Douglas and Peucker).
#[must_use]
pub fn simplify(points: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let Some(last) = points.len().checked_sub(1).filter(|last| *last > 1) else {
        return points.to_vec();
    };
    let mut keep = vec![false; points.len()];
    keep[0] = true;
    keep[last] = true;
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let far = (from + 1..to)
            .map(|i| (i, distance_to_segment(points[i], points[from], points[to])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((i, distance)) = far
            && distance > tolerance
        {
            keep[i] = true;
            open.push((from, i));
            open.push((i, to));
        }
    }
    points
        .iter()
        .zip(keep)
        .filter_map(|(point, keep)| keep.then_some(*point))
        .collect()
}

fn distance_to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let to = [p[0] - a[0], p[1] - a[1]];
    let length_squared = along[0] * along[0] + along[1] * along[1];
    let part = if length_squared > 0.0 {
        ((to[0] * along[0] + to[1] * along[1]) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (to[0] - part * along[0]).hypot(to[1] - part * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simplify_keeps_corners_and_drops_what_lies_between() {
        let mut points: Vec<[f64; 2]> = (0..=100).map(|i| [f64::from(i), 0.0]).collect();
        points.extend((1..=50).map(|i| [100.0, f64::from(i)]));
        assert_eq!(
            simplify(&points, 0.1),
            vec![[0.0, 0.0], [100.0, 0.0], [100.0, 50.0]]
        );
    }

    #[test]
    fn simplify_keeps_a_closed_loop() {
        let loop_ = [[0.0, 0.0], [5.0, 5.0], [10.0, 0.0], [0.0, 0.0]];
        assert_eq!(simplify(&loop_, 0.5).len(), 4);
    }
}
