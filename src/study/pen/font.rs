//! The fonts DejaVu Sans and DejaVu Sans Mono: widths of texts, and positions of their glyphs.

use crate::drawn::{Face, PlotError};
use ab_glyph::{Font, FontRef, GlyphId, PxScale, ScaleFont};
use std::sync::OnceLock;

/// Ratio of the em size to the text size.
pub(super) const EM: f64 = 1.0 / 1.24;

/// A font that is read once.
type ReadFont = OnceLock<Option<FontRef<'static>>>;

/// The font of a face if it has all glyphs of a text; otherwise DejaVu Sans.
pub(super) fn font(face: Face, text: &str) -> Result<&'static FontRef<'static>, PlotError> {
    static SANS: ReadFont = OnceLock::new();
    static MONO: ReadFont = OnceLock::new();
    if let Face::Mono(bytes) = face {
        let font = read(&MONO, bytes)?;
        if text.chars().all(|c| font.glyph_id(c) != GlyphId(0)) {
            return Ok(font);
        }
    }
    read(&SANS, dejavu::sans::regular())
}

fn read(
    font: &'static ReadFont,
    bytes: &'static [u8],
) -> Result<&'static FontRef<'static>, PlotError> {
    let font = font.get_or_init(|| FontRef::try_from_slice(bytes).ok());
    font.as_ref()
        .ok_or_else(|| PlotError::new("its font cannot be read"))
}

/// The glyphs of a text with their positions in pixels from the left end, and the total width.
pub(super) fn glyphs(font: &FontRef, scale: PxScale, text: &str) -> (Vec<(GlyphId, f32)>, f32) {
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

/// The scale of texts of this size, in pixels.
pub(super) fn scale(font: &FontRef, size: f64) -> PxScale {
    let units = font.units_per_em().unwrap_or(2048.0);
    PxScale::from((size * EM) as f32 * font.height_unscaled() / units)
}

/// The width of a text.
///
/// # Errors
/// If the font cannot be read.
pub fn width_of(text: &str, size: f64) -> Result<f64, PlotError> {
    let font = font(Face::Sans, text)?;
    Ok(f64::from(glyphs(font, scale(font, size), text).1))
}
