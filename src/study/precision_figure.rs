//! Work-precision charts as pictures: error over cost, both in decades.
//!
//! Runs that failed stand on a rail above the plot, at what they cost until then, and are named below it.

use super::plot::PlotError;
use super::precision::{Point, Precision};
use super::sheet::{
    Anchor, BLACK, COLOURS, Colour, GREY, LABEL, MARGIN, PALE, SMALL, Sheet, widest,
};

/// The plot, without its axes' words.
const PLOT: (f64, f64) = (620.0, 420.0);
/// Height of the rail of failures.
const RAIL: f64 = 44.0;
/// Left of the plot.
const LEFT: f64 = 84.0;
/// The colour of crosses, and of nothing else.
const CROSS: Colour = (192, 0, 0);
/// Runs that failed and are named below the plot.
const MOST_FAILED: usize = 40;
/// Errors below this are drawn here: they are none.
pub const NOTHING: f64 = 1e-16;

/// An axis in decades.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decades {
    /// Exponent of ten at its beginning.
    pub low: i32,
    /// Exponent of ten at its end.
    pub high: i32,
}

impl Decades {
    /// The decades that hold some numbers above zero; one at least.
    pub fn of(values: impl Iterator<Item = f64>) -> Decades {
        let mut all = values.filter(|v| v.is_finite() && *v > 0.0).peekable();
        if all.peek().is_none() {
            return Decades { low: 0, high: 1 };
        }
        let (low, high) = all.fold((f64::INFINITY, 0.0_f64), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        let low = low.log10().floor() as i32;
        Decades {
            low,
            high: (high.log10().ceil() as i32).max(low + 1),
        }
    }

    /// Where a number lies, from 0 to 1.
    pub fn part(self, value: f64) -> f64 {
        let value = value.max(f64::MIN_POSITIVE).log10();
        ((value - f64::from(self.low)) / f64::from(self.high - self.low)).clamp(0.0, 1.0)
    }
}

/// Some charts, one below the other.
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

fn draw(sheet: &mut Sheet, chart: &Precision) -> Result<(), PlotError> {
    let top = sheet.height + RAIL;
    let wanted = chart.target;
    let x = Decades::of(chart.points.iter().map(|p| chart.cost.of(p)));
    let errors = chart.points.iter().filter_map(|p| p.error);
    let y = Decades::of(errors.map(|e| e.max(NOTHING)).chain(wanted));
    let at = |cost: f64, error: f64| {
        (
            LEFT + PLOT.0 * x.part(cost),
            top + PLOT.1 * (1.0 - y.part(error.max(NOTHING))),
        )
    };
    rail(sheet);
    axes(sheet, chart, x, y);
    if let Some(target) = wanted {
        let (_, height) = at(1.0, target);
        sheet.line(&[(LEFT, height), (LEFT + PLOT.0, height)], 1.5, GREY);
        let words = (LEFT + PLOT.0 - 4.0, height - 9.0);
        sheet.text(
            words,
            &format!("wanted {target:?}"),
            SMALL,
            GREY,
            Anchor::Right,
        );
    }
    front(sheet, chart, &at);
    for k in 0..chart.series.len() {
        series(sheet, chart, k, top, &at);
    }
    legend(sheet, chart, top);
    sheet.height = top + PLOT.1 + 4.2 * LABEL;
    let failed = || chart.points.iter().filter(|p| p.failed.is_some());
    for point in failed().take(MOST_FAILED) {
        let why = point.failed.as_deref().unwrap_or_default();
        let line = format!("✗ {}, {}: {why}", chart.series[point.series], point.name);
        sheet.paragraph(&[line], SMALL, CROSS)?;
    }
    if let Some(more @ 1..) = failed().count().checked_sub(MOST_FAILED) {
        sheet.paragraph(&[format!("✗ and {more} more")], SMALL, CROSS)?;
    }
    let told: Vec<String> = chart.verdict().into_iter().collect();
    sheet.paragraph(&told, SMALL, BLACK)?;
    sheet.paragraph(&chart.about, SMALL, GREY)
}

/// Where failures stand.
fn rail(sheet: &mut Sheet) {
    let top = sheet.height;
    sheet.bar((LEFT, top), (PLOT.0, RAIL - 6.0), (250, 240, 240));
    let words = (LEFT - 8.0, top + 0.5 * (RAIL - 6.0));
    sheet.text(words, "failed", SMALL, BLACK, Anchor::Right);
}

fn axes(sheet: &mut Sheet, chart: &Precision, x: Decades, y: Decades) {
    let top = sheet.height + RAIL;
    let (right, bottom) = (LEFT + PLOT.0, top + PLOT.1);
    for decade in x.low..=x.high {
        let place = LEFT + PLOT.0 * f64::from(decade - x.low) / f64::from(x.high - x.low);
        sheet.line(&[(place, top), (place, bottom)], 1.0, PALE);
        let words = (place, bottom + 0.8 * LABEL);
        sheet.text(words, &power(decade), SMALL, BLACK, Anchor::Middle);
    }
    let every = 1 + (y.high - y.low) / 12;
    for decade in (y.low..=y.high).filter(|d| (d - y.low) % every == 0) {
        let place = bottom - PLOT.1 * f64::from(decade - y.low) / f64::from(y.high - y.low);
        sheet.line(&[(LEFT, place), (right, place)], 1.0, PALE);
        let words = (LEFT - 6.0, place);
        sheet.text(words, &power(decade), SMALL, BLACK, Anchor::Right);
    }
    let corners = [
        (LEFT, top),
        (right, top),
        (right, bottom),
        (LEFT, bottom),
        (LEFT, top),
    ];
    sheet.line(&corners, 1.0, BLACK);
    let below = (0.5 * (LEFT + right), bottom + 2.4 * LABEL);
    sheet.text(below, chart.cost.axis(), LABEL, BLACK, Anchor::Middle);
    sheet.upright((MARGIN, 0.5 * (top + bottom)), "error", LABEL);
}

/// A power of ten for a person.
pub fn power(decade: i32) -> String {
    match decade {
        -2..=3 => format!("{}", 10f64.powi(decade)),
        _ => format!("1e{decade}"),
    }
}

/// Steps through the runs that none beats.
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
        // A ring: what the marker does not cover.
        sheet.marker(place, 0, 8.5, BLACK);
        sheet.marker(place, 0, 7.0, (255, 255, 255));
    }
}

fn series(
    sheet: &mut Sheet,
    chart: &Precision,
    k: usize,
    top: f64,
    at: &dyn Fn(f64, f64) -> (f64, f64),
) {
    let colour = COLOURS[k % COLOURS.len()];
    let own: Vec<&Point> = chart.points.iter().filter(|p| p.series == k).collect();
    let whole: Vec<(f64, f64)> = own
        .iter()
        .filter_map(|p| Some(at(chart.cost.of(p), p.error?)))
        .collect();
    if whole.len() > 1 {
        sheet.line(&whole, 1.5, colour);
    }
    for point in own {
        let words = values(&point.name);
        let (x, bottom) = at(chart.cost.of(point), 0.0);
        let place = match (point.error, &point.failed) {
            (Some(error), _) => at(chart.cost.of(point), error),
            (None, Some(_)) => (x, top - 0.5 * RAIL - 3.0),
            // The reference itself lies on the ground.
            (None, None) => (x, bottom),
        };
        match point.failed.is_some() {
            true => sheet.cross(place, 5.0, CROSS),
            false => sheet.marker(place, k, 4.0, colour),
        }
        let words = match point.reference {
            true => format!("{words} reference"),
            false => words,
        };
        let beside = (place.0 + 9.0, place.1 - 9.0);
        sheet.text(beside, &words, 11.0, colour, Anchor::Left);
    }
}

/// `refine=2, increment=0.1` as `2, 0.1`.
fn values(name: &str) -> String {
    let value = |pair: &str| pair.rsplit('=').next().unwrap_or(pair).to_owned();
    name.split(", ").map(value).collect::<Vec<_>>().join(", ")
}

fn legend(sheet: &mut Sheet, chart: &Precision, top: f64) {
    let left = LEFT + PLOT.0 + MARGIN;
    for (k, name) in chart.series.iter().enumerate() {
        let y = top + 14.0 + 22.0 * k as f64;
        let colour = COLOURS[k % COLOURS.len()];
        sheet.line(&[(left, y), (left + 28.0, y)], 1.5, colour);
        sheet.marker((left + 14.0, y), k, 4.0, colour);
        sheet.text((left + 36.0, y), name, LABEL, BLACK, Anchor::Left);
    }
    let y = top + 14.0 + 22.0 * chart.series.len() as f64;
    sheet.marker((left + 14.0, y), 0, 8.5, BLACK);
    sheet.marker((left + 14.0, y), 0, 7.0, (255, 255, 255));
    sheet.text(
        (left + 36.0, y),
        "beaten by none",
        LABEL,
        BLACK,
        Anchor::Left,
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_hold_what_they_are_made_of() {
        let x = Decades::of([3e-3, 0.2, f64::INFINITY, 0.0].into_iter());
        assert_eq!(x, Decades { low: -3, high: 0 });
        assert_eq!(Decades::of([1.0].into_iter()), Decades { low: 0, high: 1 });
        assert_eq!(Decades::of([].into_iter()), Decades { low: 0, high: 1 });
        assert!((x.part(1e-3), x.part(1.0)) == (0.0, 1.0));
        assert!((x.part(1e-2) - 1.0 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn a_point_is_labelled_by_its_values() {
        assert_eq!(values("refine=2, increment=0.1"), "2, 0.1");
        assert_eq!(values("plain"), "plain");
    }
}
