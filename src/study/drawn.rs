//! What is to be drawn, as plain data: charts of curves, and shapes on a sheet; and why it may not be.

use crate::outside::shown;

/// Curves over two axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// What stands above it.
    pub title: String,
    /// What runs to the right.
    pub x: Axis,
    /// What runs upwards.
    pub y: Axis,
    /// Its curves, in the order of the legend.
    pub curves: Vec<Curve>,
    /// Lines below the chart that say what it was made from; long ones are broken.
    pub footer: Vec<String>,
}

/// What a chart runs along.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// What it is called.
    pub name: String,
    /// It counts something: it starts at zero and has whole numbers only.
    pub counts: bool,
}

/// One line with markers, and a line of the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// What the legend calls it.
    pub label: String,
    /// Finite numbers.
    pub points: Vec<(f64, f64)>,
    /// What its last point is.
    pub end: CurveEnd,
}

/// What a curve's last point is.
#[derive(Debug, Clone, PartialEq)]
pub enum CurveEnd {
    /// Where it should end.
    Whole,
    /// Where it failed, and why: a cross, and a line of the legend.
    Failed(String),
    /// Where it was cut off, and why: a line of the legend.
    Stopped(String),
}

/// Red, green and blue.
pub type Colour = (u8, u8, u8);

/// Where a text stands about its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// To the right of it.
    Left,
    /// About it.
    Middle,
    /// To the left of it.
    Right,
}

/// Something drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A line of text.
    Text {
        /// Its point: to the right and downwards, pixels.
        at: (f64, f64),
        /// The text.
        text: String,
        /// Size of its letters, pixels.
        size: f64,
        /// Its colour.
        colour: Colour,
        /// Where it stands about its point.
        anchor: Anchor,
        /// Read from below upwards.
        upright: bool,
    },
    /// A line through points.
    Line {
        /// The points: to the right and downwards, pixels.
        points: Vec<(f64, f64)>,
        /// How wide the line is, pixels.
        width: f64,
        /// Its colour.
        colour: Colour,
    },
    /// A filled polygon.
    Fill {
        /// Its corners: to the right and downwards, pixels.
        corners: Vec<(f64, f64)>,
        /// Its colour.
        colour: Colour,
    },
}

/// Why something could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// Its data, its size, or the font will not do.
    #[error("the chart cannot be drawn: {0}")]
    Undrawable(String),
    /// The program was built without what draws.
    #[error("this build has no plots; cargo install stickslip --features plot")]
    NotBuilt,
}

impl PlotError {
    /// That it cannot be drawn, with why.
    pub fn new(why: impl ToString) -> PlotError {
        PlotError::Undrawable(why.to_string())
    }
}

/// Most characters of a label: of a curve, an axis, a run.
const MOST_LETTERS: usize = 80;

/// A text of a label as it is drawn: harmless, and not longer than a picture can bear.
pub fn label(text: &str) -> String {
    shown::cut(text, MOST_LETTERS)
}
