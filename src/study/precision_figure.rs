//! Work-precision charts as pictures: error over cost, or cost over error, both logarithmic.
//!
//! Contact forces have a second panel. Failed runs are drawn on a rail next to the plot, at their cost until the failure, and listed
//! below it. Each run is labelled with its values or, if there is no room, with a number that is explained below. A bar through a
//! run shows the spread of its times. A triangle shows the slope of the last step of the first series. Errors at round-off
//! share one line; the error bar of the reference is another one.

use super::drawn::PlotError;
use super::log_axis::{LogAxis, written};
use super::placing::{OccupiedArea, Patch};
use super::precision::{Cost, Point, Precision, ROUND_OFF, TIE};
use super::sheet::{Anchor, Axes, BLACK, CROSS, ENTRY, GREY, LABEL, MARGIN, SMALL, Sheet, widest};
use stickslip_scene::{joined, sig2};

/// Size of the plot, without axis labels.
const PLOT: (f64, f64) = (620.0, 420.0);
/// Width of the rail of failures.
const RAIL: f64 = 44.0;
/// Left edge of the plot.
const LEFT: f64 = 84.0;
/// Maximum number of failed runs listed below the plot.
const MOST_FAILED: usize = 40;

/// Draws charts below each other; with `error_on_x` with the error on the horizontal axis.
///
/// # Errors
/// If the font cannot be read.
pub fn sheet(charts: &[Precision], error_on_x: bool) -> Result<Sheet, PlotError> {
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
        draw(&mut sheet, chart, error_on_x)?;
    }
    Ok(sheet)
}

/// One plot of a chart: maps costs and errors to the sheet.
struct ErrorPanel<'a> {
    chart: &'a Precision,
    is_force: bool,
    error_on_x: bool,
    cost: LogAxis,
    error: LogAxis,
    axes: Axes,
}

impl ErrorPanel<'_> {
    /// A plot below the rest of a sheet.
    fn new(chart: &Precision, top: f64, is_force: bool, error_on_x: bool) -> ErrorPanel<'_> {
        let errors = chart
            .points
            .iter()
            .filter_map(|p| if is_force { p.force_error } else { p.error });
        let levels = chart
            .target
            .filter(|_| !is_force)
            .into_iter()
            .chain(chart.uncertainty[usize::from(is_force)]);
        let spread = chart
            .points
            .iter()
            .filter_map(|p| p.spread)
            .filter(|_| chart.cost == Cost::Time);
        let costs = chart.points.iter().map(|p| chart.cost.of(p));
        let rail = if error_on_x { 0.0 } else { RAIL };
        ErrorPanel {
            chart,
            is_force,
            error_on_x,
            cost: LogAxis::new(costs.chain(spread.flat_map(|(least, most)| [least, most]))),
            error: LogAxis::new(errors.chain(levels).map(|e| e.max(ROUND_OFF))),
            axes: Axes {
                name: MARGIN,
                left: LEFT,
                top: top + rail,
                size: (PLOT.0 - (RAIL - rail), PLOT.1),
            },
        }
    }

    fn error_of(&self, point: &Point) -> Option<f64> {
        if self.is_force {
            point.force_error
        } else {
            point.error
        }
    }

    /// The point at these fractions of the two axes.
    fn at_parts(&self, cost: f64, error: f64) -> (f64, f64) {
        if self.error_on_x {
            self.axes.at(error, cost)
        } else {
            self.axes.at(cost, error)
        }
    }

    fn at(&self, cost: f64, error: f64) -> (f64, f64) {
        let error = self.error.part(error.max(ROUND_OFF));
        self.at_parts(self.cost.part(cost), error)
    }

    /// Position of a run: in the plot, on the rail, or (the reference itself) at the end of the smallest errors.
    fn place(&self, point: &Point) -> (f64, f64) {
        let cost = self.chart.cost.of(point);
        let (x, y) = self.at_parts(self.cost.part(cost), 1.0);
        match (self.error_of(point), &point.failed, self.error_on_x) {
            (Some(error), ..) => self.at(cost, error),
            (None, Some(_), false) => (x, y - 0.5 * RAIL - 3.0),
            (None, Some(_), true) => (x + 0.5 * RAIL + 3.0, y),
            (None, None, _) => self.at_parts(self.cost.part(cost), 0.0),
        }
    }

    fn draw(&self, sheet: &mut Sheet) -> Result<(), PlotError> {
        let (left, right) = (self.axes.left, self.axes.left + self.axes.size.0);
        let (top, bottom) = (self.axes.top, self.axes.top + self.axes.size.1);
        let colour = (250, 240, 240);
        let words = if self.error_on_x {
            sheet.bar((right + 6.0, top), (RAIL - 6.0, bottom - top), colour);
            (
                (right + 0.5 * RAIL + 3.0, bottom + 0.8 * LABEL),
                Anchor::Middle,
            )
        } else {
            sheet.bar((left, top - RAIL), (right - left, RAIL - 6.0), colour);
            ((left - 8.0, top - 0.5 * RAIL - 3.0), Anchor::Right)
        };
        sheet.text(words.0, "failed", SMALL, BLACK, words.1);
        self.draw_axes(sheet);
        let mut taken = OccupiedArea::within(Patch {
            from: (LEFT + 2.0, if self.error_on_x { top } else { top - RAIL }),
            to: (LEFT + PLOT.0 - 2.0, bottom - 2.0),
        });
        if let Some(target) = self.chart.target.filter(|_| !self.is_force) {
            self.level(sheet, target, &format!("target {target:?}"), &mut taken)?;
        }
        if let Some(bar) = self.chart.uncertainty[usize::from(self.is_force)] {
            let words = format!("error bar of the reference: {}", sig2(bar));
            self.level(sheet, bar, &words, &mut taken)?;
        }
        if self
            .chart
            .points
            .iter()
            .filter_map(|p| self.error_of(p))
            .fold(f64::INFINITY, f64::min)
            < ROUND_OFF
        {
            let least = written(short(ROUND_OFF));
            let words = format!("round-off: below {least}, treated as equal");
            self.level(sheet, ROUND_OFF, &words, &mut taken)?;
        }
        if !self.is_force {
            self.front(sheet);
        }
        for k in 0..self.chart.series.len() {
            self.series(sheet, k, &mut taken);
        }
        let triangle = self.triangle(sheet, &mut taken);
        let mut key = self.labels(sheet, &mut taken)?;
        key.extend(triangle);
        self.legend(sheet);
        sheet.height = bottom + 4.2 * LABEL;
        sheet.paragraph(&key, SMALL, BLACK)
    }

    /// Draws a line at an error, with text at its end.
    fn level(
        &self,
        sheet: &mut Sheet,
        error: f64,
        words: &str,
        taken: &mut OccupiedArea,
    ) -> Result<(), PlotError> {
        let part = self.error.part(error.max(ROUND_OFF));
        let (from, to) = (self.at_parts(0.0, part), self.at_parts(1.0, part));
        sheet.dashed(&[from, to], 1.2, GREY);
        let wide = widest([words], SMALL)?;
        let middle = if self.error_on_x {
            let most = LEFT + PLOT.0 - RAIL - 4.0 - 0.5 * wide;
            ((from.0 + 6.0 + 0.5 * wide).min(most), from.1 - 12.0)
        } else {
            (to.0 - 4.0 - 0.5 * wide, to.1 - 9.0)
        };
        let size = (wide, 1.2 * SMALL);
        sheet.text(middle, words, SMALL, GREY, Anchor::Middle);
        taken.take(Patch::about(middle, size));
        Ok(())
    }

    fn draw_axes(&self, sheet: &mut Sheet) {
        let chart = self.chart;
        let error = match (self.is_force, chart.monitors.as_slice()) {
            (true, _) => match chart.forces.as_slice() {
                [] => "error of contact forces".to_owned(),
                some => format!("error of {} (relative to the largest)", some.join(", ")),
            },
            (false, []) => "error".to_owned(),
            (false, some) => format!("error of {} (relative to the largest)", some.join(", ")),
        };
        let numbers = |axis: LogAxis, most| {
            axis.ticks(most)
                .into_iter()
                .map(move |value| (axis.part(value), written(value)))
        };
        let cost = chart.cost.axis();
        if self.error_on_x {
            let x = (error.as_str(), numbers(self.error, 9));
            self.axes.draw(sheet, x, (cost, numbers(self.cost, 12)));
        } else {
            let x = (cost, numbers(self.cost, 9));
            self.axes
                .draw(sheet, x, (error.as_str(), numbers(self.error, 12)));
        }
    }

    /// Draws steps through the runs on the Pareto front.
    fn front(&self, sheet: &mut Sheet) {
        let chart = self.chart;
        let mut best: Vec<(f64, f64)> = chart
            .points
            .iter()
            .filter(|p| p.front)
            .filter_map(|p| Some((chart.cost.of(p), p.error?)))
            .collect();
        best.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut steps: Vec<(f64, f64)> = Vec::new();
        let mut before = None;
        for &(cost, error) in &best {
            steps.extend(before.map(|before| self.at(cost, before)));
            steps.push(self.at(cost, error));
            before = Some(error);
        }
        if steps.len() > 1 {
            sheet.line(&steps, 1.0, GREY);
        }
        for (cost, error) in best {
            ring(sheet, self.at(cost, error));
        }
    }

    fn series(&self, sheet: &mut Sheet, k: usize, taken: &mut OccupiedArea) {
        let chart = self.chart;
        let own: Vec<&Point> = chart.points.iter().filter(|p| p.series == k).collect();
        let whole: Vec<(f64, f64)> = own
            .iter()
            .filter_map(|p| Some(self.at(chart.cost.of(p), self.error_of(p)?)))
            .collect();
        sheet.stroke(&whole, 1.5, k);
        for pair in whole.windows(2) {
            taken.take_line(pair[0], pair[1]);
        }
        for point in own {
            let spread = point.spread.filter(|_| chart.cost == Cost::Time);
            if let Some(((least, most), error)) = spread.zip(self.error_of(point)) {
                sheet.line(&[self.at(least, error), self.at(most, error)], 1.0, GREY);
            }
            let place = self.place(point);
            if point.failed.is_some() {
                sheet.cross(place, 5.0, CROSS)
            } else {
                sheet.series_marker(place, k)
            }
            taken.take(Patch::about(place, (14.0, 14.0)));
        }
    }

    /// Draws a triangle at the last step of the first series whose error falls throughout; returns what it shows.
    fn triangle(&self, sheet: &mut Sheet, taken: &mut OccupiedArea) -> Option<String> {
        let chart = self.chart;
        let mut steps = (0..chart.series.len()).filter_map(|k| {
            let mut own: Vec<(f64, f64)> = chart
                .points
                .iter()
                .filter(|p| p.series == k)
                .filter_map(|p| Some((chart.cost.of(p), self.error_of(p)?)))
                .filter(|p| p.0 > 0.0 && p.1 > ROUND_OFF)
                .collect();
            own.sort_by(|a, b| a.0.total_cmp(&b.0));
            let falls =
                |pair: &[(f64, f64)]| pair[1].0 > pair[0].0 && (1.0 + TIE) * pair[1].1 < pair[0].1;
            let &[before, last] = own.last_chunk::<2>().filter(|_| own.len() > 2)?;
            own.windows(2).all(falls).then_some((k, before, last))
        });
        let (k, before, last) = steps.next()?;
        let order = (before.1 / last.1).ln() / (last.0 / before.0).ln();
        // The middle of the step, moved towards higher cost and error, where no run of the series lies.
        let between = |part: f64, a: f64, b: f64| a * (b / a).powf(part);
        let corner = |part: f64| {
            let (cost, error) = (
                between(part, before.0, last.0),
                between(part, before.1, last.1),
            );
            let (x, y) = self.at(cost, error);
            (x + 10.0, y - 10.0)
        };
        let (from, to) = (corner(0.25), corner(0.75));
        let third = if self.error_on_x {
            (from.0, to.1)
        } else {
            (to.0, from.1)
        };
        sheet.line(&[from, third, to, from], 1.2, BLACK);
        let horizontal = (0.5 * (from.0 + to.0), third.1 - 8.0);
        let vertical = (third.0 + 8.0, 0.5 * (from.1 + to.1));
        let (one, falls) = if self.error_on_x {
            (vertical, horizontal)
        } else {
            (horizontal, vertical)
        };
        sheet.text(one, "1", SMALL, BLACK, Anchor::Middle);
        let anchor = if self.error_on_x {
            Anchor::Middle
        } else {
            Anchor::Left
        };
        sheet.text(falls, &sig2(order), SMALL, BLACK, anchor);
        for (a, b) in [(from, third), (third, to), (to, from)] {
            taken.take_line(a, b);
        }
        for place in [one, falls] {
            taken.take(Patch::about(place, (2.0 * SMALL, 1.2 * SMALL)));
        }
        let (name, order) = (&chart.series[k], sig2(order));
        Some(format!(
            "Triangle: the error of \"{name}\" falls with the cost to the power of {order} in its last step."
        ))
    }

    /// Labels runs with their values or, if there is no room, with numbers; returns the meaning of the numbers.
    fn labels(
        &self,
        sheet: &mut Sheet,
        taken: &mut OccupiedArea,
    ) -> Result<Vec<String>, PlotError> {
        /// Maximum distance of a label from its run, and of a number.
        const REACH: (f64, f64) = (30.0, 160.0);
        const SIZE: f64 = 11.5;
        let mut key: Vec<String> = Vec::new();
        for point in &self.chart.points {
            let at = self.place(point);
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
                    let series = &self.chart.series[point.series];
                    key.push(format!("{number} {series}, {words}"));
                }
                break;
            }
        }
        if key.is_empty() {
            Ok(key)
        } else {
            Ok(vec![key.join(";  ")])
        }
    }

    fn legend(&self, sheet: &mut Sheet) {
        let left = LEFT + PLOT.0 + MARGIN;
        let line = |k: usize| self.axes.top + 14.0 + ENTRY * k as f64;
        for (k, name) in self.chart.series.iter().enumerate() {
            sheet.entry((left, line(k)), k, name);
        }
        if !self.is_force {
            let y = line(self.chart.series.len());
            ring(sheet, (left + 14.0, y));
            let words = "on the Pareto front";
            sheet.text((left + 36.0, y), words, LABEL, BLACK, Anchor::Left);
        }
    }
}

fn draw(sheet: &mut Sheet, chart: &Precision, error_on_x: bool) -> Result<(), PlotError> {
    ErrorPanel::new(chart, sheet.height, false, error_on_x).draw(sheet)?;
    if chart.points.iter().any(|p| p.force_error.is_some()) {
        ErrorPanel::new(chart, sheet.height, true, error_on_x).draw(sheet)?;
    }
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

/// Draws the ring of the Pareto front: the part not covered by the marker.
fn ring(sheet: &mut Sheet, at: (f64, f64)) {
    sheet.marker(at, 0, 8.5, BLACK);
    sheet.marker(at, 0, 7.0, (255, 255, 255));
}

/// The values only: `refine=2, increment=0.1` gives `2, 0.1`.
fn values(name: &str) -> String {
    joined(
        name.split(", ")
            .map(|pair| pair.rsplit('=').next().unwrap_or(pair).to_owned()),
        ", ",
    )
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
