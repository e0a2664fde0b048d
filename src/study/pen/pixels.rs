//! Bitmaps: how large they may be, and PNG.

use super::bitmap::Bitmap;
use crate::study::drawn::PlotError;

/// All sizes are for SVG; a PNG has this many pixels for each.
pub(super) const PNG_SCALE: f64 = 2.0;
/// Most pixels of a bitmap; one takes three bytes.
const MOST_PIXELS: u64 = 64_000_000;

/// Pixels to be drawn on.
pub(super) fn bitmap(pixels: &mut [u8], size: (u32, u32)) -> Result<Bitmap<'_>, PlotError> {
    Bitmap::new(pixels, size).ok_or_else(|| PlotError::new("its font cannot be read"))
}

/// White pixels.
pub(super) fn paper(width: u32, height: u32) -> Result<Vec<u8>, PlotError> {
    let pixels = u64::from(width) * u64::from(height);
    if pixels > MOST_PIXELS {
        return Err(PlotError::new(format!(
            "it would have {width} by {height} pixels, and a bitmap has {} million at most; draw less of it, or draw it as SVG",
            MOST_PIXELS / 1_000_000
        )));
    }
    Ok(vec![255; 3 * pixels as usize])
}

pub(super) fn encode(
    pixels: &[u8],
    width: u32,
    height: u32,
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}
