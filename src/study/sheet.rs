//! Drawings as plain data: texts, lines and filled shapes on a sheet, written as SVG or PNG with the same bits
//! on every machine.
//!
//! Lengths are in SVG units; x to the right, y downwards.

use super::drawn::{TextLine, label};
use super::pen::{self, width_of};
use super::placing::Patch;
use stickslip_scene::shown;

pub use super::drawn::{Anchor, Colour, Face, PlotError, Shape};

/// Text and axes.
pub const BLACK: Colour = (0, 0, 0);
/// Less important text.
pub const GREY: Colour = (90, 90, 90);
/// Lines of a grid.
pub const PALE: Colour = (225, 225, 225);
/// Colours that colour-blind readers can distinguish (Okabe and Ito), without the yellow, which is too pale on
/// white paper.
pub const COLOURS: [Colour; 7] = [
    (0, 114, 178),
    (230, 159, 0),
    (0, 158, 115),
    (204, 121, 167),
    (60, 60, 60),
    (86, 180, 233),
    (213, 94, 0),
];

/// Colour of crosses only.
pub const CROSS: Colour = (192, 0, 0);

/// Font sizes. This one is for titles.
pub const TITLE: f64 = 22.0;
/// Text at axes and in legends.
pub const LABEL: f64 = 15.0;
/// Text in footers.
pub const SMALL: f64 = 13.0;
/// Margin around everything.
pub const MARGIN: f64 = 16.0;
/// Line height of a legend.
pub const ENTRY: f64 = 22.0;
/// Maximum length of a line that is wrapped, in characters.
const MAX_LINE: usize = 2000;

/// The frame of a plot.
#[derive(Debug, Clone, Copy)]
pub struct Axes {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Width and height.
    pub size: (f64, f64),
    /// Left edge of the vertical axis's name.
    pub name: f64,
}

impl Axes {
    /// The point at these fractions of the axes, from 0 to 1.
    pub fn at(&self, x: f64, y: f64) -> (f64, f64) {
        (
            self.left + self.size.0 * x,
            self.top + self.size.1 * (1.0 - y),
        )
    }

    /// Draws grid, numbers and frame. Each axis has a name and a function that positions its numbers.
    pub fn draw(
        &self,
        sheet: &mut Sheet,
        x: (&str, impl Iterator<Item = (f64, String)>),
        y: (&str, impl Iterator<Item = (f64, String)>),
    ) {
        for (part, number) in x.1 {
            let (below, above) = (self.at(part, 0.0), self.at(part, 1.0));
            sheet.line(&[above, below], 1.0, PALE);
            let words = (below.0, below.1 + 0.8 * LABEL);
            sheet.text(words, &number, SMALL, BLACK, Anchor::Middle);
        }
        for (part, number) in y.1 {
            let (left, right) = (self.at(0.0, part), self.at(1.0, part));
            sheet.line(&[left, right], 1.0, PALE);
            let words = (left.0 - 6.0, left.1);
            sheet.text(words, &number, SMALL, BLACK, Anchor::Right);
        }
        let corners = [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0), (0.0, 1.0)];
        let corners = corners.map(|(x, y)| self.at(x, y));
        sheet.line(&corners, 1.0, BLACK);
        let (middle, bottom) = self.at(0.5, 0.0);
        let below = (middle, bottom + 2.4 * LABEL);
        sheet.text(below, x.0, LABEL, BLACK, Anchor::Middle);
        sheet.upright((self.name, self.at(0.0, 0.5).1), y.0, LABEL);
    }
}

/// A drawing; later shapes lie above earlier ones.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sheet {
    /// Width in pixels.
    pub width: f64,
    /// Height in pixels.
    pub height: f64,
    /// Shapes; later ones cover earlier ones.
    pub shapes: Vec<Shape>,
}

impl Sheet {
    /// A sheet with a title; its height grows.
    ///
    /// # Errors
    /// If the font cannot be read.
    pub fn new(width: f64, title: &str) -> Result<Sheet, PlotError> {
        let mut sheet = Sheet {
            width,
            height: MARGIN,
            shapes: Vec::new(),
        };
        sheet.paragraph(&[title.to_owned()], TITLE, BLACK)?;
        Ok(sheet)
    }

    /// Adds text at the bottom, wrapped.
    ///
    /// # Errors
    /// If the font cannot be read.
    pub fn paragraph(
        &mut self,
        lines: &[String],
        size: f64,
        colour: Colour,
    ) -> Result<(), PlotError> {
        for line in broken(lines, size, self.width - 2.0 * MARGIN)? {
            let at = (MARGIN, self.height + 0.7 * size);
            self.put(at, line, (size, colour, Anchor::Left));
            self.height += 1.4 * size;
        }
        self.height += 0.4 * size;
        Ok(())
    }

    /// Adds a text next to a point, centred on its height.
    pub fn text(&mut self, at: (f64, f64), text: &str, size: f64, colour: Colour, anchor: Anchor) {
        self.put(at, label(text), (size, colour, anchor));
    }

    fn put(&mut self, at: (f64, f64), text: String, (size, colour, anchor): (f64, Colour, Anchor)) {
        let text = shown::line(&text).into_owned();
        self.shapes.push(Shape::Text(TextLine {
            anchor,
            ..TextLine::new(at, text, size, colour)
        }));
    }

    /// Adds a vertical text around a point, reading upwards.
    pub fn upright(&mut self, at: (f64, f64), text: &str, size: f64) {
        self.shapes.push(Shape::Text(TextLine {
            anchor: Anchor::Middle,
            upright: true,
            ..TextLine::new(at, label(text), size, BLACK)
        }));
    }

    /// Adds a polyline.
    pub fn line(&mut self, points: &[(f64, f64)], width: f64, colour: Colour) {
        self.shapes.push(Shape::Line {
            points: points.to_vec(),
            width,
            colour,
        });
    }

    /// A filled shape.
    pub fn fill(&mut self, corners: &[(f64, f64)], colour: Colour) {
        self.shapes.push(Shape::Fill {
            corners: corners.to_vec(),
            colour,
        });
    }

    /// Adds a filled rectangle: its upper left corner and its size.
    pub fn bar(&mut self, (x, y): (f64, f64), (width, height): (f64, f64), colour: Colour) {
        let (right, low) = (x + width, y + height);
        self.fill(&[(x, y), (right, y), (right, low), (x, low)], colour);
    }

    /// Adds one of five kinds of markers.
    pub fn marker(&mut self, (x, y): (f64, f64), kind: usize, r: f64, colour: Colour) {
        let far = 1.3 * r;
        let corners: Vec<(f64, f64)> = match kind % 5 {
            0 => (0..16)
                .map(|k| f64::from(k) * std::f64::consts::TAU / 16.0)
                .map(|a| (r * a.cos(), r * a.sin()))
                .collect(),
            1 => vec![(-r, -r), (r, -r), (r, r), (-r, r)],
            2 => vec![(0.0, -far), (far, r), (-far, r)],
            3 => vec![(0.0, -far), (far, 0.0), (0.0, far), (-far, 0.0)],
            _ => vec![(0.0, far), (far, -r), (-far, -r)],
        };
        let corners: Vec<_> = corners.iter().map(|c| (x + c.0, y + c.1)).collect();
        self.fill(&corners, colour);
    }

    /// Adds the line of series number k; every second one is dashed, so that both of two equal series are
    /// visible.
    pub fn stroke(&mut self, points: &[(f64, f64)], width: f64, k: usize) {
        let colour = COLOURS[k % COLOURS.len()];
        match k % 2 {
            _ if points.len() < 2 => {}
            0 => self.line(points, width, colour),
            _ => self.dashed(points, width, colour),
        }
    }

    /// Adds the marker of series number k: 35 series have different markers.
    pub fn series_marker(&mut self, at: (f64, f64), k: usize) {
        self.marker(at, k, 4.0, COLOURS[k % COLOURS.len()]);
    }

    /// Adds the legend entry of series number k.
    pub fn entry(&mut self, (left, y): (f64, f64), k: usize, label: &str) {
        self.stroke(&[(left, y), (left + 28.0, y)], 2.0, k);
        self.series_marker((left + 14.0, y), k);
        self.text((left + 36.0, y), label, LABEL, BLACK, Anchor::Left);
    }

    /// Adds a marker with a dark border, visible on any background.
    pub fn ringed(&mut self, at: (f64, f64), kind: usize, r: f64, inside: Colour) {
        self.marker(at, kind, r + 1.6, BLACK);
        self.marker(at, kind, r, inside);
    }

    /// Adds a dashed line.
    pub fn dashed(&mut self, points: &[(f64, f64)], width: f64, colour: Colour) {
        const DASH: f64 = 6.0;
        let mut walked = 0.0;
        for pair in points.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let length = (to.0 - from.0).hypot(to.1 - from.1);
            if !(length > 0.0 && length < 1e5) {
                continue;
            }
            let at = |s: f64| {
                let part = s / length;
                (
                    from.0 + part * (to.0 - from.0),
                    from.1 + part * (to.1 - from.1),
                )
            };
            let mut s = -(walked % (2.0 * DASH));
            while s < length {
                let (begin, end) = (s.max(0.0), (s + DASH).min(length));
                if begin < end {
                    self.line(&[at(begin), at(end)], width, colour);
                }
                s += 2.0 * DASH;
            }
            walked += length;
        }
    }

    /// Adds a line from a point to its label, if that is further away than `reach`.
    pub fn leader(&mut self, at: (f64, f64), label: &Patch, reach: f64) {
        let near = (
            at.0.clamp(label.from.0, label.to.0),
            at.1.clamp(label.from.1, label.to.1),
        );
        if (near.0 - at.0).hypot(near.1 - at.1) > reach {
            self.line(&[at, near], 0.6, GREY);
        }
    }

    /// Adds an arrow; a short one consists only of its head.
    pub fn arrow(&mut self, from: (f64, f64), to: (f64, f64), width: f64, colour: Colour) {
        let (x, y) = (to.0 - from.0, to.1 - from.1);
        let length = x.hypot(y);
        if !(length > 0.0 && length.is_finite()) {
            return;
        }
        let (x, y) = (x / length, y / length);
        let head = (4.0 * width).min(length);
        let neck = (to.0 - head * x, to.1 - head * y);
        self.line(&[from, neck], width, colour);
        let side = 0.42 * head;
        let corners = [
            to,
            (neck.0 - side * y, neck.1 + side * x),
            (neck.0 + side * y, neck.1 - side * x),
        ];
        self.fill(&corners, colour);
    }

    /// Adds the cross of a failure.
    pub fn cross(&mut self, (x, y): (f64, f64), r: f64, colour: Colour) {
        self.line(&[(x - r, y - r), (x + r, y + r)], 2.5, colour);
        self.line(&[(x - r, y + r), (x + r, y - r)], 2.5, colour);
    }

    /// The drawing as SVG.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn svg(&self) -> Result<String, PlotError> {
        pen::svg(&self.shapes, self.size())
    }

    /// The drawing as PNG, with this many pixels per unit of length.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn png(&self, pixels: f64) -> Result<Vec<u8>, PlotError> {
        pen::png(&self.shapes, self.size(), pixels)
    }

    /// The drawing with all lengths multiplied by a factor.
    pub fn scaled(mut self, factor: f64) -> Sheet {
        let point = |at: &mut (f64, f64)| *at = (factor * at.0, factor * at.1);
        for shape in &mut self.shapes {
            match shape {
                Shape::Text(text) => {
                    point(&mut text.at);
                    text.size *= factor;
                }
                Shape::Line { points, width, .. } => {
                    points.iter_mut().for_each(point);
                    *width *= factor;
                }
                Shape::Fill { corners, .. } => corners.iter_mut().for_each(point),
            }
        }
        let height = factor * (self.height + MARGIN) - MARGIN;
        let width = factor * self.width;
        Sheet {
            width,
            height,
            ..self
        }
    }

    fn size(&self) -> (f64, f64) {
        (self.width, self.height + MARGIN)
    }
}

/// Wraps lines to a width, between words; longer words are split.
fn broken(lines: &[String], size: f64, width: f64) -> Result<Vec<String>, PlotError> {
    let mut all = Vec::new();
    for line in lines {
        let line = shown::cut(line, MAX_LINE);
        let mut words: Vec<String> = line.split_whitespace().map(label).collect();
        if words.is_empty() {
            words.push(String::new());
        }
        let fits = |line: &str| Ok(1.06 * width_of(line, size)? <= width);
        all.extend(shown::wrapped(words, fits)?);
    }
    Ok(all)
}

/// Width of the widest text; a reader's font may be slightly wider than ours.
///
/// # Errors
/// If the font cannot be read.
pub fn widest<'a>(texts: impl IntoIterator<Item = &'a str>, size: f64) -> Result<f64, PlotError> {
    let mut widest: f64 = 0.0;
    for text in texts {
        widest = widest.max(1.06 * width_of(&label(text), size)?);
    }
    Ok(widest)
}
