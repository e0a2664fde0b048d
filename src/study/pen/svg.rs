//! Draws shapes as SVG.

use super::font::EM;
use crate::drawn::{Anchor, Colour, Face, PlotError, Shape};
use std::fmt::Write;

/// Draws shapes on a white sheet.
///
/// # Errors
/// Never.
pub fn svg(shapes: &[Shape], (width, height): (f64, f64)) -> Result<String, PlotError> {
    let (width, height) = (width.ceil(), height.ceil());
    let mut text = format!(
        "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" xmlns=\"http://www.w3.org/2000/svg\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#FFFFFF\"/>\n"
    );
    for shape in shapes.iter().filter(|shape| shape.is_finite()) {
        // Writing to a string does not fail.
        let _ = match shape {
            Shape::Text(line) => {
                let (x, y) = (short(line.at.0), short(line.at.1));
                let anchor = match line.anchor {
                    Anchor::Left => "start",
                    Anchor::Middle => "middle",
                    Anchor::Right => "end",
                };
                let turned = if line.upright {
                    format!(" transform=\"rotate(270, {x}, {y})\"")
                } else {
                    String::new()
                };
                let family = match line.face {
                    Face::Sans => "sans-serif",
                    Face::Mono(_) => "monospace",
                };
                let (size, colour) = (short(line.size * EM), hex(line.colour));
                let words = escaped(&line.text);
                writeln!(
                    text,
                    "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\" text-anchor=\"{anchor}\" font-family=\"{family}\" \
                     font-size=\"{size}\" fill=\"{colour}\"{turned}>\n{words}\n</text>"
                )
            }
            Shape::Line {
                points,
                width,
                colour,
            } => writeln!(
                text,
                "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" points=\"{}\"/>",
                hex(*colour),
                short(*width),
                joined(points)
            ),
            Shape::Fill { corners, colour } => writeln!(
                text,
                "<polygon fill=\"{}\" points=\"{}\"/>",
                hex(*colour),
                joined(corners)
            ),
        };
    }
    Ok(text + "</svg>\n")
}

/// Rounds a length to a tenth of a pixel.
fn short(length: f64) -> f64 {
    // Adding 0 makes a negative zero positive.
    (length * 10.0).round() / 10.0 + 0.0
}

fn hex((r, g, b): Colour) -> String {
    format!("#{r:02X}{g:02X}{b:02X}")
}

fn joined(points: &[(f64, f64)]) -> String {
    let points: Vec<String> = points
        .iter()
        .map(|(x, y)| format!("{},{}", short(*x), short(*y)))
        .collect();
    points.join(" ")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
