//! What stands for `pen` in a build without the feature `plot`: all of it says that this build has no plots.

use super::drawn::PlotError;

/// Whether this build draws.
///
/// # Errors
/// That it does not.
pub fn ready() -> Result<(), PlotError> {
    Err(PlotError::NotBuilt)
}

/// The font.
pub mod font {
    use super::PlotError;

    /// Would be the width of a text.
    ///
    /// # Errors
    /// Always.
    pub fn width_of(_: &str, _: f64) -> Result<f64, PlotError> {
        Err(PlotError::NotBuilt)
    }

    /// Would be the lines, broken where they are too wide.
    ///
    /// # Errors
    /// Always.
    pub fn broken(_: &[String], _: f64, _: f64) -> Result<Vec<String>, PlotError> {
        Err(PlotError::NotBuilt)
    }
}

/// Curves over two axes.
pub mod chart {
    use super::PlotError;
    use crate::study::drawn::Chart;

    /// Would be the chart as SVG.
    ///
    /// # Errors
    /// Always.
    pub fn svg(_: &Chart) -> Result<String, PlotError> {
        Err(PlotError::NotBuilt)
    }

    /// Would be the chart as PNG.
    ///
    /// # Errors
    /// Always.
    pub fn png(_: &Chart) -> Result<Vec<u8>, PlotError> {
        Err(PlotError::NotBuilt)
    }
}

/// Shapes on a sheet.
pub mod sheet {
    use super::PlotError;
    use crate::study::drawn::Shape;

    /// Would be the shapes as SVG.
    ///
    /// # Errors
    /// Always.
    pub fn svg(_: &[Shape], _: (f64, f64)) -> Result<String, PlotError> {
        Err(PlotError::NotBuilt)
    }

    /// Would be the shapes as PNG.
    ///
    /// # Errors
    /// Always.
    pub fn png(_: &[Shape], _: (f64, f64)) -> Result<Vec<u8>, PlotError> {
        Err(PlotError::NotBuilt)
    }
}
