//! Replaces `pen` in builds without the feature `plot`: every function fails.

use super::drawn::{PlotError, Shape};

/// Checks whether this build can draw.
///
/// # Errors
/// Always.
pub fn ready() -> Result<(), PlotError> {
    Err(PlotError::NotBuilt)
}

/// The file of a monospace font: empty.
pub fn mono() -> &'static [u8] {
    &[]
}

/// Width of a text.
///
/// # Errors
/// Always.
pub fn width_of(_: &str, _: f64) -> Result<f64, PlotError> {
    Err(PlotError::NotBuilt)
}

/// Shapes as SVG.
///
/// # Errors
/// Always.
pub fn svg(_: &[Shape], _: (f64, f64)) -> Result<String, PlotError> {
    Err(PlotError::NotBuilt)
}

/// Shapes as PNG.
///
/// # Errors
/// Always.
pub fn png(_: &[Shape], _: (f64, f64), _: f64) -> Result<Vec<u8>, PlotError> {
    Err(PlotError::NotBuilt)
}
