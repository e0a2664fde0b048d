//! The load factor over a monitor at each accepted increment up to the shown frame.

use crate::app::App;
use crate::canvas::Canvas;
use crate::chartframe::ChartFrame;
use crate::copied::monitored;
use crate::layout::{Pane, top};
use crate::paint;
use crate::pane_entry::{PaneEntry, frame};
use crate::theme::Theme;
use crate::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};
use stickslip_core::plane::range;
use stickslip_debugger::history::frame;
use stickslip_scene::{shortest, sig2, sig6};

/// Width of the axis with its labels.
const LABELS: u16 = 9;

/// The pane.
pub const PANE: PaneEntry = PaneEntry {
    draw,
    actions: &[("monitor", "monitor")],
    copied: monitored,
    is_ahead: false,
};

/// Draws the curve.
fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    let theme = &app.theme;
    let monitors = &view.model.monitors;
    let at = app.watched(view);
    let title = match monitors.get(at) {
        Some(monitor) if monitors.len() > 1 => {
            format!("Load over {}  {}/{}", monitor.name, at + 1, monitors.len())
        }
        Some(monitor) => format!("Load over {}", monitor.name),
        None => "Load".into(),
    };
    let title = paint::cut(&title, (area.width as usize).saturating_sub(4));
    let inner = frame(buffer, area, Pane::Curve, &title, app);
    let say = |buffer: &mut Buffer, text: &'static str| {
        paint::note(buffer, inner, text, theme);
    };
    if monitors.is_empty() {
        return say(buffer, "This scene has no monitors.");
    }
    let points = frame::curve(&view.frames[..=view.cursor], at);
    let Some([value, load]) = points.last() else {
        return say(buffer, "No increment accepted yet.");
    };
    let caption = Line::from(vec![
        Span::styled(" ● ", theme.strong),
        Span::raw(sig6(*value)),
        Span::styled("  at load ", theme.faint),
        Span::raw(shortest(*load)),
    ]);
    paint::lines(buffer, inner, &[caption]);
    // One row for the caption above, one for the numbers below.
    if inner.height >= 5 && inner.width > LABELS + 8 {
        let [_, plot] = top(inner, 1);
        // The scales use the whole history, so that they do not change when going back.
        let known = frame::curve(view.frames, at);
        let noise = monitors.get(at).map_or(0.0, |monitor| view.noise(monitor));
        chart(buffer, plot, &points, &known, noise, theme);
    }
}

/// The range of one coordinate, which includes zero, is wider than the noise and never overflows when subtracted.
fn span(points: &[[f64; 2]], axis: usize, noise: f64) -> [f64; 2] {
    const MOST: f64 = 1e300;
    let values = points.iter().map(|point| point[axis]);
    let [low, high] = range(values.filter(|x| x.abs() < MOST).chain([0.0]));
    match high - low {
        size if size > noise.max(1e-300) => [low, high],
        _ => [0.0, 1.0],
    }
}

fn chart(
    buffer: &mut Buffer,
    area: Rect,
    points: &[[f64; 2]],
    known: &[[f64; 2]],
    noise: f64,
    theme: &Theme,
) {
    let frame = ChartFrame::within(area, LABELS);
    let field = frame.field;
    let (x, y) = (span(known, 0, noise), span(known, 1, 0.0));
    let mut canvas = Canvas::new(field);
    let dot = canvas.scale(x, y);
    if x[0] < 0.0 && x[1] > 0.0 {
        canvas.line(dot([0.0, y[0]]), dot([0.0, y[1]]), theme.faint);
    }
    if y[0] < 0.0 && y[1] > 0.0 {
        canvas.line(dot([x[0], 0.0]), dot([x[1], 0.0]), theme.faint);
    }
    let dots: Vec<_> = points.iter().map(|point| dot(*point)).collect();
    canvas.polyline(&dots, theme.text);
    for dot in &dots {
        canvas.dot(*dot, theme.text);
    }
    canvas.render(buffer);
    if let Some(now) = dots.last() {
        canvas.mark(buffer, *now, "●", theme.strong);
    }
    axes(buffer, frame, x, y, theme);
}

/// Draws both axes with the numbers at their ends.
fn axes(buffer: &mut Buffer, frame: ChartFrame, x: [f64; 2], y: [f64; 2], theme: &Theme) {
    let label = |value: f64| {
        let whole = sig6(value);
        if whole.len() < usize::from(LABELS) {
            whole
        } else {
            sig2(value)
        }
    };
    frame.axis(buffer, theme.faint);
    let low = frame.field.height.saturating_sub(1);
    frame.tick(buffer, low, &label(y[0]), theme.faint);
    frame.tick(buffer, 0, &label(y[1]), theme.faint);
    let (left, right) = (sig6(x[0]), sig6(x[1]));
    let width = frame.field.width as usize;
    let room = width.saturating_sub(left.len());
    let text: String = format!("{left}{right:>room$}")
        .chars()
        .take(width)
        .collect();
    frame.below(buffer, frame.field.x, &text, theme.faint);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_span_includes_zero_and_is_never_empty() {
        assert_eq!(span(&[[2.0, -1.0], [3.0, 0.5]], 0, 0.0), [0.0, 3.0]);
        assert_eq!(span(&[[2.0, -1.0], [3.0, 0.5]], 1, 0.0), [-1.0, 0.5]);
        for odd in [0.0, f64::NAN, f64::INFINITY, -1e308, 1e-320] {
            assert_eq!(span(&[[odd, 0.0]], 0, 0.0), [0.0, 1.0], "{odd}");
        }
        assert_eq!(span(&[], 0, 0.0), [0.0, 1.0]);
        assert_eq!(span(&[[-5e-15, 1.0], [3e-15, 2.0]], 0, 1e-12), [0.0, 1.0]);
    }
}
