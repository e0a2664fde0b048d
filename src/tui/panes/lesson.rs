//! The lesson: what the tutor says, and what to do next.

use crate::teach::Tutor;
use crate::teach::tutor::Paragraph;
use crate::tui::app::App;
use crate::tui::paint;
use crate::tui::theme::Theme;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};

/// Rows that the lesson wants at a width, border included; 0 without a lesson.
pub fn rows(app: &App, width: u16) -> u16 {
    let inner = usize::from(width.saturating_sub(2));
    match &app.lesson {
        Some(tutor) => 3 + said(tutor, inner, &app.theme).len() as u16,
        None => 0,
    }
}

/// Draws the lesson. What to do next stands in the last row; where the rest does not fit, its end is shown.
pub fn draw(buffer: &mut Buffer, area: Rect, app: &App) {
    let Some(tutor) = &app.lesson else { return };
    let inner = paint::frame(buffer, area, &title(tutor), false, &app.theme);
    let mut lines = said(tutor, inner.width as usize, &app.theme);
    let room = (inner.height as usize).saturating_sub(1);
    lines.drain(..lines.len().saturating_sub(room));
    lines.push(todo(tutor, inner.width as usize, &app.theme));
    paint::lines(buffer, inner, &lines);
}

fn title(tutor: &Tutor) -> String {
    let lesson = tutor.lesson();
    let (right, asked) = tutor.score();
    let place = match tutor.step() {
        Some(_) => format!("{}/{}", tutor.at() + 1, lesson.steps.len()),
        None => "done".into(),
    };
    let score = match asked {
        0 => String::new(),
        _ => format!("  score {right}/{asked}"),
    };
    format!("Lesson  {}  {place}{score}", lesson.title)
}

fn todo(tutor: &Tutor, width: usize, theme: &Theme) -> Line<'static> {
    let text = paint::cut(&format!("▶ {}", tutor.todo()), width.saturating_sub(2));
    Line::styled(format!(" {text}"), theme.key)
}

/// All that the tutor says, wrapped. A mark stands before what answers an answer, so that no colour is needed.
fn said(tutor: &Tutor, width: usize, theme: &Theme) -> Vec<Line<'static>> {
    let part = |paragraph: &Paragraph| match paragraph {
        Paragraph::Text(text) => wrapped("", text, width, theme.text),
        Paragraph::Option(number, text) => wrapped(&format!("{number} "), text, width, theme.text),
        Paragraph::Right(text) => wrapped("✓ ", text, width, theme.good),
        Paragraph::Wrong(text) => wrapped("✗ ", text, width, theme.warning),
    };
    tutor.page().iter().flat_map(part).collect()
}

/// A paragraph whose further lines stand under the first one's words.
fn wrapped(mark: &str, text: &str, width: usize, style: Style) -> Vec<Line<'static>> {
    let indent = mark.chars().count();
    let lines = paint::wrap(text, width.saturating_sub(2 + indent));
    let line = |(index, words): (usize, String)| {
        let mark = if index == 0 { mark } else { "" };
        Line::from(vec![
            Span::styled(format!(" {mark:<indent$}"), style),
            Span::styled(words, style),
        ])
    };
    lines.into_iter().enumerate().map(line).collect()
}
