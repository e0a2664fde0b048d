//! Letters on a bitmap: evenly spaced, each where its outline says, to a part of a pixel.
//!
//! The library's own letters lose the blank at the left of each glyph, and so stand unevenly. All else is handed on to its
//! bitmap.

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use plotters::prelude::{BitMapBackend, DrawingBackend};
use plotters::style::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind,
};

/// A bitmap with letters of its own.
pub struct Bitmap<'a> {
    below: BitMapBackend<'a>,
    font: FontRef<'static>,
}

/// Size of an em over the size of a font, as the library has it in an SVG.
const EM: f64 = 1.0 / 1.24;

impl<'a> Bitmap<'a> {
    /// Pixels of red, green and blue, and how many; `None` if the font cannot be read.
    pub fn new(pixels: &'a mut [u8], size: (u32, u32)) -> Option<Bitmap<'a>> {
        Some(Bitmap {
            below: BitMapBackend::with_buffer(pixels, size),
            font: FontRef::try_from_slice(super::font::font()?).ok()?,
        })
    }
}

/// Glyphs of a text from its left end on: where each begins, in pixels; and how wide all of it is.
fn advance(font: &FontRef, scale: PxScale, text: &str) -> (Vec<(ab_glyph::GlyphId, f32)>, f32) {
    let scaled = font.as_scaled(scale);
    let (mut glyphs, mut x, mut before) = (Vec::new(), 0.0_f32, None);
    for c in text.chars() {
        let glyph = scaled.glyph_id(c);
        if let Some(before) = before {
            x += scaled.kern(before, glyph);
        }
        glyphs.push((glyph, x));
        x += scaled.h_advance(glyph);
        before = Some(glyph);
    }
    (glyphs, x)
}

impl DrawingBackend for Bitmap<'_> {
    type ErrorType = <BitMapBackend<'static> as DrawingBackend>::ErrorType;

    fn get_size(&self) -> (u32, u32) {
        self.below.get_size()
    }

    fn ensure_prepared(&mut self) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.below.ensure_prepared()
    }

    fn present(&mut self) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.below.present()
    }

    fn draw_pixel(
        &mut self,
        point: BackendCoord,
        color: BackendColor,
    ) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.below.draw_pixel(point, color)
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.below.draw_line(from, to, style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        upper_left: BackendCoord,
        bottom_right: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.below.draw_rect(upper_left, bottom_right, style, fill)
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        at: BackendCoord,
    ) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        let color = style.color();
        let em = style.size() * EM;
        let units = self.font.units_per_em().unwrap_or(2048.0);
        let scale = PxScale::from(em as f32 * self.font.height_unscaled() / units);
        let (glyphs, width) = advance(&self.font, scale, text);
        let anchor = style.anchor();
        let left = match anchor.h_pos {
            HPos::Left => 0.0,
            HPos::Center => -0.5 * width,
            HPos::Right => -width,
        };
        // Letters without strokes below the line are what is centred.
        let base = match anchor.v_pos {
            VPos::Top => 0.8,
            VPos::Center => 0.36,
            VPos::Bottom => -0.2,
        } * em as f32;
        let (wide, high) = self.get_size();
        let transform = style.transform();
        for (glyph, x) in glyphs {
            let glyph = glyph.with_scale_and_position(scale, point(left + x, base));
            let Some(outline) = self.font.outline_glyph(glyph) else {
                continue;
            };
            let corner = outline.px_bounds().min;
            let mut drawn = Ok(());
            outline.draw(|x, y, cover| {
                let (x, y) = (corner.x as i32 + x as i32, corner.y as i32 + y as i32);
                let (x, y) = transform.transform(x, y);
                let (x, y) = (at.0 + x, at.1 + y);
                let inside = (0..wide as i32).contains(&x) && (0..high as i32).contains(&y);
                if inside && cover > 0.0 && drawn.is_ok() {
                    let alpha = color.alpha * f64::from(cover.min(1.0));
                    drawn = self
                        .below
                        .draw_pixel((x, y), BackendColor { alpha, ..color });
                }
            });
            drawn?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotters::style::IntoFont;

    /// Columns of a row of pixels that hold ink, as runs.
    fn strokes(pixels: &[u8], (width, height): (u32, u32)) -> Vec<(usize, usize)> {
        let ink =
            |x: usize| (0..height as usize).any(|y| pixels[3 * (y * width as usize + x)] < 128);
        let mut runs: Vec<(usize, usize)> = Vec::new();
        for x in (0..width as usize).filter(|x| ink(*x)) {
            match runs.last_mut() {
                Some(last) if last.1 + 1 == x => last.1 = x,
                _ => runs.push((x, x)),
            }
        }
        runs
    }

    #[test]
    fn equal_letters_stand_at_equal_distances() {
        let size = (400, 60);
        let mut pixels = vec![255; 3 * 400 * 60];
        let style = ("sans-serif", 26.0)
            .into_font()
            .color(&plotters::style::BLACK);
        let bitmap = Bitmap::new(&mut pixels, size);
        let drawn = bitmap.map(|mut b| b.draw_text("lilililililil", &style, (10, 10)).is_ok());
        assert_eq!(drawn, Some(true));
        let runs = strokes(&pixels, size);
        assert_eq!(runs.len(), 13);
        let steps: Vec<usize> = runs.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        let (least, most) = (steps.iter().min().unwrap(), steps.iter().max().unwrap());
        assert!(most - least <= 1, "{steps:?}");
    }
}
