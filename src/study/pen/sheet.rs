//! Shapes on a sheet as SVG and PNG; the size of a sheet is its width and height in pixels of an SVG.

use super::font::{FONT, load_font};
use super::pixels::{PNG_SCALE, bitmap, encode, paper};
use crate::study::drawn::{Anchor, Colour, PlotError, Shape};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// The shapes as SVG.
///
/// # Errors
/// If they cannot be drawn.
pub fn svg(shapes: &[Shape], size: (f64, f64)) -> Result<String, PlotError> {
    load_font()?;
    let mut text = String::new();
    let root = SVGBackend::with_string(&mut text, pixels(size, 1.0)).into_drawing_area();
    draw(shapes, &root, 1.0).map_err(PlotError::new)?;
    drop(root);
    Ok(text)
}

/// The shapes as PNG, with two pixels for a unit of length.
///
/// # Errors
/// If they cannot be drawn.
pub fn png(shapes: &[Shape], size: (f64, f64)) -> Result<Vec<u8>, PlotError> {
    load_font()?;
    let (width, height) = pixels(size, PNG_SCALE);
    let mut pixels = paper(width, height)?;
    let root = bitmap(&mut pixels, (width, height))?.into_drawing_area();
    draw(shapes, &root, PNG_SCALE).map_err(PlotError::new)?;
    drop(root);
    encode(&pixels, width, height).map_err(PlotError::new)
}

fn pixels((width, height): (f64, f64), scale: f64) -> (u32, u32) {
    let pixels = |length: f64| (length * scale).ceil() as u32;
    (pixels(width), pixels(height))
}

fn draw<DB: DrawingBackend>(
    shapes: &[Shape],
    root: &DrawingArea<DB, Shift>,
    scale: f64,
) -> Result<(), DrawingAreaErrorKind<DB::ErrorType>> {
    root.fill(&WHITE)?;
    let pixel = |at: (f64, f64)| {
        let round = |x: f64| (x * scale).round() as i32;
        (round(at.0), round(at.1))
    };
    let rgb = |(r, g, b): Colour| RGBColor(r, g, b);
    for shape in shapes {
        match shape {
            Shape::Text {
                at,
                text,
                size,
                colour,
                anchor,
                upright,
            } => {
                let side = match anchor {
                    Anchor::Left => HPos::Left,
                    Anchor::Middle => HPos::Center,
                    Anchor::Right => HPos::Right,
                };
                let font = (FONT, size * scale).into_font();
                let font = match upright {
                    true => font.transform(FontTransform::Rotate270),
                    false => font,
                };
                let colour = rgb(*colour);
                let style = TextStyle::from(font)
                    .color(&colour)
                    .pos(Pos::new(side, VPos::Center));
                root.draw(&Text::new(text.as_str(), pixel(*at), style))?;
            }
            Shape::Line {
                points,
                width,
                colour,
            } => {
                let stroke = (width * scale).round().max(1.0) as u32;
                let points: Vec<_> = points.iter().map(|p| pixel(*p)).collect();
                root.draw(&PathElement::new(points, rgb(*colour).stroke_width(stroke)))?;
            }
            Shape::Fill { corners, colour } => {
                let corners: Vec<_> = corners.iter().map(|c| pixel(*c)).collect();
                root.draw(&Polygon::new(corners, rgb(*colour).filled()))?;
            }
        }
    }
    root.present()
}
