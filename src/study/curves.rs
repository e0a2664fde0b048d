//! Curves over two axes, and their drawing.
//!
//! The width of a drawing grows with the longest legend entry, its height with their number, so that nothing is
//! cut off.

use super::drawn::PlotError;
use super::linear_axis;
use super::log_axis::range;
use super::sheet::{Anchor, Axes, BLACK, CROSS, ENTRY, GREY, LABEL, MARGIN, SMALL, Sheet, widest};
use stickslip_scene::sig6;

/// Size of the plot without axis labels, and its left edge.
const PLOT: (f64, f64) = (620.0, 440.0);
const LEFT: f64 = 96.0;
/// Maximum number of curves in the legend, for readability.
const MOST_ENTRIES: usize = 48;
/// Approximate number of markers on a curve.
const MARKERS: usize = 12;

/// Curves over two axes.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveChart {
    /// Above it.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Its curves, in the order of the legend.
    pub curves: Vec<Curve>,
    /// Lines below the chart that describe its origin; long ones are wrapped.
    pub footer: Vec<String>,
}

/// An axis of a chart.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// What it is called.
    pub name: String,
    /// Whether it counts something: then it starts at zero and has only whole numbers.
    pub counts: bool,
}

/// A line with markers, and an entry of the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Text in the legend.
    pub label: String,
    /// Its points; all finite.
    pub points: Vec<(f64, f64)>,
    /// How the curve ends.
    pub end: CurveEnd,
}

/// How a curve ends.
#[derive(Debug, Clone, PartialEq)]
pub enum CurveEnd {
    /// At its planned end.
    Whole,
    /// At a failure, with the reason: drawn as a cross, and noted in the legend.
    Failed(String),
    /// Interrupted, with the reason: noted in the legend.
    Stopped(String),
}

impl CurveEnd {
    fn why(&self) -> Option<&str> {
        match self {
            CurveEnd::Whole => None,
            CurveEnd::Failed(why) | CurveEnd::Stopped(why) => Some(why),
        }
    }
}

impl CurveChart {
    /// The chart as a drawing.
    ///
    /// # Errors
    /// If the font cannot be read.
    pub fn sheet(&self) -> Result<Sheet, PlotError> {
        let named = if self
            .curves
            .iter()
            .any(|c| !c.label.is_empty() || c.end != CurveEnd::Whole)
        {
            &self.curves[..self.curves.len().min(MOST_ENTRIES)]
        } else {
            &[]
        };
        let labels = widest(named.iter().map(|c| c.label.as_str()), LABEL)?;
        let words = widest(named.iter().filter_map(|c| c.end.why()), SMALL)?;
        let legend = match named {
            [] => 0.0,
            _ => 36.0 + MARGIN + labels.max(words),
        };
        let mut sheet = Sheet::new(LEFT + PLOT.0 + 2.0 * MARGIN + legend, &self.title)?;
        let top = sheet.height;
        let place = self.curves(&mut sheet, top);
        // RandomProblem last, so that no line hides a failure.
        for curve in &self.curves {
            if let (CurveEnd::Failed(_), Some(end)) = (&curve.end, curve.points.last()) {
                sheet.cross(place(end), 7.0, CROSS);
            }
        }
        let bottom = self.legend(&mut sheet, named, top);
        sheet.height = bottom.max(top + PLOT.1 + 4.2 * LABEL);
        sheet.paragraph(&self.footer, SMALL, GREY)?;
        Ok(sheet)
    }

    /// Draws axes and curves; returns the function that positions points.
    fn curves(&self, sheet: &mut Sheet, top: f64) -> impl Fn(&(f64, f64)) -> (f64, f64) + use<> {
        let all = || self.curves.iter().flat_map(|c| &c.points);
        let x = bounds(&self.x, all().map(|p| p.0));
        let y = bounds(&self.y, all().map(|p| p.1));
        let part = |v: f64, (low, high): (f64, f64)| (v - low) / (high - low);
        let axes = Axes {
            name: MARGIN,
            left: LEFT,
            top,
            size: PLOT,
        };
        axes.draw(
            sheet,
            (
                &self.x.name,
                ticks(&self.x, x).map(|v| (part(v, x), sig6(v))),
            ),
            (
                &self.y.name,
                ticks(&self.y, y).map(|v| (part(v, y), sig6(v))),
            ),
        );
        let place = move |p: &(f64, f64)| axes.at(part(p.0, x), part(p.1, y));
        for (k, curve) in self.curves.iter().enumerate() {
            let points: Vec<(f64, f64)> = curve.points.iter().map(&place).collect();
            sheet.stroke(&points, 2.0, k);
            // Markers are staggered, so that both of two equal curves are visible.
            let every = points.len().div_ceil(MARKERS).max(1);
            let first = every * k / self.curves.len();
            for at in points.into_iter().skip(first).step_by(every) {
                sheet.series_marker(at, k);
            }
        }
        place
    }

    /// Draws the legend, and returns its lower edge.
    fn legend(&self, sheet: &mut Sheet, named: &[Curve], top: f64) -> f64 {
        let left = LEFT + PLOT.0 + MARGIN;
        let mut y = top + 0.5 * ENTRY;
        for (k, curve) in named.iter().enumerate() {
            sheet.entry((left, y), k, &curve.label);
            y += ENTRY;
            let Some(why) = curve.end.why() else { continue };
            y -= 0.1 * ENTRY;
            if matches!(curve.end, CurveEnd::Failed(_)) {
                sheet.cross((left + 14.0, y), 5.0, CROSS);
            }
            sheet.text((left + 36.0, y), why, SMALL, GREY, Anchor::Left);
            y += ENTRY;
        }
        let hidden = self.curves.len() - named.len();
        if hidden > 0 && !named.is_empty() {
            let more = format!("and {hidden} more");
            sheet.text((left + 36.0, y), &more, LABEL, BLACK, Anchor::Left);
        }
        y + MARGIN
    }
}

/// The range of an axis, with a small margin.
fn bounds(axis: &Axis, values: impl Iterator<Item = f64>) -> (f64, f64) {
    let zero = axis.counts.then_some(0.0);
    let (low, high) = range(values.chain(zero)).unwrap_or((0.0, 1.0));
    let air = match high - low {
        0.0 => 0.5 * low.abs().max(1.0),
        range => 0.04 * range,
    };
    (if axis.counts { 0.0 } else { low - air }, high + air)
}

/// At most nine round numbers within the range of an axis.
fn ticks(axis: &Axis, range: (f64, f64)) -> impl Iterator<Item = f64> + use<> {
    const MOST: f64 = 9.0;
    let step = linear_axis::step(range, MOST);
    let step = if axis.counts { step.max(1.0) } else { step };
    linear_axis::ticks(range, step)
}
