//! The font: how wide texts are in it, and where lines break.

use crate::outside::shown;
use crate::study::drawn::{PlotError, label};
use plotters::style::{FontStyle, IntoFont, register_font};
use std::sync::OnceLock;

/// What the library calls it.
pub(super) const FONT: &str = "sans-serif";
/// Most characters of a line that is broken where it is too long.
const MOST_LINE: usize = 2000;

/// DejaVu Sans, which is carried compressed (`build.rs`).
pub(super) fn font() -> Option<&'static [u8]> {
    static FONT: OnceLock<Option<Vec<u8>>> = OnceLock::new();
    const PACKED: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/font.deflate"));
    let unpacked = || miniz_oxide::inflate::decompress_to_vec(PACKED).ok();
    FONT.get_or_init(unpacked).as_deref()
}

/// Machines without fonts draw, too.
pub(super) fn load_font() -> Result<(), PlotError> {
    static LOADED: OnceLock<bool> = OnceLock::new();
    let loaded = LOADED.get_or_init(|| {
        font().is_some_and(|font| register_font(FONT, FontStyle::Normal, font).is_ok())
    });
    match loaded {
        true => Ok(()),
        false => Err(PlotError::new("its font cannot be read")),
    }
}

/// The width of a text.
pub fn width_of(text: &str, size: f64) -> Result<f64, PlotError> {
    load_font()?;
    let measured = (FONT, size).into_font().box_size(text);
    measured
        .map(|(width, _)| f64::from(width))
        .map_err(PlotError::new)
}

/// Lines that are no wider than that, broken between words; words that are too long by themselves are cut.
pub fn broken(lines: &[String], size: f64, width: f64) -> Result<Vec<String>, PlotError> {
    let mut all = Vec::new();
    for line in lines {
        let mut present = String::new();
        for word in shown::cut(line, MOST_LINE).split_whitespace() {
            let word = label(word);
            let longer = match present.is_empty() {
                true => word.clone(),
                false => format!("{present} {word}"),
            };
            if !present.is_empty() && 1.06 * width_of(&longer, size)? > width {
                all.push(std::mem::replace(&mut present, word));
            } else {
                present = longer;
            }
        }
        all.push(present);
    }
    Ok(all)
}
