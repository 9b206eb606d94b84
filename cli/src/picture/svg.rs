//! Writes a [`Picture`] as SVG: hand-made, small, the same bytes every time.

use super::{Anchor, Item, Picture, style};
use std::fmt::Write as _;

/// Escapes text for SVG, HTML and attribute values.
#[must_use]
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // Control characters are not allowed in XML at all.
            c if c.is_control() && c != '\n' && c != '\t' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A pixel coordinate with at most one decimal; not finite becomes 0.
fn px(value: f64) -> String {
    let value = if value.is_finite() { value } else { 0.0 };
    let text = format!("{value:.1}");
    let short = text.strip_suffix(".0").unwrap_or(&text);
    if short == "-0" { "0" } else { short }.to_owned()
}

/// The SVG element, for use inside a page that already holds [`style::style_sheet`].
#[must_use]
pub fn element(picture: &Picture) -> String {
    let title = escape(&picture.title);
    let (w, h) = (px(picture.width), px(picture.height));
    let id = picture
        .id
        .as_deref()
        .map_or(String::new(), |id| format!(" id=\"{}\"", escape(id)));
    let mut out = format!(
        "<svg class=\"hl\"{id} viewBox=\"0 0 {w} {h}\" role=\"img\" aria-label=\"{title}\">\
         <title>{title}</title>\n"
    );
    for item in &picture.items {
        write_item(&mut out, item, picture.id.as_deref());
    }
    out.push_str("</svg>\n");
    out
}

/// A complete SVG file with its own style sheet.
#[must_use]
pub fn file(picture: &Picture) -> String {
    let (w, h) = (px(picture.width), px(picture.height));
    let body = element(picture).replacen(
        "<svg class=\"hl\"",
        &format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"hl\" width=\"{w}\" height=\"{h}\""
        ),
        1,
    );
    body.replacen(
        "</title>\n",
        &format!("</title>\n<style>{}</style>\n", style::style_sheet()),
        1,
    )
}

fn write_item(out: &mut String, item: &Item, id: Option<&str>) {
    match item {
        Item::Line {
            points,
            closed,
            style,
        } => {
            let _ = write!(out, "<path class=\"{}\" d=\"", style.look().class);
            path_data(out, points, *closed);
            out.push_str("\"/>\n");
        }
        Item::Circle {
            centre,
            radius,
            style,
        } => {
            let _ = writeln!(
                out,
                "<circle class=\"{}\" cx=\"{}\" cy=\"{}\" r=\"{}\"/>",
                style.look().class,
                px(centre[0]),
                px(centre[1]),
                px(*radius)
            );
        }
        Item::Dots {
            points,
            size,
            style,
        } => write_dots(out, points, *size, style.look().class),
        Item::Actor {
            outline,
            frames,
            style,
        } => {
            if let Some(id) = id {
                write_actor(out, outline, frames, style.look().class, &escape(id));
            }
        }
        Item::Text {
            at,
            text,
            anchor,
            style,
        } => write_text(out, *at, text, *anchor, style.look().class),
    }
}

fn write_dots(out: &mut String, points: &[[f64; 2]], size: f64, class: &str) {
    let edge = px(size);
    let _ = write!(out, "<path class=\"{class}\" d=\"");
    for [x, y] in points {
        let (left, top) = (px(x - size / 2.0), px(y - size / 2.0));
        let _ = write!(out, "M{left} {top}h{edge}v{edge}h-{edge}z");
    }
    out.push_str("\"/>\n");
}

fn write_text(out: &mut String, at: [f64; 2], text: &str, anchor: Anchor, class: &str) {
    let align = match anchor {
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    };
    let (x, y, text) = (px(at[0]), px(at[1]), escape(text));
    let _ = writeln!(
        out,
        "<text class=\"{class}\" x=\"{x}\" y=\"{y}\"{align}>{text}</text>"
    );
}

/// Hidden until the picture is clicked; then it runs through its frames once and stays.
fn write_actor(out: &mut String, outline: &[[f64; 2]], frames: &[[f64; 4]], class: &str, id: &str) {
    let end_s = frames.last().map_or(0.0, |frame| frame[0]).max(0.1);
    let (mut times, mut places, mut angles) = (String::new(), String::new(), String::new());
    for (index, [t_s, x, y, degrees]) in frames.iter().enumerate() {
        let separator = if index == 0 { "" } else { ";" };
        // The last key time must be exactly one.
        let part = if index + 1 == frames.len() {
            1.0
        } else {
            t_s / end_s
        };
        let _ = write!(times, "{separator}{:.4}", part.clamp(0.0, 1.0));
        let _ = write!(places, "{separator}{} {}", px(*x), px(*y));
        let _ = write!(angles, "{separator}{}", px(*degrees));
    }
    let timing =
        format!("begin=\"{id}.click\" dur=\"{end_s:.1}s\" fill=\"freeze\" keyTimes=\"{times}\"");
    let _ = write!(
        out,
        "<g visibility=\"hidden\"><set attributeName=\"visibility\" to=\"visible\" begin=\"{id}.click\"/>\
         <animateTransform attributeName=\"transform\" type=\"translate\" values=\"{places}\" {timing}/>\
         <g><animateTransform attributeName=\"transform\" type=\"rotate\" values=\"{angles}\" {timing}/>\
         <path class=\"{class}\" d=\""
    );
    path_data(out, outline, true);
    out.push_str("\"/></g></g>\n");
}

fn path_data(out: &mut String, points: &[[f64; 2]], closed: bool) {
    for (i, [x, y]) in points.iter().enumerate() {
        let step = if i == 0 { 'M' } else { 'L' };
        let _ = write!(out, "{step}{} {}", px(*x), px(*y));
    }
    if closed {
        out.push('z');
    }
}

#[cfg(test)]
mod tests {
    use super::super::Style;
    use super::*;

    #[test]
    fn text_and_title_are_escaped() {
        let mut picture = Picture::new(10.0, 10.0, "a<b>\"&'");
        picture.text([0.0, 0.0], Anchor::End, Style::Label, "x<y");
        let svg = element(&picture);
        assert!(svg.contains("a&lt;b&gt;&quot;&amp;&#39;"), "{svg}");
        assert!(svg.contains(">x&lt;y</text>"), "{svg}");
    }

    #[test]
    fn numbers_are_short_and_never_nan() {
        assert_eq!(px(12.0), "12");
        assert_eq!(px(-0.01), "0");
        assert_eq!(px(1.26), "1.3");
        assert_eq!(px(f64::NAN), "0");
    }

    #[test]
    fn an_actor_moves_only_in_a_named_picture() {
        let mut picture = Picture::new(10.0, 10.0, "t");
        let outline = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        picture.actor(
            outline,
            vec![[0.0, 1.0, 2.0, 0.0], [2.0, 3.0, 4.0, 90.0]],
            Style::Footprint,
        );
        assert!(!element(&picture).contains("animateTransform"));
        picture.id = Some("p1".into());
        let svg = element(&picture);
        assert!(
            svg.contains("begin=\"p1.click\"") && svg.contains("values=\"1 2;3 4\""),
            "{svg}"
        );
    }

    #[test]
    fn a_file_stands_alone() {
        let svg = file(&Picture::new(10.0, 20.0, "t"));
        assert!(svg.starts_with("<svg xmlns="));
        assert!(svg.contains("<style>"));
    }
}
