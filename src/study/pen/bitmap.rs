//! Draws shapes as PNG: the coverage of each pixel determines its colour.

use super::font::{self, EM};
use crate::drawn::{Anchor, Colour, PlotError, Shape};
use ab_glyph::{Font, point};
use ab_glyph_rasterizer::Rasterizer;

/// Maximum number of pixels of a bitmap, at three bytes each.
const MAX_PIXELS: f64 = 64e6;

/// Red, green and blue of each pixel, row by row.
struct Bitmap {
    pixels: Vec<u8>,
    /// Pixels per unit of length.
    scale: f64,
    size: (u32, u32),
}

/// Draws shapes on a white sheet, with `scale` pixels per unit of length.
///
/// # Errors
/// If the sheet is too large, or the font cannot be read.
pub fn png(shapes: &[Shape], size: (f64, f64), scale: f64) -> Result<Vec<u8>, PlotError> {
    let (width, height) = ((size.0 * scale).ceil(), (size.1 * scale).ceil());
    if width * height > MAX_PIXELS {
        return Err(PlotError::new(format!(
            "the picture would have {width} by {height} pixels; the limit is {} million. Draw less, or use SVG",
            MAX_PIXELS / 1e6
        )));
    }
    let size = (width as u32, height as u32);
    let mut bitmap = Bitmap {
        pixels: vec![255; 3 * size.0 as usize * size.1 as usize],
        size,
        scale,
    };
    for shape in shapes.iter().filter(|shape| shape.is_finite()) {
        bitmap.draw(shape)?;
    }
    encode(&bitmap).map_err(PlotError::new)
}

fn encode(bitmap: &Bitmap) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, bitmap.size.0, bitmap.size.1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&bitmap.pixels)?;
    writer.finish()?;
    Ok(bytes)
}

impl Bitmap {
    fn draw(&mut self, shape: &Shape) -> Result<(), PlotError> {
        let pixels = self.scale;
        let scaled = |(x, y): &(f64, f64)| (x * pixels, y * pixels);
        match shape {
            Shape::Fill { corners, colour } => {
                let corners = corners.iter().map(scaled).collect();
                self.cover(&[corners], *colour);
            }
            Shape::Line {
                points,
                width,
                colour,
            } => {
                let points: Vec<_> = points.iter().map(scaled).collect();
                self.cover(&stroke(&points, width * pixels), *colour);
            }
            Shape::Text(line) => {
                let font = font::font(line.face, &line.text)?;
                let scale = font::scale(font, line.size * pixels);
                let (glyphs, width) = font::glyphs(font, scale, &line.text);
                let left = match line.anchor {
                    Anchor::Left => 0.0,
                    Anchor::Middle => -0.5 * width,
                    Anchor::Right => -width,
                };
                // Text is centred on its letters without descenders.
                let base = (0.36 * EM * line.size * pixels) as f32;
                let (x, y) = scaled(&line.at);
                let (column, row) = (x.round() as i64, y.round() as i64);
                for (glyph, x) in glyphs {
                    let glyph = glyph.with_scale_and_position(scale, point(left + x, base));
                    let Some(outline) = font.outline_glyph(glyph) else {
                        continue;
                    };
                    let corner = outline.px_bounds().min;
                    outline.draw(|x, y, part| {
                        let (x, y) = (
                            corner.x as i64 + i64::from(x),
                            corner.y as i64 + i64::from(y),
                        );
                        let (x, y) = if line.upright { (y, -x) } else { (x, y) };
                        self.mix((column + x, row + y), line.colour, part);
                    });
                }
            }
        }
        Ok(())
    }

    /// Colours the area covered by any of the polygons.
    fn cover(&mut self, polygons: &[Vec<(f64, f64)>], colour: Colour) {
        let sheet = (f64::from(self.size.0), f64::from(self.size.1));
        let polygons: Vec<_> = polygons.iter().map(|p| clipped(p, sheet)).collect();
        let all = || polygons.iter().flatten();
        let least = |of: fn(&(f64, f64)) -> f64| all().map(of).fold(f64::INFINITY, f64::min);
        let most = |of: fn(&(f64, f64)) -> f64| all().map(of).fold(0.0, f64::max);
        let (left, top) = (least(|p| p.0).floor(), least(|p| p.1).floor());
        if !left.is_finite() {
            return;
        }
        let size = |to: f64, from: f64| (to - from).ceil() as usize + 1;
        let mut raster = Rasterizer::new(size(most(|p| p.0), left), size(most(|p| p.1), top));
        for corners in &polygons {
            let near = |k: usize| {
                let (x, y) = corners[k % corners.len()];
                point((x - left) as f32, (y - top) as f32)
            };
            // All polygons get the same orientation, so that overlaps do not cancel.
            for k in 0..corners.len() {
                if turn(corners) > 0.0 {
                    raster.draw_line(near(k), near(k + 1))
                } else {
                    raster.draw_line(near(k + 1), near(k))
                }
            }
        }
        raster.for_each_pixel_2d(|x, y, part| {
            let at = (left as i64 + i64::from(x), top as i64 + i64::from(y));
            self.mix(at, colour, part);
        });
    }

    /// Blends a colour into a pixel.
    fn mix(&mut self, (x, y): (i64, i64), (r, g, b): Colour, part: f32) {
        let (width, height) = (i64::from(self.size.0), i64::from(self.size.1));
        if part <= 0.0 || !(0..width).contains(&x) || !(0..height).contains(&y) {
            return;
        }
        let start = 3 * (y * width + x) as usize;
        let part = part.min(1.0);
        for (own, new) in self.pixels[start..start + 3].iter_mut().zip([r, g, b]) {
            let mixed = f32::from(*own) * (1.0 - part) + f32::from(new) * part;
            *own = mixed.round() as u8;
        }
    }
}

/// Twice the signed area of a polygon; the sign is its orientation.
fn turn(corners: &[(f64, f64)]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners
        .iter()
        .zip(next)
        .map(|(a, b)| a.0 * b.1 - a.1 * b.0)
        .sum()
}

/// Polygons that cover a line: a rectangle per segment and a disc per corner.
fn stroke(points: &[(f64, f64)], width: f64) -> Vec<Vec<(f64, f64)>> {
    let half = 0.5 * width.max(1.0);
    let piece = |pair: &[(f64, f64)]| {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
        let length = (x1 - x0).hypot(y1 - y0).max(f64::MIN_POSITIVE);
        let (x, y) = (half * (y0 - y1) / length, half * (x1 - x0) / length);
        vec![
            (x0 + x, y0 + y),
            (x1 + x, y1 + y),
            (x1 - x, y1 - y),
            (x0 - x, y0 - y),
        ]
    };
    let bends = points
        .get(1..points.len().saturating_sub(1))
        .unwrap_or_default()
        .iter()
        .map(|(x, y)| {
            (0..8)
                .map(|k| f64::from(k) * std::f64::consts::FRAC_PI_4)
                .map(|a| (x + half * a.cos(), y + half * a.sin()))
                .collect()
        });
    points.windows(2).map(piece).chain(bends).collect()
}

/// Clips a polygon to the sheet (Sutherland and Hodgman).
fn clipped(corners: &[(f64, f64)], (width, height): (f64, f64)) -> Vec<(f64, f64)> {
    type Depth<'a> = &'a dyn Fn(&(f64, f64)) -> f64;
    let edges: [Depth; 4] = [&|p| p.0, &|p| width - p.0, &|p| p.1, &|p| height - p.1];
    let mut left = corners.to_vec();
    for inside in edges {
        let mut next = Vec::new();
        for (k, b) in left.iter().enumerate() {
            let a = &left[(k + left.len() - 1) % left.len()];
            let (from, to) = (inside(a), inside(b));
            if (from < 0.0) != (to < 0.0) {
                let part = from / (from - to);
                next.push((a.0 + part * (b.0 - a.0), a.1 + part * (b.1 - a.1)));
            }
            if to >= 0.0 {
                next.push(*b);
            }
        }
        left = next;
    }
    // Corrects round-off of the intersection points.
    let within = |(x, y): (f64, f64)| (x.clamp(0.0, width), y.clamp(0.0, height));
    left.into_iter().map(within).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawn::TextLine;

    /// The runs of columns that contain ink.
    fn strokes(bitmap: &Bitmap) -> Vec<(usize, usize)> {
        let (width, height) = (bitmap.size.0 as usize, bitmap.size.1 as usize);
        let ink = |x: usize| (0..height).any(|y| bitmap.pixels[3 * (y * width + x)] < 128);
        let mut runs: Vec<(usize, usize)> = Vec::new();
        for x in (0..width).filter(|x| ink(*x)) {
            match runs.last_mut() {
                Some(last) if last.1 + 1 == x => last.1 = x,
                _ => runs.push((x, x)),
            }
        }
        runs
    }

    fn drawn(size: (u32, u32), shape: &Shape) -> Bitmap {
        let pixels = vec![255; 3 * (size.0 * size.1) as usize];
        let mut bitmap = Bitmap {
            pixels,
            size,
            scale: 2.0,
        };
        bitmap.draw(shape).unwrap();
        bitmap
    }

    #[test]
    fn equal_letters_have_equal_spacing() {
        let text = "lilililililil".to_owned();
        let shape = Shape::Text(TextLine::new((5.0, 15.0), text, 13.0, (0, 0, 0)));
        let runs = strokes(&drawn((400, 60), &shape));
        assert_eq!(runs.len(), 13);
        let steps: Vec<usize> = runs.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        let (least, most) = (steps.iter().min().unwrap(), steps.iter().max().unwrap());
        assert!(most - least <= 1, "{steps:?}");
    }

    #[test]
    fn lines_have_their_width_and_are_clipped_at_the_sheet() {
        let shape = Shape::Line {
            points: vec![(10.0, -1e9), (10.0, 5.0), (10.0, 1e9)],
            width: 2.0,
            colour: (0, 0, 0),
        };
        assert_eq!(strokes(&drawn((40, 40), &shape)), [(18, 21)]);
    }
}
