//! The residual by major iteration in the shown increment, on a log scale, with its limit.

use crate::app::App;
use crate::convergence::{self, Point};
use crate::copied::value;
use crate::layout::{Pane, top};
use crate::paint;
use crate::pane_entry::{PaneEntry, frame};
use crate::theme::Theme;
use crate::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};
use stickslip_core::Norms;
use stickslip_debugger::WatchQuantity;
use stickslip_debugger::explain::names;
use stickslip_scene::number;

/// Minimum height of a chart; where there is less, there are numbers of this width.
const CHART: u16 = 5;
const NUMBER: usize = 13;
/// Minimum height for a line about the judge.
const ROOM_FOR_JUDGE: u16 = 7;

/// The pane.
pub const PANE: PaneEntry = PaneEntry {
    draw,
    actions: &[],
    copied: |app, view| value(WatchQuantity::Residual, app, view),
    is_ahead: false,
};

/// Draws the residual.
fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    let theme = &app.theme;
    let title = match view.model.finished {
        None => "Residual by major iteration",
        Some(_) => "Residual (%) by iteration of this attempt",
    };
    let inner = frame(buffer, area, Pane::Residual, title, app);
    let Some((_, last)) = view.residuals.last() else {
        paint::note(buffer, inner, "No iteration yet.", theme);
        return;
    };
    let words = |value: f64| short(value, view);
    let percent = |part: f64| {
        if part.is_nan() {
            number::UNREPORTED.to_owned()
        } else {
            format!("{} %", number::shortest(100.0 * part))
        }
    };
    let (main, (other, value), limit) = match &view.model.finished {
        None => (
            words(last.relative),
            ("interface", words(last.interface)),
            words(last.limit),
        ),
        Some(run) => (
            percent(last.relative),
            ("correction", percent(last.correction)),
            format!("{}, {}", percent(last.limit), percent(run.correction_limit)),
        ),
    };
    let caption = Line::from(vec![
        Span::styled(" ● relative ", theme.faint),
        Span::styled(main, theme.strong),
        Span::styled(format!("  ○ {other} "), theme.faint),
        Span::raw(value),
        Span::styled("  ┄ limit ", theme.faint),
        Span::raw(limit),
    ]);
    let mut above = vec![caption];
    let shows_judge = inner.height >= ROOM_FOR_JUDGE && !app.learning.hides_verdict();
    above.extend(judged(view, theme).filter(|_| shows_judge));
    paint::lines(buffer, inner, &above);
    // With one row for the iteration numbers below the chart.
    let [_, plot] = top(inner, above.len() as u16);
    if plot.height < CHART {
        let room = usize::from(plot.width) / NUMBER;
        let first = view.residuals.len().saturating_sub(room);
        let row = |of: &dyn Fn(&(u32, Norms)) -> String| {
            let text: String = view.residuals[first..]
                .iter()
                .map(|one| format!("{:>1$}", of(one), NUMBER))
                .collect();
            Line::styled(text, theme.faint)
        };
        let rows = [
            row(&|(number, _)| number.to_string()),
            row(&|one| format!("● {}", words(point(one, view).main))).style(theme.text),
            row(&|one| format!("○ {}", words(point(one, view).other))),
        ];
        paint::lines(buffer, plot, &rows);
    } else if convergence::fits(plot) {
        // Values that an attached solver does not report are left out.
        let points: Vec<Point> = view
            .residuals
            .iter()
            .filter(|(_, norms)| !view.is_unreported(norms.relative))
            .map(|one| point(one, view))
            .collect();
        convergence::draw(buffer, plot, &points, theme);
    }
}

/// A number of a caption; a dash if an attached solver does not report it.
fn short(value: f64, view: &View) -> String {
    if view.is_unreported(value) {
        number::UNREPORTED.into()
    } else {
        number::sig4(value)
    }
}

/// An iteration with its norms.
fn point((number, norms): &(u32, Norms), view: &View) -> Point {
    let Some(run) = &view.model.finished else {
        return Point {
            number: *number,
            main: norms.relative,
            limit: norms.limit,
            other: norms.interface,
            other_limit: None,
        };
    };
    // In percent, as in the caption.
    Point {
        number: *number,
        main: 100.0 * norms.relative,
        limit: 100.0 * norms.limit,
        other: 100.0 * norms.correction,
        other_limit: Some(100.0 * run.correction_limit),
    }
}

/// The judge's worst violation in the last accepted increment; `None` before the first.
fn judged(view: &View, theme: &Theme) -> Option<Line<'static>> {
    let verdict = view.frame().state.start.verdict.as_ref()?;
    let worst = verdict.largest()?;
    let (sign, style) = if worst.is_broken() {
        ("✗", theme.warning)
    } else {
        ("✓", theme.good)
    };
    let node = worst.slave.map(|slave| names::slave(view.model, slave));
    let place = node.map(|node| format!(" at {node}")).unwrap_or_default();
    Some(Line::from(vec![
        Span::styled(" judge ", theme.faint),
        Span::styled(sign, style),
        Span::raw(format!(
            " {} {}",
            worst.law.name(),
            number::sig4(worst.amount)
        )),
        Span::styled(
            format!("{place}, allowed {:.0e}", worst.allowed),
            theme.faint,
        ),
    ]))
}
