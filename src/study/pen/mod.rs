//! Shapes as SVG and PNG, with the same bits on every machine, because the program contains the font.
//!
//! Builds without the feature `plot` use `pen/disabled.rs` instead.

mod bitmap;
mod font;
mod svg;

use super::drawn::PlotError;
pub use bitmap::png;
pub use font::width_of;
pub use svg::svg;

/// The file of DejaVu Sans Mono.
pub fn mono() -> &'static [u8] {
    dejavu::sans_mono::regular()
}

/// Checks whether this build can draw.
///
/// # Errors
/// If it cannot; never with the feature `plot`.
pub fn ready() -> Result<(), PlotError> {
    Ok(())
}
