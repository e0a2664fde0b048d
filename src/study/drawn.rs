//! Shapes on a sheet as plain data, and why they may not be drawn.

use stickslip_scene::shown;

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

impl Shape {
    /// Whether all of its points have a place.
    pub fn is_finite(&self) -> bool {
        let points = match self {
            Shape::Text { at, .. } => std::slice::from_ref(at),
            Shape::Line { points, .. } => points,
            Shape::Fill { corners, .. } => corners,
        };
        points.iter().all(|(x, y)| x.is_finite() && y.is_finite())
    }
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
