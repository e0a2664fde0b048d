//! Work-precision charts as pictures: error over cost, both logarithmic.
//!
//! Failed runs are on a rail above the plot, at their cost until the failure, and are listed below it. Each run
//! is labelled with its values or, if there is no room, with a number that is explained below. Errors at
//! round-off share one line.

use super::drawn::PlotError;
use super::log_axis::{LogAxis, written};
use super::placing::{OccupiedArea, Patch};
use super::precision::{Point, Precision, ROUND_OFF};
use super::sheet::{Anchor, Axes, BLACK, CROSS, ENTRY, GREY, LABEL, MARGIN, SMALL, Sheet, widest};

/// Size of the plot, without axis labels.
const PLOT: (f64, f64) = (620.0, 420.0);
/// Height of the rail of failures.
const RAIL: f64 = 44.0;
/// Left edge of the plot.
const LEFT: f64 = 84.0;
/// Maximum number of failed runs listed below the plot.
const MOST_FAILED: usize = 40;
/// Draws charts below each other.
///
/// # Errors
/// If the font cannot be read.
pub fn sheet(charts: &[Precision]) -> Result<Sheet, PlotError> {
    let names = charts.iter().flat_map(|c| &c.series).map(String::as_str);
    let legend = widest(names, LABEL)?;
    let title = match charts {
        [one] => format!("Work and precision: {}", one.title),
        many => format!("Work and precision of {} scenes", many.len()),
    };
    let width = LEFT + PLOT.0 + 4.0 * MARGIN + legend.max(120.0) + MARGIN;
    let mut sheet = Sheet::new(width, &title)?;
    for chart in charts {
        if charts.len() > 1 {
            sheet.paragraph(std::slice::from_ref(&chart.title), LABEL, BLACK)?;
        }
        draw(&mut sheet, chart)?;
    }
    Ok(sheet)
}

/// Maps costs and errors to the sheet.
struct Frame {
    x: LogAxis,
    y: LogAxis,
    axes: Axes,
}

impl Frame {
    fn at(&self, cost: f64, error: f64) -> (f64, f64) {
        let error = error.max(ROUND_OFF);
        self.axes.at(self.x.part(cost), self.y.part(error))
    }

    /// Position of a run: in the plot, on the rail, or (the reference itself) at the bottom.
    fn place(&self, chart: &Precision, point: &Point) -> (f64, f64) {
        let part = self.x.part(chart.cost.of(point));
        match (point.error, &point.failed) {
            (Some(error), _) => self.at(chart.cost.of(point), error),
            (None, Some(_)) => (self.axes.at(part, 1.0).0, self.axes.top - 0.5 * RAIL - 3.0),
            (None, None) => self.axes.at(part, 0.0),
        }
    }
}

fn draw(sheet: &mut Sheet, chart: &Precision) -> Result<(), PlotError> {
    let top = sheet.height + RAIL;
    let errors = chart.points.iter().filter_map(|p| p.error);
    let frame = Frame {
        x: LogAxis::new(chart.points.iter().map(|p| chart.cost.of(p))),
        y: LogAxis::new(errors.map(|e| e.max(ROUND_OFF)).chain(chart.target)),
        axes: Axes {
            name: MARGIN,
            left: LEFT,
            top,
            size: PLOT,
        },
    };
    rail(sheet);
    axes(sheet, chart, &frame);
    let mut taken = OccupiedArea::within(Patch {
        from: (LEFT + 2.0, top - RAIL),
        to: (LEFT + PLOT.0 - 2.0, top + PLOT.1 - 2.0),
    });
    if let Some(target) = chart.target {
        let words = format!("target {target:?}");
        level(sheet, &frame, target, &words, &mut taken)?;
    }
    if chart.points.iter().any(Point::is_round_off) {
        let words = format!(
            "round-off: below {}, treated as equal",
            written(short(ROUND_OFF))
        );
        level(sheet, &frame, ROUND_OFF, &words, &mut taken)?;
    }
    front(sheet, chart, &|cost, error| frame.at(cost, error));
    for k in 0..chart.series.len() {
        series(sheet, chart, k, &frame, &mut taken);
    }
    let key = labels(sheet, chart, &frame, &mut taken)?;
    legend(sheet, chart, top);
    sheet.height = top + PLOT.1 + 4.2 * LABEL;
    sheet.paragraph(&key, SMALL, BLACK)?;
    let failed = || chart.points.iter().filter(|p| p.failed.is_some());
    for point in failed().take(MOST_FAILED) {
        let why = point.failed.as_deref().unwrap_or_default();
        let line = format!("✗ {}, {}: {why}", chart.series[point.series], point.name);
        sheet.paragraph(&[line], SMALL, CROSS)?;
    }
    if let Some(more @ 1..) = failed().count().checked_sub(MOST_FAILED) {
        sheet.paragraph(&[format!("✗ and {more} more")], SMALL, CROSS)?;
    }
    let lines: Vec<String> = chart.verdict().into_iter().collect();
    sheet.paragraph(&lines, SMALL, BLACK)?;
    sheet.paragraph(&chart.about, SMALL, GREY)
}

/// Rounds a number to two digits.
fn short(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// Draws a line at an error, with text at its right end.
fn level(
    sheet: &mut Sheet,
    frame: &Frame,
    error: f64,
    words: &str,
    taken: &mut OccupiedArea,
) -> Result<(), PlotError> {
    let (_, height) = frame.at(1.0, error);
    sheet.dashed(&[(LEFT, height), (LEFT + PLOT.0, height)], 1.2, GREY);
    let end = (LEFT + PLOT.0 - 4.0, height - 9.0);
    sheet.text(end, words, SMALL, GREY, Anchor::Right);
    let wide = widest([words], SMALL)?;
    let middle = (end.0 - 0.5 * wide, end.1);
    taken.take(Patch::about(middle, (wide, 1.2 * SMALL)));
    Ok(())
}

/// Draws the rail of failures.
fn rail(sheet: &mut Sheet) {
    let top = sheet.height;
    sheet.bar((LEFT, top), (PLOT.0, RAIL - 6.0), (250, 240, 240));
    let words = (LEFT - 8.0, top + 0.5 * (RAIL - 6.0));
    sheet.text(words, "failed", SMALL, BLACK, Anchor::Right);
}

fn axes(sheet: &mut Sheet, chart: &Precision, frame: &Frame) {
    let error = match chart.monitors.as_slice() {
        [] => "error".to_owned(),
        some => format!("error of {} (relative to the largest)", some.join(", ")),
    };
    let numbers = |axis: LogAxis, most| {
        let ticks = axis.ticks(most).into_iter();
        ticks.map(move |value| (axis.part(value), written(value)))
    };
    frame.axes.draw(
        sheet,
        (chart.cost.axis(), numbers(frame.x, 9)),
        (&error, numbers(frame.y, 12)),
    );
}

/// Draws steps through the runs on the Pareto front.
fn front(sheet: &mut Sheet, chart: &Precision, at: &dyn Fn(f64, f64) -> (f64, f64)) {
    let mut best: Vec<(f64, f64)> = chart
        .points
        .iter()
        .filter(|p| p.front)
        .filter_map(|p| Some(at(chart.cost.of(p), p.error?)))
        .collect();
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut steps: Vec<(f64, f64)> = Vec::new();
    for &(x, y) in &best {
        if let Some(&(_, before)) = steps.last() {
            steps.push((x, before));
        }
        steps.push((x, y));
    }
    if steps.len() > 1 {
        sheet.line(&steps, 1.0, GREY);
    }
    for place in best {
        // A ring: the part not covered by the marker.
        sheet.marker(place, 0, 8.5, BLACK);
        sheet.marker(place, 0, 7.0, (255, 255, 255));
    }
}

fn series(sheet: &mut Sheet, chart: &Precision, k: usize, frame: &Frame, taken: &mut OccupiedArea) {
    let own: Vec<&Point> = chart.points.iter().filter(|p| p.series == k).collect();
    let whole: Vec<(f64, f64)> = own
        .iter()
        .filter_map(|p| Some(frame.at(chart.cost.of(p), p.error?)))
        .collect();
    sheet.stroke(&whole, 1.5, k);
    for pair in whole.windows(2) {
        taken.take_line(pair[0], pair[1]);
    }
    for point in own {
        let place = frame.place(chart, point);
        match point.failed.is_some() {
            true => sheet.cross(place, 5.0, CROSS),
            false => sheet.series_marker(place, k),
        }
        taken.take(Patch::about(place, (14.0, 14.0)));
    }
}

/// Labels runs with their values or, if there is no room, with numbers; returns the meaning of the numbers.
fn labels(
    sheet: &mut Sheet,
    chart: &Precision,
    frame: &Frame,
    taken: &mut OccupiedArea,
) -> Result<Vec<String>, PlotError> {
    /// Maximum distance of a label from its run, and of a number.
    const REACH: (f64, f64) = (30.0, 160.0);
    const SIZE: f64 = 11.5;
    let mut key: Vec<String> = Vec::new();
    for point in &chart.points {
        let at = frame.place(chart, point);
        let mut words = values(&point.name);
        if point.reference {
            words += " reference";
        }
        let number = format!("({})", key.len() + 1);
        for (text, reach) in [(&words, REACH.0), (&number, REACH.1)] {
            let size = (widest([text.as_str()], SIZE)? + 3.0, 1.15 * SIZE);
            let Some(patch) = taken.place(at, size, reach) else {
                continue;
            };
            sheet.leader(at, &patch, 16.0);
            sheet.text(patch.middle(), text, SIZE, BLACK, Anchor::Middle);
            if *text == number {
                key.push(format!("{number} {}, {words}", chart.series[point.series]));
            }
            break;
        }
    }
    match key.is_empty() {
        true => Ok(key),
        false => Ok(vec![key.join(";  ")]),
    }
}

/// The values only: `refine=2, increment=0.1` gives `2, 0.1`.
fn values(name: &str) -> String {
    let value = |pair: &str| pair.rsplit('=').next().unwrap_or(pair).to_owned();
    name.split(", ").map(value).collect::<Vec<_>>().join(", ")
}

fn legend(sheet: &mut Sheet, chart: &Precision, top: f64) {
    let left = LEFT + PLOT.0 + MARGIN;
    let line = |k: usize| top + 14.0 + ENTRY * k as f64;
    for (k, name) in chart.series.iter().enumerate() {
        sheet.entry((left, line(k)), k, name);
    }
    let y = line(chart.series.len());
    sheet.marker((left + 14.0, y), 0, 8.5, BLACK);
    sheet.marker((left + 14.0, y), 0, 7.0, (255, 255, 255));
    sheet.text(
        (left + 36.0, y),
        "on the Pareto front",
        LABEL,
        BLACK,
        Anchor::Left,
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_labelled_by_its_values() {
        assert_eq!(values("refine=2, increment=0.1"), "2, 0.1");
        assert_eq!(values("plain"), "plain");
    }
}
