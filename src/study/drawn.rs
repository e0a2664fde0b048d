//! Shapes on a sheet as plain data, and errors of drawing.

use stickslip_scene::shown;

/// Red, green and blue.
pub type Colour = (u8, u8, u8);

/// Position of a text relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// To the right of the point.
    Left,
    /// Centred on the point.
    Middle,
    /// To the left of the point.
    Right,
}

/// A font.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Face {
    /// DejaVu Sans.
    #[default]
    Sans,
    /// A monospace font ([`pen::mono`](crate::pen::mono)) by the bytes of its file; DejaVu Sans for glyphs that it lacks. Passing
    /// the bytes keeps this font out of programs that do not draw with it, such as the page.
    Mono(&'static [u8]),
}

/// A line of text.
#[derive(Debug, Clone, PartialEq)]
pub struct TextLine {
    /// Its point in pixels: to the right and downwards.
    pub at: (f64, f64),
    /// The text.
    pub text: String,
    /// Font size in pixels.
    pub size: f64,
    /// Its colour.
    pub colour: Colour,
    /// Position relative to its point.
    pub anchor: Anchor,
    /// Whether it is vertical, reading upwards.
    pub upright: bool,
    /// Its font.
    pub face: Face,
}

impl TextLine {
    /// A horizontal text to the right of a point.
    pub fn new(at: (f64, f64), text: String, size: f64, colour: Colour) -> TextLine {
        TextLine {
            at,
            text,
            size,
            colour,
            anchor: Anchor::Left,
            upright: false,
            face: Face::Sans,
        }
    }
}

/// A shape.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A line of text.
    Text(TextLine),
    /// A polyline.
    Line {
        /// Points in pixels: to the right and downwards.
        points: Vec<(f64, f64)>,
        /// Line width in pixels.
        width: f64,
        /// Its colour.
        colour: Colour,
    },
    /// A filled polygon.
    Fill {
        /// Corners in pixels: to the right and downwards.
        corners: Vec<(f64, f64)>,
        /// Its colour.
        colour: Colour,
    },
}

impl Shape {
    /// Whether all its points are finite.
    pub fn is_finite(&self) -> bool {
        let points = match self {
            Shape::Text(text) => std::slice::from_ref(&text.at),
            Shape::Line { points, .. } => points,
            Shape::Fill { corners, .. } => corners,
        };
        points.iter().all(|(x, y)| x.is_finite() && y.is_finite())
    }
}

/// Why something cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The data, the size or the font is unsuitable.
    #[error("the chart cannot be drawn: {0}")]
    Undrawable(String),
    /// The program was built without plotting.
    #[error("this build has no plots; cargo install --path . --features plot")]
    NotBuilt,
}

impl PlotError {
    /// The error with this reason.
    pub fn new(why: impl ToString) -> PlotError {
        PlotError::Undrawable(why.to_string())
    }
}

/// Maximum length of a label of a curve, an axis or a run, in characters.
const MOST_LETTERS: usize = 80;

/// The text of a label with safe characters and limited length.
pub fn label(text: &str) -> String {
    shown::cut(text, MOST_LETTERS)
}
