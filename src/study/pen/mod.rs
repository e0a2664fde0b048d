//! Shapes as SVG and PNG, with the same bits on every machine, because the program carries the font.
//!
//! A build without the feature `plot` has `penless.rs` instead.

mod bitmap;
mod font;
mod svg;

use super::drawn::PlotError;
pub use bitmap::png;
pub use font::width_of;
pub use svg::svg;

/// Whether this build draws.
///
/// # Errors
/// That it does not; never with the feature `plot`.
pub fn ready() -> Result<(), PlotError> {
    Ok(())
}
