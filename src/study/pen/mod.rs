//! Who draws: SVG and PNG with the same bits on any machine, since the font comes along.
//!
//! - [`chart`]: curves over two axes; [`sheet`]: shapes.
//! - [`font`]: how wide texts are; [`bitmap`]: its letters on a bitmap; `pixels`: the bitmap as PNG.
//!
//! A build without the feature `plot` has `penless.rs` instead.

pub mod bitmap;
pub mod chart;
pub mod font;
mod pixels;
pub mod sheet;

use super::drawn::PlotError;

/// That this build draws.
///
/// # Errors
/// Never; a build without the feature `plot` says here that it does not.
pub fn ready() -> Result<(), PlotError> {
    Ok(())
}
