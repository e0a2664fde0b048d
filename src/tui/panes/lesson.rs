//! The lesson: the tutor's text and the next task.

use crate::app::App;
use crate::copied::row;
use crate::paint;
use crate::pane_entry::PaneEntry;
use crate::theme::Theme;
use crate::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use stickslip_debugger::Tutor;
use stickslip_debugger::teach::tutor::Paragraph;
use unicode_width::UnicodeWidthStr;

/// Rows that the lesson needs at a width, with border; 0 without a lesson.
pub fn rows(app: &App, width: u16) -> u16 {
    let inner = usize::from(width.saturating_sub(2));
    match &app.learning.lesson {
        Some(tutor) => {
            let todo = todo(tutor, inner, &app.theme);
            2 + (tutor_lines(tutor, inner, &app.theme).len() + todo.len()) as u16
        }
        None => 0,
    }
}

/// The pane.
pub const PANE: PaneEntry = PaneEntry {
    draw,
    actions: &[],
    copied: row,
    is_ahead: false,
};

/// Draws the lesson, with the next task at the bottom. If the text does not fit, a part of it is shown, with the key for more.
fn draw(buffer: &mut Buffer, area: Rect, app: &App, _: &View) {
    let Some(tutor) = &app.learning.lesson else {
        return;
    };
    let inner = paint::frame(buffer, area, &title(tutor, area.width), false, &app.theme);
    let (width, room) = room(area, tutor, &app.theme);
    let mut lines = tutor_lines(tutor, width, &app.theme);
    let (top, all) = (top(app, tutor, width, room), lines.len());
    let shown = top..(top + room).min(all);
    let same = app.learning.reading.edition == tutor.edition();
    let seen = if same { app.learning.reading.seen } else { 0 };
    lines = lines.into_iter().skip(top).take(room).collect();
    let more = all > shown.end.max(seen);
    if more {
        lines.push(Line::styled(" ▼ Space: more", app.theme.key))
    } else {
        lines.extend(todo(tutor, width, &app.theme))
    }
    paint::lines(buffer, inner, &lines);
    if shown.len() < all {
        let again = if more { "" } else { "; Backspace: to the top" };
        let place = format!(
            " lines {} to {} of {all}{again} ",
            shown.start + 1,
            shown.end
        );
        let x = area.x + 2;
        let room = usize::from(area.width.saturating_sub(4));
        let place = paint::cut(&place, room);
        buffer.set_string(x, area.bottom() - 1, place, app.theme.heading);
    }
}

/// Width and height available for the tutor's text.
pub fn room(area: Rect, tutor: &Tutor, theme: &Theme) -> (usize, usize) {
    let width = usize::from(area.width.saturating_sub(2));
    let inner = usize::from(area.height.saturating_sub(2));
    (width, inner.saturating_sub(todo(tutor, width, theme).len()))
}

/// The first visible line: the latest addition to the text, or the top of a new page.
pub fn top(app: &App, tutor: &Tutor, width: usize, room: usize) -> usize {
    let all = tutor_lines(tutor, width, &app.theme).len();
    let (now, then) = (tutor.edition(), app.learning.reading.edition);
    let wanted = match now.0 == then.0 {
        true if now.1 == then.1 => app.learning.reading.top,
        // The question above an answer has been read.
        true => all - result_lines(tutor, width, &app.theme).len(),
        false => 0,
    };
    wanted.min(all.saturating_sub(room))
}

/// The lesson's name, cut in favour of the place and the score.
fn title(tutor: &Tutor, width: u16) -> String {
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
    let fixed = "Lesson    ".width() + place.width() + score.width();
    let room = usize::from(width).saturating_sub(4 + fixed);
    let name = paint::cut(&lesson.title, room);
    format!("Lesson  {name}  {place}{score}")
}

/// The next task, wrapped.
fn todo(tutor: &Tutor, width: usize, theme: &Theme) -> paint::Lines {
    wrapped("▶ ", &tutor.todo(), width, theme.key)
}

/// The tutor's text, wrapped. A mark precedes the reply to an answer, so that it does not depend on colour.
pub fn tutor_lines(tutor: &Tutor, width: usize, theme: &Theme) -> paint::Lines {
    let page = tutor.page();
    page.iter()
        .flat_map(|part| paragraph(part, width, theme))
        .collect()
}

/// The tutor's reply to the last answer.
fn result_lines(tutor: &Tutor, width: usize, theme: &Theme) -> paint::Lines {
    match tutor.page().last() {
        Some(part @ (Paragraph::Right(_) | Paragraph::Wrong(_) | Paragraph::Hint(_))) => {
            paragraph(part, width, theme)
        }
        _ => Vec::new(),
    }
}

fn paragraph(part: &Paragraph, width: usize, theme: &Theme) -> paint::Lines {
    match part {
        Paragraph::Text(text) => wrapped("", text, width, theme.text),
        Paragraph::Equation(text) => wrapped("  ", text, width, theme.heading),
        Paragraph::Option(number, text) => wrapped(&format!("{number} "), text, width, theme.text),
        Paragraph::Right(text) => wrapped("✓ ", text, width, theme.good),
        Paragraph::Wrong(text) => wrapped("✗ ", text, width, theme.warning),
        Paragraph::Hint(text) => wrapped("hint: ", text, width, theme.text),
    }
}

/// A paragraph whose lines after the first are indented by the width of the mark.
fn wrapped(mark: &str, text: &str, width: usize, style: Style) -> paint::Lines {
    let lead = Span::styled(format!(" {mark}"), style);
    paint::hanging(&[lead], text, width.saturating_sub(2 + mark.width()), style)
}
