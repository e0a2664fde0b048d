//! The residual over the major iterations of the shown increment, on a log scale, with the limit it must get under.

use crate::explain::names;
use crate::explain::number::short;
use crate::linear::norms::Norms;
use crate::tui::app::App;
use crate::tui::canvas::Canvas;
use crate::tui::chartframe::ChartFrame;
use crate::tui::layout::Pane;
use crate::tui::paint;
use crate::tui::theme::Theme;
use crate::tui::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

/// Width of the labels at the axis, the axis included.
const LABELS: u16 = 7;
/// Height from which on there is a line for the judge.
const ROOM_FOR_JUDGE: u16 = 7;
/// Most columns between two major iterations.
const SPREAD: usize = 14;

/// Draws the residual.
pub fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    let theme = &app.theme;
    let inner = paint::frame(
        buffer,
        area,
        "Residual by major iteration",
        app.focus == Pane::Residual,
        theme,
    );
    let Some((_, last)) = view.residuals.last() else {
        paint::lines(
            buffer,
            inner,
            &[Line::styled(" Nothing is solved yet.", theme.faint)],
        );
        return;
    };
    let caption = Line::from(vec![
        Span::styled(" ● relative ", theme.faint),
        Span::styled(short(last.relative), theme.strong),
        Span::styled("  ○ interface ", theme.faint),
        Span::raw(short(last.interface)),
        Span::styled("  ┄ limit ", theme.faint),
        Span::raw(short(last.limit)),
    ]);
    let mut above = vec![caption];
    above.extend(judged(view, theme).filter(|_| inner.height >= ROOM_FOR_JUDGE));
    paint::lines(buffer, inner, &above);
    let above = above.len() as u16;
    // A row for the numbers of the iterations below.
    if inner.height >= above + 4 && inner.width > LABELS + 4 {
        let plot = Rect {
            y: inner.y + above,
            height: inner.height - above,
            ..inner
        };
        chart(buffer, plot, &view.residuals, theme);
    }
}

/// What the judge found worst of the last accepted increment; `None` before the first.
fn judged(view: &View, theme: &Theme) -> Option<Line<'static>> {
    let verdict = view.frame().state.start.verdict.as_ref()?;
    let worst = verdict.largest()?;
    let (sign, style) = match worst.is_broken() {
        true => ("✗", theme.warning),
        false => ("✓", theme.good),
    };
    let node = worst.slave.map(|slave| names::slave(view.model, slave));
    let place = node.map_or(String::new(), |node| format!(" at {node}"));
    Some(Line::from(vec![
        Span::styled(" judge ", theme.faint),
        Span::styled(sign, style),
        Span::raw(format!(" {} {}", worst.law.name(), short(worst.amount))),
        Span::styled(
            format!("{place}, allowed {:.0e}", worst.allowed),
            theme.faint,
        ),
    ]))
}

/// The vertical axis: decades from the top down, and under them a row for what is exactly zero, if anything is.
struct Scale {
    top: f64,
    bottom: f64,
    /// Rows of decades.
    rows: u16,
    zero: bool,
}

impl Scale {
    fn new(values: &[(u32, Norms)], rows: u16) -> Self {
        let all = || {
            values
                .iter()
                .flat_map(|(_, norms)| [norms.relative, norms.interface, norms.limit])
        };
        let logs = || all().filter(|v| v.is_finite() && *v > 0.0).map(f64::log10);
        let zero = values
            .iter()
            .any(|(_, norms)| norms.relative <= 0.0 || norms.interface <= 0.0);
        let top = logs().fold(f64::NEG_INFINITY, f64::max).ceil();
        let bottom = logs().fold(f64::INFINITY, f64::min).floor();
        let (top, bottom) = if top.is_finite() {
            (top, bottom.min(top - 1.0))
        } else {
            (0.0, -1.0)
        };
        Scale {
            top,
            bottom,
            rows: rows.saturating_sub(u16::from(zero)).max(1),
            zero,
        }
    }

    /// Height of a value in rows from the top; what is not finite is at the top.
    fn height(&self, value: f64) -> f64 {
        match value {
            v if v <= 0.0 => f64::from(self.rows) + 0.5,
            v if !v.is_finite() => 0.0,
            v => {
                let part = (self.top - v.log10()) / (self.top - self.bottom);
                0.5 + part * f64::from(self.rows - 1)
            }
        }
    }
}

fn chart(buffer: &mut Buffer, area: Rect, values: &[(u32, Norms)], theme: &Theme) {
    let frame = ChartFrame::within(area, LABELS);
    let field = frame.field;
    let shown = &values[values.len().saturating_sub(field.width as usize / 2)..];
    let scale = Scale::new(shown, field.height);
    let spread = (field.width as usize / shown.len().max(6)).clamp(2, SPREAD);
    let column = |index: usize| index * spread + spread / 2;

    // What is drawn stands on faint ground.
    let ground = Rect {
        height: field.height,
        ..area
    };
    buffer.set_style(ground, theme.faint);
    axis(buffer, frame, &scale, theme);
    let dot =
        |index: usize, value: f64| [column(index) as f64 * 2.0 + 0.5, scale.height(value) * 4.0];
    let mut canvas = Canvas::new(field);
    let line: Vec<_> = shown
        .iter()
        .enumerate()
        .map(|(index, (_, norms))| dot(index, norms.relative))
        .collect();
    canvas.polyline(&line, theme.faint);
    canvas.render(buffer);
    for (index, (major, norms)) in shown.iter().enumerate() {
        let at = |value: f64| (column(index), scale.height(value));
        limit(buffer, frame, at(norms.limit), spread, theme);
        frame.mark(buffer, at(norms.interface), "○", theme.faint);
        let good = norms.relative <= norms.limit;
        let style = if good { theme.good } else { theme.strong };
        frame.mark(buffer, at(norms.relative), "●", style);
        // The number of an iteration under its column, where it fits.
        let text = major.to_string();
        let middle = field.x as usize + column(index);
        let start = middle.saturating_sub(text.len() / 2);
        let wanted = index == 0 || spread > 3 || major.is_multiple_of(5);
        if wanted && start + text.len() <= area.right() as usize {
            frame.below(buffer, start as u16, &text, theme.faint);
        }
    }
}

/// Decades at the axis.
fn axis(buffer: &mut Buffer, frame: ChartFrame, scale: &Scale, theme: &Theme) {
    let decades = (scale.top - scale.bottom) as usize;
    let every = decades
        .div_ceil((scale.rows as usize).saturating_sub(1).max(1))
        .max(1);
    frame.axis(buffer, theme.faint);
    for decade in (0..=decades).step_by(every) {
        let power = scale.top as i32 - decade as i32;
        let row = scale.height(10f64.powi(power)).floor() as u16;
        let row = row.min(scale.rows - 1);
        frame.tick(buffer, row, &format!("1e{power}"), theme.faint);
    }
    if scale.zero {
        frame.tick(buffer, scale.rows, "0", theme.faint);
    }
}

/// The limit, as far as one iteration reaches.
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
            frame.mark(buffer, (x, height), "┄", theme.warning);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn norms(relative: f64) -> Norms {
        Norms {
            relative,
            limit: 1e-10,
            ..Norms::default()
        }
    }

    #[test]
    fn zero_has_a_row_of_its_own_under_the_decades() {
        let scale = Scale::new(&[(1, norms(1.0)), (2, norms(0.0))], 12);
        assert_eq!((scale.top, scale.bottom, scale.rows), (0.0, -10.0, 11));
        assert_eq!(scale.height(1.0), 0.5);
        assert_eq!(scale.height(1e-10), 10.5);
        assert_eq!(scale.height(0.0), 11.5);
    }

    #[test]
    fn odd_numbers_have_a_place() {
        for value in [f64::NAN, f64::INFINITY, 0.0, 1e-320] {
            let scale = Scale::new(
                &[(
                    1,
                    Norms {
                        limit: 0.0,
                        ..norms(value)
                    },
                )],
                1,
            );
            assert!((0.0..3.0).contains(&scale.height(value)), "{value}");
        }
    }
}
