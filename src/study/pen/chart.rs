//! Curves over two axes as SVG and PNG.
//!
//! A chart is wider the longer its legend, and higher the more of it there is, so that nothing is cut off.

use super::font::{FONT, broken, load_font, width_of};
use super::pixels::{PNG_SCALE, bitmap, encode, paper};
use crate::explain::number::six;
use crate::study::drawn::{Axis, Chart, Curve, CurveEnd, PlotError, label};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

const PLOT: (f64, f64) = (720.0, 520.0);
const MARGIN: f64 = 14.0;
const TITLE: f64 = 22.0;
const LABEL: f64 = 17.0;
const TICK: f64 = 15.0;
const SMALL: f64 = 13.0;
/// Height of a line of the legend.
const ENTRY: f64 = 22.0;
/// Length of a legend's piece of line.
const SAMPLE: f64 = 36.0;
/// Curves named in the legend; a taller one is of no use.
const MOST_ENTRIES: usize = 48;
/// Markers on a curve, about.
const MARKERS: usize = 12;
const GREY: RGBColor = RGBColor(90, 90, 90);
/// The colour of crosses, and of nothing else.
const CROSS: RGBColor = RGBColor(192, 0, 0);
/// Colours that colour-blind readers can tell apart (Okabe and Ito), without the yellow that white paper swallows.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(60, 60, 60),
    RGBColor(86, 180, 233),
    RGBColor(213, 94, 0),
];

type Failure<DB> = DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>;
type Area<DB> = DrawingArea<DB, Shift>;

/// The chart as SVG.
///
/// # Errors
/// If it cannot be drawn.
pub fn svg(chart: &Chart) -> Result<String, PlotError> {
    load_font()?;
    let chart = &labelled(chart);
    let layout = Layout::of(chart, 1.0)?;
    let mut text = String::new();
    let root = SVGBackend::with_string(&mut text, layout.size).into_drawing_area();
    draw(&root, chart, &layout).map_err(PlotError::new)?;
    drop(root);
    Ok(text)
}

/// The chart as PNG.
///
/// # Errors
/// If it cannot be drawn.
pub fn png(chart: &Chart) -> Result<Vec<u8>, PlotError> {
    load_font()?;
    let chart = &labelled(chart);
    let layout = Layout::of(chart, PNG_SCALE)?;
    let (width, height) = layout.size;
    let mut pixels = paper(width, height)?;
    let root = bitmap(&mut pixels, layout.size)?.into_drawing_area();
    draw(&root, chart, &layout).map_err(PlotError::new)?;
    drop(root);
    encode(&pixels, width, height).map_err(PlotError::new)
}

/// The chart with labels as they are drawn.
fn labelled(chart: &Chart) -> Chart {
    let mut chart = chart.clone();
    for axis in [&mut chart.x, &mut chart.y] {
        axis.name = label(&axis.name);
    }
    for curve in &mut chart.curves {
        curve.label = label(&curve.label);
        if let CurveEnd::Failed(why) | CurveEnd::Stopped(why) = &mut curve.end {
            *why = label(why);
        }
    }
    chart
}

/// Where everything goes, in pixels.
struct Layout {
    scale: f64,
    size: (u32, u32),
    /// Lines above and below the plot.
    title: Vec<String>,
    footer: Vec<String>,
    /// Curves named in the legend; 0 if there is nothing to tell apart.
    entries: usize,
}

impl Layout {
    fn of(chart: &Chart, scale: f64) -> Result<Layout, PlotError> {
        let told = chart
            .curves
            .iter()
            .any(|c| !c.label.is_empty() || c.end != CurveEnd::Whole);
        let entries = if told {
            chart.curves.len().min(MOST_ENTRIES)
        } else {
            0
        };
        let mut layout = Layout {
            scale,
            size: (0, 0),
            title: Vec::new(),
            footer: Vec::new(),
            entries,
        };
        let width = PLOT.0 + layout.legend_width(chart)?;
        layout.title = broken(
            std::slice::from_ref(&chart.title),
            TITLE,
            width - 4.0 * MARGIN,
        )?;
        layout.footer = broken(&chart.footer, SMALL, width - 4.0 * MARGIN)?;
        let height = PLOT.1.max(layout.legend_height(chart)) + layout.top() + layout.bottom();
        layout.size = (layout.pixels(width) as u32, layout.pixels(height) as u32);
        Ok(layout)
    }

    fn pixels(&self, length: f64) -> i32 {
        (length * self.scale).round() as i32
    }

    fn top(&self) -> f64 {
        2.0 * MARGIN + self.title.len() as f64 * TITLE * 1.3
    }

    fn bottom(&self) -> f64 {
        2.0 * MARGIN + self.footer.len() as f64 * SMALL * 1.4
    }

    fn legend_width(&self, chart: &Chart) -> Result<f64, PlotError> {
        let mut widest: f64 = 0.0;
        for curve in &chart.curves[..self.entries] {
            widest = widest.max(width_of(&curve.label, TICK)?);
            if let CurveEnd::Failed(why) | CurveEnd::Stopped(why) = &curve.end {
                widest = widest.max(width_of(why, SMALL)?);
            }
        }
        Ok(match self.entries {
            0 => 0.0,
            // A reader's own font may be a little wider than ours.
            _ => SAMPLE + 3.0 * MARGIN + 1.06 * widest,
        })
    }

    fn legend_height(&self, chart: &Chart) -> f64 {
        let lines = |curve: &Curve| {
            if curve.end == CurveEnd::Whole {
                1.0
            } else {
                1.9
            }
        };
        let lines: f64 = chart.curves[..self.entries].iter().map(lines).sum();
        let more = if self.entries < chart.curves.len() {
            1.0
        } else {
            0.0
        };
        (lines + more) * ENTRY + 2.0 * MARGIN
    }

    fn font(&self, size: f64) -> TextStyle<'static> {
        (FONT, size * self.scale).into_font().color(&BLACK)
    }
}

fn draw<DB: DrawingBackend>(
    root: &Area<DB>,
    chart: &Chart,
    layout: &Layout,
) -> Result<(), Failure<DB>> {
    root.fill(&WHITE)?;
    texts(root, layout)?;
    let (width, height) = layout.size;
    let (top, bottom) = (layout.pixels(layout.top()), layout.pixels(layout.bottom()));
    let body = root
        .clone()
        .shrink((0, top), (width, height - (top + bottom) as u32));
    let (left, _) = body.split_horizontally(layout.pixels(PLOT.0));
    curves(root, &left, chart, layout)?;
    if layout.entries > 0 {
        legend(root, chart, layout)?;
    }
    root.present()
}

/// Title and footer.
fn texts<DB: DrawingBackend>(root: &Area<DB>, layout: &Layout) -> Result<(), Failure<DB>> {
    let left = layout.pixels(2.0 * MARGIN);
    let at = Pos::new(HPos::Left, VPos::Center);
    for (k, line) in layout.title.iter().enumerate() {
        let y = layout.pixels(1.5 * MARGIN + (k as f64 + 0.5) * TITLE * 1.3);
        let style = layout.font(TITLE).pos(at);
        root.draw(&Text::new(line.as_str(), (left, y), style))?;
    }
    let start = f64::from(layout.size.1) / layout.scale - layout.bottom() + 0.8 * MARGIN;
    for (k, line) in layout.footer.iter().enumerate() {
        let y = layout.pixels(start + (k as f64 + 0.5) * SMALL * 1.4);
        let style = layout.font(SMALL).color(&GREY).pos(at);
        root.draw(&Text::new(line.as_str(), (left, y), style))?;
    }
    Ok(())
}

/// Axes and curves.
///
/// Every other curve is dashed, so that two that agree are both seen.
fn curves<DB: DrawingBackend>(
    root: &Area<DB>,
    area: &Area<DB>,
    chart: &Chart,
    layout: &Layout,
) -> Result<(), Failure<DB>> {
    let all = || chart.curves.iter().flat_map(|c| &c.points);
    let x = bounds(&chart.x, all().map(|p| p.0));
    let y = bounds(&chart.y, all().map(|p| p.1));
    let mut plot = ChartBuilder::on(area)
        .margin(layout.pixels(MARGIN))
        .x_label_area_size(layout.pixels(3.4 * LABEL))
        .y_label_area_size(layout.pixels(4.8 * LABEL))
        .build_cartesian_2d(x.0..x.1, y.0..y.1)?;
    plot.configure_mesh()
        .x_desc(&chart.x.name)
        .y_desc(&chart.y.name)
        .x_labels(9)
        .y_labels(9)
        .max_light_lines(0)
        .x_label_formatter(&|at| tick(&chart.x, *at, x.1 - x.0))
        .y_label_formatter(&|at| tick(&chart.y, *at, y.1 - y.0))
        .label_style(layout.font(TICK))
        .axis_desc_style(layout.font(LABEL))
        .axis_style(BLACK.stroke_width(layout.pixels(1.0) as u32))
        .bold_line_style(BLACK.mix(0.12).stroke_width(layout.pixels(1.0) as u32))
        .draw()?;
    for (k, curve) in chart.curves.iter().enumerate() {
        let (style, points) = (stroke(k, layout), curve.points.iter().copied());
        if dashed(k) {
            let (dash, gap) = (layout.pixels(8.0), layout.pixels(5.0));
            plot.draw_series(DashedLineSeries::new(points, dash, gap, style))?;
        } else {
            plot.draw_series(LineSeries::new(points, style))?;
        }
        for at in marked(k, curve, chart.curves.len()) {
            marker(root, k, plot.backend_coord(at), layout)?;
        }
    }
    // Above all lines, so that none hides a failure.
    for curve in &chart.curves {
        if let (CurveEnd::Failed(_), Some(end)) = (&curve.end, curve.points.last()) {
            cross(root, plot.backend_coord(end), 7.0, layout)?;
        }
    }
    Ok(())
}

/// Some points of a curve. Curves take turns, so that the markers of two that agree are both seen.
fn marked(k: usize, curve: &Curve, of: usize) -> impl Iterator<Item = &(f64, f64)> {
    let every = curve.points.len().div_ceil(MARKERS).max(1);
    let first = every * k / of.max(1);
    curve.points.iter().skip(first).step_by(every)
}

fn legend<DB: DrawingBackend>(
    root: &Area<DB>,
    chart: &Chart,
    layout: &Layout,
) -> Result<(), Failure<DB>> {
    let text = layout.font(TICK).pos(Pos::new(HPos::Left, VPos::Center));
    let small = layout.font(SMALL).pos(Pos::new(HPos::Left, VPos::Center));
    let left = PLOT.0 + MARGIN / 2.0;
    let middle = layout.pixels(left + SAMPLE / 2.0);
    let words = layout.pixels(left + SAMPLE + MARGIN / 2.0);
    let mut y = layout.top() + 1.5 * MARGIN;
    for (k, curve) in chart.curves[..layout.entries].iter().enumerate() {
        let row = layout.pixels(y);
        sample(root, k, (layout.pixels(left), row), layout)?;
        marker(root, k, (middle, row), layout)?;
        root.draw(&Text::new(curve.label.as_str(), (words, row), text.clone()))?;
        y += ENTRY;
        if let CurveEnd::Failed(why) | CurveEnd::Stopped(why) = &curve.end {
            let row = layout.pixels(y - 0.1 * ENTRY);
            if matches!(curve.end, CurveEnd::Failed(_)) {
                cross(root, (middle, row), 5.0, layout)?;
            }
            root.draw(&Text::new(why.as_str(), (words, row), small.color(&GREY)))?;
            y += 0.9 * ENTRY;
        }
    }
    let hidden = chart.curves.len() - layout.entries;
    if hidden > 0 {
        let more = format!("and {hidden} more");
        root.draw(&Text::new(more, (words, layout.pixels(y)), text))?;
    }
    Ok(())
}

/// A piece of a curve's line.
fn sample<DB: DrawingBackend>(
    root: &Area<DB>,
    k: usize,
    (left, y): (i32, i32),
    layout: &Layout,
) -> Result<(), Failure<DB>> {
    let pieces: &[(f64, f64)] = match dashed(k) {
        true => &[(0.0, 8.0), (13.0, 21.0), (26.0, SAMPLE)],
        false => &[(0.0, SAMPLE)],
    };
    for &(from, to) in pieces {
        let piece = vec![
            (left + layout.pixels(from), y),
            (left + layout.pixels(to), y),
        ];
        root.draw(&PathElement::new(piece, stroke(k, layout)))?;
    }
    Ok(())
}

/// The range of an axis, with some air.
fn bounds(axis: &Axis, values: impl Iterator<Item = f64>) -> (f64, f64) {
    let zero = axis.counts.then_some(0.0);
    let all = values.chain(zero).fold(None, |all: Option<(f64, f64)>, v| {
        Some(all.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
    });
    let (low, high) = all.unwrap_or((0.0, 1.0));
    let air = match high - low {
        0.0 => 0.5 * low.abs().max(1.0),
        range => 0.04 * range,
    };
    (if axis.counts { 0.0 } else { low - air }, high + air)
}

/// The number at a tick of an axis of that length.
fn tick(axis: &Axis, at: f64, length: f64) -> String {
    // Ticks are summed up: zero is missed by round-off.
    const ZERO: f64 = 1e-9;
    let at = if at.abs() < ZERO * length { 0.0 } else { at };
    match axis.counts && at.fract() != 0.0 {
        true => String::new(),
        false => six(at),
    }
}

fn colour(k: usize) -> RGBColor {
    COLOURS[k % COLOURS.len()]
}

fn dashed(k: usize) -> bool {
    k % 2 == 1
}

fn stroke(k: usize, layout: &Layout) -> ShapeStyle {
    colour(k).stroke_width(layout.pixels(2.0) as u32)
}

/// Seven colours and five shapes: 35 curves before two look the same.
fn marker<DB: DrawingBackend>(
    root: &Area<DB>,
    k: usize,
    (x, y): (i32, i32),
    layout: &Layout,
) -> Result<(), Failure<DB>> {
    let (style, r) = (colour(k).filled(), layout.pixels(4.0));
    let far = layout.pixels(5.3);
    let corners = match k % 5 {
        0 => return root.draw(&Circle::new((x, y), r, style)),
        1 => vec![(-r, -r), (r, -r), (r, r), (-r, r)],
        2 => vec![(0, -far), (far, r), (-far, r)],
        3 => vec![(0, -far), (far, 0), (0, far), (-far, 0)],
        _ => vec![(0, far), (far, -r), (-far, -r)],
    };
    let corners: Vec<_> = corners.iter().map(|c| (x + c.0, y + c.1)).collect();
    root.draw(&Polygon::new(corners, style))
}

/// The mark of a failure.
fn cross<DB: DrawingBackend>(
    root: &Area<DB>,
    (x, y): (i32, i32),
    size: f64,
    layout: &Layout,
) -> Result<(), Failure<DB>> {
    let (r, width) = (layout.pixels(size), layout.pixels(2.5) as u32);
    for rise in [-r, r] {
        let stroke = vec![(x - r, y - rise), (x + r, y + rise)];
        root.draw(&PathElement::new(stroke, CROSS.stroke_width(width)))?;
    }
    Ok(())
}
