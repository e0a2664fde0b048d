//! A chart of convergence: two quantities per iteration on a log scale, with their limits.

use crate::canvas::Canvas;
use crate::chartframe::ChartFrame;
use crate::theme::Theme;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Modifier;
use stickslip_core::plane::range;

/// Width of the axis with its labels.
pub const LABELS: u16 = 7;
/// An iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Its number.
    pub number: u32,
    /// The main quantity, ●.
    pub main: f64,
    /// Its limit.
    pub limit: f64,
    /// The other quantity, ○.
    pub other: f64,
    /// Its limit, if it has a separate one.
    pub other_limit: Option<f64>,
}

impl Point {
    fn numbers(&self) -> impl Iterator<Item = f64> + Clone + use<> {
        [self.main, self.other, self.limit]
            .into_iter()
            .chain(self.other_limit)
    }
}

/// The vertical axis: decades from the top down, then a row for exact zeros if there are any.
struct Scale {
    top: f64,
    bottom: f64,
    /// Decades from one label to the next, and the rows between them; the same everywhere.
    every: u16,
    apart: u16,
    /// Rows of decades.
    rows: u16,
    zero: bool,
}

impl Scale {
    fn new(points: &[Point], rows: u16) -> Self {
        let all = points.iter().flat_map(Point::numbers);
        let logs = all.filter(|v| v.is_finite() && *v > 0.0).map(f64::log10);
        let zero = points
            .iter()
            .any(|point| point.main <= 0.0 || point.other <= 0.0);
        let [bottom, top] = range(logs);
        let (bottom, top) = (bottom.floor(), top.ceil());
        let (top, bottom) = if top.is_finite() {
            (top, bottom.min(top - 1.0))
        } else {
            (0.0, -1.0)
        };
        let rows = rows.saturating_sub(u16::from(zero)).max(1);
        let decades = (top - bottom) as u16;
        let every = decades.div_ceil(((rows - 1) / 2).max(1)).max(1);
        let apart = (rows - 1) / decades.div_ceil(every);
        Scale {
            top,
            bottom,
            every,
            apart,
            rows,
            zero,
        }
    }

    /// Height of a value in rows from the top; NaN and infinity are drawn at the top.
    fn height(&self, value: f64) -> f64 {
        match value {
            v if v <= 0.0 => f64::from(self.rows) + 0.5,
            v if !v.is_finite() => 0.0,
            v => {
                let labels = (self.top - v.log10()) / f64::from(self.every);
                0.5 + labels * f64::from(self.apart)
            }
        }
    }
}

/// Whether an area is large enough for a chart.
pub fn fits(area: Rect) -> bool {
    area.height >= 4 && area.width > LABELS + 4
}

/// Draws the last iterations that fit.
pub fn draw(buffer: &mut Buffer, area: Rect, points: &[Point], theme: &Theme) {
    let frame = ChartFrame::within(area, LABELS);
    let field = frame.field;
    let room = (field.width as usize / 2).max(1);
    let shown = &points[points.len().saturating_sub(room)..];
    let scale = Scale::new(shown, field.height);
    let spread = (field.width as usize / shown.len().max(1)).max(2);
    let column = |index: usize| index * spread + spread / 2;

    // Lines and marks are drawn over the dim background.
    let ground = Rect {
        height: field.height,
        ..area
    };
    buffer.set_style(ground, theme.faint);
    axis(buffer, frame, &scale, theme);
    // The line runs through the marks, which are in the middle of a cell.
    let dot = |index: usize, value: f64| {
        let row = scale.height(value).floor();
        [column(index) as f64 * 2.0 + 0.5, row * 4.0 + 1.5]
    };
    let mut canvas = Canvas::new(field);
    let line: Vec<_> = shown
        .iter()
        .enumerate()
        .map(|(index, point)| dot(index, point.main))
        .collect();
    canvas.polyline(&line, theme.faint);
    canvas.render(buffer);
    for (index, point) in shown.iter().enumerate() {
        let at = |value: f64| (column(index), scale.height(value));
        for value in [Some(point.limit), point.other_limit]
            .into_iter()
            .flatten()
            .filter(|limit| !limit.is_nan())
        {
            limit(buffer, frame, at(value), spread, theme);
        }
        if !point.other.is_nan() {
            frame.mark(buffer, at(point.other), "○", theme.faint);
        }
        let good = point.main <= point.limit;
        let style = if good { theme.good } else { theme.strong };
        frame.mark(buffer, at(point.main), "●", style);
        // The iteration's number under its column, if it fits.
        let text = point.number.to_string();
        let middle = field.x as usize + column(index);
        let start = middle.saturating_sub(text.len() / 2);
        let wanted = index == 0 || spread > 3 || point.number.is_multiple_of(5);
        if wanted && start + text.len() <= area.right() as usize {
            frame.below(buffer, start as u16, &text, theme.faint);
        }
    }
}

/// Labels of the decades.
fn axis(buffer: &mut Buffer, frame: ChartFrame, scale: &Scale, theme: &Theme) {
    let decades = (scale.top - scale.bottom) as usize;
    frame.axis(buffer, theme.faint);
    for decade in (0..=decades).step_by(usize::from(scale.every)) {
        let power = scale.top as i32 - decade as i32;
        let row = scale.height(10f64.powi(power)).floor() as u16;
        let row = row.min(scale.rows - 1);
        let label = match power {
            0 => "1".into(),
            _ => format!("1e{power}"),
        };
        frame.tick(buffer, row, &label, theme.faint);
    }
    if scale.zero {
        frame.tick(buffer, scale.rows, "0", theme.faint);
    }
}

/// The limit across the width of one iteration.
fn limit(
    buffer: &mut Buffer,
    frame: ChartFrame,
    (column, height): (usize, f64),
    spread: usize,
    theme: &Theme,
) {
    let from = column.saturating_sub(spread / 2);
    for x in from..from + spread {
        let taken = frame
            .cell(buffer, x, height)
            .is_some_and(|cell| cell.symbol() != " ");
        if !taken {
            let style = theme.warning.remove_modifier(Modifier::UNDERLINED);
            frame.mark(buffer, (x, height), "┄", style);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(main: f64) -> Point {
        Point {
            number: 1,
            main,
            limit: 1e-10,
            other: main,
            other_limit: None,
        }
    }

    #[test]
    fn zero_has_a_separate_row_below_the_decades() {
        let one = Point {
            other: 0.0,
            ..point(1.0)
        };
        let scale = Scale::new(&[one, point(0.0)], 12);
        assert_eq!((scale.top, scale.bottom, scale.rows), (0.0, -10.0, 11));
        assert_eq!(scale.height(1.0), 0.5);
        assert_eq!(scale.height(1e-10), 10.5);
        assert_eq!(scale.height(0.0), 11.5);
    }

    #[test]
    fn labels_are_equally_far_apart() {
        for rows in 2..40 {
            for decades in 1..20 {
                let scale = Scale::new(&[point(1.0), point(10f64.powi(-decades))], rows);
                let label = |k: u16| scale.height(10f64.powi(-i32::from(k * scale.every)));
                assert_eq!(label(1) - label(0), f64::from(scale.apart));
                let lowest = scale.height(10f64.powi(-decades));
                assert!(lowest <= f64::from(scale.rows), "{rows} {decades}");
                assert!(scale.apart >= 1);
            }
        }
    }

    #[test]
    fn nan_and_infinity_are_drawn() {
        for value in [f64::NAN, f64::INFINITY, 0.0, 1e-320] {
            let odd = Point {
                limit: 0.0,
                other: 0.0,
                ..point(value)
            };
            let scale = Scale::new(&[odd], 1);
            assert!((0.0..3.0).contains(&scale.height(value)), "{value}");
        }
    }
}
