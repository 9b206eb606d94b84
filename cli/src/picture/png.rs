//! Draws a [`Picture`] into a PNG on light paper.

use super::{Anchor, Item, Picture, Style};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use tiny_skia::{
    Color, FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, PremultipliedColorU8, Stroke,
    StrokeDash, Transform,
};

/// Largest width or height in pixels; larger pictures are refused.
const SIDE_MAX: f32 = 16_384.0;

/// The picture as PNG bytes at `zoom` pixels per unit; `None` if its size cannot be drawn.
#[must_use]
pub fn encode(picture: &Picture, zoom: f32) -> Option<Vec<u8>> {
    let (width, height) = (picture.width as f32 * zoom, picture.height as f32 * zoom);
    if !(width >= 1.0 && height >= 1.0 && width <= SIDE_MAX && height <= SIDE_MAX) {
        return None;
    }
    let mut canvas = Pixmap::new(width.ceil() as u32, height.ceil() as u32)?;
    canvas.fill(Color::WHITE);
    for item in &picture.items {
        match item {
            Item::Line {
                points,
                closed,
                style,
            } => {
                if let Some(path) = line_path(points, *closed) {
                    draw(&mut canvas, &path, *style, zoom);
                }
            }
            Item::Circle {
                centre,
                radius,
                style,
            } => {
                let circle =
                    PathBuilder::from_circle(centre[0] as f32, centre[1] as f32, *radius as f32);
                if let Some(path) = circle {
                    draw(&mut canvas, &path, *style, zoom);
                }
            }
            Item::Dots {
                points,
                size,
                style,
            } => {
                if let Some(path) = dots_path(points, *size) {
                    draw(&mut canvas, &path, *style, zoom);
                }
            }
            Item::Actor { .. } => {}
            Item::Text {
                at,
                text,
                anchor,
                style,
            } => draw_text(&mut canvas, *at, text, *anchor, *style, zoom),
        }
    }
    canvas.encode_png().ok()
}

fn line_path(points: &[[f64; 2]], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (i, [x, y]) in points.iter().enumerate() {
        if i == 0 {
            builder.move_to(*x as f32, *y as f32);
        } else {
            builder.line_to(*x as f32, *y as f32);
        }
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

fn dots_path(points: &[[f64; 2]], size: f64) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for [x, y] in points {
        let (left, top) = (x - size / 2.0, y - size / 2.0);
        let rect = tiny_skia::Rect::from_xywh(left as f32, top as f32, size as f32, size as f32)?;
        builder.push_rect(rect);
    }
    builder.finish()
}

fn draw(canvas: &mut Pixmap, path: &Path, style: Style, zoom: f32) {
    let look = style.look();
    let place = Transform::from_scale(zoom, zoom);
    if let Some((light, _)) = look.fill {
        let paint = paint(light, look.opacity);
        canvas.fill_path(path, &paint, FillRule::Winding, place, None);
    }
    if let Some((light, _)) = look.stroke {
        let stroke = Stroke {
            width: look.width as f32,
            line_join: LineJoin::Round,
            dash: look
                .dash
                .and_then(|(dash, gap)| StrokeDash::new(vec![dash as f32, gap as f32], 0.0)),
            ..Stroke::default()
        };
        canvas.stroke_path(path, &paint(light, 1.0), &stroke, place, None);
    }
}

fn channels(rgb: u32) -> [u8; 3] {
    let [_, r, g, b] = rgb.to_be_bytes();
    [r, g, b]
}

fn paint(rgb: u32, opacity: f64) -> Paint<'static> {
    let [r, g, b] = channels(rgb);
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, (opacity * 255.0).round() as u8);
    paint
}

fn draw_text(
    canvas: &mut Pixmap,
    at: [f64; 2],
    text: &str,
    anchor: Anchor,
    style: Style,
    zoom: f32,
) {
    let look = style.look();
    let weight = if style == Style::LabelStrong {
        FontWeight::Bold
    } else {
        FontWeight::Regular
    };
    let size = match look.text as f32 * zoom {
        wanted if wanted < 14.0 => RasterHeight::Size16,
        wanted if wanted < 18.0 => RasterHeight::Size20,
        _ => RasterHeight::Size24,
    };
    let advance = get_raster_width(weight, size) as i64;
    let length = text.chars().count() as i64 * advance;
    let left = (at[0] as f32 * zoom).round() as i64
        - match anchor {
            Anchor::Start => 0,
            Anchor::Middle => length / 2,
            Anchor::End => length,
        };
    // The rasters leave about a fifth of their height below the base line.
    let top = (at[1] as f32 * zoom).round() as i64 - (size.val() as i64 * 4) / 5;
    let colour = channels(look.fill.map_or(0, |(light, _)| light));
    for (i, c) in text.chars().enumerate() {
        let Some(glyph) = get_raster(c, weight, size).or_else(|| get_raster('?', weight, size))
        else {
            continue;
        };
        for (dy, row) in glyph.rows().enumerate() {
            for (dx, coverage) in row.iter().enumerate() {
                let x = left + i as i64 * advance + dx as i64;
                blend(canvas, x, top + dy as i64, colour, *coverage);
            }
        }
    }
}

fn blend(canvas: &mut Pixmap, x: i64, y: i64, colour: [u8; 3], coverage: u8) {
    let (width, height) = (i64::from(canvas.width()), i64::from(canvas.height()));
    if coverage == 0 || !(0..width).contains(&x) || !(0..height).contains(&y) {
        return;
    }
    let Some(pixel) = canvas.pixels_mut().get_mut((y * width + x) as usize) else {
        return;
    };
    let mix = |old: u8, new: u8| {
        let (old, new, part) = (u32::from(old), u32::from(new), u32::from(coverage));
        ((old * (255 - part) + new * part + 127) / 255) as u8
    };
    let mixed = PremultipliedColorU8::from_rgba(
        mix(pixel.red(), colour[0]),
        mix(pixel.green(), colour[1]),
        mix(pixel.blue(), colour[2]),
        255,
    );
    if let Some(mixed) = mixed {
        *pixel = mixed;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_what_was_asked_and_nothing_else() {
        let mut picture = Picture::new(20.0, 10.0, "t");
        picture.rect([0.0, 0.0], [10.0, 10.0], Style::Wall);
        let bytes = encode(&picture, 1.0).expect("encodes");
        let image = Pixmap::decode_png(&bytes).expect("decodes");
        assert_eq!((image.width(), image.height()), (20, 10));
        let at = |x, y| image.pixel(x, y).expect("inside");
        assert_eq!(at(5, 5).red(), 0x3d);
        assert_eq!(at(15, 5).red(), 0xff);
    }

    #[test]
    fn text_leaves_ink() {
        let mut picture = Picture::new(60.0, 30.0, "t");
        picture.text([5.0, 20.0], Anchor::Start, Style::Label, "Hm");
        let image = Pixmap::decode_png(&encode(&picture, 1.0).expect("encodes")).expect("decodes");
        let dark = image.pixels().iter().filter(|p| p.red() < 150).count();
        assert!(dark > 20, "{dark} dark pixels");
    }

    #[test]
    fn impossible_sizes_are_refused() {
        assert!(encode(&Picture::new(f64::NAN, 10.0, "t"), 1.0).is_none());
        assert!(encode(&Picture::new(1e6, 10.0, "t"), 1.0).is_none());
    }
}
