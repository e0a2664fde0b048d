//! The whole screen from the app and the view.

use crate::debug::session::Session;
use crate::outside::shown;
use crate::tui::app::{App, Overlay};
use crate::tui::layout::{self, Pane};
use crate::tui::theme::Theme;
use crate::tui::view::View;
use crate::tui::{
    branches, chooser, curve, decision, diagnosis, footer, help, lesson, manual, nodes, remedies,
    residual, shape, status, timeline, workprecision,
};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;
use ratatui::widgets::{Block, BorderType, Widget};
use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

/// Draws everything. Without a view (no scene yet) there is only the chooser.
pub fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: Option<&View>) {
    let slaves = view.map_or(0, |view| view.model.slaves.len());
    let outcome = view.map_or(1, |view| status::outcome_lines(app, view, area.width));
    let message = footer::message_lines(app, view, area.width);
    let rows = view.map_or(0, |_| lesson::rows(app, area.width));
    let places = layout::places(area, &app.choice(slaves, outcome, message, rows));
    status::draw(buffer, places.status, app, view);
    let body = places
        .panes
        .iter()
        .map(|pane| pane.1)
        .reduce(Rect::union)
        .unwrap_or_default();
    match (&app.overlay, view) {
        (Overlay::Help { top }, _) => help::draw(buffer, body, *top, &app.theme),
        (Overlay::Manual(reader), _) => manual::draw(buffer, body, reader, &app.theme),
        (Overlay::Chart(page), _) => workprecision::draw(buffer, body, page, &app.theme),
        (Overlay::Chooser { at }, _) => chooser::draw(buffer, body, *at, app),
        (_, None) => {}
        (_, Some(view)) => {
            for (pane, area) in &places.panes {
                draw_pane(*pane, buffer, *area, app, view);
            }
        }
    }
    footer::draw(buffer, &places, app, view);
    harmless(buffer, area);
}

/// Takes from the cells what a terminal would obey, and what was not shown as something else before.
fn harmless(buffer: &mut Buffer, area: Rect) {
    for at in area.intersection(buffer.area).positions() {
        let cell = &mut buffer[at];
        if cell.symbol().contains(shown::is_order) {
            let left: String = cell
                .symbol()
                .chars()
                .filter(|c| !shown::is_order(*c))
                .collect();
            cell.set_symbol(if left.is_empty() { " " } else { &left });
        }
    }
}

fn draw_pane(pane: Pane, buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    // These tell what comes next.
    let tells = [
        Pane::Timeline,
        Pane::Diagnosis,
        Pane::Branches,
        Pane::Remedies,
    ];
    if tells.contains(&pane) && app.hides_any(view) {
        let inner = frame(buffer, area, "Hidden", app.focus == pane, &app.theme);
        let text = " until you have said what follows";
        Line::styled(text, app.theme.faint).render(inner, buffer);
        return;
    }
    match pane {
        Pane::Nodes => nodes::draw(buffer, area, app, view),
        Pane::Decision => decision::draw(buffer, area, app, view),
        Pane::Residual => residual::draw(buffer, area, app, view),
        Pane::Shape => shape::draw(buffer, area, app, view),
        Pane::Curve => curve::draw(buffer, area, app, view),
        Pane::Lesson => lesson::draw(buffer, area, app),
        Pane::Timeline => timeline::draw(buffer, area, app, view),
        Pane::Diagnosis => diagnosis::draw(buffer, area, app, view),
        Pane::Branches => branches::draw(buffer, area, app, view),
        Pane::Remedies => remedies::draw(buffer, area, app, view),
    }
}

/// A pane's border and title; returns what is inside. The focus is a thick border, colour or not.
pub fn frame(buffer: &mut Buffer, area: Rect, title: &str, focused: bool, theme: &Theme) -> Rect {
    let (kind, border, title_style) = match focused {
        true => (BorderType::Thick, theme.focus, theme.focus),
        false => (BorderType::Plain, theme.faint, theme.heading),
    };
    let title = Line::styled(format!(" {} ", shown::line(title)), title_style);
    let block = Block::bordered()
        .border_type(kind)
        .border_style(border)
        .title(title);
    let inner = block.inner(area);
    block.render(area, buffer);
    inner
}

/// Writes lines one under the other as far as they fit.
pub fn lines(buffer: &mut Buffer, area: Rect, lines: &[Line]) {
    for (row, line) in area.rows().zip(lines) {
        line.render(row, buffer);
    }
}

/// A text that fits; what is cut off at the end shows as `…`.
pub fn cut(text: &str, width: usize) -> String {
    let text = shown::line(text);
    if text.width() <= width {
        return text.into_owned();
    }
    let mut room = width.saturating_sub(1);
    let kept = text.chars().take_while(|letter| {
        let wide = letter.width().unwrap_or(0);
        let fits = wide <= room;
        room = room.saturating_sub(wide);
        fits
    });
    let kept: String = kept.collect();
    match width {
        0 => kept,
        _ => format!("{}…", kept.trim_end()),
    }
}

/// Breaks a text into lines at its blanks.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in shown::line(text).split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}

/// The program's own screen as plain text, one line a row, no blanks at the ends.
pub fn picture(session: &Session, width: u16, height: u16) -> String {
    text(
        &App::new(Theme::mono(), Vec::new()),
        Some(&View::of(session)),
        width,
        height,
    )
}

/// Any screen as plain text.
pub fn text(app: &App, view: Option<&View>, width: u16, height: u16) -> String {
    let area = Rect::new(0, 0, width, height);
    let mut buffer = Buffer::empty(area);
    draw(&mut buffer, area, app, view);
    let rows = area.rows().map(|row| {
        let row: String = row
            .columns()
            .map(|cell| buffer[(cell.x, cell.y)].symbol())
            .collect();
        row.trim_end().to_string() + "\n"
    });
    rows.collect()
}
